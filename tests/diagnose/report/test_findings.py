"""Findings are their own schema, take arrays, and hold no digits that mean nothing."""

import json
from importlib.resources import files

import numpy as np
import pytest
from fabricated_findings import KINDS, explained
from gearheat.tools.diagnose.answer.evidence import Rows
from gearheat.tools.diagnose.answer.findings import Alarm, Findings, Hypothesis
from gearheat.tools.diagnose.answer.numbers import as_object
from pydantic import ValidationError

SHIPPED = files("gearheat.tools.diagnose.report").joinpath("diagnosis.schema.json")


def test_the_shipped_schema_is_that_of_the_models() -> None:
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": "gearheat.diagnosis/2"}
    wanted = head | Findings.model_json_schema(by_alias=True, mode="serialization")
    text = json.dumps(wanted, indent=1, ensure_ascii=False) + "\n"
    assert SHIPPED.read_text(encoding="utf-8") == text, f"the file should hold:\n{text}"


@pytest.mark.parametrize("kind", KINDS)
def test_a_result_survives_its_json(kind: str) -> None:
    found = KINDS[kind]()
    text = json.dumps(as_object(found), allow_nan=False)
    again = Findings.model_validate(json.loads(text))
    assert json.dumps(as_object(again)) == text
    assert again == found


def test_fields_of_version_1_are_there_with_their_meaning() -> None:
    found = as_object(explained())
    assert found["schema"] == "gearheat.diagnosis/2"
    assert {"verdict", "test", "hypotheses", "causes", "confusable", "impact", "gain", "next_experiment"} <= set(found)
    assert {"alpha", "p_any", "p_omnibus", "p_adequacy", "draws"} == set(found["test"])
    assert found["hypotheses"][0] == {"causes": ["losses.churning"], "probability": 0.96, "mc_error": 0.012}
    assert found["causes"][0]["parameters"][0]["ci95"] == [102.0, 132.0]
    assert found["gain"]["before"] == {"without": 2.3, "with": 1.2}
    assert found["gain"]["rmse_before"] == 2.3


def test_arrays_become_lists_and_missing_readings_null() -> None:
    values = Rows.Values(measured=np.array([20.123456789, np.nan]), nominal=np.zeros(2), sd=np.float64(0.1234567891))
    assert values.model_dump(mode="json")["measured"] == [20.123, None]
    assert values.sd == 0.123457


def test_probabilities_never_add_up_to_more_than_one() -> None:
    parts = [Hypothesis(causes=(str(k),), probability=1 / 3 + 1e-12) for k in range(3)]
    assert sum(h.probability for h in parts) <= 1.0


def test_a_p_ends_where_no_null_is_known() -> None:
    assert Alarm(alpha=0.05, p_any=2.7e-190, p_adequacy=1.0).p_any == 1e-6


def test_findings_are_frozen_and_know_their_keys() -> None:
    found = explained()
    with pytest.raises(ValidationError, match="frozen"):
        found.verdict = "consistent"  # type: ignore[misc]
    with pytest.raises(ValidationError, match="propability"):
        Hypothesis(causes=(), propability=0.5)  # type: ignore[call-arg]
