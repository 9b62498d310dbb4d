"""Units as they are met in practice mean what an engineer means, or are refused by name."""

from math import pi

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.units import in_unit, to_si
from gearheat.scenarios.csv_table import scale, split_unit


@pytest.mark.parametrize(
    "written", ["1/min", "min-1", "min^-1", "min⁻¹", "U/min", "r/min", "RPM", "rpm", "rev/min", " 1/min "]
)
def test_speeds_per_minute_count_revolutions(written: str) -> None:
    assert to_si(f"250 {written}", "rad/s") == pytest.approx(250 * pi / 30)
    factor, zero = scale(split_unit(f"speed [{written}]")[1], "rad/s", name="speed")
    assert (factor, zero) == pytest.approx((pi / 30, 0.0))


@pytest.mark.parametrize(
    ("written", "radians"), [("4 Hz", 8 * pi), ("4 rev/s", 8 * pi), ("4 rad/s", 4.0), ("180 deg/s", pi)]
)
def test_speeds_per_second(written: str, radians: float) -> None:
    assert to_si(written, "rad/s") == pytest.approx(radians)


#: Units that count something in a time, and do not say whether revolutions or radians, however they are written.
UNCLEAR = [
    "1/s",
    "s-1",
    "s^-1",
    "s⁻¹",
    "s**-1",
    "1/second",
    "1/minute",
    "1/hour",
    "min**-1",
    "hertz",
    "kHz",
    "kilohertz",
    "Bq",
    "becquerel",
    "Ci",
    "cps",
    "count/s",
    "percent/s",
]


@pytest.mark.parametrize("written", [*UNCLEAR, "1/ s", "1 / min", "1 / s", "count / minute"])
def test_what_may_be_revolutions_or_radians_is_refused_by_name(written: str) -> None:
    for use in (
        lambda: to_si(f"4 {written}", "rad/s"),
        lambda: scale(split_unit(f"speed [{written}]")[1], "rad/s", name="speed"),
        lambda: in_unit(4.0, written, "rad/s"),
    ):
        with pytest.raises(ScenarioError, match=r"revolutions or radians\. Write rpm, Hz"):
            use()


@pytest.mark.parametrize("written", ["rpm", "Hz", "deg/s", "turn/h", "krpm", "rad/min", "cycle/s"])
def test_a_speed_comes_back_in_the_unit_in_which_it_was_given(written: str) -> None:
    assert in_unit(to_si(f"4 {written}", "rad/s"), written, "rad/s") == pytest.approx(4.0)


def test_a_result_is_given_in_no_unit_of_another_kind() -> None:
    with pytest.raises(ScenarioError, match='unit "m" does not fit rpm'):
        in_unit(4.0, "m", "rad/s")


@pytest.mark.parametrize(
    ("written", "unit", "value"),
    [
        ("40 Nm", "N.m", 40.0),
        ("\N{MINUS SIGN}40 Nm", "N.m", -40.0),
        ("4 kNm", "N.m", 4000.0),
        ("40 N m", "N.m", 40.0),
        ("10 lb ft", "N.m", 13.5582),
        ("60 C", "K", 333.15),
        ("60 deg C", "K", 333.15),
        ("60 Celsius", "K", 333.15),
        ("60 °C", "K", 333.15),
        ("60°C", "K", 333.15),
        ("60 ℃", "K", 333.15),
        ("140 °F", "K", 333.15),
        ("5 C", "K (difference)", 5.0),
        ("5 °C", "K (difference)", 5.0),
        ("220 mm2/s", "m2/s", 220e-6),
        ("220 mm²/s", "m2/s", 220e-6),
        ("220 cSt", "m2/s", 220e-6),
        ("2 l", "m3", 0.002),
        ("10 hp", "W", 7457.0),
        ("10 PS", "W", 7354.99),
        ("5 %", "1", 0.05),
    ],
)
def test_other_spellings(written: str, unit: str, value: float) -> None:
    assert to_si(written, unit) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize(("written", "unit"), [("4 Hz", "N.m"), ("40 Nm", "rad/s"), ("60 C", "m"), ("5 PS", "K")])
def test_another_kind_is_refused(written: str, unit: str) -> None:
    with pytest.raises(ScenarioError, match="does not fit"):
        to_si(written, unit)
