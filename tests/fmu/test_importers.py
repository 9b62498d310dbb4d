"""The importers that are installed here run our FMUs, and the page tells what came out."""

import re

from gearheat.tools.docs.blocks import PAGES
from importers import PACKAGES, PROGRAMS, rows

#: FMPy always runs.
LEAST = {("FMPy", f"FMI {fmi}.0 {kind}") for fmi in (2, 3) for kind in ("CoSimulation", "ModelExchange")}


def test_the_page_tells_what_importers_do() -> None:
    page = (PAGES / "howto" / "fmu.md").read_text(encoding="utf-8").partition("\n## In importers of others\n")[2]
    table = re.findall(r"^\| (.+) \| ([\d.]+) \| (.+) \| below (\S+) K \|$", page, flags=re.MULTILINE)
    told = {(importer, interface): float(bound) for importer, _, interface, bound in table}
    assert {importer for importer, _ in told} == PACKAGES.keys() | PROGRAMS.keys()
    found = {(row.importer, row.interface): row.error for row in rows()}
    assert found.keys() >= LEAST
    assert {key: error for key, error in found.items() if not error < told[key]} == {}
