"""What must be told by its name lies far from its rivals, seen and unseen forms of them; what is alike does not."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gearheat.tools.challenge import case, choose
from gearheat.tools.challenge.causes import CAUSES, REGIMES, merged
from gearheat.tools.challenge.forms import Form, kinds_of
from gearheat.tools.challenge.hidden import Draw, Effect, Surroundings
from gearheat.tools.challenge.rivals import Rivals
from gearheat.tools.challenge.signal import Yardstick

COOLING = {"cooling.air", "cooling.emissivity", "cooling.foundation", "cooling.contact", "sensor.ambient.heated"}


class Place:
    """A campaign with its rivals."""

    def __init__(self, sheet: str, seed: int = 5) -> None:
        self.sheet, self.setting = sheet, case.draw_setting(sheet, np.random.default_rng(seed), series=False)
        s, plan = self.setting, self.setting.campaign.plan
        self.yard = Yardstick(s.rig, s.campaign, s.instruments, s.reference)
        own = s.reference is None
        self.around = Surroundings(plan.n[0], plan.load[0], self.yard.oil, plan.tests, own, s.inner_share)
        self.rivals = self.others(1)

    def others(self, seed: int) -> Rivals:
        return Rivals(self.yard, self.around, humidity=True, seed=(seed,))

    def loud(self, effect: Effect, snr: float) -> float:
        """The amplitude of some signal-to-noise."""
        found, _ = self.yard.survey(effect, effect.sign * effect.high * np.geomspace(1e-3, 1.0, 25))
        wanted = np.interp(np.log(snr), np.log(found), np.log(np.geomspace(1e-3, 1.0, 25)))
        return float(effect.sign * effect.high * np.exp(wanted))

    def chosen(self, kind: str, *names: str, seed: int = 0) -> list[choose.Hidden]:
        rng = np.random.default_rng(seed)
        return choose.choose(kind, self.sheet, iter(names * 4), self.yard, self.around, self.rivals, rng)


@pytest.fixture(scope="module")
def foreign() -> Place:
    return Place("foreign")


@pytest.fixture(scope="module")
def own() -> Place:
    return Place("own")


def test_look_alikes_are_near_and_others_far(foreign: Place) -> None:
    draw = Draw(np.random.default_rng(3), foreign.around)
    near, far = (CAUSES[name](draw) for name in ("cooling.foundation", "procedure.day_scatter"))
    found = foreign.rivals.nearest(near, foreign.loud(near, 20.0))
    assert found.cause in COOLING and found.distance < 1.0
    assert foreign.rivals.nearest(far, foreign.loud(far, 20.0)).distance > 12.0


def disguised(place: Place, effect: Effect, snr: float) -> tuple[str, float]:
    """The rival of an effect under a name of its own, and its distance over the signal-to-noise."""
    amplitude = place.loud(effect, snr)
    found = place.rivals.nearest(replace(effect, cause="outside.disguise"), amplitude)
    return found.cause, found.distance / place.yard.snr(effect, amplitude)


def test_no_disguise_helps(foreign: Place) -> None:
    """Under another name an effect has its own cause as a rival: hardly any form is far from what is searched.

    Not what follows a table of the days, which is drawn anew in every form.
    """
    rng = np.random.default_rng(8)
    tables = {"procedure.day_scatter", "procedure.not_stationary"}
    effects = {c: CAUSES[c](Draw(rng, foreign.around)) for c in CAUSES if c not in tables}
    found = {c: disguised(foreign, effect, 15.0) for c, effect in effects.items()}
    left = [share for _, share in found.values()]
    assert np.median(left) < 0.03 and max(left) < 1 / 3
    assert all(found[c][0] == c for c in effects if c.startswith("sensor.torque"))


def test_regimes_are_rivals_too(own: Place) -> None:
    rng = np.random.default_rng(2)
    effects = [CAUSES[c](Draw(rng, own.around).limited(REGIMES[c])) for c in REGIMES]
    left = [disguised(own, effect, 15.0)[1] for effect in effects]
    assert np.median(left) < 0.1 and max(left) < 1 / 3


def test_who_is_no_rival(own: Place) -> None:
    """Neither its own class, nor what is there beside it; the humidity only where it is told."""
    effect = CAUSES["sensor.torque.gain"](Draw(np.random.default_rng(1), own.around))
    amplitude = own.loud(effect, 20.0)
    nearest = own.rivals.nearest(effect, amplitude)
    other = own.rivals.nearest(effect, amplitude, beside=[nearest.cause])
    assert merged(nearest.cause) not in (merged(effect.cause), merged(other.cause))
    assert other.distance >= nearest.distance
    told, untold = (Rivals(own.yard, own.around, humidity=h, seed=(1,)) for h in (True, False))
    causes = [{kind[0][0].cause for kind in rivals._kinds} for rivals in (told, untold)]
    assert causes[0] - causes[1] == {"cooling.humidity"} and causes[0] == set(CAUSES)


def test_enough_is_enough(foreign: Place) -> None:
    """The search may stop early, but only at a rival that is near enough."""
    for seed, name in enumerate(("cooling.air", "losses.churning", "sensor.oil_temp.gain")):
        effect = CAUSES[name](Draw(np.random.default_rng(seed), foreign.around))
        amplitude = foreign.loud(effect, 25.0)
        whole = foreign.rivals.nearest(effect, amplitude).distance
        early = foreign.rivals.nearest(effect, amplitude, enough=3.0).distance
        assert early == whole if whole >= 3.0 else whole <= early < 3.0


@pytest.mark.parametrize("sheet", case.SHEETS)
def test_what_is_single_is_far_from_its_rivals(sheet: str, own: Place, foreign: Place) -> None:
    """Rivals of forms that the choice has not seen come hardly nearer."""
    place = own if sheet == "own" else foreign
    unseen = place.others(77)
    for kind, name in (("single", "sensor.torque.drift"), ("single", "cooling.oil_wall"), ("regime", "cooling.air")):
        (hidden,) = place.chosen(kind, name)
        low, high = choose.BANDS[sheet]
        assert low <= hidden.snr <= 1.1 * high
        assert hidden.rival is not None and hidden.rival.distance >= choose.APART_FROM_RIVALS
        again = unseen.nearest(hidden.effect, hidden.amplitude)
        assert again.distance > 0.8 * choose.APART_FROM_RIVALS


@pytest.mark.parametrize("sheet", case.SHEETS)
def test_what_is_alike_is_near_a_rival(sheet: str, own: Place, foreign: Place) -> None:
    place = own if sheet == "own" else foreign
    for name in ("cooling.foundation", "sensor.ambient.bias"):
        (hidden,) = place.chosen("alike", name)
        low, high = choose.BANDS[sheet]
        assert low <= hidden.snr <= 1.1 * high
        assert hidden.rival is not None and hidden.rival.distance < choose.ALIKE


def test_what_nobody_can_tell_is_never_single(foreign: Place) -> None:
    with pytest.raises(LookupError, match="rivals"):
        foreign.chosen("single", "cooling.emissivity")


def test_parts_of_a_pair_are_far_from_others(foreign: Place) -> None:
    names = ["cooling.emissivity", "sensor.torque.offset", "cooling.oil_wall", "losses.mesh_direction"]
    parts = foreign.chosen("pair", *names)
    found = [p.effect.cause for p in parts]
    assert len(set(found)) == 2 and "cooling.emissivity" not in found
    for part in parts:
        rival = foreign.rivals.nearest(part.effect, part.amplitude, beside=found)
        assert rival.distance >= choose.APART_FROM_RIVALS


def test_forms_are_what_is_asked_for(own: Place) -> None:
    """A form is the same for the same seed and shapes; kinds hold forms of one sign, apart from each other."""
    for cause in CAUSES:
        for kind in kinds_of(cause, own.around, (3,)):
            assert {f.kind for f in kind} == {kind[0].kind}
            shares = [tuple(f.shares) for f in kind]
            assert len(set(shares)) == len(shares)
    form = Form("losses.churning", own.around, (3, 0), limited=True)
    same, moved = form.at(np.array(form.shares)), form.at(np.array(form.shares) * 0.5)
    assert same.effect.form == form.effect.form and same.effect.regime == form.effect.regime
    assert moved.kind == form.kind and moved.shares == pytest.approx(np.array(form.shares) * 0.5)
    assert moved.effect.form != form.effect.form


@pytest.mark.parametrize("sheet", case.SHEETS)
def test_truth_tells_the_rival(sheet: str, tmp_path: Path) -> None:
    for kind, name in (("single", "procedure.order"), ("alike", "cooling.foundation")):
        truth = case.make_case(sheet, 4, 7, tmp_path / kind, kind=kind, causes=[name], series=False)
        assert truth["kind"] == kind and set(truth["rival"]) == {"cause", "distance"}
        assert merged(truth["rival"]["cause"]) not in truth["answer"]
        apart = truth["rival"]["distance"] >= choose.APART_FROM_RIVALS
        assert apart if kind == "single" else truth["rival"]["distance"] < choose.ALIKE
    assert "rival" not in case.make_case(sheet, 4, 7, tmp_path / "weak", kind="weak")


def test_alike_is_the_same_again(tmp_path: Path) -> None:
    for name in "ab":
        case.make_case("foreign", 4, 8, tmp_path / name, kind="alike", series=False)
    first, second = (json.loads((tmp_path / name / "TRUTH.json").read_text(encoding="utf-8")) for name in "ab")
    assert first == second and first["rival"]["cause"] in CAUSES
    assert (tmp_path / "a/case/DATA.csv").read_bytes() == (tmp_path / "b/case/DATA.csv").read_bytes()


def test_a_part_of_a_pair_is_as_loud_as_it_is_beside_the_other(own: Place) -> None:
    """A foundation that carries off most heat leaves little for humidity to change."""
    draw = Draw(np.random.default_rng(3), own.around)
    humidity, foundation = CAUSES["cooling.humidity"](draw), CAUSES["cooling.foundation"](draw)
    size = own.loud(humidity, 12.0)
    beside = own.yard.beside(foundation, 3.0)
    assert beside.snr(humidity, size) < 0.7 * own.yard.snr(humidity, size)


def test_what_another_size_of_the_other_part_would_do_too_is_not_heard(own: Place) -> None:
    draw = Draw(np.random.default_rng(3), own.around)
    offset = CAUSES["sensor.torque.offset"](draw)
    beside = own.yard.beside(offset, 5.0)
    assert own.yard.snr(offset, 6.0) > 3.0 > 0.5 > beside.snr(offset, 1.0)


def test_days_that_scatter_are_noise_to_the_other_part(own: Place) -> None:
    draw = Draw(np.random.default_rng(3), own.around)
    source = CAUSES["heat.external_source"](draw)
    size = own.loud(source, 12.0)
    beside = own.yard.beside(CAUSES["procedure.day_scatter"](draw), 0.15)
    assert beside.snr(source, size) < 0.7 * own.yard.snr(source, size)


@pytest.mark.parametrize("seed", [2, 3])
def test_pairs_are_loud_and_apart_beside_each_other(own: Place, seed: int) -> None:
    causes = ("losses.churning", "sensor.wall_temp.offset", "sensor.torque.offset", "cooling.foundation")
    parts = own.chosen("pair", *causes, seed=seed)
    for part, other in (parts, parts[::-1]):
        yard = own.yard.beside(other.effect, other.amplitude)
        assert part.snr == pytest.approx(yard.snr(part.effect, part.amplitude))
        assert part.snr >= choose.BANDS["own"][0] and part.rival.distance >= choose.APART_FROM_RIVALS
