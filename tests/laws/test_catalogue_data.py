"""The catalogue files: every value has a source and a unit that fits, and agrees with the others of its entry."""

import csv
import itertools
import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from for_each import for_each
from gearheat.model.laws.oil import kinematic_viscosity
from gearheat.model.parts import PARTS
from gearheat.model.sources import sources
from gearheat.model.units import to_si
from gearheat.scenarios.shipped import read_entries

FOLDER = Path(__file__).parents[2] / "scenarios" / "catalogue"
ABOUT = {"doc", "source", "sources", "checked", "series"}
UNITS = {
    **dict.fromkeys(("nu", "nu_40", "nu_100"), "m2/s"),
    **dict.fromkeys(("rho", "rho_15"), "kg/m3"),
    **dict.fromkeys(("k", "k_fin"), "W/(m.K)"),
    **dict.fromkeys(("d", "D", "d_m", "B", "d_sh"), "m"),
    **dict.fromkeys(("X_L", "s_p", "t_p", "R_1", "R_2", "S_1", "S_2", "Y", "K_Z", "K_L", "emissivity", "Pr"), "1"),
    **dict.fromkeys(("R_3", "R_4", "S_3", "S_4"), "1"),
    **{"T_pour": "K", "alpha_T": "1/K", "c_p": "J/(kg.K)", "C_0": "N", "C": "N", "c_sh": "N.m/m2"},
}
LUBRICANT = {"nu_40", "nu_100", "rho_15", "alpha_T", "X_L", "s_p", "t_p"}
BEARING = {"d", "D", "R_1", "R_2", "S_1", "S_2", "K_Z"}


@cache
def entries(file: str) -> dict[str, dict[str, Any]]:
    return read_entries(FOLDER / file)


def si(entry: dict[str, Any]) -> dict[str, float]:
    return {key: to_si(value, UNITS[key], name=key) for key, value in entry.items() if key not in ABOUT}


EVERY = [(path.name, name) for path in sorted(FOLDER.glob("*.toml")) for name in entries(path.name)]


@for_each(EVERY)
def test_entry(file: str, name: str) -> None:
    entry = entries(file)[name]
    values = si(entry)
    assert values
    assert all(math.isfinite(v) and (v > 0 or key == "alpha_T") for key, v in values.items())
    assert set(entry.get("sources", {})) <= set(values)
    for text in (entry["source"], *entry.get("sources", {}).values()):
        kind, colon, reason = text.partition(":")
        known = kind.partition(",")[0] in sources() or (
            kind in ("assumed", "inferred", "calibrated") and colon and reason
        )
        assert known, text


def viscosity_index(U: float, Y: float) -> float:
    """ASTM D2270 for viscosities of 2 to 100 mm2/s at 100 degC: Y in one of the segments of L and H."""
    segments = [
        (2.0, (1.14673, 1.7576, -0.109), (0.84155, 1.5521, -0.077)),
        (3.8, (3.38095, -15.4952, 33.196), (0.78571, 1.7929, -0.183)),
        (4.4, (2.5, -7.2143, 13.812), (0.82143, 1.5679, 0.119)),
        (5.0, (0.101, 16.635, -45.469), (0.04985, 9.1613, -18.557)),
        (6.4, (3.35714, -23.5643, 78.466), (0.22619, 7.7369, -16.656)),
        (7.0, (0.01191, 21.475, -72.87), (0.79762, -0.7321, 14.61)),
        (7.7, (0.41858, 16.1558, -56.04), (0.05794, 10.5156, -28.24)),
        (9.0, (0.88779, 7.5527, -16.6), (0.26665, 6.7015, -10.81)),
        (12.0, (0.7672, 10.7972, -38.18), (0.20073, 8.4658, -22.49)),
        (15.0, (0.97305, 5.3135, -2.2), (0.28889, 5.9741, -4.93)),
        (18.0, (0.97256, 5.25, -0.98), (0.24504, 7.416, -16.73)),
        (22.0, (0.91413, 7.4759, -21.82), (0.20323, 9.1267, -34.23)),
        (28.0, (0.87031, 9.7157, -50.77), (0.18411, 10.1015, -46.75)),
        (40.0, (0.84703, 12.6752, -133.31), (0.17029, 11.4866, -80.62)),
        (55.0, (0.85921, 11.1009, -83.19), (0.1713, 11.368, -76.94)),
        (70.0, (0.83531, 14.6731, -216.246), (0.16841, 11.8493, -96.947)),
    ]
    _, low, high = max(s for s in segments if s[0] <= Y)
    L, H = (a * Y * Y + b * Y + c for a, b, c in (low, high))
    if U >= H:
        return 100 * (L - U) / (L - H)
    return (10 ** (math.log10(H / U) / math.log10(Y)) - 1) / 0.00715 + 100


