"""Rigs and tables of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import read_card
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.measured.table import Campaign
from gearheat.scenarios.scenario import Scenario
from made_tables import made, written


@pytest.fixture(scope="session")
def rig() -> Callable[[str], Scenario]:
    known: dict[str, Scenario] = {}
    return lambda name: known.setdefault(name, load(name))


@pytest.fixture(scope="session")
def helical(rig) -> dict[str, list[float]]:
    return made(rig("helical_two_stage"))


@pytest.fixture(scope="session")
def planetary(rig) -> dict[str, list[float]]:
    columns = made(rig("planetary"), directions=(1, 2))
    n = len(columns["T_oil_C"])
    place = {"test": [k // 2 + 1 for k in range(n)], "direction": [1, 2] * (n // 2), "dwell_min": [240, 90] * (n // 2)}
    return {"point": list(range(1, n + 1)), **place, "oil": ["PAOR"] * n, **columns}


@pytest.fixture
def read(rig, tmp_path) -> Callable[..., Campaign]:
    """Reads a table of columns for a rig, with the text of a card."""

    def reader(name: str, columns: Mapping[str, Iterable[object]], card: str = "", **options: bool) -> Campaign:
        path = None
        if card:
            path = tmp_path / "card.toml"
            path.write_text(card, encoding="utf-8")
        return read_campaign(written(tmp_path / "data.csv", columns), rig(name), read_card(path), **options)

    return reader
