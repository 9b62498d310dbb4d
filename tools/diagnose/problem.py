"""Data, reference and model as one linearised problem: residual, covariance, and signatures of causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from ..effects.cause import Cause, Readings, Theta
from .campaign_model import CampaignModel, Rig
from .card import Card
from .nuisance import Channels, Parameters, day_values, instrument_covariance

#: Steps of the difference quotients: in standard deviations of a nuisance, and share of a day's cooling.
STEP, DAY_STEP = 0.25, 0.02
#: Gauss-Newton ends when no nuisance moves by more than this; it always ends after so many steps.
SETTLED, MOST_STEPS = 0.02, 8
#: Standard deviation of the smooth remainder a reference campaign leaves, per feature: temperatures [K], loss [N.m].
REMAINDER = {"T_oil": 0.8, "T_oil2": 0.8, "T_wall": 0.8, "loss": 1.0}


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
        channels = Channels(tuple(readings), len(model.readings))
        return Campaigned(model, channels, np.concatenate(list(readings.values())), acting)


def measured_readings(model: CampaignModel) -> dict[str, np.ndarray]:
    """Measured channels: temperatures [K] and the loss torque on the carrier's side [N.m]."""
    readings, rows = model.readings, model.rows
    found = {"T_oil": np.array([r.si("T_oil_C") for r in readings])}
    if all(r.given("T_oil2_C") for r in readings):
        found["T_oil2"] = np.array([r.si("T_oil2_C") for r in readings])
    found["T_wall"] = np.array([r.si("T_wall_C") for r in readings])
    sun = np.array([r.values["T_sun_Nm"] for r in readings])
    found["loss"] = (rows.tau - 4 * sun) * rows.direction
    return found


@dataclass(frozen=True)
class Linear:
    """The problem linearised at nuisances `z`: residual ~ N(signature of the truth, covariance)."""

    z: np.ndarray
    values: Mapping[str, float]
    nominal: np.ndarray
    residual: np.ndarray
    covariance: np.ndarray
    jacobian: np.ndarray
    noise: np.ndarray


