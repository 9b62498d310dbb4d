"""Data, reference and model as one linearised problem: residual, covariance, and signatures of causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.linalg import block_diag, cho_factor, cho_solve

from ...model.errors import SolveError
from ..effects.cause import Cause, Readings, Rows, Theta
from .campaign_model import CampaignModel, Rig
from .card import Card
from .nuisance import COURSES, Channels, Parameters, day_values, instrument_covariance

#: Steps of the difference quotients: in standard deviations of a nuisance, and share of a day's cooling.
STEP, DAY_STEP = 0.25, 0.02
#: Gauss-Newton ends when no nuisance moves by more than this; it always ends after so many steps.
SETTLED, MOST_STEPS = 0.02, 12
#: Tries of each step with more damping (Levenberg and Marquardt), and the longest step of a nuisance.
TRIES, LONGEST = 4, 1.5
#: Standard deviation of the smooth remainder a reference campaign leaves, per feature: temperatures [K], loss [N.m].
REMAINDER = {"T_oil": 0.8, "T_oil2": 0.8, "T_wall": 0.8, "loss": 1.0, "T_oil course": 0.8, "T_wall course": 0.8}
#: Powers of the share of the dwell to come by which it fades along a course: the highest are the first minutes, when
#: every rig's gears, oil and wall warm in their own way, and the oil is as thick as the room is cold.
FADING = (1, 2, 4, 8, 16)
#: Parameters that another filling or mounting of the gearbox changes, and by what share of their prior deviations.
REFILLED = ("mesh friction", "bearing loss", "seal loss", "oil to gears", "oil to wall")
CHANGED = 0.5
#: A second oil probe may stand elsewhere: standard deviation of the share of the wall that it sees.
ELSEWHERE = 0.08


@dataclass(frozen=True)
class Campaigned:
    """One campaign: its model, what was measured, and whether causes act in it."""

    model: CampaignModel
    channels: Channels
    measured: np.ndarray
    acting: bool

    @staticmethod
    def of(model: CampaignModel, *, acting: bool) -> Campaigned:
        """From a campaign's readings."""
        readings = measured_readings(model)
        holds = {channel: rows for channel, (rows, _) in readings.items()}
        logged = [item.scatter for own in model.logged for item in own]
        scatter = block_diag(*logged) if logged else None
        return Campaigned(model, Channels(holds, scatter), np.concatenate([v for _, v in readings.values()]), acting)


def measured_readings(model: CampaignModel) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Measured channels: rows of the readings, and values: temperatures [K], loss torque at the carrier [N.m]."""
    readings, ends = model.readings, np.arange(model.n)
    found = {"T_oil": np.array([r.si("T_oil_C") for r in readings])}
    if all(r.given("T_oil2_C") for r in readings):
        found["T_oil2"] = np.array([r.si("T_oil2_C") for r in readings])
    found["T_wall"] = np.array([r.si("T_wall_C") for r in readings])
    sun = np.array([r.values["T_sun_Nm"] for r in readings])
    found["loss"] = (model.rows.tau[ends] - 4 * sun) * model.rows.direction[ends]
    steady = {channel: (ends, values) for channel, values in found.items()}
    return steady | _logged(model)


def _logged(model: CampaignModel) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Channels of logged courses, and how long the logged dwells were against what is stated."""
    places, halves = np.arange(model.n, model.n + model.samples), np.cumsum([0, *(len(t.halves) for t in model.tests)])
    items = [(int(halves[k]) + item.half, item) for k, own in enumerate(model.logged) for item in own]
    if not items:
        return {}
    stated = [model.readings[row].si("dwell_min") for row, _ in items]
    dwell = np.array([item.dwell for _, item in items]) / stated - 1
    return {
        "T_oil course": (places, np.concatenate([item.T_oil for _, item in items])),
        "T_wall course": (places, np.concatenate([item.T_wall for _, item in items])),
        "dwell": (np.array([row for row, _ in items]), dwell),
    }


