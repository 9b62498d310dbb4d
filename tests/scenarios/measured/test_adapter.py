"""Adapters of published campaigns, on extracts that are made up here in the layouts of the files."""

from pathlib import Path

import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.adapter import Case, adapter, tables, write_csv
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.logs import read_log

#: Made up: six rows of two turbines over the cut between reference and question, one of them at rest.
EDP = "Turbine_ID;Timestamp;Gen_RPM_Avg;Grd_Prod_Pwr_Avg;Gear_Oil_Temp_Avg;Gear_Bear_Temp_Avg;Nac_Temp_Avg\n" + "".join(
    f"{machine};{date}T00:{10 * k:02d}:00+00:00;{speed};{power};5{k};6{k},5;30\n"
    for machine in ("T01", "T07")
    for date in ("2016-04-30", "2016-05-01")
    for k, (speed, power) in enumerate([(1500, 1000), (0, 0), (1600, 1200), (1600, 1200)])
)
#: Made up: the comments and the names of the files of Kelmarsh.
KELMARSH = "# This file was exported\n# Turbine: Kelmarsh 1\n#\n# Date and time,Power (kW),Generator RPM (RPM)," + (
    "Gear oil temperature (°C),Gear oil inlet temperature (°C),Nacelle temperature (°C)\n"
)


def edp(folder: Path, text: str = EDP) -> Path:
    for name in ("Wind-Turbine-SCADA-signals-2016.csv", "Wind-Turbine-SCADA-signals-2017_0.csv"):
        (folder / name).write_text(text if "2016" in name else text.replace("2016-0", "2017-0"), encoding="utf-8")
    return folder


