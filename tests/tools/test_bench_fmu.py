"""The bench of the FMU: every figure is there, what does not depend on the machine meets its goal."""

import json

import numpy as np
import pytest
from gearheat.fmu.equations import equations
from gearheat.model.core.flatten import flatten
from gearheat.model.run.rows import evaluate_at
from gearheat.tools.bench import fmu as bench_fmu
from gearheat.tools.bench.costs import chain, growth, massless, massless_chain
from gearheat.tools.bench.harness import rows


def test_figures_of_the_fmu_and_its_peers() -> None:
    found = json.loads(json.dumps(bench_fmu.measure(pythonfmu=False, chains=(4,), conductors=(20,))))
    assert found["warmup_60_error_K"] < 1e-4
    assert found["warmup_1_error_K"] < found["warmup_10_error_K"] < found["warmup_60_error_K"]
    assert found["state_bytes"] <= 2048
    assert found["instance_bytes"] < 8192
    peers = found["peers"]
    fair = [bench_fmu.OF_FMU.format(method) for method in bench_fmu.METHODS]
    assert list(peers).index(fair[0]) < list(peers).index("SciPy LSODA, expressions from Python")
    for name in ("FMPy, model exchange, its CVode", "CasADi IDAS from Python", *fair):
        assert peers[name]["error_K"] <= found["warmup_60_error_K"], name
        assert peers[name]["over_fmu_from_c"] > 2, name
    assert len(found["goals"]) == 8
    table = dict(rows("fmu", found))
    assert all(text for text in table.values())
    assert len([name for name in table if name.startswith("goal")]) == 8


def test_a_larger_chain_costs_more() -> None:
    small, large = growth(4), growth(40)
    for key in ("flatten_s", "generate_s", "source_kB", "binary_kB", "rhs_s", "step_s"):
        assert large[key] > small[key] > 0, key
    assert large["compile_s"] > 0.05, "it was compiled anew"
    assert large["step_s"] < 40 * small["step_s"], "a step grows about as the number of nodes, not as its cube"


def test_a_chain_without_masses_is_right_and_grows_as_its_length() -> None:
    """n conductances of 10 W/K in series conduct 10 / n."""
    for n in (1, 20, 160):
        flat = flatten(massless_chain(n))
        u, p = flat.starts("input"), flat.starts("parameter")
        y = evaluate_at(flat, [400.0, 300.0], u, p)["y"]
        assert y == pytest.approx(np.full(n, 10.0 / n * 100.0), rel=1e-9)
    small, large = massless(100), massless(1000)
    assert large["instructions"] < 10.5 * small["instructions"]


def test_instructions_of_a_step_grow_as_the_number_of_nodes() -> None:
    small, large = (sum(f.n_instructions() for f in equations(flatten(chain(n))).functions) for n in (50, 500))
    assert large < 10.5 * small
