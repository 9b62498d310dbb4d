"""The bench of the FMU: every figure is there, what does not depend on the machine meets its goal."""

import json

from gearheat.tools import bench_fmu
from gearheat.tools.bench_costs import growth


def test_figures_of_the_fmu_and_its_peers() -> None:
    found = json.loads(json.dumps(bench_fmu.measure(pythonfmu=False, chains=(4,))))
    assert found["warmup_60_error_K"] < 1e-4
    assert found["warmup_1_error_K"] < found["warmup_10_error_K"] < found["warmup_60_error_K"]
    assert found["state_bytes"] <= 2048
    assert found["instance_bytes"] < 8192
    peers = found["peers"]
    for name in ("FMPy, model exchange, its CVode", "CasADi IDAS from Python", "SciPy LSODA", "SciPy BDF"):
        assert peers[name]["error_K"] <= found["warmup_60_error_K"], name
        assert peers[name]["over_fmu_from_c"] > 2, name
    assert len(found["goals"]) == 7
    table = dict(bench_fmu.rows(found))
    assert all(text for text in table.values())
    assert len([name for name in table if name.startswith("goal")]) == 7


def test_a_larger_chain_costs_more() -> None:
    small, large = growth(4), growth(40)
    for key in ("flatten_s", "generate_s", "source_kB", "binary_kB", "rhs_s", "step_s"):
        assert large[key] > small[key] > 0, key
    assert large["compile_s"] > 0.05, "it was compiled anew"
    assert large["step_s"] < 40 * small["step_s"], "a step grows about as the number of nodes, not as its cube"
