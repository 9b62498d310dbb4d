"""How big: sizes and shapes of causes with intervals, what they change on average, and what would have been seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import ndtri

from ....model.units import from_si, show_unit
from ....scenarios.measured.table import Campaign, Sensor
from ..infer.evidence import White, log_bayes_factors
from ..infer.fit import Fit, Vector
from ..infer.found import Found, Hypothesis, Member
from ..infer.problem import Acting, Problem, priors
from ..library.cause import Form, Shape, Size
from ..model.observe import Observed
from . import channels, findings
from .evidence import Bound, Estimate

#: Changes of the loss by name, with their units.
LOSS = {"loss_Nm": "N.m", "heat_W": "W"}
#: Half width of a 95 % interval in standard deviations.
WIDE = 1.96
#: The power of the detectable size.
POWER = 0.8
#: How near to a bound a value sits on it, as a share of its range.
NEAR = 0.02
#: Hypotheses that share an estimate, as a share.
COUNTS = 0.01
#: Standard deviations of a spread that are weighed, in half widths of the prior.
SPREADS = np.geomspace(0.1, 32.0, 33)


def posterior(problem: Problem, fit: Fit) -> np.ndarray:
    """Covariance (d, d) of the vector of a hypothesis, linearised where it was fitted."""
    vector, G = Vector(problem, fit.look), White.of(fit.noise.covariance)(fit.look.jacobian)
    covariance = np.linalg.inv(G.T @ G + np.diag(vector.precision))
    covariance[vector.sizes, vector.sizes] += (fit.form * fit.look.x[vector.sizes]) ** 2
    return covariance


def _of_cause(problem: Problem, fit: Fit, cause: str) -> tuple[np.ndarray, np.ndarray]:
    """The vector and its covariance from a cause on: its size, its shapes, and what follows."""
    begin = Vector(problem, fit.look).sizes[fit.causes.index(cause)]
    return fit.look.x[begin:], posterior(problem, fit)[begin:, begin:]


def loose_variance(fit: Fit) -> np.ndarray:
    """Variances (M,) by the scatter of readings, inputs and days as found, without tolerances."""
    return np.diag(fit.noise.scaled(fit.noise.loose))


def estimate_cause(found: Found, cause: str, members: Sequence[Member]) -> tuple[Estimate, ...]:
    """Size, averaged over the hypotheses that hold a cause in the form of the most probable one, and shapes of that."""
    total = sum(p for _, p in members)
    acting = [(h, p) for h, p in members if cause in h.fit.causes and p >= COUNTS * total]
    if not acting or cause not in members[0][0].fit.causes:
        return _spread(found, cause, members)
    best = max(acting, key=lambda member: member[1])[0]
    alike = [(h, p) for h, p in acting if h.form(cause) == best.form(cause)]
    sizes = [(x[0], covariance[0, 0]) for x, covariance in (_of_cause(found.problem, h.fit, cause) for h, _ in alike)]
    w, (m, variances) = [p for _, p in alike], np.transpose(sizes)
    centre = float(np.average(m, weights=w))
    spread = float(np.sqrt(np.average(variances + (m - centre) ** 2, weights=w)))
    one = best.fit.look.acting[best.fit.causes.index(cause)]
    s = replace(one.formula.extent, low=max(one.formula.extent.low, one.formula.form.low))
    ends = [float(np.clip(s.sd * (centre + k * spread), s.low, s.high)) for k in (-WIDE, 0.0, WIDE)]
    return (_told(s, ends, one.formula.form.scale), *_shapes(found.problem, best.fit, one))


def _told(of: Shape | Size, ends: Sequence[float], scale: float = 1.0) -> Estimate:
    """A size or a shape with its interval: low end, value, high end, of what has it times a scale."""
    unit, (low, value, high) = convert(of, [scale * end for end in ends])
    near = NEAR * (of.high - of.low)
    bound: Bound = "low" if ends[1] <= of.low + near and of.low != 0.0 else "high" if ends[1] >= of.high - near else ""
    return Estimate(name=of.name, value=value, ci95=(low, high), unit=unit, doc=of.doc, at_bound=bound)


def _shapes(problem: Problem, fit: Fit, one: Acting) -> list[Estimate]:
    """The shapes of a cause in a hypothesis."""
    x, covariance = _of_cause(problem, fit, one.id)
    found = []
    for k, shape in enumerate(one.formula.form.shapes, start=1):
        sd = min(float(np.sqrt(covariance[k, k])), 1.0)
        values = []
        for step in (-WIDE * sd, 0.0, WIDE * sd):
            t = one.t.copy()
            t[k] = np.clip(x[k] + step, -3.0, 3.0)
            values.append(one.formula.theta(t)[shape.name])
        found.append(_told(shape, values))
    return found


def convert(shape: Shape | Size, values: Sequence[float]) -> tuple[str, list[float]]:
    """Values of a shape in the unit people read: degC and rpm; kelvins that may be few are a difference."""
    unit = "K (difference)" if shape.unit == "K" and shape.low <= 150.0 else shape.unit
    return show_unit(unit), [from_si(v, unit) for v in values]


def _spread(found: Found, cause: str, members: Sequence[Member]) -> tuple[Estimate, ...]:
    """The standard deviation of sizes that differ, as the most probable hypothesis has it."""
    own = [(h, e) for h, _ in members for e in h.extras if e.cause == cause]
    if not own:
        return ()
    h, extra = own[0]
    white, e = h.fit.linear(found.problem)
    V, r, one = white.L @ white.L.T, white.L @ e, extra.of.columns @ extra.of.columns.T
    V = V - extra.size**2 * one
    whites = [White.of(V + size**2 * one) for size in SPREADS]
    logs = [white.log_density(white(r)) for white in whites]
    share = np.cumsum(np.exp(np.array(logs) - np.logaddexp.reduce(logs)))
    mine = next(f for f in found.formulas if (f.cause.id, f.form.name) == (cause, extra.form))
    of, ends = mine.extent, [float(np.interp(s, share, SPREADS)) for s in (0.025, 0.5, 0.975)]
    told = _told(of, [of.sd * end for end in ends], mine.form.scale)
    doc = of.doc if "standard deviation" in of.doc else f"standard deviation of: {of.doc}"
    return (told.model_copy(update={"doc": doc, "at_bound": ""}),)


def form_shares(cause: str, members: Sequence[Member]) -> dict[str, float]:
    """Form -> its share of the cause's probability, most probable first."""
    total: dict[str, float] = {}
    for h, p in members:
        if spread := next((e for e in h.extras if e.cause == cause), None):
            own = {spread.form: 1.0}
        elif cause in h.forms:
            logs = h.forms[cause]
            scale = np.logaddexp.reduce(list(logs.values()))
            own = {name: float(np.exp(value - scale)) for name, value in logs.items()}
        else:
            own = {h.form(cause): 1.0}
        for name, share in own.items():
            total[name] = total.get(name, 0.0) + p * share
    whole = sum(total.values()) or 1.0
    return dict(sorted(((n, v / whole) for n, v in total.items()), key=lambda item: (-item[1], item[0])))


