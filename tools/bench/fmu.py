"""The FMU against its peers on the same equations: what calls cost, a warm-up of 330 min, growth with the model's size.

All ratios are of one run. A right-hand side is the rates at a new point, its implicit equations solved from the last
solution, by the functions in the source of the FMU; it is the unit in which costs are given. All times are processor
times, so other work on the machine does not count.
"""

from __future__ import annotations

import io
import json
import tempfile
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from fmpy import extract
from scipy.integrate import solve_ivp

from ...fmu.export import export
from ...fmu.play import Player
from ...model.core.flat import FlatModel
from ...model.errors import DataError
from ...model.run.algebra import algebra
from ...model.run.fast import Fast
from ...model.run.schedule import Schedule, join_phases
from ...model.run.simulate import simulate
from ...scenarios.load import load
from ..show.console import note
from ..solve.settings import flat_of
from .costs import STAGE, STAGES, from_c, growth, massless
from .exchange import Exchange, exchanged
from .harness import TABLES, environment, run, script, timed

#: Thermal nodes of the chains by which growth is measured.
CHAINS = (4, 20, 100, 400, 1000)
#: Conductors of the chains without masses between them.
MASSLESS = (20, 80, 160, 1000)
#: Tolerances at which a peer is tried: the first that is as accurate as the FMU counts.
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
#: Communication step of the peers that have one [s].
STEP = 60.0
#: Solvers of SciPy, and the peer that is one on functions of the FMU itself.
METHODS = ("LSODA", "BDF")
OF_FMU = "SciPy {}, functions of this FMU"
PYTHONFMU = "PythonFMU, explicit Euler of 0.5 s, in FMPy"


class Peer(NamedTuple):
    """A run by other means: processor time [s], largest error of a state, and the tolerance it was given."""

    s: float
    error_K: float
    tolerance: float | None


def measure(
    rig: str = "planetary",
    *,
    pythonfmu: bool = True,
    chains: tuple[int, ...] = CHAINS,
    conductors: tuple[int, ...] = MASSLESS,
) -> dict[str, Any]:
    """All figures of the bench of the FMU; `goals` lists each goal with its figure and whether it is met."""
    scenario = load(rig)
    flat = flat_of(scenario)
    speed = next(q.name for q in flat.inputs if q.name.endswith(".w"))
    duty = join_phases([(STAGE, {speed: share * flat.quantity(speed).start}) for share in STAGES])
    ends = [STAGE * (k + 1) for k in range(len(STAGES))]
    reference = simulate(flat, duty, times=ends, tolerance=1e-12)
    truth = np.stack([reference[q.name] for q in flat.states], axis=1)
    with tempfile.TemporaryDirectory() as folder:
        fmu = export(flat, Path(folder) / "rig.fmu")
        found = from_c(fmu, Path(folder), speed, truth, flat)
        found["fmu_kB"] = fmu.stat().st_size / 1000
        bare = export(flat, Path(folder) / "bare.fmu", audit=False)
        peers = _peers(flat, duty, ends, truth, (fmu, bare), speed, found["warmup_60_error_K"])
        if pythonfmu:
            try:
                peers[PYTHONFMU] = Peer(*_pythonfmu(flat, duty, ends, truth, Path(folder)), None)
            except DataError as problem:  # it crashes now and then; what else was measured stays
                note(f"left out: {problem}")
    base = found["warmup_60_s"]
    found["peers"] = {name: {**peer._asdict(), "over_fmu_from_c": peer.s / base} for name, peer in peers.items()}
    for method in METHODS:
        found[f"{method.lower()}_ratio"] = found["peers"][OF_FMU.format(method)]["over_fmu_from_c"]
    if PYTHONFMU in peers:
        found["pythonfmu_ratio"] = found["peers"][PYTHONFMU]["over_fmu_from_c"]
    found["growth"] = [growth(n) for n in chains]
    found["massless"] = [massless(n) for n in conductors]
    found["goals"] = [
        {"goal": goal, "bound": f"{sign} {bound:g}", "measured": found[key], "met": _meets(found[key], sign, bound)}
        for goal, (key, sign, bound) in TABLES["goals"].items()
        if key in found
    ]
    return found


