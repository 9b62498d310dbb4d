"""Parts of a rig of `gearheat new` that are set wrong are named by what they are, in campaigns that nobody tuned to.

A cheap campaign of some faults; with `GEARHEAT_HIDDEN=all` three rigs of each fault, and of a healthy machine.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path

import pytest
from challenge.answers import ask_here, read_answer
from challenge.classes import class_of
from challenge.new_rig import FAULTS, PLATES, write_campaign, write_rig
from for_each import thin

ALL = os.environ.get("GEARHEAT_HIDDEN", "") == "all"
#: What is hidden -> the class that names it, and how many hypotheses may come before it.
NAMED: Mapping[str, tuple[str, int]] = {
    "fan dead": ("cooling.fan", 0),
    "fan at 40 %": ("cooling.fan", 0),
    "teeth": ("losses.mesh_friction", 2),
}
#: What is hidden -> word of the verdict: one bearing of many may show as the loss of all of them.
SAID = {"bearing": "bearing"}
#: Seed of the rig that is diagnosed fastest.
CHEAP = 3
CASES = [(f, seed) for f in FAULTS for seed in PLATES] if ALL else [(f, CHEAP) for f in thin(FAULTS, apart=2)]


@pytest.mark.parametrize(("fault", "seed"), CASES)
def test_what_is_set_wrong_is_named(fault: str, seed: int, tmp_path: Path) -> None:
    rig = write_rig(tmp_path, seed)
    data = write_campaign(tmp_path, rig, fault, seed)
    ask_here(str(rig), {"data": data}, tmp_path / "answer")
    answer = read_answer(tmp_path / "answer")
    leading = [f"{'+'.join(sorted(h.names)) or 'nothing'} {h.probability:.2f}" for h in answer.hypotheses[:4]]
    print(f"{fault}, rig {seed}: {answer.verdict}, {', '.join(leading)}")
    if fault in SAID:
        result = json.loads((tmp_path / "answer" / "RESULT.json").read_text("utf-8"))
        assert SAID[fault] in result["says"]["verdict"]
        return
    if fault not in NAMED:
        assert not answer.alarm
        return
    cause, before = NAMED[fault]
    assert answer.alarm
    assert any(class_of(cause) in h.names for h in [answer.top, *answer.hypotheses][: before + 1])
