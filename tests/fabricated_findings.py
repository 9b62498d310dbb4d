"""Findings made by hand: one of each kind, as an inference would fill them."""

from __future__ import annotations

from typing import Any

import numpy as np
from gearheat.tools.diagnose.answer.evidence import (
    DataQuality,
    Estimate,
    GrossReading,
    NuisanceOff,
    Picture,
    Repeat,
    RepeatedPoint,
    Rows,
    VarianceComponent,
    View,
)
from gearheat.tools.diagnose.answer.findings import (
    About,
    Alarm,
    Answer,
    Calibrated,
    Cause,
    CauseSet,
    Channel,
    Experiment,
    Findings,
    FormShare,
    Gain,
    Hypothesis,
    Impact,
    Invisible,
    Isolability,
    Played,
    Remainder,
    RemainderChannel,
)
from gearheat.tools.diagnose.report.words import with_words

CHURNING, WINDAGE, AIR, EMISSIVITY = "losses.churning", "losses.windage", "cooling.air", "cooling.emissivity"
OFFSET = "sensor.torque.offset"
SIZES = {
    CHURNING: ("power", 120.0, "W", "power at the middle of the range", "compare two oil levels"),
    WINDAGE: ("power", 30.0, "W", "power at the middle of the range", "run it without oil"),
    AIR: ("ln_factor", -0.4, "1", "logarithm of the coefficient over that of the file", "blow at the housing"),
    EMISSIVITY: (
        "ln_factor",
        -0.5,
        "1",
        "logarithm of the emissivity over that of the file",
        "heat it in a still, cold room",
    ),
    OFFSET: ("offset", 4.0, "N.m", "zero of the transducer", "tare the transducers"),
}


def cause(id: str, probability: float, *, at_bound: str = "", value: float | None = None) -> Cause:
    """A cause with its size and a shape."""
    name, size, unit, doc, exposes = SIZES[id]
    size = size if value is None else value
    low, high = sorted((0.85 * size, 1.1 * size))
    return Cause(
        id=id,
        probability=probability,
        mc_error=0.012,
        detectable=abs(0.5 * size),
        usual=abs(size),
        unit=unit,
        meaning=doc,
        parameters=(
            Estimate(name=name, value=size, ci95=(low, high), unit=unit, doc=doc, at_bound=at_bound),
            Estimate(name="speed", value=1.62, ci95=(1.2, 2.1), unit="1", doc="exponent of the speed"),
        ),
        forms=(FormShare(name="", share=1.0),),
        exposes=exposes,
    )