@dataclass(frozen=True)
class Linear:
    """The problem linearised at nuisances `z`: residual ~ N(signature of the truth, covariance).

    `theta` and `causes` act in it; `days` are the effects of the cooling of the acting campaign's tests (m, tests).
    """

    z: np.ndarray
    values: Mapping[str, float]
    nominal: np.ndarray
    residual: np.ndarray
    covariance: np.ndarray
    jacobian: np.ndarray
    noise: np.ndarray
    days: np.ndarray
    theta: Mapping[str, Theta] = field(default_factory=dict)
    causes: Sequence[Cause] = ()

    def with_days(self, size: float, sign: float = 1.0) -> Linear:
        """The same where the acting campaign's days scatter by so much more in their cooling, or less with sign -1."""
        days = sign * size**2 * self.days @ self.days.T
        return replace(self, covariance=self.covariance + days, noise=self.noise + days)


@dataclass
class Problem:
    """All campaigns of a diagnosis; `acting` is the one whose causes are sought.

    `scattered` is the standard deviation of the acting campaign's days of cooling beside what the card states.
    """

    rig: Rig
    campaigns: Sequence[Campaigned]
    card: Card
    parameters: Parameters
    scattered: float = 0.0
    measured: np.ndarray = field(init=False)
    instrument: np.ndarray = field(init=False)
    scatter: np.ndarray = field(init=False)
    tied: np.ndarray = field(init=False)
    tied_names: Sequence[str] = field(init=False)

    def __post_init__(self) -> None:
        self.measured = np.concatenate([c.measured for c in self.campaigns])
        blocks, shared = [], []
        for c in self.campaigns:
            R, columns = instrument_covariance(c.channels, c.model.rows, self.card)
            blocks.append(R)
            shared.append(columns | (remainder(c.channels, c.model.rows) if len(self.campaigns) > 1 else {}))
        self.tied_names = sorted(set().union(*shared))
        none = [np.zeros(len(c.measured)) for c in self.campaigns]
        joined = np.concatenate(
            [
                np.stack([own.get(name, zero) for name in self.tied_names], axis=1)
                for own, zero in zip(shared, none, strict=True)
            ]
        )
        self.scatter, self.tied = block_diag(*blocks), joined
        self.instrument = self.scatter + joined @ joined.T

    @property
    def data(self) -> Campaigned:
        """The campaign in which causes act."""
        return next(c for c in self.campaigns if c.acting)

    def place(self, campaign: Campaigned) -> slice:
        """Place of a campaign's readings in the whole vector."""
        begin = 0
        for c in self.campaigns:
            end = begin + len(c.measured)
            if c is campaign:
                return slice(begin, end)
            begin = end
        raise ValueError("no campaign of this problem")

    def linearised(
        self, z: np.ndarray, theta: Mapping[str, Theta] | None = None, causes: Sequence[Cause] = ()
    ) -> Linear:
        """The problem at nuisances z, with causes of given parameters acting."""
        variants = [self.parameters.values(z)]
        variants += [self.parameters.values(z + STEP * unit) for unit in np.eye(len(z))]
        variants.append({**variants[0], **day_values({**self.rig.base, **variants[0]}, DAY_STEP)})
        parts = [self.shown_at(c, [(values, theta or {}) for values in variants], causes) for c in self.campaigns]
        columns = np.concatenate(parts)
        if not np.isfinite(columns).all():
            raise SolveError("the model cannot be run near what its causes make of it.")
        nominal = columns[:, 0]
        jacobian = (columns[:, 1:-1] - nominal[:, None]) / STEP
        day = (columns[:, -1] - nominal) / DAY_STEP
        days = self._days(day)
        stated = self.card.day_cooling_sd**2 * sum(d @ d.T for d in days)
        noise = self.instrument + stated + self.scattered**2 * days[0] @ days[0].T + self._elsewhere(nominal)
        noise = noise + self._between_grids(jacobian)
        residual = self.measured - nominal + jacobian @ z
        covariance = noise + jacobian @ jacobian.T
        return Linear(z, variants[0], nominal, residual, covariance, jacobian, noise, days[0], theta or {}, causes)

    def moved(self, linear: Linear, z: np.ndarray, theta: Mapping[str, Theta], causes: Sequence[Cause]) -> Linear:
        """A linearisation carried to other nuisances and causes: their readings, the slopes of before.

        Raises:
            SolveError: the model cannot be run there
        """
        values = self.parameters.values(z)
        nominal = np.concatenate([self.shown_at(c, [(values, theta)], causes)[:, 0] for c in self.campaigns])
        if not np.isfinite(nominal).all():
            raise SolveError("the model cannot be run with what its causes make of it.")
        residual = self.measured - nominal + linear.jacobian @ z
        return replace(linear, z=z, values=values, nominal=nominal, residual=residual, theta=theta, causes=causes)

    def shown_by(self, values: Mapping[str, Any], theta: Mapping[str, Theta], causes: Sequence[Cause]) -> np.ndarray:
        """What the instruments of the acting campaign show with causes of given parameters."""
        return self.shown_at(self.data, [(values, theta)], causes)[:, 0]

    def _days(self, response: np.ndarray) -> list[np.ndarray]:
        """Effects of every test's cooling (m, tests), the acting campaign's first."""
        found = []
        for c in sorted(self.campaigns, key=lambda c: not c.acting):
            part, test = self.place(c), c.model.rows.test[c.channels.rows]
            columns = np.zeros((len(response), c.model.rows.n_tests))
            columns[part] = response[part, None] * (test[:, None] == np.arange(c.model.rows.n_tests))
            found.append(columns)
        return found

    def _between_grids(self, jacobian: np.ndarray) -> np.ndarray:
        """Covariance of what another filling and mounting change: each grid of a campaign has losses of its own."""
        own = [k for k, name in enumerate(self.parameters.names) if name in REFILLED]
        found = np.zeros((len(jacobian), len(jacobian)))
        for c in self.campaigns:
            part = self.place(c)
            names = np.array([test.halves[0].texts.get("grid", "") for test in c.model.tests])
            grid = names[c.model.rows.test[c.channels.rows]]
            if len(set(names)) > 1:
                J = CHANGED * jacobian[part][:, own]
                found[part, part] = J @ J.T * (grid[:, None] == grid)
        return found

    def _elsewhere(self, nominal: np.ndarray) -> np.ndarray:
        """Covariance of second oil probes that see something of the wall, each rig's its own."""
        column = np.zeros(len(nominal))
        for c in self.campaigns:
            if "T_oil2" in c.channels.names:
                own = nominal[self.place(c)]
                difference = own[c.channels.part("T_wall")] - own[c.channels.part("T_oil")]
                part = c.channels.part("T_oil2")
                column[self.place(c).start + np.arange(part.start, part.stop)] = ELSEWHERE * difference
        return np.outer(column, column)

    def shown_at(
        self, c: Campaigned, cases: Sequence[tuple[Mapping[str, Any], Mapping[str, Theta]]], causes: Sequence[Cause]
    ) -> np.ndarray:
        """What the instruments of a campaign show (m, cases), each with its own values and parameters of the causes."""
        acting = list(causes) if c.acting else []
        variants = [self._extended(values, theta, acting, c) for values, theta in cases]
        n = len(cases)
        if any(not cause.logged for cause in acting):
            logged = [cause for cause in acting if cause.logged]
            variants += [self._extended(values, theta, logged, c) for values, theta in cases]
        found = c.model.simulate(variants)
        if len(found) > n:
            found = [_joined(end, course, c.model.n) for end, course in zip(found[:n], found[n:], strict=True)]
        return np.stack(
            [self._read(c, true, theta, acting) for true, (_, theta) in zip(found, cases, strict=True)], axis=1
        )

    def _extended(
        self, values: Mapping[str, Any], theta: Mapping[str, Theta], causes: Sequence[Cause], c: Campaigned
    ) -> dict[str, Any]:
        """Values of the machine with causes acting."""
        extended = dict(values)
        for cause in causes:
            extended |= cause.values({**self.rig.base, **extended}, theta[cause.id], c.model.rows)
        return extended

    @staticmethod
    def _read(c: Campaigned, true: Readings, theta: Mapping[str, Theta], causes: Sequence[Cause]) -> np.ndarray:
        """True readings as faulty instruments show them, as one vector."""
        for cause in causes:
            true = cause.readings(theta[cause.id], c.model.rows, true)
        return c.channels.stack(true)

    def nuisances(self, linear: Linear, residual: np.ndarray) -> np.ndarray:
        """The most likely nuisances for a residual, by a linearisation."""
        J = linear.jacobian
        weighted = cho_solve(cho_factor(linear.noise), J)
        return np.asarray(np.linalg.solve(J.T @ weighted + np.eye(J.shape[1]), weighted.T @ residual))

    def settled(
        self,
        z: np.ndarray | None = None,
        theta: Mapping[str, Theta] | None = None,
        causes: Sequence[Cause] = (),
        steps: int = MOST_STEPS,
    ) -> Linear:
        """Damped Gauss-Newton on the nuisances, causes held: to convergence, or so many steps."""
        linear, damping = self.linearised(np.zeros(len(self.parameters.names)) if z is None else z, theta, causes), 0.0
        for _ in range(steps - 1):
            factor = cho_factor(linear.noise)
            weighted = cho_solve(factor, linear.jacobian)
            H = linear.jacobian.T @ weighted + np.eye(len(linear.z))
            downhill = weighted.T @ (self.measured - linear.nominal) - linear.z
            before = self._cost(linear, factor)
            for _ in range(TRIES):
                change = np.clip(np.linalg.solve(H + damping * np.diag(np.diag(H)), downhill), -LONGEST, LONGEST)
                with suppress(SolveError):
                    if self._cost(self.moved(linear, linear.z + change, theta or {}, causes), factor) <= before + 1e-6:
                        linear = self.linearised(linear.z + change, theta, causes)
                        break
                damping = max(5 * damping, 0.3)
            else:
                break
            damping /= 5
            if float(np.abs(change).max()) < SETTLED:
                break
        return linear

    def _cost(self, linear: Linear, factor: Any) -> float:
        """Half the squared misfit at a linearisation, priors included."""
        r = self.measured - linear.nominal
        return float(0.5 * r @ cho_solve(factor, r) + 0.5 * linear.z @ linear.z)

    def signatures(self, linear: Linear, wanted: Sequence[tuple[Cause, Theta, float]]) -> np.ndarray:
        """Change of all readings per unit of size, for causes of given form, as a secant to a given size (m, k).

        The other causes that act in the linearisation go on acting.
        """
        c, part = self.data, self.place(self.data)
        variants: list[dict[str, Any]] = []
        places: dict[tuple[str, ...], int] = {}
        jobs = []
        for cause, form, size in wanted:
            others = [other for other in linear.causes if other.id != cause.id]
            name = tuple(other.id for other in others)
            if name not in places:
                places[name] = len(variants)
                variants.append(self._extended(linear.values, linear.theta, others, c))
            theta = {**linear.theta, cause.id: {**form, cause.size.name: size}}
            jobs.append((cause, theta, others, places[name], len(variants) if cause.physical else places[name]))
            if cause.physical:
                variants.append(self._extended(linear.values, theta, [*others, cause], c))
        simulated = c.model.simulate(variants)
        found = np.zeros((len(self.measured), len(wanted)))
        for k, (cause, theta, others, before, after) in enumerate(jobs):
            true = simulated[after] if cause.logged else _joined(simulated[after], simulated[before], c.model.n)
            change = self._read(c, true, theta, [*others, cause]) - self._read(c, simulated[before], theta, others)
            found[part, k] = change / wanted[k][2]
        found[:, ~np.isfinite(found).all(axis=0)] = 0.0  # a form that no machine has explains nothing
        return found

    def healthy(self) -> np.ndarray:
        """Nuisances by the reference campaign alone; the nominal where there is none."""
        references = [c for c in self.campaigns if not c.acting]
        if not references:
            return np.zeros(len(self.parameters.names))
        return Problem(self.rig, references, self.card, self.parameters).settled().z

    def put_back(self, linear: Linear, forms: Sequence[float] = (0.0,)) -> list[Linear]:
        """A linearisation with its causes' effects put back into the residual, by their signatures there.

        Each of `forms` is a standard deviation of what a form leaves of a true effect, as a share of it that changes
        smoothly with the conditions: it adds to the scatter of a linearisation of its own.
        """
        sizes = [linear.theta[c.id][c.size.name] for c in linear.causes]
        acting = [(c, size) for c, size in zip(linear.causes, sizes, strict=True) if size != 0.0]
        if not acting:
            return [linear] * len(forms)
        G = self.signatures(linear, [(c, linear.theta[c.id], size) for c, size in acting])
        effects, part = G * np.array([size for _, size in acting]), self.place(self.data)
        rough = np.zeros_like(linear.noise)
        rough[part, part] = (effects[part] @ effects[part].T) * alike(self.data)
        return [
            replace(
                linear,
                residual=linear.residual + effects.sum(axis=1),
                covariance=linear.covariance + form**2 * rough,
                noise=linear.noise + form**2 * rough,
            )
            for form in forms
        ]


