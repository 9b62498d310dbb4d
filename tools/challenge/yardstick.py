"""How loud a hidden fault is, and how far from what could be taken for it: for any simulator of rigs.

The signature of a fault is what it changes in the readings without noise. Its signal-to-noise is the norm of the
whitened signature, sqrt(s' S^-1 s) with S = R + J Sigma J'. R holds the repeatabilities squared; each column of J is
what a nuisance does to the readings, by differences; Sigma is its variance: the fixed tolerance of every channel; the
rig's parameters; the cooling of every day; the true speed, torque and room of every half, practically free, since only
their readings tell them; with a reference campaign also a smooth remainder over speed, load and room in both campaigns.
A reference adds its readings, in which the signature is zero; parameters and tolerances are shared. Of what differs by
chance from test to test nobody knows the course; it is as loud, and as far from rivals, as its scatter tells
(`loudness`).

A rival is a fault of another class in any form. Its distance is what the best non-negative mixture of drawn forms and
amounts of one cause leaves of the whitened signature: shapes, heat locations and sizes are free. Rivals may act under
some conditions only, too: to first order, by their signatures in those readings. They do so by as much in each reading
as a fault that is limited itself, or on one side of a speed, a load, an oil temperature or a test, or in one direction.
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

from .classes import merged
from .forms import step
from .plan import Plan

#: A fault, the columns in which it acts, and how much of it in each of them.
Acting = tuple[Any, slice, np.ndarray]

#: Readings without noise (channels, 2, columns) of tests with factors of the rig and acting faults.
Run = Callable[[Plan, Mapping[str, Any], Sequence[Acting]], np.ndarray]

#: Practically free: true speed [rpm], torque [N.m] and room [K] of a half; steps of them.
FREE = {"n": (300.0, 2.0), "load": (3000.0, 20.0), "room": (100.0, 1.0)}

#: Remainder of a rig that is not the model: sun torque [N.m], oil and wall [K].
REMAINDER_SD = {"T_sun_Nm": 0.25, "T_oil_C": 1.0, "T_oil2_C": 1.0, "T_wall_C": 1.0}

#: Change of an oil temperature at which a rig would be stopped [K].
OBVIOUS = 35.0

#: What differs by chance from test to test.
BY_CHANCE = frozenset(("procedure.day_scatter",))

#: Tests in one run of several variants.
BATCH = 4000

_STEP = 0.05


@dataclass(frozen=True)
class Setting:
    """A campaign for the yardstick.

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


def tiled(base: Mapping[str, Any], copies: int) -> dict[str, Any]:
    """Factors for several copies of the tests."""
    return {name: np.tile(f, copies) if np.ndim(f) else f for name, f in base.items()}


