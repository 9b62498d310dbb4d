"""What is to be known of data and rig before any cause: gross readings, values far off, scatter against the card."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..infer.found import Found, Hypothesis
from ..infer.gross import distances
from .decide import p_adequacy
from .estimate import posterior

#: Prior standard deviations beyond which a value of the rig is told.
OFF = 2.5


@dataclass(frozen=True)
class Gross:
    """A reading that was set aside: campaign and row (from 0), sensor, and what it shows and should show [SI]."""

    campaign: int
    row: int
    sensor: str
    size_sd: float
    shown: float
    expected: float | None


@dataclass(frozen=True)
class Off:
    """A nuisance far from the rig's file: standard deviations, and the factor on each of its parameters."""

    name: str
    z: float
    factors: dict[str, float]


@dataclass(frozen=True)
class Scatter:
    """A loose term of the scatter: what the data make of the card's standard deviation."""

    name: str
    ratio: float
    ci95: tuple[float, float]


def gross_readings(found: Found, h: Hypothesis) -> list[Gross]:
    """All readings that were set aside, by what a hypothesis says of them."""
    problem, told = found.problem, []
    rows = np.cumsum([0, *(o.campaign.n for o in problem.campaigns)])
    entries = np.cumsum([0, *(o.m for o in problem.campaigns)])
    for suspect in distances(problem, h.fit):
        number, sensor = suspect.aside.number, suspect.aside.sensor
        if sensor:
            k = int(np.searchsorted(rows, number, side="right")) - 1
            row, name, expected = int(number - rows[k]), sensor, None
        else:
            k = int(np.searchsorted(entries, number, side="right")) - 1
            o, i = problem.campaigns[k], int(number - entries[k])
            row, name, expected = int(o.row[i]), o.read[o.kind[i]].name, float(h.fit.look.shown[number])
        value = float(problem.campaigns[k].campaign.values[name][row])
        told.append(Gross(k, row, name, suspect.size_sd, value, expected))
    return sorted(told, key=lambda g: -abs(g.size_sd))


def values_off(found: Found, h: Hypothesis) -> list[Off]:
    """Nuisances beyond `OFF` of their prior, the farthest first."""
    x, _ = posterior(found.problem, h)
    told = []
    for nuisance, z in zip(found.problem.data.nuisances, x[: found.problem.nz], strict=False):
        if abs(z) > OFF:
            factors = {path: float(np.exp(e * nuisance.sd * z)) for path, e in nuisance.paths.items()}
            told.append(Off(nuisance.name, float(z), factors))
    return sorted(told, key=lambda o: -abs(o.z))


def scatters(found: Found, h: Hypothesis) -> list[Scatter]:
    """The loose terms of the scatter, as they were found."""
    noise = h.fit.noise
    spreads = scale_sds(found, h)
    told = []
    for term, scale, sd in zip(noise.loose, noise.scales, spreads, strict=True):
        low, high = np.exp(scale + 1.96 * sd * np.array([-1.0, 1.0]))
        told.append(Scatter(term.name, float(np.exp(scale)), (float(low), float(high))))
    return told


def scale_sds(found: Found, h: Hypothesis) -> np.ndarray:
    """Standard deviations of the logarithms of the scales, by the information of the data and of the prior."""
    noise = h.fit.noise
    white, _ = h.fit.linear(found.problem)
    inverse = white.inverse
    weighted = [inverse @ t.matrix * np.exp(2 * s) for s, t in zip(noise.scales, noise.loose, strict=True)]
    information = np.array([2 * float((W * W.T).sum()) for W in weighted])
    prior = np.array([t.loose for t in noise.loose])
    return np.asarray(1 / np.sqrt(information + prior**-2))


def adequacy(found: Found, h: Hypothesis) -> dict[str, float]:
    """Compared sensor -> p of what a hypothesis leaves in it."""
    o = found.problem.data
    own = {s.name: np.flatnonzero(o.kind == i) for i, s in enumerate(o.read)}
    return {name: p_adequacy(found, h, entries) for name, entries in own.items() if len(entries)}
