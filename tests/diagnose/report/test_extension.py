"""The extended rig: a rig file that every command reads, with what is no matter of the machine in comments."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from gearheat.model.machines.spec import PartSpec
from gearheat.model.parts.free_form import step
from gearheat.scenarios.load import load
from gearheat.scenarios.write import DIAGNOSED
from gearheat.tools.diagnose.library.cause import Form, Row, Theta, Values
from gearheat.tools.diagnose.report.extension import Applied, directions, extended

RIG = load("helical_two_stage")
OIL = next(name for name, kinds in RIG.entries.items() if "oil" in kinds)


def applied(form: Form, id: str = "cooling.air", **theta: float) -> Applied:
    return Applied(id, "It cools.", form, theta)


def beside(theta: Theta, row: Row) -> Values:
    """The added conductor gets its conductance."""
    return {"extra_air.G": theta["G"]}


@pytest.fixture
def conductor() -> Form:
    """A conductance between two bodies of the rig that have conductors already."""
    net = RIG.spec.connections[0]
    ports = [port for net in RIG.spec.connections for port in net if port.endswith((".heat", ".floor"))]
    assert len(ports) >= 2, net
    parts = (PartSpec("extra_air", "ThermalConductor", {"G": 0.0}),)
    nets = ((ports[0], "extra_air.a"), ("extra_air.b", ports[1]))
    return Form(parts=parts, connections=nets, values=beside)


def written(tmp_path: Path, text: str) -> Path:
    (path := tmp_path / "extended.toml").write_text(text, encoding="utf-8")
    return path


def test_a_cause_adds_its_part_under_a_free_name(tmp_path: Path, conductor: Form) -> None:
    one = applied(conductor, G=3.0)
    path = written(tmp_path, extended(RIG, {}, [one], "mine.csv").text({}))
    again = load(path)
    assert again.spec.part("found_air").values["G"] == 3.0
    assert again.value_sources["found_air.G"] == f"{DIAGNOSED} mine.csv, cooling.air"
    twice = load(written(tmp_path, extended(again, {}, [one], "later.csv").text({})))
    assert twice.spec.part("found_air_2").values["G"] == 3.0
    assert "cooling by the air (cooling.air)" in twice.doc


def test_what_is_nearly_nothing_may_be_very_uncertain(tmp_path: Path, conductor: Form) -> None:
    text = extended(RIG, {}, [applied(conductor, G=0.01)], "mine.csv").text({"posterior_1": {"found_air.G": 5.0}})
    assert load(written(tmp_path, text)).joint_uncertainties["posterior_1"]["found_air.G"] == 5.0


def test_calibrated_values_come_first_and_stay_within_their_range(tmp_path: Path) -> None:
    path, quantity = next((p, q) for p, q in RIG.settable().items() if q.high == 1.0 and not q.high_open)
    factor = Form(values=lambda theta, row: {f"{OIL}.nu_40": row.base[f"{OIL}.nu_40"] * ca.exp(theta["G"])})
    text = extended(RIG, {path: 1.3, f"{OIL}.nu_40": 1e-4}, [applied(factor, G=0.5)], "mine.csv").text({})
    again = load(written(tmp_path, text))
    assert again.spec.part(path.rpartition(".")[0]).values[quantity.name.rpartition(".")[2]] == 1.0
    assert f"# {path} would be 1.3; no more than this is possible." in text
    assert again.spec.part(OIL).values["nu_40"] == pytest.approx(1e-4 * float(ca.exp(0.5)))


def test_what_causes_change_stays_possible(tmp_path: Path) -> None:
    """A pump gives no more than it displaces."""
    rig = load("e_axle")
    more = Form(values=lambda theta, row: {"pump.eta_v": row.base["pump.eta_v"] * ca.exp(theta["G"])})
    text = extended(rig, {}, [applied(more, "cooling.oil_flow", G=0.5)], "a.csv").text({})
    assert load(written(tmp_path, text)).spec.part("pump").values["eta_v"] == 1.0
    assert "# pump.eta_v would be 1.517; no more than this is possible." in text


def test_a_value_that_the_file_leaves_to_its_default_is_written(tmp_path: Path) -> None:
    """A fan is a factor on the speed of the air, which no rig file states."""
    assert "k_air" not in RIG.spec.part("room").values
    factor = Form(values=lambda theta, row: {"room.k_air": row.base["room.k_air"] * ca.exp(theta["G"])})
    again = load(written(tmp_path, extended(RIG, {}, [applied(factor, "cooling.fan", G=0.5)], "a.csv").text({})))
    assert again.spec.part("room").values["k_air"] == pytest.approx(float(ca.exp(0.5)))


def test_several_oils_keep_their_own_values(tmp_path: Path) -> None:
    factor = Form(values=lambda theta, row: {f"{OIL}.nu_40": row.base[f"{OIL}.nu_40"] * theta["G"]})
    text = extended(RIG, {}, [applied(factor, G=1.5)], "mine.csv", oils=3).text({})
    assert "of the rig's own oil" in text.splitlines()[1]
    assert not load(written(tmp_path, text)).value_sources[f"{OIL}.nu_40"].startswith(DIAGNOSED)


@pytest.mark.parametrize(
    "form",
    [
        Form("T_oil", shown=lambda theta, row, true: {"T_oil": true["T_oil"] + theta["G"]}),
        Form(values=lambda theta, row: {f"{OIL}.nu_40": 1e-4 * (1 + theta["G"] * row.order)}),
        Form(values=lambda theta, row: {f"{OIL}.nu_40": 1e-6 * (row.sensors["T_amb"] - 200)}),
        Form(values=lambda theta, row: {f"{OIL}.nu_40": 1e-4 * (1 + theta["G"] * step(row.rise - 90))}),
        Form(values=lambda theta, row: {f"{OIL}.nu_40": 1e-4 * (1 + theta["G"] * step(290 - row.sensors["T_amb"]))}),
        Form(values=lambda theta, row: {f"{OIL}.nu_40": 1e-4 * theta["G"]}, spread="test"),
        Form("anew with each mounting", spread="mounting"),
    ],
)
def test_instruments_and_days_are_comments(tmp_path: Path, form: Form) -> None:
    text = extended(RIG, {}, [applied(form, "sensor.oil_temp.offset", G=2.0)], "mine.csv").text({})
    assert "# Not a matter of the machine, hence not below: sensor.oil_temp.offset" in text
    assert "G = 2" in text.splitlines()[1]
    assert load(written(tmp_path, text)).spec.parts == RIG.spec.parts


def test_directions_hold_the_whole_covariance(tmp_path: Path) -> None:
    """v = v_0 exp(s x_0) and w = 3 x_0 + x_1, with x_0 and x_1 correlated, go through the file; u stays as it is."""
    covariance, x = np.array([[0.04, 0.03], [0.03, 0.09]]), np.array([0.5, 1.0])

    def values(x: np.ndarray) -> dict[str, float]:
        return {f"{OIL}.nu_40": 1e-4 * np.exp(0.2 * x[0]), "room.k_air": 3 * x[0] + x[1], "room.humidity": 0.5}

    found = directions(values, x, covariance)
    slopes = np.array([[0.2e-4 * np.exp(0.1), 0.0], [3.0, 1.0]])
    again = load(written(tmp_path, extended(RIG, {}, [], "a.csv").text(found))).joint_uncertainties
    assert list(again) == ["posterior_1", "posterior_2"]
    changes = np.array([[moved.get(path, 0.0) for path in (f"{OIL}.nu_40", "room.k_air")] for moved in again.values()])
    assert changes.T @ changes == pytest.approx(slopes @ covariance @ slopes.T, rel=2e-4)
    assert not any("room.humidity" in moved for moved in again.values())


def test_the_same_findings_give_the_same_bytes(conductor: Form) -> None:
    one = applied(conductor, G=3.0)
    assert extended(RIG, {}, [one], "a.csv").text({}) == extended(RIG, {}, [one], "a.csv").text({})