def first_test(campaign: Campaign, place: float) -> str:
    """The first test behind a place in the running order, which goes from 0 to 1, with its date; of logs the date."""
    later = np.where(campaign.progress >= place, campaign.progress, np.inf)
    test = int(campaign.test[np.argmin(later)])
    date = campaign.date[test]
    if not (name := campaign.names[test] if campaign.names else str(test + 1)):  # of a log
        return date or f"span {test + 1} of {campaign.n_tests}"
    return f"test {name}{f' ({date})' if date else ''}"


def regime(form: Form, theta: Mapping[str, float]) -> dict[str, tuple[float | None, float | None]]:
    """Where a form acts: quantity with unit -> above, below; empty where it acts everywhere."""
    shape = next((s for s in form.shapes if s.name == form.regime.get("shape")), None)
    if shape is None:
        return {}
    quantity, _, side = form.regime["quantity"].rpartition(" ")
    unit, (value,) = convert(shape, [theta[shape.name]])
    return {f"{quantity} [{unit}]": (value, None) if side == "above" else (None, value)}


def impacts(
    problem: Problem, h: Hypothesis, ratios: Mapping[str, float], only: str | None = None
) -> dict[str, findings.Impact]:
    """Mean change of each compared sensor, and of the loss, by the causes of a hypothesis, or by one of them.

    Ratios are those of `loss_means`.
    """
    fit, o = h.fit, problem.data
    moved = [a for a in fit.look.acting if only is None or a.id == only]
    if not moved:
        return {}
    without = [replace(a, t=np.r_[0.0, a.t[1:]]) if a in moved else a for a in fit.look.acting]
    change = (fit.look.shown - problem.shown(fit.look, without))[problem.own]
    spans = zip(Vector(problem, fit.look).sizes, fit.look.acting, strict=True)
    own = np.concatenate([np.arange(begin, begin + a.formula.size) for begin, a in spans if a in moved])
    run, told = np.isfinite(change), dict[str, findings.Impact]()  # without the cause the machine may run away
    with_it, moves = fit.look.jacobian, np.isin(np.arange(len(fit.look.x)), own)
    still = problem.look(fit.look.z, without, fit.look.sd, fit.look.laws).jacobian if run.all() else with_it
    jacobian, covariance = (with_it - np.where(moves, 0.0, still))[problem.own], posterior(problem, fit)

    def add(name: str, weights: np.ndarray, unit: str, what: str) -> None:
        if share := np.abs(weights[run]).sum() / (np.abs(weights).sum() or 1.0):
            slope = weights @ jacobian
            value, sd = float(weights[run] @ change[run] / share), float(np.sqrt(slope @ covariance @ slope))
            ends = (value - WIDE * sd, value + WIDE * sd)
            each = (weights * change)[run & (weights != 0)] * (weights != 0).sum()
            single = None if name in LOSS else (float(each.min()), float(each.max()))  # two torques are one loss
            told[name] = findings.Impact(value=value, ci95=ends, single=single, unit=unit, what=what)

    for _, s, mine in channels.compared(o):
        weights = channels.difference(s, 1.0) * mine / mine.sum()
        add(channels.change_name(s), weights, channels.unit_of_difference(s), channels.words(s))
    wrong = {o.campaign.sensor(name).kind for a in moved for name in (*a.formula.read, *a.formula.given)}
    loss = "loss" if wrong.isdisjoint(("torque", "speed")) else "apparent loss"
    for (name, unit), weights in zip(LOSS.items(), loss_means(o, ratios) or (), strict=False):
        if len(weights):
            add(name, weights, unit, loss)
    return told


