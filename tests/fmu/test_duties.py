"""Random duties of the shipped rigs, with jumps, extremes and nonsense: done well, or refused well.

Two thousand of them, ten thousand with GEARHEAT_TESTS=all.
"""

import re
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from fmu_in_c import HERE, library, told, unpacked
from for_each import ALL
from gearheat.scenarios.load import load
from gearheat.tools.bench.c_importer import Compiler, program
from gearheat.tools.export.fmu import operating_start
from gearheat.tools.solve.settings import adjust, drive_at, flat_of
from gearheat.tools.solve.simulate import first_temperatures

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processor time is asked of Linux")

#: Rig, shaft that drives, what is given, number of duties; the seeds are 1 to that number.
VARIANTS = {
    "carrier": ("planetary", "carrier", "speed", 700),
    "sun": ("planetary", "sun", "speed", 500),
    "torques": ("planetary", None, "torque", 200),
    "helical": ("helical_two_stage", None, "speed", 500),
    "helical on torques": ("helical_two_stage", None, "torque", 100),
}
#: How many times as many are done.
TIMES = 5 if ALL else 1

Facts = Callable[[str], Path]


@pytest.fixture(scope="module")
def facts(tmp_path_factory: pytest.TempPathFactory) -> Facts:
    """The facts of a variant's FMU, exported as the command does it."""
    folder = tmp_path_factory.mktemp("duties")

    @cache
    def made(variant: str) -> Path:
        rig, shaft, given, _ = VARIANTS[variant]
        scenario = load(rig)
        setting = adjust(scenario, drive=drive_at(scenario, shaft, given))
        flat = flat_of(setting)
        start = first_temperatures(setting, flat, None) | operating_start(scenario, setting, flat, ())
        return unpacked(flat, folder / variant, start)

    return made


def duties(facts: Path, count: int, *library: Path) -> str:
    return told(program([HERE / "duties.c"]), facts, 1, count, *library)


def test_there_are_as_many_as_is_said() -> None:
    assert TIMES * sum(count for *_, count in VARIANTS.values()) == (10_000 if ALL else 2_000)


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_step_is_bounded_and_none_is_wrong(facts: Facts, variant: str) -> None:
    count = TIMES * VARIANTS[variant][-1]
    said = duties(facts(variant), count)
    print(f"{variant}: {said}", end="")
    found = re.search(r"(\d+) duties begun of \d+, (\d+) steps done, (\d+) discarded", said)
    assert found, said
    begun, done, discarded = map(int, found.groups())
    assert begun > 0.9 * count
    assert done > 2 * count, "hardly anything was done"
    assert discarded > count / 2, "hardly anything was refused"


#: Faults the duties are there for: text of the source, what it becomes, what is told of it.
PLANTED = {
    "repeats what is hopeless": ("if (refused_before(m, step))", "if (0)", "the same step again is no error"),
    "steps out of the range": ("if (!in_range(FIRST_X + i, x_new[i])) {", "if (0) {", "after a good step"),
    "keeps a part of what it refuses": (
        "return stuck(m, time, step, &w);",
        "return m->s.x[0] += 1, stuck(m, time, step, &w);",
        "a refused step changed a value",
    ),
    "lets a slope lead anywhere": ("if ((r = input_astray(m, step)) != N_VARIABLES) {", "if (0) {", "good step"),
}


@pytest.mark.parametrize("fault", PLANTED)
def test_planted_faults_are_found(facts: Facts, fault: str, tmp_path: Path) -> None:
    before, after, expected = PLANTED[fault]
    own = facts("carrier")
    text = (own.parent / "sources" / "all.c").read_text()
    assert text.count(before) == 1
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "all.c").write_text(text.replace(before, after))
    (tmp_path / "facts.txt").write_text(own.read_text())
    with pytest.raises(AssertionError, match=expected):
        duties(own, 100, library(tmp_path / "facts.txt", Compiler.zig(), "-O1"))
