"""Catalogues: every entry is valid and fits the parts it is for, and every way a file can be wrong."""

from pathlib import Path

import pytest
from for_each import for_each
from gearheat.model.errors import ScenarioError
from gearheat.model.parts import PARTS
from gearheat.model.sources import sources
from gearheat.model.units import si_of
from gearheat.scenarios.document import SOURCE_KINDS
from gearheat.scenarios.entries import FILES, Entry, catalogue, entry, read_catalogue
from gearheat.scenarios.values import entry_values, oil_values, settable

ENTRIES = [found for kind in FILES for found in catalogue(kind).values()]

#: What an entry has to give a part of a type, by the kind of entry and a word of its description.
NEEDED = {
    "TaperedRollerBearing": {"d", "D", "d_m", "R_1", "R_2", "S_1", "S_2", "Y", "K_Z"},
    "DeepGrooveBallBearing": {"d", "D", "d_m", "R_1", "R_2", "S_1", "S_2", "C_0", "K_Z"},
    "CylindricalRollerBearing": {"d", "D", "d_m", "B", "R_1", "S_1", "S_2", "K_Z", "K_L"},
    "AngularContactBallBearing": {"d", "D", "d_m", "R_1", "R_2", "R_3", "S_1", "S_2", "S_3", "K_Z"},
    "SphericalRollerBearing": {"d_m", "B", "R_1", "R_2", "R_3", "R_4", "S_1", "S_2", "S_3", "S_4", "K_Z", "K_L"},
    "ThrustBallBearing": {"d", "D", "d_m", "R_1", "S_1", "K_Z"},
    "CylindricalRollerThrustBearing": {"d", "D", "d_m", "B", "R_1", "S_1", "K_Z", "K_L"},
    "NeedleBearing": {"d_m"},
}
WORDS = {"tapered": "TaperedRollerBearing", "deep groove": "DeepGrooveBallBearing", "needle": "NeedleBearing"}
WORDS |= {"cylindrical roller bearing": "CylindricalRollerBearing", "angular contact": "AngularContactBallBearing"}
WORDS |= {"spherical roller": "SphericalRollerBearing", "thrust ball": "ThrustBallBearing"}
WORDS |= {"roller thrust": "CylindricalRollerThrustBearing"}


def problems(tmp_path: Path, text: str, kind: str = "bearing") -> tuple[str, ...]:
    (path := tmp_path / "own.toml").write_text(text)
    with pytest.raises(ScenarioError) as raised:
        read_catalogue(kind, path)
    return raised.value.problems


@for_each(ENTRIES, lambda e: f"{e.kind} {e.name}")
def test_every_value_of_an_entry_has_a_source_that_exists(found: Entry) -> None:
    assert set(found.values) == set(found.sources)
    for text in found.sources.values():
        assert text.split(",")[0] in sources() or text.split(":")[0] in SOURCE_KINDS, text


@for_each(ENTRIES, lambda e: f"{e.kind} {e.name}")
def test_an_entry_says_what_its_values_were_compared_with(found: Entry) -> None:
    """A value from memory, typical or assumed for a product that does not exist is never called checked."""
    assert set(found.checked) <= set(found.values)
    for key, source in found.sources.items():
        assert "memory" not in source
        assert ("unchecked" in found.told(key, source)) == (key not in found.checked)
        if source.startswith("assumed: typical") and key != "nu_40":
            assert key not in found.checked


def test_all_other_bearings_are_checked() -> None:
    missing = {name: set(found.values) - set(found.checked) for name, found in catalogue("bearing").items()}
    large = {name for name, keys in missing.items() if keys == {"d", "D", "B", "C"}}  # sized by rules
    assert all(name.startswith("NU 10") and si_of(catalogue("bearing")[name].values["d"]) >= 0.32 for name in large)
    assert {name for name, keys in missing.items() if keys} - large == {"7208 B", "51108", "81108"}  # no print at hand


@for_each(catalogue("oil").values(), lambda e: e.name)
def test_an_oil_gives_all_that_a_lubricant_needs(found: Entry) -> None:
    given = set(entry_values(found, settable(PARTS["OilBath"])))
    needed = {"nu_40", "nu_100", "rho_15", "alpha_T", "s_p", "t_p", "X_L"}
    assert given == (needed if "grease" in found.name else needed | {"c_p", "T_pour"})
    values = entry_values(found, settable(PARTS["OilBath"]))
    assert values["nu_40"] > values["nu_100"]
    assert 800 < values["rho_15"] < 1100