def rows(n: int = 24) -> Rows:
    """Readings of an oil and a torque channel whose deviation grows with the speed."""
    i = np.arange(n)
    speed, torque = 80.0 + 40 * (i // 2 % 4), 800.0 + 400 * (i // 8)
    wave = 0.4 * np.sin(5.0 * i)
    excess = 6e-5 * speed**2
    values = {
        "T_oil": Rows.Values(measured=40 + speed / 8 + excess + wave, nominal=40 + speed / 8,
                             extended=40 + speed / 8 + excess, sd=0.4),
        "loss": Rows.Values(measured=20 + wave / 2, nominal=20 + 0 * wave, extended=20 + 0 * wave, sd=0.3),
    }  # fmt: skip
    quantities = {
        "w": Rows.Quantity(label="carrier speed", unit="rpm", values=speed),
        "tau": Rows.Quantity(label="carrier torque", unit="N.m", values=torque),
        "order": Rows.Quantity(label="running order", values=i // 2 + 1.0),
    }
    direction = tuple(1 if k % 2 == 0 else -1 for k in i)
    return Rows(row=tuple(i + 1), test=tuple(i // 2 + 1), direction=direction, channels=values, quantities=quantities)


def findings(verdict: str, **given: Any) -> Findings:
    """Findings with what all kinds share, and their words."""
    common: dict[str, Any] = {
        "about": About(data="campaign.csv", rig="planetary", readings=24, tests=12, seed=0),
        "test": Alarm(alpha=0.05, p_any=0.4, p_omnibus=0.5, p_adequacy=0.4, draws=400),
        "channels": (
            Channel(name="T_oil", column="T_oil_C", kind="oil_temp", unit="degC", repeat_sd=0.35, offset_sd=0.15),
            Channel(name="loss", column="T_carrier_Nm", kind="torque", unit="N.m", repeat_sd=0.3, offset_sd=0.5),
        ),
        "rows": rows(),
        "hypotheses": (),
        "causes": (),
        "isolability": (Isolability(cause=AIR, visible=4.1, nearest=EMISSIVITY, distance=2.0),),
        "invisible": (Invisible(cause="cooling.humidity", reason="no column humidity_pct"),),
    }
    return with_words(Findings(verdict=verdict, **(common | given)))


def clean(**given: Any) -> Findings:
    """Nothing is wrong."""
    hypotheses = (Hypothesis(causes=(), probability=0.93, mc_error=0.01), Hypothesis(causes=(AIR,), probability=0.03))
    return findings("consistent", hypotheses=hypotheses, causes=(cause(AIR, 0.03), cause(CHURNING, 0.004)), **given)


def explained(**given: Any) -> Findings:
    """Churning, with everything that a full result holds."""
    made = rows()
    oil = made.channels["T_oil"]
    before, after = (np.subtract(oil.measured, model) for model in (oil.nominal, oil.extended))
    full: dict[str, Any] = {
        "test": Alarm(alpha=0.05, p_any=2.7e-190, p_omnibus=1e-60, p_adequacy=0.4, draws=400),
        "hypotheses": (
            Hypothesis(causes=(CHURNING,), probability=0.96, mc_error=0.012),
            Hypothesis(causes=(AIR,), probability=0.02),
            Hypothesis(causes=(), probability=0.0),
        ),
        "answers": (Answer(causes=((CHURNING, WINDAGE),), probability=0.97, mc_error=0.012),),
        "causes": (cause(CHURNING, 0.96), cause(AIR, 0.02), cause(WINDAGE, 0.01), cause(OFFSET, 1e-9)),
        "impact": {
            "T_oil_K": Impact(value=2.1, ci95=(1.8, 2.4), unit="K", what="oil temperature"),
            "heat_W": Impact(value=118.0, ci95=(100, 131), unit="W", what="heat"),
        },
        "gain": Gain(
            scheme="leave-one-operating-point", channel="T_oil", unit="K", n=24, rmse_before=2.3, rmse_after=0.6,
            before=Gain.Both(without=2.3, with_=1.2), after=Gain.Both(without=0.6, with_=0.55), ratio_ci90=(0.2, 0.35),
            noise_floor=0.4, rivals={"constant cooling": 2.2, "linear in speed and load": 1.1},
        ),
        "gain_grouped": (
            Gain(scheme="leave-one-speed", channel="T_oil", unit="K", n=24, rmse_before=2.5, rmse_after=0.8),
        ),
        "played": {"T_oil": Played(rms_calibrated=2.2, rms_extended=0.5, unit="K")},
        "next_experiment": (
            Experiment(id="level", what="the same points with half the oil", separates=(CHURNING, WINDAGE),
                       separation_before=0.8, separation_after=5.1),
        ),
        "sets": (CauseSet(causes=(CHURNING, WINDAGE), distance=0.8, reason="both are powers of the speed"),),
        "views": (
            View(channel="loss", asks="the torque given the measured temperatures", p=0.3, nothing=0.7,
                 causes=(View.Alone(id=CHURNING, probability=0.2),), unit="N.m"),
        ),
        "pictures": (Picture(cause=CHURNING, channel="T_oil", quantity="w", before=before, after=after),),
        "calibrated": (Calibrated(path="housing.C", unit="J/K", file=3600.0, nominal=3500.0, extended=3550.0),),
    }  # fmt: skip
    return findings("explained", **(full | given))


def ambiguous(**given: Any) -> Findings:
    """Air or emissivity."""
    full: dict[str, Any] = {
        "test": Alarm(alpha=0.05, p_any=0.001, p_adequacy=0.3, draws=400),
        "hypotheses": (
            Hypothesis(causes=(AIR,), probability=0.55, mc_error=0.03),
            Hypothesis(causes=(EMISSIVITY,), probability=0.41, mc_error=0.03),
        ),
        "answers": (
            Answer(causes=((AIR,),), probability=0.55, mc_error=0.03),
            Answer(causes=((EMISSIVITY,),), probability=0.41, mc_error=0.03),
        ),
        "causes": (cause(AIR, 0.55), cause(EMISSIVITY, 0.41)),
        "sets": (CauseSet(causes=(AIR, EMISSIVITY), distance=2.0),),
        "next_experiment": (
            Experiment(id="cold", what="some points in a room of 5 degC", separates=(AIR, EMISSIVITY),
                       separation_before=2.0, separation_after=3.6),
        ),
    }  # fmt: skip
    return findings("ambiguous", **(full | given))


def unexplained(**given: Any) -> Findings:
    """Something outside the library."""
    full: dict[str, Any] = {
        "test": Alarm(alpha=0.05, p_any=1e-5, p_adequacy=0.2, draws=400),
        "hypotheses": (
            Hypothesis(causes=("model.unexplained",), probability=0.94),
            Hypothesis(causes=(CHURNING,), probability=0.05),
        ),
        "answers": (
            Answer(causes=(("model.unexplained",),), probability=0.94),
            Answer(causes=((CHURNING,),), probability=0.05),
        ),
        "causes": (Cause(id="model.unexplained", probability=0.94, mc_error=0.01), cause(CHURNING, 0.05)),
        "remainder": Remainder(probability=0.94, channels=(RemainderChannel(channel="T_oil", rms=1.9, unit="K"),)),
    }
    return findings("unexplained", **(full | given))


def spoiled() -> Findings:
    """A cause beside a gross reading, a rig unlike its file, a room that scatters, and repeated points."""
    quality = DataQuality(
        gross=(GrossReading(row=17, line=18, point="17", channel="T_oil", size_sd=14.2, shown=84.2, expected=71.3,
                            unit="degC"),),
        nuisances=(NuisanceOff(name="heat capacity of the gears", z=-4.2, factor=0.17, paths=("gears.C",)),),
        variance=(VarianceComponent(name="readings of T_amb", channel="T_amb", unit="K", card=0.4, found=1.0,
                                    ratio=2.5),),
        repeated=(RepeatedPoint(condition="100 rpm, 1600 N.m", channel="T_oil", unit="K", sd=0.4, card=0.35,
                                repeats=(Repeat(test=1, order=1, sum=0.2, difference=0.1),
                                         Repeat(test=9, order=9, sum=-0.2, difference=0.0))),),
        adequacy={"T_oil": 0.998, "loss": 0.3},
    )  # fmt: skip
    return explained(data_quality=quality)


KINDS = {
    "clean": clean,
    "explained": explained,
    "ambiguous": ambiguous,
    "unexplained": unexplained,
    "spoiled": spoiled,
}