def loudness(cause: str, norm: Any, tests: int) -> Any:
    """Signal-to-noise from the norm of a whitened signature.

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


class Yardstick:
    """Signal-to-noise of faults in one campaign."""

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        plans = [p for p in (setting.plan, setting.reference) if p is not None]
        blocks = [self._block(plan) for plan in plans]
        self.quiet = blocks[0][0]
        shared, local = np.vstack([b[1] for b in blocks]), block_diag(*(b[2] for b in blocks))
        S = shared @ shared.T + local @ local.T
        sd = [np.repeat([setting.repeat_sd[c] for c in setting.channels], 2 * p.columns) for p in plans]
        S[np.diag_indices_from(S)] += np.concatenate(sd) ** 2
        own = solve_triangular(np.linalg.cholesky(S), np.eye(len(S), self.quiet.size), lower=True)
        self._white = qr(own, mode="r")[0][: self.quiet.size]

    def _block(self, plan: Plan) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Readings (channels, 2, tests); shared and local sensitivities (readings, columns), scaled by their sd."""
        s = self.setting
        names = [*s.prior, " ".join(s.days)]
        moves = [(name, rows) for name in ("n", "load") for rows in ((0,), (1,))] + [("room", (0, 1)), ("room", (2,))]
        m, copies = plan.columns, 1 + len(names) + len(moves)
        big, base = plan.tiled(copies), tiled(s.base, copies)
        here = [slice(i * m, (i + 1) * m) for i in range(copies)]
        for part, joined in zip(here[1:], names, strict=False):
            for name in joined.split():
                base[name] = base.get(name, 1.0) * np.ones(copies * m)
                base[name][part] *= 1.0 + _STEP
        for part, (name, rows) in zip(here[1 + len(names) :], moves, strict=True):
            for row in rows:
                getattr(big, name)[row, part] += FREE[name][1]
        y = s.run(big, base, ())
        y = y.reshape(*y.shape[:2], copies, m)
        change = np.moveaxis(y[:, :, 1:] - y[:, :, :1], 2, 0)
        shared = [change[i].ravel() / _STEP * sd for i, sd in enumerate(s.prior.values())]
        for i, c in enumerate(s.channels):
            zero = np.zeros_like(y[:, :, 0])
            zero[i] = s.offset_sd[c]
            shared.append(zero.ravel())
        shared += _remainder(plan, s.channels) if s.reference is not None else []
        local = [change[len(s.prior)] / _STEP * s.day_sd]
        local += [c / FREE[name][1] * FREE[name][0] for c, (name, _) in zip(change[len(names) :], moves, strict=True)]
        per_test = [(e[..., None] * np.eye(m)).reshape(-1, m) for e in local]
        return y[:, :, 0], np.array(shared).T, np.hstack(per_test)

    def signatures(self, faults: Sequence[Any], amounts: np.ndarray) -> np.ndarray:
        """What each fault changes with its amount (faults, channels, 2, tests); not finite where the rig runs away."""
        s, m, size = self.setting, self.setting.plan.columns, max(BATCH // self.setting.plan.columns, 1)
        found = np.empty((len(faults), *self.quiet.shape))
        physical = [i for i, fault in enumerate(faults) if set(fault.stages) != {"read"}]
        for i in set(range(len(faults))) - set(physical):  # what only misreads needs no other run
            shown = self.quiet.copy()
            faults[i].stages["read"](shown, s.plan, np.full(m, amounts[i]))
            found[i] = shown - self.quiet
        for some in (physical[k : k + size] for k in range(0, len(physical), size)):
            acting = [(faults[i], slice(k * m, (k + 1) * m), np.full(m, amounts[i])) for k, i in enumerate(some)]
            with np.errstate(all="ignore"):
                y = s.run(s.plan.tiled(len(some)), tiled(s.base, len(some)), acting)
            found[some] = np.moveaxis(y.reshape(*y.shape[:2], len(some), m) - self.quiet[:, :, None], 2, 0)
        return found

    def whitened(self, signatures: np.ndarray) -> np.ndarray:
        """Whitened signatures (readings, faults); zero for what is not finite."""
        flat = signatures.reshape(len(signatures), -1)
        return np.asarray(self._white @ np.where(np.isfinite(flat).all(axis=1)[:, None], flat, 0.0).T)

    def acting(self, regime: Mapping[str, Any], oil: np.ndarray) -> np.ndarray:
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
            "direction": np.array([[1.0], [2.0]]),
        }[what]
        sign = 1.0 if side == "above" else -1.0
        return np.broadcast_to(step(sign * seen, sign * at, regime["width"]), oil.shape)

    def survey(self, fault: Any, amounts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signal-to-noise for some amounts, and which of them change no oil temperature by more than `OBVIOUS`."""
        change = self.signatures([fault] * len(amounts), amounts)
        oil = change[:, self.setting.channels.index("T_oil_C")]
        with np.errstate(invalid="ignore"):
            sensible = (np.abs(oil) < OBVIOUS).all(axis=(1, 2))
        return self.loud(fault, np.linalg.norm(self.whitened(change), axis=0)), sensible

    def loud(self, fault: Any, norm: Any) -> Any:
        """Signal-to-noise of a fault from the norm of its whitened signature."""
        return loudness(fault.cause, norm, self.setting.plan.columns)


def _remainder(plan: Plan, channels: tuple[str, ...]) -> list[np.ndarray]:
    """Smooth terms of the conditions, per channel and direction, flat over readings."""
    x, y = (plan.n[0] - 175.0) / 75.0, (plan.load[0] - 2130.0) / 580.0
    terms = [np.ones_like(x), x, y, x * y, x * x, y * y, (plan.room[1] - 24.0) / 5.0]
    found = []
    for i, c in enumerate(channels):
        for half in (0, 1):
            for term in terms if c in REMAINDER_SD else ():
                one = np.zeros((len(channels), 2, plan.columns))
                one[i, half] = REMAINDER_SD[c] * term
                found.append(one.ravel())
    return found


@dataclass(frozen=True)
class Rival:
    """The nearest cause of another class, and how far it is [sigma]."""

    cause: str
    distance: float


#: Forms drawn of each cause, and amounts of each over the largest sensible.
FORMS, AMOUNTS = 8, (0.1, 0.5)

#: Causes that may act under some conditions only, as any of the simulators draws them.
PARTLY = frozenset(
    ("losses.churning", "losses.windage", "losses.mesh_friction", "losses.seal_drag", "losses.bearing_preload")
    + ("heat.external_source", "cooling.air", "cooling.foundation", "cooling.contact")
    + ("sensor.oil_temp.offset", "sensor.torque.offset")
)

#: Widths of the borders of what limits them, by quantity; thresholds at these quantiles of the tests.
WIDTHS = {"speed": (4.0, 12.0), "load": (40.0, 120.0), "oil": (1.3, 4.0), "order": (0.02,)}
QUANTILES = np.arange(0.1, 0.95, 0.1)


class _Mixture:
    """Non-negative mixtures of forms of one cause: whitened columns (readings, forms), each of length 1."""

    def __init__(self, columns: np.ndarray) -> None:
        length = np.linalg.norm(columns, axis=0)
        self.columns = columns[:, length > 1e-9] / length[length > 1e-9]
        self.gram = self.columns.T @ self.columns

    def beside(self, q: np.ndarray) -> Callable[[np.ndarray], tuple[float, Callable[[], float]]]:
        """What of a vector is left, beside what orthonormal columns q take up: a lower bound, and how to get it."""
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
        yard: of the campaign
        families: draw a form of each cause
        rng: source of forms
    """

    yard: Yardstick
    families: Mapping[str, Callable[[np.random.Generator], Any]]
    rng: np.random.Generator

    def _limits(self) -> list[np.ndarray]:
        """How much of a limited cause acts, by reading (2, tests): one side of each quantity, one direction."""
        yard = self.yard
        plan, oil = yard.setting.plan, yard.quiet[yard.setting.channels.index("T_oil_C")]
        seen = {"speed": plan.n, "load": plan.load, "oil": oil, "order": plan.progress}
        sides = [
            {"where": f"{what} {side}", "at": at, "width": width}
            for what, widths in WIDTHS.items()
            for side in ("above", "below")
            for at in np.quantile(seen[what], QUANTILES)
            for width in widths
        ]
        sides += [{"where": f"direction {side}", "at": 1.5, "width": 0.05} for side in ("above", "below")]
        return [yard.acting(side, oil) for side in sides]

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
        found, named, limits = self.yard.signatures(faults, np.array(amounts)), np.array(causes), self._limits()
        known = {}
        for cause in self.families:
            forms = found[named == cause]
            sides = [_Mixture(self.yard.whitened(forms * limit)) for limit in limits if cause in PARTLY]
            known[cause] = forms, sides
        return known

    def nearest(self, fault: Any, amount: float, beside: Iterable[tuple[Any, float]] = ()) -> tuple[float, Rival]:
        """Signal-to-noise of a fault, and its nearest rival.

        Args:
            fault, amount: what is judged
            beside: other faults that act as well, of unknown size
        """
        others = list(beside)
        faults, amounts = [fault, *(f for f, _ in others)], np.array([amount, *(a for _, a in others)])
        changes = self.yard.signatures(faults, amounts)
        white = self.yard.whitened(changes)
        q = np.linalg.qr(white[:, 1:])[0]
        t = white[:, 0] - q @ (q.T @ white[:, 0])
        own = {merged(f.cause) for f in faults}
        oil = (self.yard.quiet + changes.sum(axis=0))[self.yard.setting.channels.index("T_oil_C")]
        limits = [1.0, *(self.yard.acting(f.regime, oil) for f in faults if f.regime)]
        length = float(np.linalg.norm(t))
        nearest = Rival("nothing", length)
        bounds = []
        for cause, (forms, sides) in self._forms.items():
            if merged(cause) not in own:
                alike = _Mixture(np.hstack([self.yard.whitened(forms * limit) for limit in limits]))
                bounds += [(*side.beside(q)(t), cause) for side in (alike, *sides)]
        for least, distance, cause in sorted(bounds, key=lambda b: b[0]):
            if least >= nearest.distance:
                break
            nearest = min(nearest, Rival(cause, distance()), key=lambda r: r.distance)
        snr, distance = self.yard.loud(fault, np.array([length, nearest.distance])).tolist()
        return snr, Rival(nearest.cause, distance)
