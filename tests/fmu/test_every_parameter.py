"""Every parameter of the shipped rigs, set in the FMU, in a batch or for a run, gives what the rig file gives with it.

Where values contradict each other, all of them refuse.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import product, zip_longest
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from for_each import one_of_each, thin
from gearheat.fmu.batch import Batch, Status
from gearheat.fmu.export import export
from gearheat.model.core.flat import FlatModel, Quantity
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.spec import Spec
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

RIGS = ("helical_two_stage", "planetary")
Values = dict[str, float]
Open = Callable[..., Any]


@dataclass(frozen=True)
class Rig:
    """A shipped rig, flattened once: everything else is about changing its parameters afterwards."""

    spec: Spec
    flat: FlatModel

    def vector(self, values: Mapping[str, float]) -> np.ndarray:
        p = self.flat.starts("parameter")
        for name, value in values.items():
            p[self.flat.locate(name)[1]] = value
        return p

    def refuses(self, values: Mapping[str, float]) -> bool:
        """Whether the rig file with these values is refused."""
        try:
            for part in self.spec.with_values(values).parts:
                if any(name.startswith(f"{part.name}.") for name in values):
                    PARTS[part.type](part.name, **part.values)
        except ScenarioError:
            return True
        return False

    def assembled(self, values: Mapping[str, float]) -> FlatModel:
        """The model of the rig file with these values."""
        return self.spec.with_values(values).flat()


@cache
def rig(name: str) -> Rig:
    spec = load(name).spec
    return Rig(spec, spec.flat())


def moved(q: Quantity, share: float) -> float | None:
    """Another value of a parameter, in its range; the next one of a number that is whole."""
    whole = q.start == round(q.start) and q.start >= 1 and q.unit == "1"
    steps = (1.0, -1.0) if whole and share > 0.01 else (q.start * share or q.nominal * share,)
    candidates = [q.start + sign * step for step in steps for sign in (1.0, -1.0)]
    return next((value for value in candidates if q.problem(value) is None), None)


def changes(flat: FlatModel, share: float) -> Values:
    found = {q.name: moved(q, share) for q in flat.parameters}
    return {name: value for name, value in found.items() if value is not None}


def rounds(values: Values) -> Iterator[Values]:
    """One change per part at a time, so that few models have to be assembled."""
    by_part: dict[str, list[str]] = {}
    for name in values:
        by_part.setdefault(name.rpartition(".")[0], []).append(name)
    for names in zip_longest(*by_part.values()):
        yield {name: values[name] for name in names if name is not None}


def outputs(flat: FlatModel, p: np.ndarray) -> np.ndarray:
    """Derivatives and outputs at the states the model starts from."""
    x, u = flat.starts("state") + 20.0, flat.starts("input")
    found = evaluate_at(flat, x, u, p)
    return np.concatenate([found["ode"], found["y"]])


@pytest.mark.parametrize("name", RIGS)
def test_every_parameter_can_be_changed(name: str) -> None:
    flat = rig(name).flat
    assert changes(flat, 1e-3).keys() == {q.name for q in flat.parameters}


@pytest.mark.parametrize(("name", "share"), one_of_each(product(RIGS, (1e-3, 0.1)), lambda case: case[0]))
def test_a_changed_parameter_is_a_changed_rig_file(name: str, share: float) -> None:
    """Also for all that follows from it, at the same states; what the rig file refuses, no run begins with."""
    here = rig(name)
    flat = here.flat
    refused = {n for n, v in changes(flat, share).items() if here.refuses({n: v})}
    assert refused == {n for n, v in changes(flat, share).items() if flat.contradictions(here.vector({n: v}))}
    kept = {n: v for n, v in changes(flat, share).items() if n not in refused}
    for values in rounds(kept):
        again = here.assembled(values)
        expected = outputs(again, again.starts("parameter"))
        found = outputs(flat, here.vector(values))
        assert found == pytest.approx(expected, rel=1e-9, abs=1e-9), values


@pytest.mark.parametrize("name", thin(RIGS, 1, apart=2))
def test_steady_states_and_batches_agree_with_the_rig_file(name: str) -> None:
    here = rig(name)
    flat = here.flat
    every = list(rounds({n: v for n, v in changes(flat, 1e-3).items() if not here.refuses({n: v})}))
    rows = Batch(flat).steady(None, np.array([here.vector(values) for values in every]))
    assert (rows.status == Status.OK).all()
    for k, values in enumerate(every):
        expected = steady(here.assembled(values), {})
        own = steady(flat, values)
        for q in flat.outputs:
            assert own[q.name][0] == pytest.approx(expected[q.name][0], rel=1e-9, abs=1e-7), (q.name, values)
            assert rows[q.name][k] == pytest.approx(expected[q.name][0], rel=1e-9, abs=1e-7), (q.name, values)


@pytest.mark.parametrize("name", RIGS)
def test_what_the_rig_file_refuses_no_row_of_a_batch_answers(name: str) -> None:
    here = rig(name)
    values = changes(here.flat, 0.1)
    batch = Batch(here.flat)
    rows = batch.steady(None, np.array([here.vector({n: v}) for n, v in values.items()]))
    refused = [here.refuses({n: v}) for n, v in values.items()]
    assert any(refused)
    assert ((rows.status == Status.CONTRADICTION) == refused).all()
    assert np.isnan(rows.x[refused]).all()
    names = batch.contradictions(np.array([here.vector({n: v}) for n, v in values.items()]))
    assert [n is not None for n in names] == refused


@pytest.fixture(scope="module", params=RIGS)
def exported(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Rig, Path]:
    here = rig(request.param)
    return here, export(here.flat, tmp_path_factory.mktemp("every") / f"{request.param}.fmu")


def test_the_fmu_agrees_with_the_rig_file(exported: tuple[Rig, Path], opened: Open) -> None:
    """Each change alone: either both refuse, or all outputs are the same. Idle parameters are none of the FMU's."""
    here, path = exported
    flat, one = here.flat, opened(path)
    names = [q.name for q in flat.outputs]
    for share in (1e-3, 0.1):
        held = {n: v for n, v in changes(flat, share).items() if n in one.refs or (n in one.whole and v == round(v))}
        assert len(held) > 0.8 * len(flat.parameters)
        for name, value in held.items():
            one.fmu.reset()
            one.set(**{name: value})
            if here.refuses({name: value}):
                status, told = one.refused(one.start)
                assert status == 3
                assert told.startswith(f"fmi2ExitInitializationMode: {name.rpartition('.')[0]}: ")
                continue
            one.start()
            p = here.vector({name: value})
            expected = evaluate_at(flat, flat.starts("state"), flat.starts("input"), p)["y"]
            assert one.get(*names) == pytest.approx(expected, rel=1e-9, abs=1e-9), name