@pytest.mark.parametrize(("U", "Y", "printed"), [(73.30, 8.86, 92), (22.83, 5.05, 156)])
def test_viscosity_index_of_the_standards_examples(U: float, Y: float, printed: float) -> None:
    assert viscosity_index(U, Y) == pytest.approx(printed, abs=0.5)


@for_each([n for n in entries("oils.toml") if n.startswith("ISO VG")])
def test_grade(name: str) -> None:
    """The grade is the viscosity at 40 degC; the one at 100 degC has the viscosity index of the text."""
    entry = entries("oils.toml")[name]
    values = si(entry)
    grade = float(name.split()[2])
    assert 1e6 * values["nu_40"] == pytest.approx(grade)
    stated = float(entry["doc"].rpartition(" ")[2])
    assert viscosity_index(1e6 * values["nu_40"], 1e6 * values["nu_100"]) == pytest.approx(stated, abs=0.5)


@for_each(entries("oils.toml"))
def test_oil(name: str) -> None:
    """Everything an oil bath needs but its volume; where Cragoe is cited, his specific heat."""
    entry = entries("oils.toml")[name]
    values = si(entry)
    assert values.keys() >= LUBRICANT
    assert name == "bearing grease" or "c_p" in values
    if entry.get("sources", {}).get("c_p", "").startswith("Cragoe1929"):
        assert values["c_p"] == pytest.approx((1685 + 3.4 * 60) / math.sqrt(values["rho_15"] / 999), abs=0.5)


@for_each(entries("bearings.toml"))
def test_bearing(name: str) -> None:
    values = si(entries("bearings.toml")[name])
    assert values.get("d_m", (values["d"] + values["D"]) / 2) == pytest.approx((values["d"] + values["D"]) / 2)
    if name.startswith("SKF"):
        kind = "TaperedRollerBearing" if "Y" in values else "DeepGrooveBallBearing"
        assert kind in PARTS
        assert BEARING | ({"Y", "K_L"} if "Y" in values else {"C_0"}) <= values.keys()
    if name not in ("SKF 6217-2Z", "K 40x48x20", "SKF 32208", "NJ 406", "7208 B", "51108", "81108"):
        assert 4e3 < values["C"] < 5e6


@pytest.mark.parametrize(
    "prefix", [*(f"SKF {s}" for s in (62, 63, 302, 303, 313, 320, 322, 323)), "NU 2", "NU 10", "222"]
)
def test_bearings_of_a_series_grow_together(prefix: str) -> None:
    """Outside diameter and width never fall with the bore, and a load rating by no more than a tenth."""
    sizes = sorted(
        (v["d"], v["D"], v["B"], v["C"])
        for v in (si(e) for name, e in entries("bearings.toml").items() if name.startswith(prefix) and "C" in e)
    )
    assert sizes[-1][0] >= {"SKF 313": 0.15, "SKF 323": 0.12}.get(prefix, 0.22)
    for before, after in itertools.pairwise(sizes):
        assert all(b >= a for a, b in zip(before[:3], after[:3], strict=True)), after
        assert after[3] > 0.9 * before[3], after


@for_each([n for n in entries("bearings.toml") if n.startswith("NU 10")])
def test_large_cylindrical_roller_bearings_are_rated_as_their_series(name: str) -> None:
    """By ISO 281 C goes with L^(7/9) Z^(3/4) D_w^(29/27): here L as the width, D_w as the section, Z as d_m / D_w."""
    one, other = (si(entries("bearings.toml")[n]) for n in (name, "NU 1060"))
    expected = other["C"] * (one["B"] / other["B"]) ** (7 / 9)
    expected *= ((one["D"] - one["d"]) / (other["D"] - other["d"])) ** (29 / 27 - 3 / 4)
    expected *= ((one["D"] + one["d"]) / (other["D"] + other["d"])) ** (3 / 4)
    assert one["C"] == pytest.approx(expected, rel=0.07 if one["d"] < 0.31 else 0.006)


