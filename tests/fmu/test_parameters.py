"""Every parameter of the FMU acts, what does not act is not in it, and the same rig gives the same file."""

import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_in_c import planetary
from gearheat.fmu.compiling import cache_folder
from gearheat.fmu.export import export
from gearheat.fmu.play import Player
from gearheat.model.run.rows import evaluate_at

#: Values under which laws act that the rig's own values switch off, and the parameters that act only then.
SWITCHES = {
    "churning.c": (40.0, {"churning.a", "churning.b", "churning.count", "churning.k_loss"}),
    "carrier_bearing.K_rs": (3e-8, {"carrier_bearing.d", "carrier_bearing.D", "carrier_bearing.K_Z"}),
    "sun_bearing.K_rs": (3e-8, {"sun_bearing.d", "sun_bearing.D", "sun_bearing.K_Z"}),
}

#: Half an hour at speed, backwards, and so slow that the power is below the width of the efficiency's blend.
DUTY = {
    "carrier.w": (np.array([0, 600, 600, 1200, 1200, 1800.0]), np.array([26, 30, -10, -20, 4e-7, 4e-7])),
    "carrier.tau": (np.array([0, 1800.0]), np.array([2500.0, 1000.0])),
}


#: A parameter that bounds the range of a law acts where it puts the run out of range: it moves the count of such laws.
BOUNDS = {"oil.T_pour": 400.0}
#: Of an output's largest value; a parameter that does not act leaves every bit as it is.
ACTS = 1e-9


@pytest.fixture(scope="module")
def player(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Player]:
    flat, start = planetary()
    with Player(export(flat, tmp_path_factory.mktemp("parameters") / "m.fmu", start=start)) as opened:
        yield opened


@pytest.fixture(scope="module")
def exported(player: Player) -> dict[str, float]:
    """Parameters of the FMU with their start values."""
    described = fmpy.read_model_description(str(player._path))
    kept = [v for v in described.modelVariables if v.causality == "parameter" and v.type != "Enumeration"]
    return {v.name: float(v.start) for v in kept}


def moved(player: Player, name: str, value: float, others: dict[str, float]) -> float:
    """How far any output moves when a parameter has another value, relative to the output's largest value."""
    usual = player.run(DUTY, 1800, 60, start=others)
    changed = player.run(DUTY, 1800, 60, start=others | {name: value})
    assert usual.names == changed.names
    scale = np.abs(usual.values).max(axis=0)
    difference = np.abs(changed.values - usual.values).max(axis=0)
    return float((difference / np.where(scale > 0, scale, 1.0)).max())


def other(name: str, start: float) -> float:
    """Another value of a parameter, near by, that fits the rest: whole numbers stay whole."""
    flat, _ = planetary()
    for value in (1.02 * start, 1.002 * start, start + 1.0, start + 3.0):
        p = flat.starts("parameter")
        p[flat.locate(name)[1]] = value
        if not flat.contradictions(p):
            return value
    raise AssertionError(name)


def test_every_parameter_moves_an_output(player: Player, exported: dict[str, float]) -> None:
    assert len(exported) > 90
    sleeping = {name for _, names in SWITCHES.values() for name in names}
    still = set()
    for name, start in exported.items():
        value = BOUNDS.get(name, other(name, start) if start else SWITCHES.get(name, (1e-3, set()))[0])
        if moved(player, name, value, {}) < ACTS:
            still.add(name)
    assert still == sleeping


@pytest.mark.parametrize("switch", SWITCHES)
def test_a_sleeping_parameter_acts_when_its_law_does(player: Player, exported: dict[str, float], switch: str) -> None:
    on, names = SWITCHES[switch]
    assert exported[switch] == 0.0
    for name in names:
        assert moved(player, name, other(name, exported[name]), {switch: on}) > ACTS, name


def test_what_is_not_exported_acts_nowhere(exported: dict[str, float]) -> None:
    flat, _ = planetary()
    left_out = [i for i, q in enumerate(flat.parameters) if q.name not in exported]
    assert set(exported) <= {q.name for q in flat.parameters}
    rng = np.random.default_rng(3)
    x = flat.starts("state") + rng.uniform(0, 60, len(flat.states))
    for w in (-20.0, 4e-7, 26.0):
        u = flat.starts("input")
        u[flat.locate("carrier.w")[1]] = w
        p = flat.starts("parameter")
        usual = evaluate_at(flat, x, u, p).values()
        for i in left_out:
            p[i] = 1.3 * p[i] + 0.1
        changed = evaluate_at(flat, x, u, p).values()
        for a, b in zip(usual, changed, strict=True):
            assert a == pytest.approx(b, rel=1e-12, abs=1e-9)  # a share of two equal bodies is round-off


def test_the_same_rig_gives_the_same_file_in_every_process(tmp_path: Path) -> None:
    """In two processes that order sets and dictionaries of names differently."""
    tests = Path(__file__).parents[1]
    script = f"""
import sys; sys.path.insert(0, {str(tests)!r})
from fmu_in_c import planetary
from fmpy.validation import validate_fmu
from gearheat.fmu.compiling import cache_folder
from gearheat.fmu.export import export
flat, start = planetary()
export(flat, sys.argv[1], start=dict(start))
"""
    digests = []
    for seed in ("1", "2"):
        path = tmp_path / f"{seed}.fmu"
        environment = {**os.environ, "PYTHONHASHSEED": seed, "TZ": f"UTC{seed}", "XDG_CACHE_HOME": str(tmp_path / seed)}
        for kind in ("global", "local"):  # the libraries of the compiler itself need not be built twice
            environment.setdefault(f"ZIG_{kind.upper()}_CACHE_DIR", str(cache_folder() / "zig" / kind))
        subprocess.run([sys.executable, "-c", script, str(path)], check=True, env=environment)
        digests.append(hashlib.sha256(path.read_bytes()).hexdigest())
    assert digests[0] == digests[1]


def test_fmpy_finds_no_problem(player: Player) -> None:
    assert validate_fmu(str(player._path)) == []