def test_parameters_that_are_tuned_must_fit_at_the_next_step(exported: tuple[Rig, Path], opened: Open) -> None:
    """One by one they may pass through values that do not; no step begins with those, and no output shows them."""
    here, path = exported
    (name,) = (n for n in ("stage_1.m_n", "gear_set.m_n") if n in here.flat.index)
    own = here.flat.quantity(name).start
    one = opened(path).start()
    one.fmu.doStep(0.0, 1.0)
    one.fmu.setReal([one.refs[name]], [1.5 * own])
    status, told = one.refused(lambda: one.fmu.doStep(1.0, 1.0))
    assert status == 3
    assert "does not hold" in told
    assert one.refused(lambda: one.get("efficiency.P_loss"))[0] == 2
    one.fmu.setReal([one.refs[name]], [own])
    one.fmu.doStep(1.0, 1.0)
    assert one.get("efficiency.P_loss")[0] > 0


def test_a_parameter_that_is_tuned_a_little_moves_the_outputs_as_a_little_more_does(
    exported: tuple[Rig, Path], opened: Open
) -> None:
    """Also where it moves what is solved for by less than the iteration leaves: the last correction is applied."""
    here, path = exported
    one = opened(path).start()
    one.fmu.doStep(0.0, 60.0)
    names = [q.name for q in here.flat.outputs if not q.name.endswith("residual")]
    scale = np.abs(one.get(*names)).max()
    tuned = [v for v in one.description.modelVariables if v.variability == "tunable" and v.name in one.refs]
    near = {v.name: here.flat.quantity(v.name) for v in tuned if float(v.start)}
    held = {n: q.start for n, q in near.items() if not any(q.problem(q.start * (1 + s)) for s in (2e-5, -2e-5))}
    for name, start in held.items():
        outputs = []
        for share in (2e-5, 1e-5, -1e-5, -2e-5):
            one.set(**{name: start * (1 + share)})
            outputs.append(np.array(one.get(*names)))
        one.set(**{name: start})
        more, little = (outputs[0] - outputs[3]) / 2, outputs[1] - outputs[2]
        assert little == pytest.approx(more, rel=0.01, abs=1e-12 * scale), name
    assert len(held) > 50


def test_model_exchange_goes_on_only_with_parameters_that_fit(exported: tuple[Rig, Path], opened: Open) -> None:
    _, path = exported
    one = opened(path, FMU2Model).start()
    (name,) = (n for n in ("stage_1.m_n", "gear_set.m_n") if n in one.refs)
    one.set(**{name: 0.1})
    status, told = one.refused(one.fmu.enterContinuousTimeMode)
    assert status == 3
    assert told.startswith("fmi2EnterContinuousTimeMode: ")
    assert any("does not hold" in text for _, _, text in one.messages)


def test_a_derived_parameter_is_found_in_the_fmu_and_says_what_it_follows_from(opened: Open, tmp_path: Path) -> None:
    here = rig("helical_two_stage")
    one = opened(export(here.flat, tmp_path / "helical.fmu"))
    assert "is calculated" in one.refused(lambda: one.set(stage_1__eps_alpha=1.5))[1]
    (variable,) = (v for v in one.description.modelVariables if v.name == "stage_1.eps_alpha")
    assert "follows from z_1, z_2" in variable.description
    one.start()
    assert one.get("stage_1.eps_alpha")[0] == pytest.approx(here.flat.quantity("stage_1.eps_alpha").start, rel=1e-12)