def test_bearings_of_a_series_share_their_constants() -> None:
    by_series: dict[str, set[tuple[float, ...]]] = {}
    for name, entry in entries("bearings.toml").items():
        if name.startswith("SKF"):
            number = name.split()[1]
            series = number[:2] if len(number.partition("-")[0]) == 4 else number[:3]
            by_series.setdefault(series, set()).add(tuple(entry[k] for k in ("R_1", "R_2", "S_1", "S_2", "K_Z")))
    assert set(by_series) == {"62", "63", "302", "303", "313", "320", "322", "323"}
    assert all(len(constants) == 1 for constants in by_series.values())


PRINTED = [
    row
    for row in csv.DictReader(
        line
        for line in (FOLDER.parents[1] / "tests" / "golden" / "bearing_catalogue.csv").read_text("utf-8").splitlines()
        if not line.startswith("#")
    )
]
#: Printed friction constants by series: SKF2017, tables 3a and 3d (R_1, R_2, S_1, S_2) and 5 (K_Z, K_L).
SERIES = {
    "62": (3.9e-7, 1.7, 3.23e-3, 36.5, 3.1, None),
    "63": (3.7e-7, 1.7, 2.84e-3, 92.8, 3.1, None),
    "302": (1.76e-6, 10.9, 0.017, 2.0, 6.0, 0.7),
    "303": (1.69e-6, 10.9, 0.017, 2.0, 6.0, 0.7),
    "313": (1.84e-6, 10.9, 0.048, 2.0, 6.0, 0.7),
    "320": (2.38e-6, 10.9, 0.014, 2.0, 6.0, 0.7),
    "322": (2.27e-6, 10.9, 0.018, 2.0, 6.0, 0.7),
    "323": (2.38e-6, 10.9, 0.019, 2.0, 6.0, 0.7),
}


@for_each(PRINTED, lambda row: row["name"])
def test_bearing_is_the_printed_one(row: dict[str, str]) -> None:
    """Sizes, static load rating and axial factor as the maker's general catalogue prints them."""
    values = si(entries("bearings.toml")[row["name"]])
    for key in ("d", "D", "B"):
        assert 1e3 * values[key] == pytest.approx(float(row[key]), abs=1e-9), key
    if "C" in values:
        assert 1e-3 * values["C"] == pytest.approx(float(row["C"]), abs=1e-9)
    if row["Y"]:
        assert values["Y"] == float(row["Y"])
    else:
        assert 1e-3 * values["C_0"] == pytest.approx(float(row["C_0"]), abs=1e-9)


def test_every_bearing_of_the_maker_is_compared_with_print() -> None:
    """Sizes of a series come from one catalogue as print; those that the other one was read for are the same."""
    names = {name.removesuffix("-2Z") for name in entries("bearings.toml") if name.startswith("SKF")}
    assert names >= {row["name"] for row in PRINTED}


@for_each([n for n in entries("bearings.toml") if n.startswith("SKF")])
def test_bearing_has_the_printed_friction_constants_of_its_series(name: str) -> None:
    number = name.split()[1]
    printed = SERIES[number[:2] if len(number.partition("-")[0]) == 4 else number[:3]]
    entry = entries("bearings.toml")[name]
    assert tuple(entry.get(key) for key in ("R_1", "R_2", "S_1", "S_2", "K_Z", "K_L")) == printed


def test_every_oil_has_a_pour_point_and_a_grease_has_none() -> None:
    """Thicker oils of one base pour at higher temperatures, mineral ones before PAO; all are thick there."""
    oils = {name: si(entry) | {"doc": entry["doc"]} for name, entry in entries("oils.toml").items()}
    assert [name for name, oil in oils.items() if "T_pour" not in oil] == ["bearing grease"]
    for base in ("mineral", "PAO", "ester", "PAG"):
        points = [oil["T_pour"] for name, oil in oils.items() if name.endswith(base)]
        assert points == sorted(points) and 213.0 < points[0] < points[-1] < 273.0
    assert oils["ISO VG 220 mineral"]["T_pour"] > oils["ISO VG 220 PAO"]["T_pour"] + 20
    for oil in oils.values():
        if "T_pour" in oil:
            assert kinematic_viscosity(oil["T_pour"], oil["nu_40"], oil["nu_100"]) > 1.5e-3


def test_cylindrical_roller_bearing_is_the_printed_one() -> None:
    """SKF2017, tables 3c (series 4, with a cage) and 5; general catalogue 6000, page 524."""
    entry = entries("bearings.toml")["NJ 406"]
    assert [entry[k] for k in ("d", "D", "B")] == ["30 mm", "90 mm", "23 mm"]
    assert [entry[k] for k in ("R_1", "S_1", "S_2", "K_Z", "K_L")] == [1.0e-6, 0.16, 0.0015, 5.1, 0.65]