def _meets(value: float, sign: str, bound: float) -> bool:
    return value <= bound if sign == "<=" else value >= bound


Run = Callable[[float], np.ndarray]
Rates = Callable[[float, np.ndarray], np.ndarray]


def _clock(work: Callable[[], np.ndarray], truth: np.ndarray) -> tuple[float, float]:
    """Least processor time of five runs, and their largest error."""
    runs = [timed(work) for _ in range(5)]
    return min(seconds for seconds, _ in runs), float(np.abs(runs[-1][1] - truth).max())


def _as_accurate(run: Run, truth: np.ndarray, error: float) -> Peer:
    """The run at the loosest tolerance whose error is no larger; the tightest when none is as accurate."""
    for tolerance in TOLERANCES:
        found = float(np.abs(run(tolerance) - truth).max())  # and what is compiled once is compiled
        if found <= error:
            break
    return Peer(*_clock(lambda: run(tolerance), truth), tolerance)


def _peers(
    flat: FlatModel,
    duty: Schedule,
    ends: list[float],
    truth: np.ndarray,
    fmus: tuple[Path, Path],
    speed: str,
    error: float,
) -> dict[str, Peer]:
    """The same warm-up by other means, at tolerances where their error is no larger than that of the FMU.

    Of the two FMUs the second one is without states of the audit, for solvers that would have to integrate them.
    """
    fmu, bare = fmus
    place = fmu.with_suffix("")
    extract(str(fmu), str(place))
    inputs = {name: (duty.time, values) for name, values in duty.values.items()}
    names = [q.name for q in flat.states]

    def idas(tolerance: float) -> np.ndarray:
        found = simulate(flat, duty, times=ends, tolerance=tolerance)
        return np.stack([found[q.name] for q in flat.states], axis=1)

    def played() -> np.ndarray:
        return np.asarray(player.run(inputs, ends[-1], STEP, record=names, output_times=ends).values)

    def fmpy(kind: str, what: Path = place) -> Run:
        return lambda tolerance: _fmpy(what, duty, ends, speed, names, kind, tolerance)

    with Player(fmu) as player:
        peers = {"this project's Player, this FMU, 60 s": Peer(*_clock(played, truth), 1e-5)}
    for name, what in (("FMPy, this FMU, 60 s", place), ("FMPy, this FMU, 60 s, unpacked at every run", fmu)):
        peers[name] = Peer(*_clock(lambda what=what: fmpy("CoSimulation", what)(1e-5), truth), 1e-5)  # type: ignore[misc]
    peers["FMPy, model exchange, its CVode"] = _as_accurate(fmpy("ModelExchange"), truth, error)
    peers["CasADi IDAS from Python"] = _as_accurate(idas, truth, error)
    with exchanged(bare, bare.with_suffix("")) as model:
        for method in METHODS:
            peers[OF_FMU.format(method)] = _as_accurate(_exchange(flat, model, ends, speed, method), truth, error)
    for method in METHODS:
        peers[f"SciPy {method}, expressions from Python"] = _as_accurate(
            _scipy(flat, ends, speed, method), truth, error
        )
    return peers


def _exchange(flat: FlatModel, model: Exchange, ends: list[float], speed: str, method: str) -> Run:
    """The warm-up by a solver of SciPy on the functions of an FMU."""
    whole = flat.quantity(speed).start

    def at(share: float) -> tuple[Rates, Rates]:
        model.give({speed: share * whole})
        return model.rates, model.slopes

    return _solved(flat, ends, method, at)


def _scipy(flat: FlatModel, ends: list[float], speed: str, method: str) -> Run:
    """The warm-up by a solver of SciPy on compiled expressions, with the exact Jacobian."""
    p, place = flat.starts("parameter"), flat.locate(speed)[1]
    ode, symbols = _explicit(flat)
    value = ode(*symbols)
    rates, slopes = Fast("rates", symbols, [value]), Fast("slopes", symbols, [ca.jacobian(value, symbols[0])])

    def at(share: float) -> tuple[Rates, Rates]:
        u = flat.starts("input")
        u[place] *= share
        return lambda _, z: rates(z, u, p)[0], lambda _, z: slopes(z, u, p)[0]

    return _solved(flat, ends, method, at)