def alike(c: Campaigned) -> np.ndarray:
    """Correlation of what is smooth in speed, torque, direction and time, between all readings of a campaign."""
    rows, which = c.model.rows, c.channels.rows
    conditions = [(rows.w - 18.0) / 5.0, (rows.tau - 2100.0) / 450.0, rows.direction, rows.share / 0.3]
    features = np.stack(conditions, axis=1)[which]
    return np.asarray(np.exp(-0.5 * ((features[:, None, :] - features[None, :, :]) ** 2).sum(axis=2)))


def _joined(ends: Readings, courses: Readings, n: int) -> Readings:
    """The readings at the ends of the halves from one, along the courses from the other."""
    return {c: np.concatenate([ends[c][:n], courses[c][n:]]) for c in ends}


def remainder(channels: Channels, rows: Rows) -> dict[str, np.ndarray]:
    """Effects of a smooth remainder in speed, torque, room and direction, the same in all campaigns of a rig.

    A probe's logged course shares that of its readings, and has more that fades as the dwell passes.
    """
    which = channels.rows
    w, tau, room = (rows.w - 18.0) / 6.0, (rows.tau - 2100.0) / 500.0, (rows.T_room - 300.0) / 6.0
    d, one = rows.direction, np.ones(len(rows.w))
    smooth = [one, w, tau, room, d, w * tau, w**2, tau**2, d * w, d * tau]
    fading = [(1 - rows.share) ** k * (1 + side * d) for k in FADING for side in (1, -1)]
    begun = [fades * f for fades in fading for f in (one, w, tau, room)]
    found: dict[str, np.ndarray] = {}
    for name in (n for n in channels.names if n in REMAINDER):
        part = channels.part(name)
        features = {f"remainder of {COURSES.get(name, name)} {k}": f for k, f in enumerate(smooth)}
        if name in COURSES:
            features |= {f"remainder of {name} {k}": f for k, f in enumerate(begun)}
        for own, feature in features.items():
            found.setdefault(own, np.zeros(len(which)))[part] = feature[which[part]] * REMAINDER[name]
    return found
