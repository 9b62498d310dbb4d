"""An importer in C, written from the standard alone, drives the FMU through what importers do and what they must not.

The checks themselves are C (`importer/`), so that what is tested is the binary and not a Python layer around it.
"""

import re
import sys
from pathlib import Path
from types import SimpleNamespace

import fmpy
import pytest
from fmu_in_c import check, checks, library, planetary, planetary_on_torques, sanitizer, told, unpacked

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the checks read the memory of a process of Linux")

#: An input and a value with which no step can be done.
BREAKING = {"rc": ("source.v", 1e300), "heat": ("load.tau", 1e9), "planetary": ("oil.Q_flow_external", -1e9)}


@pytest.fixture(scope="module")
def facts(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Unpacked FMUs: a circuit, a network with a stiff shaft, the planetary rig and the same with its speed a state."""
    folder = tmp_path_factory.mktemp("importer")
    made = {"rc": (models.rc, None), "heat": (models.heat, None)}
    made |= {"planetary": planetary(), "torques": planetary_on_torques()}
    return {name: unpacked(flat, folder / name, start) for name, (flat, start) in made.items()}


@pytest.mark.parametrize("model", BREAKING)
def test_what_the_standard_allows_is_done_and_all_else_refused(facts: dict[str, Path], model: str) -> None:
    assert "37 calls in 10 modes" in check(facts[model], "order", *BREAKING[model])


def test_instances_that_must_not_come_to_be(facts: dict[str, Path]) -> None:
    assert check(facts["rc"], "birth")


@pytest.mark.parametrize("model", BREAKING)
def test_the_order_of_setting_does_not_matter(facts: dict[str, Path], model: str) -> None:
    check(facts[model], "shuffle", 20)


@pytest.mark.parametrize("model", BREAKING)
def test_a_run_after_a_reset_is_a_fresh_run(facts: dict[str, Path], model: str) -> None:
    check(facts[model], "reset")


@pytest.mark.parametrize("model", BREAKING)
def test_a_rollback_at_any_point_is_bit_equal(facts: dict[str, Path], model: str) -> None:
    check(facts[model], "rollback", 300)


@pytest.mark.parametrize("model", BREAKING)
def test_a_saved_state_goes_on_in_another_process(facts: dict[str, Path], model: str, tmp_path: Path) -> None:
    going_on = check(facts[model], "save", tmp_path / "state")
    assert len(going_on.splitlines()) == 20
    assert check(facts[model], "restore", tmp_path / "state") == going_on


def test_a_saved_state_of_another_fmu_is_refused(facts: dict[str, Path], tmp_path: Path) -> None:
    check(facts["heat"], "save", tmp_path / "state")
    with pytest.raises(AssertionError, match="saved by another FMU"):
        check(facts["rc"], "restore", tmp_path / "state")


@pytest.mark.parametrize(("model", "rounds"), [("rc", 200), ("heat", 60), ("planetary", 6)])
def test_sixteen_threads_give_what_each_run_gives_alone(facts: dict[str, Path], model: str, rounds: int) -> None:
    check(facts[model], "threads", rounds)


def test_threads_do_not_race(facts: dict[str, Path], tmp_path: Path) -> None:
    if not (compiler := sanitizer("thread", tmp_path)):
        pytest.skip("there is no gcc with the thread sanitizer")
    options = ("-fsanitize=thread", "-O1", "-g")
    racing = library(facts["heat"], compiler, *options)
    text = facts["heat"].read_text().splitlines()
    (tmp_path / "facts.txt").write_text("\n".join([f"library {racing}", *text[1:]]) + "\n")
    told(checks(compiler, "-fsanitize=thread"), tmp_path / "facts.txt", "threads", 3)


@pytest.mark.parametrize("model", BREAKING)
def test_ten_thousand_lives_leave_no_byte_behind(facts: dict[str, Path], model: str) -> None:
    assert "0 bytes" in check(facts[model], "cycles", 10_000)


def test_a_million_tenths_of_a_second_without_drift(facts: dict[str, Path]) -> None:
    check(facts["heat"], "drift", 1_000_000, 0.1, 1e-4)
    check(facts["planetary"], "drift", 20_000, 0.1, 1e-4)


@pytest.mark.parametrize(
    ("model", "steps"),
    [("rc", (0.01, 0.1, 1, 10, 100, 500, 1000)), ("heat", (0.01, 0.1, 1, 10, 100, 500, 1000))]
    + [("planetary", (0.1, 1, 10, 100, 500, 1000))],
)
def test_the_step_does_not_matter_but_by_the_tolerance(
    facts: dict[str, Path], model: str, steps: tuple[float, ...]
) -> None:
    """After 6000 s with jumps at every 1000 s all states agree within ten times the tolerance of one step."""
    said = check(facts[model], "steps", 6000, 1e-5, 1e-4, *steps)
    assert len(re.findall(r"^step", said, re.MULTILINE)) == len(steps)


@pytest.mark.parametrize(
    ("model", "phase", "step"),
    [("rc", 30, 0.01), ("heat", 30, 5e-4), ("planetary", 30, 0.1), ("torques", 0.05, 1e-5)],
)
def test_model_exchange_with_an_integrator_of_ones_own(
    facts: dict[str, Path], model: str, phase: float, step: float
) -> None:
    check(facts[model], "exchange", phase, step, 1e-6)


@pytest.mark.parametrize("model", ["rc", "heat", "planetary", "torques"])
def test_derivatives_along_everything_in_every_mode_and_what_depends_on_what(
    facts: dict[str, Path], model: str
) -> None:
    found: dict[str, set[str]] = {}
    for line in check(facts[model], "slopes").splitlines():
        unknown, known = line.split()
        found.setdefault(unknown, set()).add(known)
    described = fmpy.read_model_description(str(facts[model].parent / "model.fmu"))
    parameters = {v.name for v in described.modelVariables if v.causality == "parameter"}
    reals = {v.name for v in described.modelVariables if v.type == "Real"}
    listed = {u.variable.name: {v.name for v in u.dependencies} & reals for u in described.initialUnknowns}
    while_stepping = {
        u.variable.name: {v.name for v in u.dependencies} for u in (*described.outputs, *described.derivatives)
    }
    assert len(found) > 2
    for unknown, known in found.items():
        assert known <= listed[unknown], f"{unknown} depends on more at the start than is listed"
        assert known - parameters <= while_stepping[unknown], f"{unknown} depends on more than is listed"
    for unknown in listed.keys() - {"validity.count"}:  # a count has no slope
        if "residual" not in unknown:
            assert listed[unknown] == found.get(unknown, set()), f"{unknown} does not depend on all that is listed"