def _solved(flat: FlatModel, ends: list[float], method: str, at: Callable[[float], tuple[Rates, Rates]]) -> Run:
    """The warm-up by a solver of SciPy, from rates and their Jacobian at a share of the speed."""
    nominal = np.array([q.nominal for q in flat.states])

    def run(tolerance: float) -> np.ndarray:
        x, t, rows = flat.starts("state"), 0.0, []
        for end, share in zip(ends, STAGES, strict=True):
            rates, slopes = at(share)
            solved = solve_ivp(rates, (t, end), x, method=method, jac=slopes, rtol=1e-12, atol=tolerance * nominal)
            x, t = solved.y[:, -1], end
            rows.append(x)
        return np.stack(rows)

    return run


def _explicit(flat: FlatModel) -> tuple[Any, list[Any]]:
    """The rates as a function of x, u, p, and symbols for these; CasADi's Newton solves the implicit equations."""
    x, u, p = symbols = [ca.MX.sym(name, v.shape[0]) for name, v in zip("xup", (flat.x, flat.u, flat.p), strict=True)]
    given = ca.vertcat(flat.x, flat.u, flat.p)
    z = ca.DM(flat.starts("algebraic"))
    if flat.algebraic:
        root = ca.rootfinder("z", "fast_newton", {"x": flat.z, "p": given, "g": flat.residual})
        start = algebra(flat).solve(*map(flat.starts, ("state", "input", "parameter")))
        z = root(x0=start, p=ca.vertcat(*symbols))["x"]
    return ca.Function("ode", symbols, [flat.function(x, z, u, p)[0]]), symbols


def _fmpy(
    fmu: Path, duty: Schedule, ends: list[float], speed: str, names: list[str], kind: str, tolerance: float
) -> np.ndarray:
    """The warm-up by FMPy's own loop."""
    from fmpy import simulate_fmu

    signal = np.array(list(zip(duty.time, duty.values[speed], strict=True)), dtype=[("time", "d"), (speed, "d")])
    options = {"stop_time": ends[-1], "output_interval": STEP, "relative_tolerance": tolerance}
    with redirect_stdout(io.StringIO()):  # it warns of every input that keeps its start value
        found = simulate_fmu(str(fmu), fmi_type=kind, input=signal, output=names, **options)
    rows = [np.flatnonzero(np.isclose(found["time"], end))[0] for end in ends]
    return np.stack([[found[name][row] for name in names] for row in rows])


def _pythonfmu(
    flat: FlatModel, duty: Schedule, ends: list[float], truth: np.ndarray, folder: Path
) -> tuple[float, float]:
    """The same warm-up by PythonFMU in FMPy, both in an environment of their own."""
    place, n = flat.locate(next(iter(duty.values)))[1], len(flat.states)
    u, speed = flat.starts("input"), float(flat.starts("input")[place])
    _explicit(flat)[0].save(str(folder / "ode.casadi"))
    start = {"x": flat.starts("state").tolist(), "u": u.tolist(), "p": flat.starts("parameter").tolist()}
    script(folder, "peer", ode=repr(str(folder / "ode.casadi")), place=place, speed=speed, **start)
    play = script(folder, "play", steps=round(STAGE / STEP), step=STEP)
    python = str(environment(folder, "PythonFMU", [("pythonfmu", "fmpy", "casadi")]))
    run([python, "-m", "pythonfmu", "build", "-f", "peer.py"], folder, "PythonFMU does not build")
    command = [python, str(play), "Peer.fmu", json.dumps(STAGES), str(speed), str(n)]
    seconds, rows = json.loads(run(command, folder, "PythonFMU does not run"))
    return float(seconds), float(np.abs(np.array(rows) - truth).max())