def impacts_of(
    problem: Problem, h: Hypothesis, read: Sequence[Sensor], changes: Mapping[str, np.ndarray]
) -> dict[str, findings.Impact]:
    """Mean change of each sensor by causes of a hypothesis, from that by each (sensors,), in proportion to its size."""
    x, covariance = h.fit.look.x, posterior(problem, h.fit)
    own = np.array(Vector(problem, h.fit.look).sizes)[[h.fit.causes.index(c) for c in changes]]
    slopes = np.array(list(changes.values())) / x[own, None]
    sds = np.sqrt(np.einsum("ij,ik,kj->j", slopes, covariance[np.ix_(own, own)], slopes))
    told = {}
    for s, change, sd in zip(read, x[own] @ slopes, sds, strict=True):
        value, half = channels.difference(s, change), WIDE * channels.difference(s, sd)
        ends, unit = (value - half, value + half), channels.unit_of_difference(s)
        told[channels.change_name(s)] = findings.Impact(value=value, ci95=ends, unit=unit, what=channels.words(s))
    return told


def loss_means(o: Observed, ratios: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray] | None:
    """Weights of the readings (m,) in the mean loss torque [N.m] and in the mean loss [W]; None without a torque.

    Args:
        ratios: speed of each shaft end over that of the one at which the loss is stated
    """
    torque, power = np.zeros(o.m), np.zeros(o.m)
    speed = next((s for s in o.campaign.sensors if s.kind == "speed" and abs(ratios.get(_end(s), 0.0)) > 0), None)
    ends = set[str]()
    for _, s, mine in channels.compared(o):
        if s.kind != "torque" or _end(s) in ends or not np.isfinite(ratios.get(_end(s), np.nan)):
            continue
        ends.add(_end(s))
        share = np.where(mine, ratios[_end(s)] * o.signs[s.name][o.row] / mine.sum(), 0.0)
        w = (o.sensors[speed.name] * o.signs[speed.name])[o.row] / ratios[_end(speed)] if speed else np.ones(o.m)
        torque, power = torque + np.sign(w) * share, power + w * share
    return (torque, power if speed else np.zeros(0)) if ends else None


def _end(sensor: Sensor) -> str:
    return sensor.reads.partition(".")[0]


def find_detectable(found: Found) -> dict[str, float]:
    """Smallest size of each cause, in its unit, that would be an alarm in 80 of 100 such campaigns; none: never."""
    _, places = np.unique([c.id for c in found.first.candidates], return_index=True)
    candidates = [found.first.candidates[k] for k in places]
    q = (found.first.white[:, places] ** 2).sum(axis=0)
    low, high, widths = priors(candidates)
    needed = np.array([found.critical - found.prior.share[c.id] for c in candidates])
    sign = np.where(high > 0, 1.0, -1.0)
    below, above = np.zeros(len(q)), np.where(sign > 0, high, -low)

    def seen(size: np.ndarray) -> np.ndarray:
        s = sign * (size * q - ndtri(POWER) * np.sqrt(q))
        return np.asarray(log_bayes_factors(s, q, low, high, widths) > needed)

    known = seen(above)
    for _ in range(30):
        middle = 0.5 * (below + above)
        enough = seen(middle)
        below, above = np.where(enough, below, middle), np.where(enough, middle, above)
    return {c.id: float(a * c.formula.cause.size.sd) for c, a, k in zip(candidates, above, known, strict=True) if k}


def replay(problem: Problem, null: Fit, h: Hypothesis) -> dict[str, findings.Played]:
    """Root mean square that the rig leaves when it is played over the data, by sensor, with faults of inputs as found.

    Nothing where no cause is a matter of the machine. Sensors that a hypothesis calls wrong are left out.
    """
    o, own, acting = problem.data, problem.own, h.fit.look.acting
    wrong = {name for a in acting for name in a.formula.read}
    if not any(a.formula.paths for a in acting):
        return {}
    found = {}
    for _, s, mine in channels.compared(o):
        rows = np.setdiff1d(np.flatnonzero(mine), problem.entries_aside)
        left = [o.measured[rows] - fit.look.shown[own][rows] for fit in (null, h.fit)]
        if len(rows) and s.name not in wrong:
            a, b = (channels.difference(s, float(np.sqrt(np.mean(e**2)))) for e in left)
            found[s.name] = findings.Played(rms_calibrated=a, rms_extended=b, unit=channels.unit_of_difference(s))
    return found
