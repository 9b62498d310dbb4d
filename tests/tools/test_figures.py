"""Words of every figure in the reports of `run`, `diagnose` and `plan`: none lies over another or beyond the edge."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from typing import Any

import fabricated_findings
import numpy as np
import pytest
from fabricated_findings import AIR, CHURNING, EMISSIVITY, KINDS, OFFSET, WINDAGE, explained
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.compare import report
from gearheat.tools.compare.errors import channels_of
from gearheat.tools.diagnose.answer.evidence import Rows, View
from gearheat.tools.diagnose.answer.plan import Outlook, Plan, Planned, PlannedCause, PlannedPair
from gearheat.tools.diagnose.report import page, plan
from gearheat.tools.diagnose.report.page import render
from matplotlib.figure import Figure
from pages import words_that_collide


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[Figure]]:
    """The figures that are drawn; at the end their words are looked at."""
    found: list[Figure] = []
    monkeypatch.setattr(report, "hovering", lambda figure, marks: found.append(figure) or "<svg></svg>")
    for module in (page, report):
        monkeypatch.setattr(module, "svg", lambda figure: found.append(figure) or "<svg></svg>")
    yield found
    assert [word for figure in found for word in words_that_collide(figure)] == []


@pytest.mark.parametrize("kind", KINDS)
def test_of_a_diagnosis(drawn: list[Figure], kind: str) -> None:
    render(KINDS[kind]())
    assert drawn


def test_of_a_diagnosis_of_many_channels(drawn: list[Figure]) -> None:
    """Three channels, five quantities, three questions."""
    few = fabricated_findings.rows()
    speed = few.quantities["w"].values
    names = {"T_oil": "oil temperature", "T_room": "room temperature", "order": "running order"}
    names |= {"tau": "carrier torque", "dwell": "time the point was held"}
    quantities = {k: Rows.Quantity(label=v, unit="degC", values=np.array(speed) * 1.7) for k, v in names.items()}
    channels = {f"T_housing_{k}": few.channels["T_oil"] for k in range(3)}
    rows = few.model_copy(update={"quantities": quantities, "channels": channels})
    order, wave = np.arange(24.0), 0.4 * np.sin(np.arange(24.0))
    given: dict[str, Any] = {"p": 0.3, "nothing": 0.7, "causes": (), "unit": "K", "order": order, "deviation": wave}
    asks = "against the other thermometers and T_sun, given the measured temperatures of housing and room"
    views = tuple(View(channel=f"T_housing_{k}", asks=asks, **given) for k in range(3))
    render(explained(rows=rows, views=views, pictures=()))
    assert len(drawn) == 2


PAIRS = ((AIR, EMISSIVITY), (CHURNING, WINDAGE), (OFFSET, "cooling.internal_pressure"))


@pytest.mark.parametrize("pairs", [PAIRS[:1], PAIRS, (*PAIRS, (AIR, CHURNING))])
def test_of_a_plan(drawn: list[Figure], pairs: tuple[tuple[str, str], ...]) -> None:
    """Twelve experiments, three of them together, for few and for many pairs."""

    def outlook(far: float, *names: str) -> Outlook:
        each = tuple(Outlook.Pair(causes=pair, before=0.4, after=far + k) for k, pair in enumerate(pairs))
        return Outlook(experiments=names, smallest=far, nearest=pairs[0], gain=far, separates=far > 3, pairs=each)

    names = [f"instrument.heat_flux_{k}" for k in range(12)]
    found = Plan(
        rig="mine",
        verdict="several",
        causes=tuple(PlannedCause(id=id, usual=0.4, visible=4.0) for pair in pairs for id in pair),
        pairs=tuple(PlannedPair(causes=pair, distance=0.4) for pair in pairs),
        now=outlook(0.4),
        catalogue=tuple(Planned(id=name, what="heat flux at a wall") for name in names),
        outlooks=tuple(outlook(0.9 + 1.1 * k, name) for k, name in enumerate(names)),
        together=(outlook(11.97, *names[:2]), outlook(13.0, *names[:3])),
    )
    drawn.append(plan.picture(found))


def test_of_a_run(drawn: list[Figure]) -> None:
    """All readings of the planetary rig, the simulation a little off."""
    with (RIGS / "planetary" / "measured.csv").open(encoding="utf-8") as file:
        readings = list(csv.DictReader(file))
    rows = []
    for k, reading in enumerate(readings):
        row: dict[str, Any] = {
            key: int(float(reading[key])) for key in ("point", "test", "direction", "n_set_rpm", "T_set_Nm")
        }
        for key in ("T_oil_C", "T_wall_C", "T_amb_C"):
            row |= {f"{key}_meas": float(reading[key]), key: float(reading[key]) + np.sin(k)}
        rows.append(row | {"oil": reading["oil"], "time_s": 14400.0, "P_loss_W": 500.0 + k, "P_loss_W_meas": 510.0})
    losses = tuple(report.LOSSES)
    for row in rows:
        row |= {name: 10.0 + 3 * k for k, name in enumerate(losses)}
    time = np.linspace(0.0, 335 * 60.0, 20)
    curves = {
        t: {"time": time, **{n: 20 + time / 1e3 for n in ("T_oil_C", "T_wall_C", "T_amb_C")}} for t in (1, 16, 22, 36)
    }
    channels = channels_of(rows)
    report.parity(rows, channels)
    report.residuals(rows, channels, {"T_oil_K": 0.3})
    report.warm_up(curves, rows)
    report.breakdown(rows, losses)
    report.shares(rows[0], losses)
    assert len(drawn) == 5