@for_each(catalogue("bearing").values(), lambda e: e.name)
def test_a_bearing_gives_its_type_all_the_catalogue_knows(found: Entry) -> None:
    (part,) = [part for word, part in WORDS.items() if word in found.doc]
    values = entry_values(found, settable(PARTS[part]))
    assert NEEDED[part] <= set(values) | {"d", "D", "d_m"}
    sizes = entry_values(found, settable(PARTS["DeepGrooveBallBearing"]))
    mean = (sizes["d"] + sizes["D"]) / 2
    assert values.get("d_m", mean) == pytest.approx(mean, rel=1e-12)


@for_each(catalogue("seal").values(), lambda e: e.name)
def test_a_seal_gives_its_shaft_and_its_friction(found: Entry) -> None:
    values = entry_values(found, settable(PARTS["LipSeal"]))
    assert set(values) == {"d_sh", "c_sh"}
    assert found.name.startswith(f"{1e3 * values['d_sh']:g}x")


@for_each(catalogue("material").values(), lambda e: e.name)
def test_a_material_gives_a_fin_or_a_surface(found: Entry) -> None:
    values = entry_values(found, settable(PARTS["FinnedBoxCooling"]))
    assert set(values) in ({"k_fin"}, {"emissivity"})


def test_the_four_oils_of_the_campaign_are_the_printed_ones() -> None:
    """Dias2014, chapter 4."""
    assert oil_values("MINR")["nu_40"] == pytest.approx(319.25e-6)
    assert oil_values("PAGD")["rho_15"] == 1059
    assert oil_values("MINE")["alpha_T"] == -6.7e-4
    assert oil_values("PAOR")["s_p"] == 7.382


class TestNames:
    def test_a_misspelt_oil(self) -> None:
        with pytest.raises(ScenarioError, match=r'^unknown oil "MINNR"\. Did you mean "MINR"'):
            entry("oil", "MINNR")

    def test_a_name_like_no_other(self) -> None:
        with pytest.raises(ScenarioError, match=r'^unknown seal "x"\. Known: 30x47x7, '):
            entry("seal", "x")

    def test_a_misspelt_kind(self) -> None:
        with pytest.raises(ScenarioError, match=r'^there is no catalogue "oils"\. Did you mean "oil"'):
            catalogue("oils")


class TestBadFiles:
    def test_all_mistakes_at_once(self, tmp_path: Path) -> None:
        text = (
            '["A 1"]\nchecked = false\nd_m = 62\nmu_EHLL = 3\nsource = "SKF2018"\n'
            '["A 2"]\nchecked = "SKF2018"\nd_m = "62 kg"\nD = "80 mm"\nsources = { d_m = "SKF2018" }\n'
        )
        assert problems(tmp_path, "stray = 3\n" + text) == (
            "own.toml [stray]: is no table. Write the values of the entry below [stray].",
            'own.toml [A 1]: d_m = 62 has no unit. Write "62 mm" or "62 m" (expected a unit like m).',
            'own.toml [A 1]: no part takes "mu_EHLL". Did you mean "mu_EHL"?',
            "own.toml [A 2]: no source is given for D."
            ' Add source = "..." (a citation, or "assumed: reason") to the table.',
            'own.toml [A 2]: d_m = "62 kg": unit "kg" does not fit m. Write for example "62 mm".',
        )

    @pytest.mark.parametrize(
        ("line", "found"),
        [
            ("", "checked is missing"),
            ("checked = true\n", "checked = True names no print"),
            ('checked = " "\n', "checked = ' ' names no print"),
            ("checked = { D = true }\n", "checked = {'D': True} names no print"),
        ],
    )
    def test_not_said_what_it_was_compared_with(self, tmp_path: Path, line: str, found: str) -> None:
        remedy = "Write the print that the values were compared with, a table of such texts by value, or false."
        text = f'["A 1"]\n{line}D = "62 mm"\nsource = "SKF2018"\n'
        assert problems(tmp_path, text) == (f"own.toml [A 1]: {found}. {remedy}",)

    def test_compared_value_that_is_not_there(self, tmp_path: Path) -> None:
        text = '["A 1"]\nchecked = { d_n = "SKF2018" }\nd_m = "62 mm"\nsource = "SKF2018"\n'
        (problem,) = problems(tmp_path, text)
        assert problem == 'own.toml [A 1]: checked names "d_n", which has no value. Did you mean "d_m"?'

    def test_the_same_name_twice(self, tmp_path: Path) -> None:
        (problem,) = problems(tmp_path, "[A]\n[A]\n")
        assert problem.startswith("own.toml line 2: TOML syntax, cannot declare ('A',) twice")

    def test_no_file(self, tmp_path: Path) -> None:
        with pytest.raises(ScenarioError, match="there is no such file"):
            read_catalogue("oil", tmp_path / "no.toml")
