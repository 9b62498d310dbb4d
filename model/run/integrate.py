"""Integration of a flat model over one stretch without jumps, by IDAS through CasADi or by SciPy's LSODA."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from ..core.flat import FlatModel
from ..errors import SolveError
from .algebra import algebra
from .fast import Fast, once

#: Steps between two output times before IDAS gives up.
MOST_STEPS = 100_000

#: First step of IDAS over its tolerance [s].
FIRST_STEP = 1e-3

#: Steps in search of the moment where an integration fails.
MOST_TRIAL_STEPS = 20_000
#: Size of a state, in nominals, that is beyond all reason.
BLOWN_UP = 1e9


class Failure(Exception):
    """An integration that cannot go on: time reached [s], states there and their derivatives.

    `passable` where only the method failed: small steps get through. `block` says which implicit block has no solution
    behind that time, where that is the reason.
    """

    def __init__(self, time: float, x: np.ndarray, rate: np.ndarray, passable: bool, block: str = "") -> None:
        super().__init__(f"stopped at {time} s")
        self.time, self.x, self.rate, self.passable, self.block = time, x, rate, passable, block


@dataclass(frozen=True)
class Stretch:
    """Inputs over a time without jumps: linear between the points.

    Args:
        time: n times [s], increasing
        table: a row per input, a column per time
    """

    time: np.ndarray
    table: np.ndarray

    @property
    def begin(self) -> float:
        """First time [s]."""
        return float(self.time[0])

    @property
    def end(self) -> float:
        """Last time [s]."""
        return float(self.time[-1])

    def inputs(self, times: np.ndarray) -> np.ndarray:
        """Inputs at some times, a column each."""
        rows = [np.interp(times, self.time, row) for row in self.table]
        return np.array(rows).reshape(len(self.table), len(times))

    def lines(self, times: np.ndarray) -> np.ndarray:
        """Per piece that begins at one of the times: inputs there, their slopes, and when it begins after `begin`."""
        piece = np.clip(np.searchsorted(self.time, times, side="right") - 1, 0, len(self.time) - 2)
        value = self.table[:, piece]
        slope = (self.table[:, piece + 1] - value) / (self.time[piece + 1] - self.time[piece])
        return np.vstack([value, slope, self.time[piece] - self.begin])


class Transient:
    """The right-hand side of a run, scaled: states count in nominals from where the run started.

    The local error of every state is then held to tolerance times (nominal + distance from the start). Supply and
    throughput are integrated beside the states, for the audit, to the same tolerance of their own size.
    """

    def __init__(self, flat: FlatModel, x: np.ndarray, p: np.ndarray, tolerance: float) -> None:
        self.flat, self.origin, self.p, self.tolerance = flat, x, p, tolerance
        self.nominal = np.array([q.nominal for q in flat.states])
        self.z_nominal = np.array([q.nominal for q in flat.algebraic])
        self.algebra = algebra(flat)
        n, nz = len(flat.inputs), len(flat.algebraic)
        sizes = {"s": max(len(x), 1), "z": nz, "line": 2 * n + 1, "t": 1}
        s, z, line, time = (ca.SX.sym(name, size) for name, size in sizes.items())
        states = ca.DM(self.origin) + ca.DM(self.nominal) * s if len(x) else ca.SX(0, 1)
        inputs = line[:n] + line[n : 2 * n] * (time - line[2 * n])
        rate, residual, *power = _rates(flat)(states, ca.DM(self.z_nominal) * z, inputs, ca.SX(ca.DM(p)))
        rate = rate / ca.DM(self.nominal) if len(x) else ca.SX(1, 1)
        self._dae = {"x": s, "z": z, "u": line, "t": time, "ode": ca.densify(rate), "alg": ca.densify(residual)}
        self._dae["quad"] = ca.densify(ca.vertcat(*power))
        self._made: dict[bytes, Any] = {}

    def idas(self, stretch: Stretch, grid: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """States at the times of a grid (first and last are the stretch's ends), algebraic variables, and integrals.

        Args:
            stretch: time without a jump, and its inputs
            grid: times (n) [s]
            x: states at the first of them, SI

        Returns:
            states and algebraic variables, a column per time; supply and throughput [J]

        Raises:
            Failure: IDAS gave up
            SolveError: an implicit block has no solution at the begin
        """
        run = self._integrator(grid[1:] - stretch.begin)
        z = self.algebra.solve(x, stretch.inputs(grid[:1])[:, 0], self.p)
        try:
            done = run(x0=self._scaled(x), z0=z / self.z_nominal, u=stretch.lines(grid[:-1]))
        except RuntimeError:
            raise self._failure(stretch, x) from None
        path = self._states(np.column_stack([self._scaled(x), np.array(done["xf"])]))
        algebraic = np.column_stack([z, self.z_nominal[:, None] * np.array(done["zf"]).reshape(len(z), len(grid) - 1)])
        if not (np.isfinite(path).all() and np.isfinite(algebraic).all()):
            raise self._failure(stretch, x)
        return path, algebraic, np.array(done["qf"])[:, -1]

    def lsoda(self, stretch: Stretch, grid: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The same by SciPy's LSODA, restarted at every kink of the inputs, the implicit blocks solved at every call.

        Args:
            stretch: time without a jump, and its inputs
            grid: times (n) [s]
            x: states at the first of them, SI

        Raises:
            Failure: LSODA gave up
            SolveError: an implicit block has no solution at the begin
        """
        from scipy.integrate import solve_ivp

        state = np.concatenate([self._scaled(x), [0.0, 0.0]])
        path = [state]
        for begin, end in pairwise(stretch.time):
            inside = grid[(grid > begin) & (grid <= end)]
            rates = self._rates(stretch, begin)
            times = np.union1d(inside, [end])
            try:
                done = solve_ivp(rates, (begin, end), state, "LSODA", times, rtol=self.tolerance, atol=self.tolerance)
            except SolveError:
                raise self._failure(stretch, x) from None
            if not done.success or not np.isfinite(done.y).all():
                raise self._failure(stretch, x)
            path += list(done.y.T[: len(inside)])
            state = done.y[:, -1]
        states = self._states(np.array(path).T[:-2])
        u, p = stretch.inputs(grid), np.tile(self.p[:, None], (1, len(grid)))
        return states, self.algebra.solve_rows(states, u, p), state[-2:]

    def _integrator(self, times: np.ndarray) -> Any:
        """IDAS with outputs at given times after the begin of a stretch; one per grid of times."""
        key = times.tobytes()
        if key not in self._made:
            options = {
                "reltol": self.tolerance,
                "abstol": self.tolerance,
                "max_num_steps": MOST_STEPS,
                "quad_err_con": True,
                "calc_ic": False,  # the begin is consistent but for its slopes, hence a tiny first step
                "step0": FIRST_STEP * self.tolerance,
                "linear_solver": "csparse",  # pivots; the default squares entries and loses those that underflow
                "disable_internal_warnings": True,
                "show_eval_warnings": False,
            }
            self._made[key] = ca.integrator("transient", "idas", self._dae, 0.0, list(times), options)
        return self._made[key]

    def _scaled(self, x: np.ndarray) -> np.ndarray:
        return (x - self.origin) / self.nominal if len(x) else np.zeros(1)

    def _states(self, z: np.ndarray) -> np.ndarray:
        n = len(self.origin)
        states: np.ndarray = self.origin[:, None] + self.nominal[:, None] * z[:n]
        return states

    @cached_property
    def _scaled_rates(self) -> Fast:
        """(scaled states, scaled algebraic variables, line, time) -> derivatives with those of the integrals."""
        d = self._dae
        return Fast("rates", [d["x"], d["z"], d["u"], d["t"]], [ca.vertcat(d["ode"], d["quad"])])

    def _rates(self, stretch: Stretch, begin: float) -> Any:
        """(time [s], scaled states with integrals) -> derivatives, for SciPy, on the piece that starts at `begin`."""
        line = stretch.lines(np.array([begin]))[:, 0]
        m, n = len(stretch.table), self._dae["x"].numel()
        warm: np.ndarray | None = None

        def rates(now: float, state: np.ndarray) -> np.ndarray:
            nonlocal warm
            u = line[:m] + line[m : 2 * m] * (now - stretch.begin - line[2 * m])
            warm = self.algebra.solve(self._states(state[:n, None])[:, 0], u, self.p, warm)
            return self._scaled_rates(state[:n], warm / self.z_nominal, line, np.array([now - stretch.begin]))[0]

        return rates

    def _failure(self, stretch: Stretch, x: np.ndarray) -> Failure:
        """How far a stretch can be followed, step by step."""
        from scipy.integrate import LSODA

        state, now, passable, block = np.concatenate([self._scaled(x), [0.0, 0.0]]), stretch.begin, True, ""
        rates = self._rates(stretch, now)
        try:
            for begin, end in pairwise(stretch.time):
                rates = self._rates(stretch, begin)
                solver = LSODA(rates, begin, state, end, rtol=self.tolerance, atol=self.tolerance)
                steps = 0
                while solver.status == "running" and steps < MOST_TRIAL_STEPS:
                    solver.step()
                    steps += 1
                    if not np.isfinite(solver.y).all() or np.abs(solver.y[:-2]).max() > BLOWN_UP:
                        break
                    state, now = solver.y.copy(), float(solver.t)
                passable = solver.status == "finished"
                if not passable:
                    break
        except SolveError as error:
            passable, block = False, str(error)
        last, rate = self._states(state[:-2, None])[:, 0], rates(now, state)[:-2][: len(x)] * self.nominal
        return Failure(now, last, rate, passable, block)


@once
def _rates(flat: FlatModel) -> Any:
    """CasADi function (x, z, u, p) -> derivatives, algebraic residuals, supply and throughput."""
    results = [flat.ode, flat.residual, flat.supply, flat.throughput]
    return ca.Function("powers", flat.point, results, {"cse": True})