@dataclass
class Problem:
    """All campaigns of a diagnosis; `acting` is the one whose causes are sought."""

    rig: Rig
    campaigns: Sequence[Campaigned]
    card: Card
    parameters: Parameters
    measured: np.ndarray = field(init=False)
    instrument: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.measured = np.concatenate([c.measured for c in self.campaigns])
        blocks, columns = [], []
        for c in self.campaigns:
            R, tolerance = instrument_covariance(c.channels, c.model.rows, self.card)
            blocks.append(R)
            columns.append(tolerance)
        shared = np.concatenate(columns)
        if len(self.campaigns) > 1:
            shared = np.concatenate([shared, np.concatenate([_remainder(c) for c in self.campaigns])], axis=1)
        self.instrument = _block_diagonal(blocks) + shared @ shared.T

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

    def shown(self, variants: Sequence[Mapping[str, Any]]) -> np.ndarray:
        """What healthy instruments show in all campaigns (m, variants)."""
        parts = []
        for c in self.campaigns:
            parts.append(np.stack([c.channels.stack(r) for r in c.model.simulate(variants)], axis=1))
        return np.concatenate(parts)

    def linearised(
        self, z: np.ndarray, theta: Mapping[str, Theta] | None = None, causes: Sequence[Cause] = ()
    ) -> Linear:
        """The problem at nuisances z, with causes of given parameters acting."""
        variants = [self.parameters.values(z)]
        variants += [self.parameters.values(z + STEP * unit) for unit in np.eye(len(z))]
        variants.append({**variants[0], **day_values({**self.rig.base, **variants[0]}, DAY_STEP)})
        parts = [self._shown_with(c, variants, theta or {}, causes if c.acting else ()) for c in self.campaigns]
        columns = np.concatenate(parts)
        nominal = columns[:, 0]
        jacobian = (columns[:, 1:-1] - nominal[:, None]) / STEP
        day = (columns[:, -1] - nominal) / DAY_STEP * self.card.day_cooling_sd
        noise = self.instrument + self._days(day)
        residual = self.measured - nominal + jacobian @ z
        return Linear(z, variants[0], nominal, residual, noise + jacobian @ jacobian.T, jacobian, noise)

    def shown_by(self, values: Mapping[str, Any], theta: Mapping[str, Theta], causes: Sequence[Cause]) -> np.ndarray:
        """What the instruments of the acting campaign show with causes of given parameters."""
        return self._shown_with(self.data, [values], theta, causes)[:, 0]

    def _days(self, response: np.ndarray) -> np.ndarray:
        """Covariance of days whose cooling differs; readings of one test share theirs."""
        covariance = np.zeros((len(response), len(response)))
        for c in self.campaigns:
            part = self.place(c)
            test = np.tile(c.model.rows.test, len(c.channels.names))
            same = test[:, None] == test[None, :]
            covariance[part, part] = np.outer(response[part], response[part]) * same
        return covariance

    def _shown_with(
        self, c: Campaigned, variants: Sequence[Mapping[str, Any]], theta: Mapping[str, Theta], causes: Sequence[Cause]
    ) -> np.ndarray:
        rows = c.model.rows
        changed = []
        for values in variants:
            extended = dict(values)
            for cause in causes:
                extended |= cause.values({**self.rig.base, **extended}, theta[cause.id], rows)
            changed.append(extended)
        found = []
        for readings in c.model.simulate(changed):
            shown: Readings = readings
            for cause in causes:
                shown = cause.readings(theta[cause.id], rows, shown)
            found.append(c.channels.stack(shown))
        return np.stack(found, axis=1)

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
        """Gauss-Newton on the nuisances, causes held: to convergence, or so many steps."""
        linear = self.linearised(np.zeros(len(self.parameters.names)) if z is None else z, theta, causes)
        for _ in range(steps - 1):
            new = self.nuisances(linear, linear.residual)
            new = linear.z + np.clip(new - linear.z, -1.5, 1.5)
            moved = float(np.abs(new - linear.z).max())
            linear = self.linearised(new, theta, causes)
            if moved < SETTLED:
                break
        return linear

    def without(self, linear: Linear) -> Linear:
        """A linearisation made with causes acting, with their effect put back into the residual."""
        healthy = self.shown([linear.values])[:, 0]
        return replace(linear, residual=linear.residual + linear.nominal - healthy)

    def signatures(self, linear: Linear, wanted: Sequence[tuple[Cause, Theta, float]]) -> np.ndarray:
        """Change of all readings per unit of size, for causes of given form, as a secant to a given size (m, k)."""
        c, part = self.data, self.place(self.data)
        rows = c.model.rows
        base = {**self.rig.base, **linear.values}
        variants = [dict(linear.values)]
        for cause, form, size in wanted:
            if cause.physical:
                theta = {**form, cause.size.name: size}
                variants.append({**linear.values, **cause.values(base, theta, rows)})
        simulated = c.model.simulate(variants)
        healthy, physical = simulated[0], iter(simulated[1:])
        nominal = c.channels.stack(healthy)
        found = np.zeros((len(self.measured), len(wanted)))
        for k, (cause, form, size) in enumerate(wanted):
            true = next(physical) if cause.physical else healthy
            shown = cause.readings({**form, cause.size.name: size}, rows, true)
            found[part, k] = (c.channels.stack(shown) - nominal) / size
        found[:, ~np.isfinite(found).all(axis=0)] = 0.0  # a form that no machine has explains nothing
        return found


def _remainder(c: Campaigned) -> np.ndarray:
    """Columns of a smooth remainder in speed, torque, room and direction, the same in all campaigns of a rig."""
    rows = c.model.rows
    w, tau, room = (rows.w - 18.0) / 6.0, (rows.tau - 2100.0) / 500.0, (rows.T_room - 300.0) / 6.0
    d = rows.direction
    features = np.stack([np.ones_like(w), w, tau, room, d, w * tau, w**2, tau**2, d * w, d * tau], axis=1)
    columns = []
    for name in c.channels.names:
        block = np.zeros((len(c.measured), features.shape[1]))
        block[c.channels.part(name)] = features * REMAINDER[name]
        columns.append(block)
    return np.concatenate(columns, axis=1)


def _block_diagonal(blocks: Sequence[np.ndarray]) -> np.ndarray:
    size = sum(len(b) for b in blocks)
    whole, begin = np.zeros((size, size)), 0
    for b in blocks:
        whole[begin : begin + len(b), begin : begin + len(b)] = b
        begin += len(b)
    return whole
