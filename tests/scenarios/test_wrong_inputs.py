"""Wrong inputs by kinds, each refused by the reader that commands use, with what was found or what to do."""

import tomllib
from pathlib import Path

import pytest
import wrong_inputs
from gearheat.model.errors import GearheatError
from gearheat.scenarios.ranges import override
from wrong_inputs.readers import READERS

TABLES = Path(wrong_inputs.__file__).parent
#: Inputs that must be there in all.
LEAST = 1000


def lines(kind: str) -> dict[str, str]:
    found: dict[str, str] = tomllib.loads((TABLES / f"{kind}.toml").read_text(encoding="utf-8"))
    return found


@pytest.mark.parametrize("kind", READERS)
def test_wrong_inputs_of_a_kind(kind: str, tmp_path: Path) -> None:
    taken, unsaid = [], []
    for line, part in lines(kind).items():
        try:
            READERS[kind](tmp_path, line)
        except GearheatError as error:
            if part not in str(error).replace(f"{tmp_path}/", ""):
                unsaid.append((line, error.problems[0]))
        else:
            taken.append(line)
    assert not taken
    assert not unsaid


def test_an_override_takes_sizes_and_nothing_else(tmp_path: Path) -> None:
    """What is refused for any other reason than its size is refused all the same."""
    taken = []
    with override():
        for line, part in list(lines("set").items())[::4]:
            try:
                READERS["set"](tmp_path, line)
                taken.append((line, part))
            except GearheatError as error:
                assert "--override" not in str(error)
    assert taken
    assert all(part.endswith("--override.") for _, part in taken), taken


def test_there_are_enough_of_each_kind() -> None:
    counts = {kind: len(lines(kind)) for kind in READERS}
    assert min(counts.values()) >= 50, counts
    assert sum(counts.values()) >= LEAST, counts
