"""One case of the challenge: what a sheet draws, what is hidden in it, and the files.

    FOLDER/case/DATA.csv, CARD.json, POINTS.csv [REF.csv]   what the diagnosis sees
    FOLDER/TRUTH.json                                       what it does not

Everything follows from sheet, seed and number of the case.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from . import files, forms
from .classes import merged_all
from .hide import WEAK, Choice, Hidden, causes_to_try, choose, schedule
from .instruments import INSTRUMENTS
from .plan import Plan
from .yardstick import Rivals, Run, Setting, Yardstick

#: No healthy rig gets its oil so hot in a test [degC]: its engineer would not run that.
HOT = 150.0

#: Kinds of cases whose truth tells the nearest rival.
RIVALRY = ("single", "regime", "alike", "pair")


@dataclass(frozen=True)
class Drawn:
    """A rig with its instruments and campaigns, before anything is hidden.

    Args:
        run: the simulator
        plan, points: tests of the campaign, and conditions to predict; reference: tests of the healthy campaign
        base: factors of the rig; cooling: those that a day scales
        days: factors of the days of the campaign and of the reference; day_sd: their scatter as it is
        prior: standard deviation of factors (see `yardstick.Setting`)
        instruments, card, columns: for the files
        bearing_oil, room_drift: told by the card
        band: signal-to-noise of what is hidden
        names: causes that a kind of case may hide
        draw: draws a form of a cause for a kind of case
        facts: of the rig, for the record
    """

    run: Run
    plan: Plan
    points: Plan
    reference: Plan | None
    base: Mapping[str, Any]
    cooling: tuple[str, ...]
    days: tuple[np.ndarray, np.ndarray]
    day_sd: float
    prior: Mapping[str, float]
    instruments: files.Instruments
    columns: files.Columns
    bearing_oil: bool
    room_drift: float
    band: tuple[float, float]
    names: Callable[[str], Sequence[str]]
    draw: Callable[[str, str, np.ndarray, np.random.Generator], Any]
    facts: Mapping[str, Any]


#: Draws a sheet's rig and campaigns.
Sheet = Callable[[np.random.Generator], Drawn]


def make_case(
    draw: Sheet, number: int, seed: int, k: int, folder: Path, *, kind: str | None = None, cause: str | None = None
) -> dict[str, Any]:
    """Write one case and return its truth.

    Args:
        draw: of the sheet
        number: of the sheet, for its chance
        seed, k: of the challenge, and number of the case
        folder: for the files; made if need be
        kind, cause: drawn if left out

    Raises:
        LookupError: no cause can be as loud as wanted, and as far from its rivals
    """
    drawn, rank = schedule(number, seed, k)
    kind = kind or drawn
    setting_rng, hidden_rng, noise_rng, rival_rng = (np.random.default_rng([seed, number, k, i]) for i in range(4))
    d = draw(setting_rng)
    while not (_quiet(d)[d.instruments.channels.index("T_oil_C")] < HOT).all():
        d = draw(setting_rng)
    hidden: list[Hidden] = []
    if kind != "clean":
        key = (seed, number, sum(map(ord, kind)))
        names = iter([cause] * 8) if cause else causes_to_try(d.names(kind), key, rank)
        yard = Yardstick(setting(d))
        oil = yard.quiet[d.instruments.channels.index("T_oil_C")]
        families = {n: partial(forms.draw, d.plan, 0.5, n, "single", oil) for n in INSTRUMENTS}
        families |= {n: partial(d.draw, n, "single", oil) for n in d.names("single")}
        rivals = Rivals(yard, families, rival_rng)
        band = WEAK if kind == "weak" else d.band
        form = partial(_form, d, kind, oil, hidden_rng)
        hidden = choose(names, Choice(kind, band, form, yard, rivals, hidden_rng))
    truth = {"schema": "gearheat.truth/1", "seed": seed, "case": k, "kind": kind}
    truth |= _write(d, hidden, folder, noise_rng)
    if kind in RIVALRY:
        near = min((h.rival for h in hidden if h.rival), key=lambda r: r.distance)
        truth["rival"] = {"cause": near.cause, "distance": round(near.distance, 3)}
    (folder / "TRUTH.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def _form(d: Drawn, kind: str, oil: np.ndarray, rng: np.random.Generator, name: str) -> Any:
    return d.draw(name, kind, oil, rng)


def _quiet(d: Drawn) -> np.ndarray:
    return d.run(d.plan, d.base, ())


def setting(d: Drawn) -> Setting:
    """What the yardstick measures with."""
    i = d.instruments
    offset = {c: i.understated * sd for c, sd in i.offset_sd.items()}
    return Setting(d.run, i.channels, d.plan, d.base, d.reference, i.repeat_sd, offset, d.prior, d.cooling, d.day_sd)


def _write(d: Drawn, hidden: Sequence[Hidden], folder: Path, rng: np.random.Generator) -> dict[str, Any]:
    """Simulate and write all files; the part of the truth that comes from it."""
    case = folder / "case"
    case.mkdir(parents=True, exist_ok=True)

    def played(plan: Plan, faults: Sequence[Hidden], days: np.ndarray | None = None) -> np.ndarray:
        base = dict(d.base)
        for name in d.cooling if days is not None else ():
            base[name] = base.get(name, 1.0) * days
        return d.run(plan, base, [(h.fault, slice(None), np.full(plan.columns, h.amount)) for h in faults])

    ill, well = played(d.plan, hidden, d.days[0]), played(d.plan, (), d.days[0])
    i = d.instruments
    gross = {"DATA": files.table(case / "DATA.csv", d.plan, i.noisy(ill, rng), i, d.columns, rng)}
    if d.reference is not None:
        shown = i.noisy(played(d.reference, (), d.days[1]), rng)
        earlier = files.Columns(d.columns.humidity, d.columns.start, d.columns.date, files.EARLIER)
        gross["REF"] = files.table(case / "REF.csv", d.reference, shown, i, earlier, rng)
    card = files.card(i, bearing_oil=d.bearing_oil, room_drift=d.room_drift)
    (case / "CARD.json").write_text(json.dumps(card, indent=1) + "\n", encoding="utf-8")
    at = [i.fixed(played(d.points, faults)) for faults in (hidden, ())]
    files.points(case / "POINTS.csv", d.points, at[0], i.channels, d.columns)
    change = {c: (ill - well)[i.channels.index(c)] for c in i.channels}
    loss = np.array([[1.0], [-1.0]]) * (change["T_carrier_Nm"] - 4.0 * change["T_sun_Nm"])
    loss_sd = float(np.hypot(i.repeat_sd["T_carrier_Nm"], 4.0 * i.repeat_sd["T_sun_Nm"]))
    impact = {"T_oil_K": change["T_oil_C"], "T_wall_K": change["T_wall_C"], "loss_Nm": loss}
    oil = [a[i.channels.index("T_oil_C")].T.ravel() for a in at]
    return {
        "causes": [h.fault.cause for h in hidden],
        "answer": sorted(merged_all(h.fault.cause for h in hidden)),
        "effects": [_told(h) for h in hidden],
        "impact": {name: round(float(c.mean()), 5) for name, c in impact.items()},
        "repeat_sd": {"T_oil_K": i.repeat_sd["T_oil_C"], "T_wall_K": i.repeat_sd["T_wall_C"], "loss_Nm": loss_sd},
        "points": [
            {"point": p + 1, "T_oil_C": round(float(a), 4), "T_oil_without_C": round(float(b), 4)}
            for p, (a, b) in enumerate(zip(*oil, strict=True))
        ],
        "gross": {name: found for name, found in gross.items() if found},
        "rig": dict(d.facts),
    }


def _told(h: Hidden) -> dict[str, Any]:
    """A fault for the record."""
    f = h.fault
    told = {"cause": f.cause, "amount": h.amount, "unit": f.unit, "snr": round(h.snr, 3), "form": dict(f.form)}
    return told | ({"regime": dict(f.regime)} if f.regime else {})
