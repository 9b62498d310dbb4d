"""Random calls with random arguments, in a build that stops at undefined behaviour or at a wrong address.

`GEARHEAT_FUZZ=100000 python -m pytest -s tests/fmu/test_fuzz.py` runs as many sequences of each model in each build,
the planetary rig included, for FMI 2.0 and 3.0, and tells what they did.
"""

import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from fmu_in_c import fuzzer, library, planetary, sanitizer, told, unpacked, unpacked_3
from gearheat.tools.bench.c_importer import Compiler

ADDRESS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g", "-O1")

#: Sequences of each model.
MANY = int(os.environ.get("GEARHEAT_FUZZ", "0"))
COUNTS = {"rc": MANY, "heat": MANY, "planetary": MANY} if MANY else {"rc": 1000, "heat": 1000}
COUNTS |= {f"{name}, FMI 3.0": count // (1 if MANY else 4) for name, count in COUNTS.items()}

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the sanitizers are used on Linux")


def undefined(facts: Path, first: int, count: int) -> str:
    """Sequences of calls in ziglang's debug build, which stops at undefined behaviour."""
    return told(fuzzer(), facts, first, count, library(facts, Compiler.zig(), "-O0", "-g"))


def address(facts: Path, first: int, count: int, compiler: Compiler) -> str:
    """Sequences of calls in gcc's build with the address and leak sanitizers."""
    return told(fuzzer(compiler, *ADDRESS), facts, first, count, library(facts, compiler, *ADDRESS))


@pytest.fixture(scope="module")
def facts(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("fuzz")
    made = {"rc": (models.rc, None), "heat": (models.heat, None)} | ({"planetary": planetary()} if MANY else {})
    found = {name: unpacked(flat, folder / name, start) for name, (flat, start) in made.items()}
    return found | {f"{name}, FMI 3.0": unpacked_3(found[name], *those) for name, those in made.items()}


def in_parts(name: str, work: Callable[[int, int], str], first: int, count: int, size: int = 2000) -> np.ndarray:
    """Runs of at most `size` sequences; how many calls of co-simulation, of model exchange and steps were done."""
    total = np.zeros(3, dtype=int)
    for begin in range(first, first + count, size):
        said = work(begin, min(size, first + count - begin))
        print(f"{name}, from {begin}: {said}", end="")
        found = re.search(r"CS: (\d+) OK.* ME: (\d+),.* (\d+) steps done", said)
        assert found, said
        total += [int(n) for n in found.groups()]
    return total


@pytest.mark.parametrize("model", COUNTS)
def test_no_undefined_behaviour(facts: dict[str, Path], model: str) -> None:
    done = in_parts(f"{model}, undefined", lambda a, n: undefined(facts[model], a, n), 1, COUNTS[model])
    assert (done > np.array([8, 4, 3]) * COUNTS[model]).all(), "hardly anything was done"


@pytest.mark.parametrize("model", COUNTS)
def test_no_wrong_address_and_no_leak(facts: dict[str, Path], model: str, tmp_path: Path) -> None:
    if not (compiler := sanitizer("address,undefined", tmp_path)):
        pytest.skip("there is no gcc with the address sanitizer")
    in_parts(f"{model}, addresses", lambda a, n: address(facts[model], a, n, compiler), 1_000_001, COUNTS[model])


#: Faults of a kind the guards are there for: text of the source, what it becomes, what is told of it.
PLANTED = {
    "reads behind the table": ("if (r[i] >= N_VARIABLES)", "if (r[i] > N_VARIABLES)", "index|bounds|overflow"),
    "passes on what is not finite": (
        'status = discard(m, "fmi2GetReal:',
        'discard(m, "fmi2GetReal:',
        "fmi2OK with (nan|-nan|inf|-inf)",
    ),
    "keeps a part of what it refuses": (
        'if (!takes(m, r[i], value[i], "fmi2SetReal"))',
        'if ((r[i] < FIRST_U && (m->s.x[r[i]] += 1, 0)) || !takes(m, r[i], value[i], "fmi2SetReal"))',
        "but the state changed",
    ),
    "takes damaged states": (
        "header.checksum != hash(bytes + sizeof header, SAVED_SIZE)",
        "0",
        "damaged state was taken",
    ),
    "steps to infinity": (
        "if (!isfinite(end) || step < 0)",
        "if (!isfinite(step) || step < 0)",
        "was done|seed",
    ),
}


@pytest.mark.parametrize("fault", PLANTED)
def test_planted_faults_are_found(facts: dict[str, Path], fault: str, tmp_path: Path) -> None:
    before, after, expected = PLANTED[fault]
    text = (facts["rc"].parent / "sources" / "all.c").read_text()
    assert text.count(before) == 1
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources" / "all.c").write_text(text.replace(before, after))
    (tmp_path / "facts.txt").write_text(facts["rc"].read_text())
    with pytest.raises(AssertionError, match=expected):
        undefined(tmp_path / "facts.txt", 1, 1500)
