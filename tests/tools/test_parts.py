"""`gearheat parts` and `gearheat schema`: what a rig can be built of."""

from __future__ import annotations

import json
import tomllib

from for_each import for_each
from gearheat.model.core.declare import Parameter, Port, list_declared
from gearheat.model.parts import PARTS
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.describe import parts
from gearheat.tools.export.extras import text_of

SCHEMA = parts.schema()


def test_all_types_are_listed(gearheat):
    types = gearheat("parts", "--json", "-").json["types"]
    assert [t["type"] for t in types] == list(PARTS)
    assert all(t["doc"].endswith((".", ":")) for t in types)


@for_each(PARTS)
def test_everything_about_a_type(kind):
    found = parts.describe_part(kind)
    assert [p["name"] for p in found["parameters"]] == list(list_declared(PARTS[kind], Parameter))
    assert [p["name"] for p in found["ports"]] == list(list_declared(PARTS[kind], Port))
    assert found["equations"]
    for line in (*found["parameters"], *found["ports"], *found["outputs"]):
        assert line["doc"], line
    example = tomllib.loads(found["example"])
    assert example["part"]["name"]["type"] == kind
    assert set(example["part"]["name"]) <= set(SCHEMA["$defs"][f"part_{kind}"]["properties"])


def test_a_type_without_words(monkeypatch):
    """One of a user's own, or any where Python leaves out all docstrings (-OO)."""
    for cls in PARTS["HeatCapacity"].__mro__[:-1]:
        monkeypatch.setattr(cls, "__doc__", None)
    assert parts.schema()["$defs"]["part_HeatCapacity"]
    assert text_of(PARTS["HeatCapacity"]("body", C=1.0)).doc == "HeatCapacity: "


def test_a_lip_seal_tells_what_other_laws_give(gearheat):
    """The recommended law first, the spread of three and more at one shaft; parts of one law alone have none."""
    lines = gearheat("parts", "LipSeal", "--json", "-").json["spread"]
    assert "recommended" in lines[0]["law"]
    torques = [float(line["100 mm [N.m]"]) for line in lines]
    assert max(torques) > 3 * min(torques)
    assert "What laws give at the same sizes" in gearheat("parts", "OilLipSeal").out
    assert parts.describe_part("LabyrinthSeal")["spread"] == []


def test_one_type_for_a_reader(gearheat):
    answer = gearheat("parts", "LipSeal")
    assert answer.code == 0
    for words in ("Ports", "Parameters", "d_sh", "Equations: ", "[part.name]", "values of the rig"):
        assert words in answer.out
    wrong = gearheat("parts", "Lipseal")
    assert wrong.code == 2
    assert 'Did you mean "LipSeal"' in wrong.err


def test_the_schema_knows_every_key_of_every_shipped_rig(gearheat, tmp_path):
    path = tmp_path / "rig.schema.json"
    assert "#:schema rig.schema.json" in gearheat("schema", "-o", path).out
    found = json.loads(path.read_text())
    assert found == json.loads(gearheat("schema").out)
    for rig in RIGS.glob("*/rig.toml"):
        table = tomllib.loads(rig.read_text(encoding="utf-8"))
        assert set(table) <= set(found["properties"]), rig
        for name, part in table["part"].items():
            known = found["$defs"].get(f"part_{part.get('type')}", {}).get("properties")
            assert known is None or set(part) <= set(known), (rig, name)


def test_the_version(gearheat):
    answer = gearheat("--version")
    assert answer.code == 0
    assert answer.out.startswith("gearheat ")
