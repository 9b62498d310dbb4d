"""What holds for all tests."""

import gc
import os
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from browser import CHROMIUM, Browser

#: Files that take more than 10 s, the longest first. A parallel run hands out whole files in this order, then the rest:
#: what a file's tests share is made once, and no processor waits at the end for a long file that began late.
LONGEST = (
    "challenge/test_hidden.py",
    "static/test_readme.py",
    "diagnose/infer/test_logs.py",
    "fmu/test_operating_points.py",
    "scenarios/test_relations_of_runs.py",
    "tools/test_export.py",
    "fmu/test_duties.py",
    "tools/test_new.py",
    "diagnose/test_readings_and_logs.py",
    "tools/test_docs.py",
    "tools/test_run.py",
    "diagnose/library/test_causes.py",
    "fmu/test_every_parameter.py",
    "tools/test_any_rig.py",
    "challenge/test_new_rig.py",
    "diagnose/infer/test_looks.py",
    "challenge/test_bench.py",
    "tools/test_page.py",
    "tools/test_maps.py",
    "tools/test_verify.py",
    "parts/test_every_part.py",
    "tools/test_transients.py",
    "diagnose/test_pages.py",
    "tools/test_bench_fmu.py",
    "fmu/test_export.py",
    "diagnose/answer/test_answer.py",
    "fmu/test_fuzz.py",
    "fmu/test_sources.py",
    "tools/test_loads.py",
    "fmu/test_cold_start.py",
    "tools/test_warmups.py",
    "tools/test_four_square.py",
    "laws/test_sweeps.py",
    "fmu/test_batch.py",
)
#: FMUs of tests run little: their code is compiled as it stands. That it gives the same digits has a test.
os.environ.setdefault("GEARHEAT_COMPILE", "quick")
#: New objects after which the collector of cycles looks through them, 700 by default: texts of C and expressions are
#: millions of objects, few of them in cycles.
LOOK_AFTER = 50_000


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first; the others, and the tests of a file, stay in their order."""
    here = Path(__file__).parent
    ranks = {here / name: rank for rank, name in enumerate(LONGEST)}
    items.sort(key=lambda item: ranks.get(item.path, len(ranks)))


def pytest_collection_finish() -> None:
    """What is loaded lives to the end: the collector does not look through it again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(LOOK_AFTER)


@pytest.fixture(autouse=True)
def no_screen(monkeypatch):
    """Output is that of a pipe, whatever screen the tests run on: parallel runs tell their workers a width."""
    monkeypatch.delenv("COLUMNS", raising=False)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """One browser for the tests of a module, where there is one and what drives it."""
    if not (CHROMIUM and find_spec("websockets")):
        pytest.skip("no browser")
    with Browser(tmp_path_factory.mktemp("browser")) as opened:
        yield opened
