"""Wrong inputs by kinds, each refused by the reader that commands use, with what was found or what to do."""

import tomllib
from pathlib import Path

import pytest
import wrong_inputs
from gearheat.model.errors import GearheatError
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


def test_there_are_enough_of_each_kind() -> None:
    counts = {kind: len(lines(kind)) for kind in READERS}
    assert min(counts.values()) >= 50, counts
    assert sum(counts.values()) >= LEAST, counts
