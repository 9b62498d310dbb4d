"""One case of the challenge: what a sheet draws, what is hidden in it, and the files.

    FOLDER/case/DATA.csv, CARD.json, POINTS.csv [REF.csv]   what the diagnosis sees
    FOLDER/TRUTH.json                                       what it does not

Everything follows from sheet, seed and number of the case.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from . import files, forms
from .classes import classes_of
from .hide import BANDS, Choice, Hidden, causes_to_try, choose, schedule
from .plan import Plan
from .rig import RATIO
from .signal_to_noise import Noise, Rivals, Run, Setting

#: Oil of a healthy rig stays below this in every test [degC]: its engineer would not run a hotter one.
T_OIL_MAX = 150.0

#: Factors of the cooling, which differs from day to day.
COOLING = ("conv", "rad")


@dataclass(frozen=True)
class Drawn:
    """A rig with its instruments and campaigns, before anything is hidden.

    Args:
        run: the simulator
        plan, points: tests of the campaign, and conditions to predict
        days: factors of the cooling on the days of the campaign and of the reference
        prior: standard deviation of factors (see `signal_to_noise.Setting`)
        instruments, layout: for the files
        band: signal-to-noise ratio of what is hidden
        names: causes that a kind of case may hide
        draw: draws a form of a cause for a kind of case
        facts: of the rig, for the record
        reference: tests of the healthy campaign, if there is one
        base: factors of the rig
        day_sd: scatter of the days as it is
        bearing_oil, room_drift: that the card states
    """

    run: Run
    plan: Plan
    points: Plan
    days: tuple[np.ndarray, np.ndarray]
    prior: Mapping[str, float]
    instruments: files.Instruments
    layout: files.Layout
    band: tuple[float, float]
    names: Callable[[str], Sequence[str]]
    draw: Callable[[str, str, np.ndarray, np.random.Generator], Any]
    facts: Mapping[str, Any]
    reference: Plan | None = None
    base: Mapping[str, Any] = field(default_factory=dict)
    day_sd: float = files.DAY_COOLING_SD
    bearing_oil: bool = False
    room_drift: float = 0.0

    def oil(self, readings: np.ndarray) -> np.ndarray:
        """Oil temperatures (2, tests) among readings [degC]."""
        return np.asarray(readings[self.instruments.channels.index("T_oil_C")])


#: Draws a sheet's rig and campaigns.
Sheet = Callable[[np.random.Generator], Drawn]


def make_case(
    draw: Sheet,
    number: int,
    seed: int,
    k: int,
    folder: Path,
    *,
    kind: str | None = None,
    cause: str | None = None,
    apart: bool = True,
) -> dict[str, Any]:
    """Write one case and return its truth.

    Args:
        draw: of the sheet
        number: of the sheet, for its chance
        seed, k: of the challenge, and number of the case
        folder: for the files; made if need be
        kind, cause: drawn if left out
        apart: whether what is hidden has to be as far from its rivals as its kind wants; to look takes long

    Raises:
        LookupError: no cause reaches the wanted signal-to-noise ratio as far from its rivals as wanted
    """
    kind, rank = (kind, k) if kind else schedule(number, seed, k)
    setting_rng, hidden_rng, noise_rng, rival_rng = (np.random.default_rng([seed, number, k, i]) for i in range(4))
    d = draw(setting_rng)
    while not (d.oil(d.run(d.plan, d.base, ())) < T_OIL_MAX).all():
        d = draw(setting_rng)
    hidden: list[Hidden] = []
    if kind != "clean":
        key = (seed, number, sum(map(ord, kind)))
        names = iter([cause] * 8) if cause else causes_to_try(d.names(kind), key, rank)
        noise = Noise(setting(d))
        oil = d.oil(noise.healthy)
        families = {n: partial(forms.draw, d.plan, 0.5, n, "single", oil) for n in forms.misreadings(d.plan)}
        families |= {n: partial(d.draw, n, "single", oil) for n in d.names("single")}
        rivals = Rivals(noise, families, rival_rng) if apart else None
        band = BANDS.get(kind, d.band)
        choice = Choice(kind, band, lambda name: d.draw(name, kind, oil, hidden_rng), noise, rivals, hidden_rng)
        hidden = choose(names, choice)
    truth = {"schema": "gearheat.truth/1", "seed": seed, "case": k, "kind": kind}
    truth |= _write(d, hidden, folder, noise_rng)
    near = min((h.rival for h in hidden if h.rival), key=lambda r: r.distance, default=None)
    if near:
        truth["rival"] = {"cause": near.cause, "distance": round(near.distance, 3)}
    (folder / "TRUTH.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def setting(d: Drawn) -> Setting:
    """What the signal-to-noise ratio is measured with."""
    i = d.instruments
    offset = {c: i.understated * sd for c, sd in i.offset_sd.items()}
    return Setting(d.run, i.channels, d.plan, d.base, d.reference, i.repeat_sd, offset, d.prior, COOLING, d.day_sd)


def _write(d: Drawn, hidden: Sequence[Hidden], folder: Path, rng: np.random.Generator) -> dict[str, Any]:
    """Simulate and write all files; the part of the truth that comes from it."""
    case, i = folder / "case", d.instruments
    case.mkdir(parents=True, exist_ok=True)
    ill, well = (_simulate(d, d.plan, faults, d.days[0]) for faults in (hidden, ()))
    gross = {"DATA": files.write_table(case / "DATA.csv", d.plan, i.noisy(ill, rng), i, d.layout, rng)}
    if d.reference is not None:
        shown = i.noisy(_simulate(d, d.reference, (), d.days[1]), rng)
        earlier = replace(d.layout, earlier=files.EARLIER)
        gross["REF"] = files.write_table(case / "REF.csv", d.reference, shown, i, earlier, rng)
    if d.plan.steady:
        card = files.card_of_steady_points(i, d.layout.shown)
    else:
        card = files.card(i, bearing_oil=d.bearing_oil, room_drift=d.room_drift)
    (case / "CARD.json").write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")
    at = [i.without_noise(_simulate(d, d.points, faults)) for faults in (hidden, ())]
    files.write_points(case / "POINTS.csv", d.points, at[0], i.channels, d.layout)
    impact, repeat_sd = _impact(d, ill - well)
    oil = [d.oil(a).T.ravel() for a in at]
    return {
        "causes": [h.fault.cause for h in hidden],
        "answer": sorted(classes_of(h.fault.cause for h in hidden)),
        "effects": [_record(h) for h in hidden],
        "impact": impact,
        "repeat_sd": repeat_sd,
        "points": [
            {"point": p + 1, "T_oil_C": round(float(a), 4), "T_oil_without_C": round(float(b), 4)}
            for p, (a, b) in enumerate(zip(*oil, strict=True))
        ],
        "gross": {name: one for name, one in gross.items() if one},
        "rig": dict(d.facts),
    }


def _simulate(d: Drawn, plan: Plan, faults: Sequence[Hidden], days: np.ndarray | None = None) -> np.ndarray:
    """Readings without noise of some tests, with the cooling of the days if they are given."""
    base = dict(d.base)
    for name in COOLING if days is not None else ():
        base[name] = base.get(name, 1.0) * days
    return d.run(plan, base, [(h.fault, slice(None), np.full(plan.columns, h.amount)) for h in faults])


def _impact(d: Drawn, change: np.ndarray) -> tuple[dict[str, float], dict[str, float]]:
    """Mean change of the readings, and repeatability of each; losses of a rig in its own units only."""
    by, sd = dict(zip(d.instruments.channels, change, strict=True)), d.instruments.repeat_sd
    impact = {"T_oil_K": by["T_oil_C"], "T_wall_K": by["T_wall_C"]}
    repeat_sd = {"T_oil_K": sd["T_oil_C"], "T_wall_K": sd["T_wall_C"]}
    if not d.layout.shown:
        impact["loss_Nm"] = np.array([[1.0], [-1.0]]) * (by["T_carrier_Nm"] - RATIO * by["T_sun_Nm"])
        repeat_sd["loss_Nm"] = float(np.hypot(sd["T_carrier_Nm"], RATIO * sd["T_sun_Nm"]))
    return {name: round(float(c.mean()), 5) for name, c in impact.items()}, repeat_sd


def _record(h: Hidden) -> dict[str, Any]:
    """A fault for the record."""
    f = h.fault
    record = {"cause": f.cause, "amount": h.amount, "unit": f.unit, "snr": round(h.snr, 3), "form": dict(f.form)}
    return record | ({"regime": dict(f.regime)} if f.regime else {})