def read(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    monkeypatch.setitem(tables()[name], "size_MB", [0.0, 1.0])  # type: ignore[index]
    return adapter(name).cases(folder)


def test_edp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples at rest are left out; torque follows from power and speed; commas are decimals; siblings are others."""
    case = read("edp", edp(tmp_path), monkeypatch)[0]
    assert case.name == "T01"
    assert case.asked["time_utc"].tolist() == [f"2016-05-01T00:{k}0:00+00:00" for k in (0, 2, 3)]
    assert case.asked["T_bearing1_C"].tolist() == [60.5, 62.5, 63.5]
    assert case.reference["T_hss_Nm"] == pytest.approx([6366.2, 7161.97, 7161.97], rel=1e-5)
    assert [len(s["T_sump_C"]) for s in case.siblings] == [6]
    write_csv(tmp_path / "log.csv", case.asked)
    log = read_log(tmp_path / "log.csv", load(adapter("edp").rig), Card())
    assert log.values["T_sump"] == pytest.approx([323.15, 325.15, 326.15])


def test_kelmarsh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names stand in the last comment; every turbine is a case with its own year before, the others are siblings."""
    for number, year in ((1, 2018), (1, 2019), (2, 2018), (2, 2019)):
        rows = "".join(f"{year}-03-01 00:{k}0:00,900,1500,5{k},50,{20 + number}\n" for k in range(3))
        path = tmp_path / f"Kelmarsh_SCADA_{year}" / f"Turbine_Data_Kelmarsh_{number}_{year}-01-01_-_{year + 1}_228.csv"
        path.parent.mkdir(exist_ok=True)
        path.write_text(KELMARSH + rows, encoding="utf-8")
    first, second = read("kelmarsh", tmp_path, monkeypatch)
    assert (first.name, second.name) == ("turbine 1", "turbine 2")
    assert second.asked["time_utc"][0] == "2019-03-01 00:00:00"
    assert set(second.reference["T_nacelle_C"]) == {22.0}
    assert [set(s["T_nacelle_C"]) for s in second.siblings] == [{21.0}]


def test_pronostia(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files without names, separated by commas or semicolons: one mean a minute, in hours since the first."""
    for bearing, sign in (("1_1", ","), ("1_4", ";")):
        for minute in (1, 2, 60, 61, 62):
            path = tmp_path / f"Bearing{bearing}" / f"temp_{minute:05d}.csv"
            path.parent.mkdir(exist_ok=True)
            rows = (sign.join(map(str, (9, minute % 60, 0, k, 60 + minute + k))) for k in (0, 1))
            path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    first, second = read("pronostia", tmp_path, monkeypatch)
    assert second.name == "bearing 1_4"
    assert second.asked["time_s"].tolist() == [3600.0, 3660.0, 3720.0]
    assert second.asked["T_bearing_C"].tolist() == [120.5, 121.5, 122.5]
    assert len(first.reference["n_rpm"]) == 2
    assert load(adapter("pronostia").rig).sensors["T_bearing_C"] == "ring.T"


#: Made up: the comments of a dynamometer, and two steps of its command by three samples, the first of them not settled.
DYNAMOMETER = "# Test started at noon\n# g1 = 6.0; g2 = 6.0\n" + (
    "time [s],a1 q-axis cmd [A],a1 torque [Nm],c1 vel [Hz],c1 torque [Nm],c1 fault,trd605 torque [Nm],temp 1 [C]\n"
)


def test_dynamometer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps of two files, each without its beginning; current by the controller's torque; no reference."""
    monkeypatch.setitem(tables()["dynamometer"], "readings", {"by": ["command"], "skip": 1, "least": 2})  # type: ignore[index]
    steps = [(1, 5, 0.108), (2, 10, 0.216), (0, 0, 0.0)]
    rows = "".join(
        f"{3 * k + i},{cmd},{6 * tau},{hz if i else 2},{tau},0,{5 * tau},30\n"
        for k, (cmd, hz, tau) in enumerate(steps)
        for i in range(3)
    )
    for hour in ("15-39-36", "15-48-50"):
        (tmp_path / f"futek_test_21_04_2021_{hour}.csv").write_text(DYNAMOMETER + rows, encoding="utf-8")
    (case,) = read("dynamometer", tmp_path, monkeypatch)
    assert case.asked["n_motor_rpm"].tolist() == [300.0, 600.0] * 2
    assert case.asked["T_output_Nm"] == pytest.approx([-0.54, -1.08] * 2)
    assert case.asked["I_motor_A"] == pytest.approx([1.0, 2.0] * 2, rel=1e-3)
    assert case.reference == {} and case.siblings == ()


def test_hydraulic() -> None:
    """The record that is shipped: stages of the cooler, and states of the leak with the makers' efficiency."""
    cases = adapter("hydraulic").cases(load("hydraulic").path.parent)
    assert [case.name for case in cases] == ["cooler at 3 %", "leak 1", "leak 2"]
    assert [len(case.asked["point"]) for case in cases] == [12, 16, 16]
    assert cases[0].reference["T_room_C"].mean() == pytest.approx(22.1, abs=0.1)
    drop = [(part["TS3_C"] - part["T_room_C"]).mean() for part in (cases[0].asked, cases[0].reference)]
    assert drop == pytest.approx([32.1, 16.8], abs=0.1)
    assert "SE_pct" in cases[1].asked
    assert "SE_pct" not in cases[0].asked


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("Gear_Oil_Temp_Avg", "Gear_Oil_Temp", 'no column "Gear_Oil_Temp_Avg", which is expected. Did you mean'),
        (";Nac_Temp_Avg", "", 'no column "Nac_Temp_Avg", which is expected'),
        ("T01;2016-04-30T00:00:00+00:00;1500", "T01;2016-04-30T00:00:00+00:00;much", "column speed is no number"),
    ],
)
def test_what_is_wrong_with_a_file_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, says: str
) -> None:
    """With the name that was expected; a folder without files says what to download, one of another size that."""
    with pytest.raises(DataError, match="there is no file Wind-Turbine-SCADA-signals-2016"):
        read("edp", tmp_path, monkeypatch)
    with pytest.raises(DataError, match=says):
        read("edp", edp(tmp_path, EDP.replace(old, new)), monkeypatch)
    monkeypatch.setitem(tables()["edp"], "size_MB", [1.0, 400.0])  # type: ignore[index]
    with pytest.raises(DataError, match="expected 1 to 400"):
        adapter("edp").cases(tmp_path)
