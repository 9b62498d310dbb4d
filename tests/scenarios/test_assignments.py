"""Values from the command line: units, catalogue names, and all mistakes at once."""

import math

import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError
from gearheat.scenarios.load import load
from gearheat.scenarios.scenario import Scenario, parse_assignments
from gearheat.scenarios.values import oil_values


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load("planetary")


@pytest.fixture(scope="module")
def flat(scenario: Scenario) -> FlatModel:
    return scenario.spec.flat()


def problems(target: Scenario | FlatModel, *texts: str) -> tuple[str, ...]:
    with pytest.raises(ScenarioError) as raised:
        parse_assignments(target, texts)
    return raised.value.problems


def test_values_in_si(scenario: Scenario) -> None:
    values = parse_assignments(scenario, ["carrier.w=250 rpm", " room.T = 20 degC ", "gear_set.k_mu=1", "oil.V=0.5 l"])
    assert values == pytest.approx(
        {"carrier.w": 250 * math.pi / 30, "room.T": 293.15, "gear_set.k_mu": 1, "oil.V": 5e-4}
    )


def test_either_shaft_may_be_set_whatever_the_rig_drives(scenario: Scenario) -> None:
    assert parse_assignments(scenario, ["sun.tau=-600 N.m"]) == {"sun.tau": -600}


def test_outputs_of_a_flat_model_as_targets(flat: FlatModel) -> None:
    assert parse_assignments(flat, ["sun.tau=-600 N.m", "oil.T=80 degC"]) == {"sun.tau": -600, "oil.T": 353.15}


def test_a_catalogue_name_sets_all_of_its_part(scenario: Scenario) -> None:
    expected = {f"oil.{key}": value for key, value in oil_values("MINR").items()}
    assert parse_assignments(scenario, ["oil=MINR"]) == expected
    changed = scenario.with_values(expected)
    assert changed.spec.part("oil").values["nu_40"] == pytest.approx(319.25e-6)
    assert changed.spec.part("oil").values["V"] == pytest.approx(1e-3)


def test_a_catalogue_is_no_value_of_its_part(scenario: Scenario) -> None:
    """As an FMU has it: `oil.oil` chooses an oil there."""
    assert problems(scenario, "oil.oil=MINR") == ('planetary: unknown name "oil.oil". Write "oil=MINR".',)


def test_a_later_value_wins_over_a_catalogue_name(scenario: Scenario) -> None:
    values = parse_assignments(scenario, ["oil=MINR", "oil.nu_40=100 mm2/s"])
    assert values["oil.nu_40"] == pytest.approx(1e-4)
    assert values["oil.nu_100"] == pytest.approx(22.41e-6)


def test_all_mistakes_at_once(scenario: Scenario) -> None:
    texts = "carier.w=250 rpm", "room.T=20", "room.T", "oil=MINNR", "oil.V=-1 l", "oil.V=1 kg", "sun_bearing=PAOR", "=3"
    assert problems(scenario, *texts) == (
        'planetary: unknown name "carier.w". Did you mean "carrier.w" or "carrier" or "carrier.tau"?',
        'room.T = "20" has no unit. Write "20 degC" (expected a unit like K).',
        '"room.T" is no assignment. Write name=value with its unit, for example "room.T=20 degC".',
        'oil = MINNR: unknown oil "MINNR". Did you mean "MINR" or "MINE"?',
        'oil.V = "-1 l" is out of range. It must be above 0 l.',
        'oil.V = "1 kg": unit "kg" does not fit m3. Write for example "20 l".',
        f'sun_bearing = PAOR: unknown bearing "PAOR". Known: {", ".join(scenario_bearings(scenario))}.',
        '"=3" is no assignment. Write name=value with its unit, for example "room.T=20 degC".',
    )


def scenario_bearings(scenario: Scenario) -> list[str]:
    from gearheat.scenarios.entries import catalogue

    return list(catalogue("bearing"))


def test_a_catalogue_name_means_nothing_to_a_flat_model(flat: FlatModel) -> None:
    (problem,) = problems(flat, "oil=MINR")
    assert problem.startswith('planetary: unknown name "oil".')
