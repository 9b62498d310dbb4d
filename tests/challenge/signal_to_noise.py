"""Signal-to-noise ratio of a hidden fault and its distance from the nearest other cause, for any simulator of rigs.

The signature of a fault is what it changes in the readings without noise. Its signal-to-noise is the norm of the
whitened signature, sqrt(s' S^-1 s) with S = R + J Sigma J'. R holds the repeatabilities squared; each column of J is
what a nuisance does to the readings, by differences; Sigma is its variance: the fixed tolerance of every channel; the
rig's parameters; the cooling of every day; the true speed, torque and room of every half, practically free, since only
their readings tell them; with a reference campaign also a smooth remainder over speed, load and room in both campaigns.
A reference adds its readings, in which the signature is zero; parameters and tolerances are shared. Where a fault
differs by chance from test to test, only its scatter counts (`snr_of`).

A rival is a fault of another class in any form. Its distance is what the best non-negative mixture of drawn forms and
amounts of one cause leaves of the whitened signature: shapes, heat locations and sizes are free. Rivals may act under
some conditions only, too: to first order, by their signatures in those readings. They then act in each reading by
the share of a fault that is limited itself, or on one side of a speed, load, oil temperature or test, or in one
direction.
Below 2.5 to 3 the right answer names both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import block_diag, qr, solve_triangular
from scipy.optimize import nnls

from .classes import class_of
from .forms import step
from .plan import Plan

#: A fault, the columns in which it acts, and how much of it in each of them.
Acting = tuple[Any, slice, np.ndarray]

#: Readings without noise (channels, 2, columns) of tests with factors of the rig and acting faults.
Run = Callable[[Plan, Mapping[str, Any], Sequence[Acting]], np.ndarray]

#: Standard deviations of the true speed [rpm], torque [N.m] and room [K] of a half: practically free, as only their
#: readings tell them.
FREE_SD = {"n": 300.0, "load": 3000.0, "room": 100.0}
#: Steps of their differences: small against the campaign's range, large against round-off.
FREE_STEP = {"n": 2.0, "load": 20.0, "room": 1.0}
#: Step of the differences of factors, relative [1].
FACTOR_STEP = 0.05

#: Remainder of a rig that is not the model: sun torque [N.m], oil and wall [K].
REMAINDER_SD = {"T_sun_Nm": 0.25, "T_oil_C": 1.0, "T_oil2_C": 1.0, "T_wall_C": 1.0}

#: Change of an oil temperature at which a rig would be stopped [K].
OBVIOUS = 35.0

#: What differs by chance from test to test.
BY_CHANCE = frozenset(("procedure.day_scatter",))

#: Tests in one run of several variants.
BATCH = 4000


@dataclass(frozen=True)
class Setting:
    """A campaign in which signal-to-noise ratios are measured.

    Args:
        run: the simulator
        channels: of its readings
        plan, base: the campaign's tests and factors of the rig
        reference: the healthy campaign's tests, if there is one
        repeat_sd, offset_sd: of every channel, as they are
        prior: standard deviations of factors of the rig; several names of one parameter joined by a blank
        days, day_sd: factors of cooling that a day changes, and by how much
    """

    run: Run
    channels: tuple[str, ...]
    plan: Plan
    base: Mapping[str, Any]
    reference: Plan | None
    repeat_sd: Mapping[str, float]
    offset_sd: Mapping[str, float]
    prior: Mapping[str, float]
    days: tuple[str, ...]
    day_sd: float


def tile(base: Mapping[str, Any], copies: int) -> dict[str, Any]:
    """Factors for several copies of the tests."""
    return {name: np.tile(f, copies) if np.ndim(f) else f for name, f in base.items()}


def snr_of(cause: str, norm: Any, tests: int) -> Any:
    """Signal-to-noise ratio from the norm of a whitened signature.

    Of what differs by chance from test to test only the mean square m can be told. A likelihood speaks for n tests that
    scatter by m beside their noise as it does for a known signature of the length sqrt(n (m - log(1 + m))).

    Args:
        cause: of the fault
        norm: of its whitened signature
        tests: number of tests in which it acts
    """
    if cause not in BY_CHANCE:
        return norm
    m = norm**2 / tests
    return np.sqrt(tests * (m - np.log1p(m)))


class Noise:
    """Covariance of the readings of one campaign, and signal-to-noise ratios of faults in it."""

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        plans = [p for p in (setting.plan, setting.reference) if p is not None]
        blocks = [self._block(plan) for plan in plans]
        self.healthy = blocks[0][0]
        shared, local = np.vstack([b[1] for b in blocks]), block_diag(*(b[2] for b in blocks))
        S = shared @ shared.T + local @ local.T
        sd = [np.repeat([setting.repeat_sd[c] for c in setting.channels], 2 * p.columns) for p in plans]
        S[np.diag_indices_from(S)] += np.concatenate(sd) ** 2
        white = solve_triangular(np.linalg.cholesky(S), np.eye(len(S), self.healthy.size), lower=True)
        self._white = qr(white, mode="r")[0][: self.healthy.size]

    def _block(self, plan: Plan) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Readings (channels, 2, tests); shared and local sensitivities (readings, columns), scaled by their sd."""
        s = self.setting
        names = [*s.prior, " ".join(s.days)]
        moves = [(name, rows) for name in ("n", "load") for rows in ((0,), (1,))] + [("room", (0, 1)), ("room", (2,))]
        m, copies = plan.columns, 1 + len(names) + len(moves)
        big, base = plan.tile(copies), tile(s.base, copies)
        here = [slice(i * m, (i + 1) * m) for i in range(copies)]
        for part, joined in zip(here[1:], names, strict=False):
            for name in joined.split():
                base[name] = base.get(name, 1.0) * np.ones(copies * m)
                base[name][part] *= 1.0 + FACTOR_STEP
        for part, (name, rows) in zip(here[1 + len(names) :], moves, strict=True):
            for row in rows:
                getattr(big, name)[row, part] += FREE_STEP[name]
        y = s.run(big, base, ())
        y = y.reshape(*y.shape[:2], copies, m)
        change = np.moveaxis(y[:, :, 1:] - y[:, :, :1], 2, 0)
        shared = [change[i].ravel() / FACTOR_STEP * sd for i, sd in enumerate(s.prior.values())]
        for i, c in enumerate(s.channels):
            zero = np.zeros_like(y[:, :, 0])
            zero[i] = s.offset_sd[c]
            shared.append(zero.ravel())
        shared += _remainder(plan, s.channels) if s.reference is not None else []
        local = [change[len(s.prior)] / FACTOR_STEP * s.day_sd]
        local += [c / FREE_STEP[name] * FREE_SD[name] for c, (name, _) in zip(change[len(names) :], moves, strict=True)]
        per_test = [(e[..., None] * np.eye(m)).reshape(-1, m) for e in local]
        return y[:, :, 0], np.array(shared).T, np.hstack(per_test)

    def signatures(self, faults: Sequence[Any], amounts: np.ndarray) -> np.ndarray:
        """What each fault changes with its amount (faults, channels, 2, tests); not finite where the rig runs away."""
        s, m, size = self.setting, self.setting.plan.columns, max(BATCH // self.setting.plan.columns, 1)
        changes = np.empty((len(faults), *self.healthy.shape))
        physical = [i for i, fault in enumerate(faults) if set(fault.stages) != {"read"}]
        for i in set(range(len(faults))) - set(physical):  # what only misreads needs no other run
            shown = self.healthy.copy()
            faults[i].stages["read"](shown, s.plan, np.full(m, amounts[i]))
            changes[i] = shown - self.healthy
        for some in (physical[k : k + size] for k in range(0, len(physical), size)):
            acting = [(faults[i], slice(k * m, (k + 1) * m), np.full(m, amounts[i])) for k, i in enumerate(some)]
            with np.errstate(all="ignore"):
                y = s.run(s.plan.tile(len(some)), tile(s.base, len(some)), acting)
            changes[some] = np.moveaxis(y.reshape(*y.shape[:2], len(some), m) - self.healthy[:, :, None], 2, 0)
        return changes

    def whiten(self, signatures: np.ndarray) -> np.ndarray:
        """Whitened signatures (readings, faults); zero for what is not finite."""
        flat = signatures.reshape(len(signatures), -1)
        return np.asarray(self._white @ np.where(np.isfinite(flat).all(axis=1)[:, None], flat, 0.0).T)

    def share(self, regime: Mapping[str, Any], oil: np.ndarray) -> np.ndarray:
        """How much of a limited fault acts, by reading (2, tests).

        Args:
            regime: of the fault: a quantity and its side ("above" or "below") in one text or as key and value, the
                threshold, and the width of the border
            oil: temperatures where it acts (2, tests)
        """
        plan = self.setting.plan
        at = regime["at"] if "at" in regime else regime["threshold"]
        what, side = str(regime["where"]).split() if "where" in regime else next(iter(regime.items()))
        seen = {
            "speed": plan.n,
            "load": plan.load,
            "oil": oil,
            "temperature": oil,
            "order": plan.progress,
            "direction": np.array(plan.directions, float)[:, None],
        }[what]
        sign = 1.0 if side == "above" else -1.0
        return np.broadcast_to(step(sign * seen, sign * at, regime["width"]), oil.shape)

    def survey(self, fault: Any, amounts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signal-to-noise ratio by amount, and which of them change no oil temperature by more than `OBVIOUS`."""
        change = self.signatures([fault] * len(amounts), amounts)
        oil = change[:, self.setting.channels.index("T_oil_C")]
        with np.errstate(invalid="ignore"):
            sensible = (np.abs(oil) < OBVIOUS).all(axis=(1, 2))
        return self.snr(fault, np.linalg.norm(self.whiten(change), axis=0)), sensible

    def snr(self, fault: Any, norm: Any) -> Any:
        """Signal-to-noise ratio of a fault from the norm of its whitened signature."""
        return snr_of(fault.cause, norm, self.setting.plan.columns)


def _remainder(plan: Plan, channels: tuple[str, ...]) -> list[np.ndarray]:
    """Smooth terms of the conditions, per channel and half, flat over readings."""
    x, y = (plan.n[0] - 175.0) / 75.0, (plan.load[0] - 2130.0) / 580.0
    terms = [np.ones_like(x), x, y, x * y, x * x, y * y, (plan.room[1] - 24.0) / 5.0]
    remainder = []
    for i, c in enumerate(channels):
        for half in (0, 1):
            for term in terms if c in REMAINDER_SD else ():
                one = np.zeros((len(channels), 2, plan.columns))
                one[i, half] = REMAINDER_SD[c] * term
                remainder.append(one.ravel())
    return remainder


@dataclass(frozen=True)
class Rival:
    """The nearest cause of another class, and how far it is [sigma]."""

    cause: str
    distance: float


#: Forms drawn of each cause.
FORMS = 8
#: Amounts of each form, over its largest sensible one.
AMOUNTS = (0.1, 0.5)

#: Causes that may act under some conditions only, as any of the simulators draws them.
PARTLY = frozenset(
    ("losses.churning", "losses.windage", "losses.mesh_friction", "losses.seal_drag", "losses.bearing_preload")
    + ("heat.external_source", "cooling.air", "cooling.foundation", "cooling.contact")
    + ("sensor.oil_temp.offset", "sensor.torque.offset")
)

#: Widths of the borders of what limits them: speed [rpm], load [N.m], oil [K], share of the campaign [1].
WIDTHS = {"speed": (4.0, 12.0), "load": (40.0, 120.0), "oil": (1.3, 4.0), "order": (0.02,)}
#: Quantiles of the tests at which thresholds lie.
QUANTILES = np.arange(0.1, 0.95, 0.1)


class _Mixture:
    """Non-negative mixtures of forms of one cause: whitened columns (readings, forms), each of length 1."""

    def __init__(self, columns: np.ndarray) -> None:
        length = np.linalg.norm(columns, axis=0)
        self.columns = columns[:, length > 1e-9] / length[length > 1e-9]
        self.gram = self.columns.T @ self.columns

    def beside(self, q: np.ndarray) -> Callable[[np.ndarray], tuple[float, Callable[[], float]]]:
        """What the mixture leaves of a vector beside orthonormal columns q: a lower bound, and how to get the value."""
        inside = self.columns.T @ q
        R = np.linalg.cholesky(self.gram - inside @ inside.T + 1e-9 * np.eye(len(inside))).T

        def left(t: np.ndarray) -> tuple[float, Callable[[], float]]:
            along = solve_triangular(R, self.columns.T @ t, trans=1)
            beyond = max(float(t @ t - along @ along), 0.0)
            return np.sqrt(beyond), lambda: float(np.hypot(nnls(R, along)[1], np.sqrt(beyond)))

        return left


@dataclass
class Rivals:
    """Nearest rivals in one campaign.

    Args:
        noise: of the campaign
        families: draw a form of each cause
        rng: source of forms
    """

    noise: Noise
    families: Mapping[str, Callable[[np.random.Generator], Any]]
    rng: np.random.Generator

    def _limits(self) -> list[np.ndarray]:
        """How much of a limited cause acts, by reading (2, tests): one side of each quantity, one direction."""
        noise = self.noise
        plan, oil = noise.setting.plan, noise.healthy[noise.setting.channels.index("T_oil_C")]
        seen = {"speed": plan.n, "load": plan.load, "oil": oil, "order": plan.progress}
        sides = [
            {"where": f"{what} {side}", "at": at, "width": width}
            for what, widths in WIDTHS.items()
            for side in ("above", "below")
            for at in np.quantile(seen[what], QUANTILES)
            for width in widths
        ]
        if not plan.steady:
            sides += [{"where": f"direction {side}", "at": 1.5, "width": 0.05} for side in ("above", "below")]
        return [noise.share(side, oil) for side in sides]

    @cached_property
    def _forms(self) -> Mapping[str, tuple[np.ndarray, list[_Mixture]]]:
        """Signatures of every cause (forms, channels, 2, tests), and mixtures of them on each side that limits it."""
        faults, amounts, causes = [], [], []
        for cause, family in self.families.items():
            for _ in range(FORMS):
                fault = family(self.rng)
                for a in (sign * share * fault.high for sign in fault.signs for share in AMOUNTS):
                    faults.append(fault)
                    amounts.append(a)
                    causes.append(cause)
        changes, cause_of, limits = self.noise.signatures(faults, np.array(amounts)), np.array(causes), self._limits()
        known = {}
        for cause in self.families:
            forms = changes[cause_of == cause]
            sides = [_Mixture(self.noise.whiten(forms * limit)) for limit in limits if cause in PARTLY]
            known[cause] = forms, sides
        return known

    def nearest(self, fault: Any, amount: float, beside: Iterable[tuple[Any, float]] = ()) -> tuple[float, Rival]:
        """Signal-to-noise ratio of a fault, and its nearest rival.

        Args:
            fault, amount: what is judged
            beside: other faults that act as well, of unknown size
        """
        others = list(beside)
        faults, amounts = [fault, *(f for f, _ in others)], np.array([amount, *(a for _, a in others)])
        changes = self.noise.signatures(faults, amounts)
        white = self.noise.whiten(changes)
        q = np.linalg.qr(white[:, 1:])[0]
        t = white[:, 0] - q @ (q.T @ white[:, 0])
        classes = {class_of(f.cause) for f in faults}
        oil = (self.noise.healthy + changes.sum(axis=0))[self.noise.setting.channels.index("T_oil_C")]
        limits = [1.0, *(self.noise.share(f.regime, oil) for f in faults if f.regime)]
        length = float(np.linalg.norm(t))
        nearest = Rival("nothing", length)
        bounds = []
        for cause, (forms, sides) in self._forms.items():
            if class_of(cause) not in classes:
                alike = _Mixture(np.hstack([self.noise.whiten(forms * limit) for limit in limits]))
                bounds += [(*side.beside(q)(t), cause) for side in (alike, *sides)]
        for least, distance, cause in sorted(bounds, key=lambda b: b[0]):
            if least >= nearest.distance:
                break
            nearest = min(nearest, Rival(cause, distance()), key=lambda r: r.distance)
        snr, distance = self.noise.snr(fault, np.array([length, nearest.distance])).tolist()
        return snr, Rival(nearest.cause, distance)
