"""An effect is hidden in a campaign of some rig; the diagnosis, which gets its files alone, has to find it.

One effect of each family of causes and a clean campaign; with `GEARHEAT_HIDDEN=all python -m pytest -s
tests/challenge/test_hidden.py` every cause that campaigns of three rigs show, and twenty clean campaigns of each.
"""

from __future__ import annotations

import os
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from challenge import foreign, forms, model_rig, practice
from challenge.answers import ask_here, read_answer
from challenge.bench import rig_of
from challenge.cases import Drawn, make_case
from challenge.scoring import Outcome, score

ALL = os.environ.get("GEARHEAT_HIDDEN", "") == "all"
#: Steady points of two rigs, and timed tests of a planetary one with a healthy reference.
CAMPAIGNS = {
    "harmonic": partial(model_rig.draw_steady, machine="harmonic"),
    "helical": partial(model_rig.draw_steady, machine="helical_two_stage"),
    "foreign": foreign.draw,
}
#: Signal-to-noise ratios: large ones, as to keep effects apart from all rivals takes longer than to diagnose them.
BAND = (15.0, 40.0)
#: One effect of each family in a campaign that shows it: campaign, cause, seed.
FAMILIES = (
    ("helical", "losses.churning", 0),
    ("harmonic", "heat.external_source", 0),
    ("harmonic", "cooling.foundation", 0),
    ("foreign", "thermal.mass", 2),
    ("harmonic", "sensor.torque.since", 0),
    ("harmonic", "sensor.oil_temp.offset", 0),
    ("harmonic", "sensor.ambient.offset", 0),
    ("harmonic", "procedure.order", 0),
)
#: Every cause in every campaign that may show it.
EVERY = tuple(
    (name, cause, 0)
    for name in CAMPAIGNS
    for cause in (forms.names if name == "foreign" else forms.steady_names)("single")
)
#: Least share of causes in the 90 % set [1]: chance may hide one of the eight.
IN_SET = 0.8
#: Least share of causes named first [1].
FIRST = 0.6


def draw_strong(name: str, rng: np.random.Generator) -> Drawn:
    return replace(CAMPAIGNS[name](rng), band=BAND)


def diagnose_hidden(folder: Path, name: str, cause: str | None, seed: int) -> Outcome | None:
    """Hide a cause, or nothing; diagnose, score and print. None where no sensible amount of it shows as much."""
    kind = "single" if cause else "clean"
    try:
        truth = make_case(partial(draw_strong, name), 3, seed, 0, folder, kind=kind, cause=cause, apart=False)
    except LookupError:
        return None
    begin = time.process_time()
    ask_here(rig_of(truth), practice.files(folder / "case", made=True), folder / "answer")
    o = score(truth, read_answer(folder / "answer"), time.process_time() - begin)
    right = "first" if o.exact else "in set" if o.covered else "MISSED"
    print(f"{name:9} {cause} ({o.snr:.1f}): {right}, {o.top} ({o.p_top:.2f}), gross {o.gross}, {o.seconds:.1f} s")
    return o


def test_hidden_effects_are_named_or_in_the_set_and_gross_readings_named(tmp_path: Path) -> None:
    cases = EVERY if ALL else FAMILIES
    outcomes = [o for case in cases if (o := diagnose_hidden(tmp_path / "-".join(case[:2]), *case))]
    assert len(outcomes) >= (0.6 if ALL else 1.0) * len(cases)
    missed = [f"{o.truth}: {o.top} ({o.p_top:.2f})" for o in outcomes if not o.covered]
    assert len(missed) <= (1 - IN_SET) * len(outcomes), missed
    assert sum(o.exact for o in outcomes) >= FIRST * len(outcomes)
    # three in a hundred may be wrong and sure: of eight, one has a chance of .22, two of .02
    assert sum(o.sure_wrong for o in outcomes) <= (0.03 * len(outcomes) if ALL else 1)
    gross = [o.gross for o in outcomes if o.gross is not None]
    assert gross and sum(gross) >= IN_SET * len(gross)


@pytest.mark.parametrize("name", list(CAMPAIGNS) if ALL else ["harmonic"])
def test_clean_campaigns_raise_few_alarms(name: str, tmp_path: Path) -> None:
    """One alarm in twenty is what is asked for: two in two have a chance of less than one in a hundred."""
    outcomes = [diagnose_hidden(tmp_path / str(seed), name, None, seed) for seed in range(20 if ALL else 2)]
    assert sum(o is None or o.alarm for o in outcomes) <= (2 if ALL else 1)
