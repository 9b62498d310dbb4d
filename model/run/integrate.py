"""Integration of a flat model over one stretch without jumps, by CVODES through CasADi or by SciPy's LSODA."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from ..core.flat import FlatModel
from .fast import Fast

#: Steps between two output times before CVODES gives up.
MOST_STEPS = 100_000

#: Steps in search of the moment where an integration fails, and the size of a scaled state that is beyond all reason.
MOST_TRIAL_STEPS, BLOWN_UP = 20_000, 1e9


class Failure(Exception):
    """An integration that cannot go on: time reached [s], states there and their derivatives.

    `passable` where only the method failed: small steps get through.
    """

    def __init__(self, time: float, x: np.ndarray, rate: np.ndarray, passable: bool) -> None:
        super().__init__(f"stopped at {time} s")
        self.time, self.x, self.rate, self.passable = time, x, rate, passable


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
        n = len(flat.inputs)
        z, line, time = ca.SX.sym("z", max(len(x), 1)), ca.SX.sym("line", 2 * n + 1), ca.SX.sym("time")
        states = ca.DM(self.origin) + ca.DM(self.nominal) * z if len(x) else ca.SX(0, 1)
        inputs = line[:n] + line[n : 2 * n] * (time - line[2 * n])
        rate, *power = _rates(flat)(states, inputs, ca.SX(ca.DM(p)))
        rate = rate / ca.DM(self.nominal) if len(x) else ca.SX(1, 1)
        self._dae = {"x": z, "u": line, "t": time, "ode": ca.densify(rate), "quad": ca.densify(ca.vertcat(*power))}
        self._made: dict[bytes, Any] = {}

    def cvodes(self, stretch: Stretch, grid: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States at the times of a grid (first and last are the stretch's ends), and supply and throughput [J].

        Raises:
            Failure: CVODES gave up
        """
        run = self._integrator(grid[1:] - stretch.begin)
        try:
            done = run(x0=self._scaled(x), u=stretch.lines(grid[:-1]))
        except RuntimeError:
            raise self._failure(stretch, x) from None
        path = self._states(np.column_stack([self._scaled(x), np.array(done["xf"])]))
        if not np.isfinite(path).all():
            raise self._failure(stretch, x)
        return path, np.array(done["qf"])[:, -1]

    def lsoda(self, stretch: Stretch, grid: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same by SciPy's LSODA, restarted at every kink of the inputs.

        Raises:
            Failure: LSODA gave up
        """
        from scipy.integrate import solve_ivp

        state = np.concatenate([self._scaled(x), [0.0, 0.0]])
        path = [state]
        for begin, end in pairwise(stretch.time):
            inside = grid[(grid > begin) & (grid <= end)]
            rates = self._rates(stretch, begin)
            times = np.union1d(inside, [end])
            done = solve_ivp(rates, (begin, end), state, "LSODA", times, rtol=self.tolerance, atol=self.tolerance)
            if not done.success or not np.isfinite(done.y).all():
                raise self._failure(stretch, x)
            path += list(done.y.T[: len(inside)])
            state = done.y[:, -1]
        return self._states(np.array(path).T[:-2]), state[-2:]

    def _integrator(self, times: np.ndarray) -> Any:
        """CVODES with outputs at given times after the begin of a stretch; one per grid of times."""
        key = times.tobytes()
        if key not in self._made:
            options = {
                "reltol": self.tolerance,
                "abstol": self.tolerance,
                "max_num_steps": MOST_STEPS,
                "quad_err_con": True,
                "linear_solver": "csparse",  # pivots; the default squares entries and loses those that underflow
                "disable_internal_warnings": True,
                "show_eval_warnings": False,
            }
            self._made[key] = ca.integrator("transient", "cvodes", self._dae, 0.0, list(times), options)
        return self._made[key]

    def _scaled(self, x: np.ndarray) -> np.ndarray:
        return (x - self.origin) / self.nominal if len(x) else np.zeros(1)

    def _states(self, z: np.ndarray) -> np.ndarray:
        n = len(self.origin)
        states: np.ndarray = self.origin[:, None] + self.nominal[:, None] * z[:n]
        return states

    def _rates(self, stretch: Stretch, begin: float) -> Any:
        """(time [s], scaled states with integrals) -> derivatives, for SciPy, on the piece that starts at `begin`."""
        d = self._dae
        function = Fast("rates", [d["x"], d["u"], d["t"]], [ca.vertcat(d["ode"], d["quad"])])
        line = stretch.lines(np.array([begin]))[:, 0]
        n = d["x"].numel()

        def rates(now: float, state: np.ndarray) -> np.ndarray:
            return function(state[:n], line, np.array([now - stretch.begin]))[0]

        return rates

    def _failure(self, stretch: Stretch, x: np.ndarray) -> Failure:
        """How far a stretch can be followed, step by step."""
        from scipy.integrate import LSODA

        state, now, passable = np.concatenate([self._scaled(x), [0.0, 0.0]]), stretch.begin, True
        rates = self._rates(stretch, now)
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
        last, rate = self._states(state[:-2, None])[:, 0], rates(now, state)[:-2][: len(x)] * self.nominal
        return Failure(now, last, rate, passable)


def _rates(flat: FlatModel) -> Any:
    """CasADi function (x, u, p) -> derivatives, supply and throughput."""
    if "powers" not in flat.prepared:
        results = [flat.ode, flat.supply, flat.throughput]
        flat.prepared["powers"] = ca.Function("powers", [flat.x, flat.u, flat.p], results, {"cse": True})
    return flat.prepared["powers"]
