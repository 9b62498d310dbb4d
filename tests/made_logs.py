"""Logs of wind turbines made by the rig itself: weather, machines and years that differ, noise that is correlated."""

from dataclasses import replace

import numpy as np
from gearheat.scenarios.measured.logs import Log
from gearheat.tools.diagnose.library.knobs import Knob
from gearheat.tools.diagnose.model.logs import Filter
from gearheat.tools.diagnose.model.windows import windows

STEP = 600.0
DAY = 86400.0
YEAR = 365.25 * DAY
#: Standard deviation between machines and years over that of the knobs between machines.
MACHINES, YEARS = 0.6, 0.15
#: Noise of readings: sd [K] and correlation time [samples] of a slow part, sd of a fast one.
SLOW, SAMPLES, FAST = 0.5, 12.0, 0.1


def walk(rng: np.random.Generator, n: int, samples: float) -> np.ndarray:
    """A stationary process of unit variance."""
    a = np.exp(-1 / samples)
    x = np.empty(n)
    x[0] = rng.standard_normal()
    for k in range(1, n):
        x[k] = a * x[k - 1] + np.sqrt(1 - a * a) * rng.standard_normal()
    return x


def weather(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
    """Speed [rad/s], torque of the generator as a magnitude [N.m] and temperature of the nacelle [K]."""
    wind = np.maximum(8.0 + 2.6 * walk(rng, n, 60.0) + 0.6 * walk(rng, n, 3.0), 0.0)
    power = 2e6 * np.clip((wind / 12.5) ** 3, 0.0, 1.0) * (wind > 3.5)
    w = np.where(wind > 3.5, np.clip(100.0 + 12.0 * (wind - 3.5), 100.0, 188.5), 0.0)
    day = np.sin(2 * np.pi * np.arange(n) * STEP / DAY)
    T = 296.0 + 4.0 * walk(rng, n, 300.0) + 3.0 * day + 2.0 * walk(rng, n, 6.0)
    return {"n_hss": w, "T_hss": np.where(w > 0, power / np.maximum(w, 1.0), 5.0), "T_nacelle": T}


def made(own: Filter, like: Log, seed: int, year: float, n: int, z: np.ndarray, name: str = "made") -> Log:
    """A log of n samples.

    Args:
        own: the rig
        like: a log of the rig with all sensors
        seed: of weather and noise
        year: when it begins
        n: number of samples
        z: knobs (k,), or of each sample (n, k) in blocks of equal rows
    """
    rng = np.random.default_rng(seed)
    given = weather(rng, n)
    time = 1.36e9 + year * YEAR + STEP * np.arange(n)
    values = given | {s.name: np.full(n, 320.0) for s in like.read}
    stretch = np.zeros(n, dtype=int)
    log = replace(
        like, name=name, values=values, time=time, stretch=stretch, step=STEP, lines=np.arange(2, n + 2), gross=()
    )
    data = windows([log], own.given, own.read, 0)
    shown = _in_blocks(own, data, np.broadcast_to(z, (n, z.shape[-1])))
    for j, s in enumerate(like.read):
        values[s.name] = shown[:, j] + SLOW * walk(rng, n, SAMPLES) + FAST * rng.standard_normal(n)
    return replace(log, values=values)


def _in_blocks(own: Filter, data, z: np.ndarray) -> np.ndarray:
    """Free runs with the knobs of each block throughout, put together: what a change does sets in at once."""
    blocks = np.unique(z, axis=0)
    found = np.empty(data.read.shape[1:])
    for block in blocks:
        rows = (z == block).all(axis=1)
        found[rows] = own.run(data, block[None], slopes=False).shown[0][rows]
    return found


def differing(knobs: tuple[Knob, ...], rng: np.random.Generator, share: float) -> np.ndarray:
    """Deviations of all knobs (k,)."""
    return share * rng.standard_normal(len(knobs)) * np.array([k.sd for k in knobs])
