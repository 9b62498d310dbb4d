"""A speed in a unit that may mean revolutions or radians is refused wherever a speed is written."""

import itertools

import pytest

WORDS = "may mean revolutions or radians"
DUTY = "time [min],carrier.w [{}],carrier.tau [N.m]\n0,4,1500\n60,4,1500\n"
LOG = "time_s,n_hss [{}],T_hss_Nm,T_sump_C,T_nacelle_C\n" + "".join(f"{600 * k},4,3000,55,20\n" for k in range(9))


@pytest.fixture
def files(rig, tmp_path):
    """Files with speeds in a unit, by what they are."""

    def written(unit):
        texts = {
            "duty": DUTY.format(unit),
            "log": LOG.format(unit),
            "campaign": (rig.folder / "measured.csv").read_text().replace("n_carrier_rpm", f"n_carrier [{unit}]"),
            "plain": (rig.folder / "measured.csv").read_text().replace("n_carrier_rpm", "n_carrier"),
        }
        for name, text in texts.items():
            (tmp_path / f"{name}.csv").write_text(text)
        (tmp_path / "card.toml").write_text(f'units = {{ n_carrier = "{unit}" }}\n')
        rig.line("operating_point", "carrier.w", f'carrier.w = "4 {unit}"')
        return {name: tmp_path / f"{name}.csv" for name in texts} | {"card": tmp_path / "card.toml", "rig": rig}

    return written


#: Place of a speed -> the command that reads it.
PLACES = {
    "rig file": "steady {rig}",
    "--set": "steady planetary --set carrier.w=4§{unit}",
    "--vary": "sweep planetary --vary carrier.w=4..5§{unit} --sample 3 -o {out}",
    "--speed": "map planetary --speed 4..5§{unit} -o {out}",
    "--target": "design planetary --free cooling.A --target carrier.w=4§{unit}",
    "new": "new three_stage --stages planetary --ratio 4 --power 10§kW --speed 4§{unit} -o {out}",
    "duty": "simulate planetary --duty {duty} -o {out}",
    "sweep of a duty": "sweep planetary --vary room.T=20§degC..30§degC --sample 3 --kind warmup --duty {duty} -o {out}",
    "log": "replay wind_turbine --fit {log}",
    "campaign": "losses planetary --data {campaign}",
    "card": "diagnose {plain} --rig planetary --card {card}",
}


@pytest.mark.parametrize(("place", "unit"), zip(PLACES, itertools.cycle(["hertz", "s**-1", "1/ s"]), strict=False))
def test_a_unit_that_may_mean_two_speeds(gearheat, files, tmp_path, place, unit):
    known = files(unit)
    words = PLACES[place].format(out=tmp_path / "out.csv", unit=unit.replace(" ", "§"), **known).split()
    answer = gearheat(*(word.replace("§", " ") for word in words))
    assert answer.code == 2
    assert WORDS in answer.err, answer.err
    assert not (tmp_path / "out.csv").exists()
