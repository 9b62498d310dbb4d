"""Every row of the golden files: a law against a number from print.

A row has `law` ("module.function"), `args` (numbers in SI, or text with a unit), `expect` with `unit`, and `tol` in
that unit or `rel`. `kind` says what the number is: "published" as the source prints it, "corrected" by an erratum,
"reproduced" a recomputation that no one printed, "misprint" what a misprint of the source leads to. Only the first two
verify a law. `item` picks from a law with several results.
"""

import importlib
import tomllib
from pathlib import Path
from typing import Any

from for_each import for_each

GOLDEN = Path(__file__).parents[2] / "model" / "golden"
RPM = 3.141592653589793 / 30
#: Unit -> factor to SI. "W at 250 rpm" is a torque, "W at 250 K" a conductance, told by their power.
UNITS = {
    "1": 1.0,
    "mm": 1e-3,
    "um": 1e-6,
    "cSt": 1e-6,
    "mPa.s": 1e-3,
    "N/mm": 1e3,
    "N.mm": 1e-3,
    "rpm": RPM,
    "deg": RPM / 6,
    "1/GPa": 1e-9,
    "W at 250 rpm": 1 / (250 * RPM),
    "W at 1000 rpm": 1 / (1000 * RPM),
    "W at 250 K": 1 / 250,
}
KINDS = {"published", "corrected", "reproduced", "misprint"}
#: Laws that whole chains compare with printed statements: test_planetary_chain.py, tools/test_teeth.py, and what
#: `verify` has of the rig.
CHAINED = {
    "oil.walther_constants",
    "oil.pressure_viscosity",
    "gears.reduced_radius",
    "gears.contact_length",
    "mesh.friction_schlenk",
    "mesh.load_per_contact_length",
    "film.film_thickness",
    "film.specific_film_thickness",
    "tooth_flanks.flash_temperature",
}


def si(value: Any) -> Any:
    """A number as it is, text with a unit in SI."""
    if not isinstance(value, str):
        return value
    number, _, unit = value.partition(" ")
    return float(number) + 273.15 if unit == "degC" else float(number) * UNITS[unit]


def rows() -> list[dict[str, Any]]:
    """All rows of all golden files that belong to laws."""
    found = []
    for path in sorted(GOLDEN.glob("*.toml")):
        found += [{**row, "file": path.stem} for row in tomllib.loads(path.read_text("utf-8")).get("row", [])]
    return [row for row in found if "law" in row]


def function(name: str) -> Any:
    module, _, law = name.partition(".")
    return getattr(importlib.import_module(f"gearheat.model.laws.{module}"), law)


def laws() -> dict[str, Any]:
    """Every decorated law by "module.function"."""
    folder = Path(importlib.import_module("gearheat.model.laws").__file__).parent
    found = {}
    for path in sorted(folder.glob("[a-z]*.py")):
        module = importlib.import_module(f"gearheat.model.laws.{path.stem}")
        for name, value in vars(module).items():
            if hasattr(value, "law") and value.__module__ == module.__name__:
                found[f"{path.stem}.{name}"] = value
    return found


@for_each(rows(), lambda r: f"{r['law']}: {r['name']}")
def test_row(row: dict[str, Any]) -> None:
    assert row["kind"] in KINDS
    assert row["source"]
    result = function(row["law"])(**{name: si(value) for name, value in row["args"].items()})
    if "item" in row:
        result = result[row["item"]]
    in_print = float(result) / UNITS[row.get("unit", "1")]
    tolerance = row["tol"] if "tol" in row else row["rel"] * abs(row["expect"])
    assert abs(in_print - row["expect"]) <= tolerance


def test_the_flag_verified_is_honest() -> None:
    """A law is verified if and only if a printed number or statement was compared with it."""
    printed = {row["law"] for row in rows() if row["kind"] in ("published", "corrected")} | CHAINED
    known = laws()
    here = {name for name in known if known[name].law.source}
    wrong = {name for name in here if known[name].law.verified != (name in printed)}
    assert not wrong, f"verified flag and golden rows disagree: {sorted(wrong)}"


def test_every_law_has_a_row() -> None:
    """No formula goes without a number from outside of it."""
    without = laws().keys() - {row["law"] for row in rows()}
    assert not without, f"laws without a golden row: {sorted(without)}"
