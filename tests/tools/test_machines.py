"""Machines of `gearheat new` from 0.1 kW to 1 MW, as the page shows them."""

from __future__ import annotations

import pytest
from gearheat.tools.build.machines import HEAD, draw_up
from gearheat.tools.build.plausible import MACHINES, WARM, usual
from gearheat.tools.docs.blocks import PAGES

ROWS = [
    tuple(cell.strip() for cell in line.strip("| \n").split("|"))
    for line in (PAGES / "trust" / "machines.md").read_text(encoding="utf-8").splitlines()
    if line.startswith("| ")
]


def test_the_page_has_every_machine_and_all_are_plausible() -> None:
    """0.1 kW to 1 MW, all kinds, VG 68 to 460, one to four stages."""
    assert ROWS[0] == tuple(cell.strip() for cell in HEAD)
    rows = ROWS[1:]
    assert [" ".join((*row[:5], *row[5].replace(",", "").split())) for row in rows] == MACHINES["plates"]
    assert len(rows) >= 40
    assert {stage for row in rows for stage in row[0].split(",")} == {"spur", "helical", "bevel", "worm", "planetary"}
    assert {row[4] for row in rows} >= {"68", "460"}
    assert {float(row[2]) for row in rows} >= {0.1, 1000.0}
    for row in rows:
        low, high = usual(row[0], float(row[2]), float(row[1]))
        assert low <= float(row[6]) <= high, row
        assert WARM[0] < float(row[8]) < WARM[1], row


@pytest.mark.parametrize("place", [1, 10, 24, 34, 50])
def test_a_row_is_what_the_command_prints(place: int) -> None:
    plate = MACHINES["plates"][place]
    found = draw_up(plate)
    assert found["plausible"]
    assert tuple(str(cell) for cell in found["cells"]) == ROWS[1 + place]
