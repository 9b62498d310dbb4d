"""One case of the challenge: draws a rig, a campaign and what is hidden in it, and writes the files.

    FOLDER/case/DATA.csv, CARD.json, POINTS.csv [REF.csv] [SERIES.csv] [REF_SERIES.csv]   what the diagnosis sees
    FOLDER/TRUTH.json                                                                      what it does not

Everything follows from sheet, seed and number of the case.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import ScenarioError, suggestion
from . import write
from .card import DAY_COOLING_SD, PRIOR_SD, Instruments, card, draw_instruments, unequal, with_days
from .causes import CAUSES, OUTSIDE, merged_all
from .choose import KINDS, Hidden, choose, order_of_causes, schedule
from .foreign import ForeignRig, draw_sizes
from .hidden import Surroundings
from .own import own_rig
from .plan import Plan, draw_plan, draw_points
from .rig import Rig, Run, simulate
from .rivals import Rivals
from .signal import Campaign, Yardstick

SHEETS = ("own", "foreign")

#: Share of campaigns with a time series, with the humidity, with a second oil sensor, with tests that start warm.
SERIES, HUMIDITY, SECOND_OIL, WARM = 0.12, 0.35, 0.5, 0.15

#: No healthy rig gets its oil so hot in a test [degC]: its engineer would not run that.
HOT = 150.0

#: Causes that only a certain column can show.
NEEDS_HUMIDITY = ("cooling.humidity",)


#: Kinds of cases whose truth tells the nearest rival.
RIVALRY = ("single", "regime", "alike")


@dataclass(frozen=True)
class Setting:
    """A rig with its instruments and campaigns, before anything is hidden."""

    rig: Rig
    campaign: Campaign
    reference: Campaign | None
    points: Plan
    days: tuple[np.ndarray, np.ndarray]
    instruments: Instruments
    room_drift: float
    bearing_oil: bool
    inner_share: float
    columns: write.Columns


def make_case(
    sheet: str,
    seed: int,
    k: int,
    folder: Path,
    *,
    kind: str | None = None,
    causes: Sequence[str] | None = None,
    series: bool | None = None,
) -> dict[str, Any]:
    """Write one case.

    Args:
        sheet: "own" or "foreign"
        seed: of the whole challenge
        k: number of the case, from 0
        folder: for the files; made if need be
        kind: one of `KINDS`; drawn if left out
        causes: causes to hide, in the order to try them; drawn if left out. A regime's must be one that can be limited
        series: whether there is a time series; drawn if left out

    Returns:
        the truth, as written

    Raises:
        ScenarioError: an unknown sheet, kind or cause
        LookupError: none of the causes can be as loud as wanted, and as far from its rivals
    """
    check(sheet, kind, causes)
    number = SHEETS.index(sheet)
    drawn, rank = schedule(number, seed, k)
    kind = kind or drawn
    setting_rng, hidden_rng, noise_rng = (np.random.default_rng([seed, number, k, 10 + i]) for i in range(3))
    names = list(causes) * 8 if causes else order_of_causes(number, seed, kind, rank if kind == drawn else k)
    setting = draw_setting(sheet, setting_rng, series)
    while _hot(setting):
        setting = draw_setting(sheet, setting_rng, series)
    hidden: list[Hidden] = []
    if kind != "clean":
        yard = Yardstick(setting.rig, setting.campaign, setting.instruments, setting.reference)
        plan = setting.campaign.plan
        around = Surroundings(plan.n[0], plan.load[0], yard.oil, plan.tests, sheet == "own", setting.inner_share)
        rivals = Rivals(yard, around, humidity=setting.columns.humidity, seed=(seed, number, k, 13))
        hidden = choose(kind, sheet, iter(names), yard, around, rivals, hidden_rng)
    found = [h.effect.cause for h in hidden]
    if any(c in NEEDS_HUMIDITY for c in found):
        setting = replace(setting, columns=replace(setting.columns, humidity=True))
    truth = {"schema": "gearheat.truth/1", "sheet": sheet, "seed": seed, "case": k, "kind": kind}
    truth |= _write(setting, hidden, folder, noise_rng)
    if kind in RIVALRY:
        (rival,) = (h.rival for h in hidden)
        truth["rival"] = {"cause": rival.cause, "distance": round(rival.distance, 3)} if rival else None
    (folder / "TRUTH.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def check(sheet: str, kind: str | None, causes: Sequence[str] | None) -> None:
    """Raise ScenarioError with everything that names no sheet, kind or cause."""
    problems = []
    if sheet not in SHEETS:
        problems.append(f'challenge: unknown sheet "{sheet}".{suggestion(sheet, SHEETS)} Choose own or foreign.')
    if kind is not None and kind not in KINDS:
        problems.append(f'challenge: unknown kind "{kind}".{suggestion(kind, KINDS)} Kinds: {", ".join(KINDS)}.')
    known = {**CAUSES, **OUTSIDE}
    problems += [f'challenge: unknown cause "{c}".{suggestion(c, known)}' for c in causes or () if c not in known]
    if problems:
        raise ScenarioError(problems)


def draw_setting(sheet: str, rng: np.random.Generator, series: bool | None = None) -> Setting:
    """A rig and its campaigns. The own rig has unequal parameters and no reference; the foreign one has a reference."""
    own, series_drawn = sheet == "own", bool(rng.random() < SERIES)
    series = series_drawn if series is None else series
    warm = bool(rng.random() < WARM)
    room_drift = 0.0 if own else round(float(rng.uniform(-1.5, 0.5)), 2)
    plan = draw_plan(rng, warm_start=warm, room_drift=room_drift)
    rig: Rig
    if own:
        rig, base, inner_share, bearing_oil = own_rig(), unequal(rng, PRIOR_SD), own_rig().inner_share, False
    else:
        rig = foreign = ForeignRig(draw_sizes(rng))
        base, inner_share, bearing_oil = {}, foreign.inner_share, foreign.sizes.bearing_oil
    second = draw_plan(rng, warm_start=warm, room_drift=room_drift)
    if rng.random() < 0.6:  # the reference repeats the campaign's conditions, on other days in another order
        second = replace(second, n=plan.n + rng.normal(0, 0.5, plan.columns), load=plan.load)
    columns = write.Columns(
        humidity=bool(rng.random() < HUMIDITY), start=warm, date=bool(rng.random() < 0.5), second_oil=False
    )
    columns = replace(columns, second_oil=bool(rng.random() < SECOND_OIL))
    days = tuple(np.exp(rng.normal(0.0, DAY_COOLING_SD, p.columns)) for p in (plan, second))
    return Setting(
        rig=rig,
        campaign=Campaign(plan, base, series),
        reference=None if own else Campaign(second, base, series),
        points=draw_points(rng, plan, room_drift=room_drift),
        days=(days[0], days[1]),
        instruments=draw_instruments(rng, 0.25 if own else 0.7, columns.second_oil),
        room_drift=room_drift,
        bearing_oil=bearing_oil,
        inner_share=inner_share,
        columns=columns,
    )


def _hot(s: Setting) -> bool:
    """Whether a test of the healthy rig overheats."""
    campaigns = [c for c in (s.campaign, s.reference) if c is not None]
    ends = [_run(s, c.plan, c.base, (), False).ends for c in campaigns]
    return not all((e.values["T_oil_C"] < HOT).all() for e in ends)


def _write(s: Setting, hidden: Sequence[Hidden], folder: Path, rng: np.random.Generator) -> dict[str, Any]:
    """Simulate and write all files; the part of the truth that comes from it."""
    case = folder / "case"
    case.mkdir(parents=True, exist_ok=True)
    series = s.campaign.series
    base = with_days(s.campaign.base, s.days[0])
    ill = _run(s, s.campaign.plan, base, hidden, series)
    well = _run(s, s.campaign.plan, base, (), False) if hidden else ill
    _campaign_files(s, s.campaign.plan, ill, case, "", rng)
    if s.reference is not None:
        plan = s.reference.plan
        run = _run(s, plan, with_days(s.reference.base, s.days[1]), (), series)
        _campaign_files(s, plan, run, case, "REF_", rng)
    description = card(s.instruments, bearing_oil=s.bearing_oil, room_drift=s.room_drift, series=series)
    (case / "CARD.json").write_text(json.dumps(description, indent=1) + "\n", encoding="utf-8")
    points_ill = s.instruments.fixed(_run(s, s.points, s.campaign.base, hidden, False).ends)
    points_well = s.instruments.fixed(_run(s, s.points, s.campaign.base, (), False).ends)
    write.points(case / "POINTS.csv", s.points, points_ill, s.columns)
    change = {
        "T_oil_K": ill.ends.values["T_oil_C"] - well.ends.values["T_oil_C"],
        "T_wall_K": ill.ends.values["T_wall_C"] - well.ends.values["T_wall_C"],
        "loss_Nm": ill.ends.loss - well.ends.loss,
    }
    sd = s.instruments.repeat_sd
    loss_sd = float(np.hypot(sd["T_carrier_Nm"], 4.0 * sd["T_sun_Nm"]))
    return {
        "causes": [h.effect.cause for h in hidden],
        "answer": sorted(merged_all(h.effect.cause for h in hidden)),
        "effects": [_told(h) for h in hidden],
        "impact": {name: round(float(c.mean()), 5) for name, c in change.items()},
        "repeat_sd": {"T_oil_K": sd["T_oil_C"], "T_wall_K": sd["T_wall_C"], "loss_Nm": round(loss_sd, 4)},
        "points": write.point_truth(s.points, points_ill.values["T_oil_C"], points_well.values["T_oil_C"]),
        "rig": {"nodes": s.rig.nodes, "series": series},
    }


def _run(s: Setting, plan: Plan, base: Mapping[str, Any], hidden: Sequence[Hidden], series: bool) -> Run:
    acting = [(h.effect, np.full(plan.columns, h.amplitude)) for h in hidden]
    return simulate(s.rig, plan, base, acting, series=series)


def _campaign_files(s: Setting, plan: Plan, run: Run, case: Path, prefix: str, rng: np.random.Generator) -> None:
    """The table of steady readings, and the time series that ends in them."""
    shown = s.instruments.noisy(run.ends, rng)
    columns = replace(s.columns, first_day=write.FIRST_DAY - write.EARLIER) if prefix else s.columns
    write.table(case / ("REF.csv" if prefix else "DATA.csv"), plan, shown, columns)
    if s.campaign.series:
        write.series(case / f"{prefix}SERIES.csv", plan, run.steps, shown, s.instruments, rng)


def _told(h: Hidden) -> dict[str, Any]:
    """An effect for the record."""
    e = h.effect
    told = {"cause": e.cause, "amplitude": h.amplitude, "unit": e.unit, "snr": round(h.snr, 3), "form": dict(e.form)}
    return told | ({"regime": dict(e.regime)} if e.regime else {})
