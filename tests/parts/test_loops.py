"""Closed power loops and parallel paths: they close, they carry what is said, and what does not close is refused."""

import math

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import SolveError, StructureError
from gearheat.model.parts import PARTS
from gearheat.model.run.design import design
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady

OIL = dict(nu_40=1e-4, nu_100=1.1e-5, rho_15=885.0, alpha_T=-6.2e-4, s_p=9.904, t_p=0.139, X_L=1.0)
TEETH = dict(z_1=16.0, z_2=24.0, m_n=4.5e-3, alpha_n=math.radians(20), beta=0.0, b=0.014, a_w=0.0915)
TEETH |= dict(x_1=0.1817, x_2=0.1715, Ra=3e-7, k_mu=1.0, line_load="F_bn/l", E=2.06e11, poisson=0.3)
W = 1450 * math.pi / 30


def part(kind: str, name: str, **values):
    return PARTS[kind](name, **values)


def warm(pairs: tuple[str, ...]) -> tuple[list, list]:
    """An oil bath that lubricates and cools the pairs, and a room."""
    parts = [part("OilBath", "oil", V=2e-3, c_p=2000.0, **OIL), part("ThermalConductor", "cooler", G=100.0)]
    nets = [("oil.lubricant", *(f"{p}.lubricant" for p in pairs)), ("cooler.b", "room.floor")]
    return [*parts, part("Room", "room")], [*nets, ("oil.heat", "cooler.a", *(f"{p}.gears" for p in pairs))]


#: Another ratio at the same centre distance.
OTHER = TEETH | dict(z_1=15.0, z_2=25.0)


def four_square(slave: dict = TEETH, inertias: int = 0) -> FlatModel:
    """Two pairs whose shafts are coupled, one of them by a clutch; a motor drives the wheels, by its torque where the
    first of the three shafts have a rotor."""
    pairs = [part("HelicalGearPair", "test", **TEETH), part("HelicalGearPair", "slave", **slave)]
    parts = [*pairs, part("LoadingClutch", "clutch")]
    wheels = ["test.wheel", "slave.wheel", "motor.flange"]
    pinions = [["test.pinion", "clutch.a"], ["slave.pinion", "clutch.b"]]
    parts += [part("ShaftEnd", "motor", given=("tau",) if inertias else ("w",))]
    for i, net in enumerate((wheels, *pinions)[:inertias]):
        parts += [part("Inertia", f"rotor_{i}", J=0.05)]
        net.append(f"rotor_{i}.flange")
    more, nets = warm(("test", "slave"))
    nets += [tuple(net) for net in (wheels, *pinions)]
    return flatten(Assembly("four_square", "", (*parts, *more), tuple(nets)))


def power_split(share: float | None = None, two: dict = TEETH) -> FlatModel:
    """Two pairs side by side from an input to an output shaft: a clutch in one path, or a split of the torque."""
    pairs = [part("HelicalGearPair", "one", **TEETH), part("HelicalGearPair", "two", **two)]
    parts = [*pairs, part("ShaftEnd", "input", given=("w",)), part("ShaftEnd", "output", given=("tau",))]
    more, nets = warm(("one", "two"))
    nets += [("output.flange", "one.wheel", "two.wheel")]
    if share is None:
        parts += [part("LoadingClutch", "clutch")]
        nets += [("input.flange", "clutch.a", "two.pinion"), ("clutch.b", "one.pinion")]
    else:
        parts += [part("TorqueSplit", "split", share=share)]
        nets += [("input.flange", "split.flange"), ("split.a", "one.pinion"), ("split.b", "two.pinion")]
    return flatten(Assembly("power_split", "", (*parts, *more), tuple(nets)))


class TestFourSquare:
    @pytest.mark.parametrize("w", [W, -W])
    @pytest.mark.parametrize("tau", [183.4, -183.4])
    def test_the_motor_covers_the_losses(self, w: float, tau: float) -> None:
        found = steady(four_square(), {"motor.w": w, "clutch.tau": tau})
        losses = float(found["test.P_loss"][0] + found["slave.P_loss"][0])
        circulating = 183.4 * 1.5 * W
        assert float(found["motor.P"][0]) == pytest.approx(losses, rel=1e-9)
        assert 0.005 * circulating < losses < 0.03 * circulating
        assert found.audit.residual < 1e-9
        assert abs(float(found["clutch.slip"][0])) < 1e-9

    def test_the_loss_of_a_mesh_does_not_ask_where_the_motor_is(self) -> None:
        """One pair alone, driven at its pinion with the torque of the clutch, loses the same."""
        loop = steady(four_square(), {"motor.w": W, "clutch.tau": 183.4, "room.T": 363.15})
        more, nets = warm(("test",))
        parts = [part("HelicalGearPair", "test", **TEETH), part("ShaftEnd", "a", given=("w", "tau"))]
        nets += [("a.flange", "test.pinion"), ("b.flange", "test.wheel")]
        alone = flatten(Assembly("pair", "", (*parts, part("ShaftEnd", "b"), *more), tuple(nets)))
        T_oil = float(loop["oil.T"][0])
        held = steady(alone, {"a.w": -1.5 * W, "a.tau": -183.4, "cooler.G": 1e9, "room.T": T_oil})
        assert float(held["test.P_loss"][0]) == pytest.approx(float(loop["test.P_loss"][0]), rel=1e-6)

    def test_without_twist_next_to_nothing_is_lost(self) -> None:
        found = steady(four_square(), {"motor.w": W, "clutch.tau": 0.0})
        assert 0.0 <= float(found["motor.tau"][0]) < 0.02

    def test_rotors_on_its_shafts_are_one_state(self) -> None:
        """By its energy a rotor on a half of the pinion shaft counts 1.5 squared. What accelerates it passes a mesh,
        whose loss it changes by some percent of a percent."""
        duty = join_phases([(5.0, {"motor.tau": 60.0, "clutch.tau": 183.4})])
        speeds = {}
        for inertias in (1, 3):
            flat = four_square(inertias=inertias)
            assert [q.name for q in flat.states if q.unit == "rad/s"] == ["rotor_0.w"]
            run = simulate(flat, duty, values={"rotor_0.J": 0.05 * 5.5} if inertias == 1 else {})
            assert run.audit.residual < 1e-6
            speeds[inertias] = run["rotor_0.w"][-1]
        assert speeds[1] > 100.0
        assert speeds[3] == pytest.approx(speeds[1], rel=1e-3)


MISMATCH = ["clutch", "does not close", "2175 rpm", "2416.67 rpm", "product of the ratios"]


class TestRefused:
    def test_ratios_that_do_not_fit_are_refused_by_name(self) -> None:
        flat, given = four_square(OTHER), {"motor.w": W, "clutch.tau": 183.4}
        with pytest.raises(SolveError) as steadily:
            steady(flat, given)
        with pytest.raises(SolveError) as over_time:
            simulate(flat, join_phases([(5.0, given)]))
        with pytest.raises(SolveError) as sought:
            design(flat, ["cooler.G"], {"oil.T": 360.0}, given)
        for error in (steadily, over_time, sought):
            assert all(piece in str(error.value) for piece in MISMATCH), str(error.value)

    def test_so_are_those_of_parallel_paths(self) -> None:
        given = {"input.w": W, "output.tau": 300.0}  # the output turns backwards and is braked
        with pytest.raises(SolveError, match="clutch: the loop does not close"):
            steady(power_split(two=OTHER), given | {"clutch.tau": 100.0})
        with pytest.raises(SolveError, match="split: the loop does not close"):
            steady(power_split(0.5, OTHER), given)

    def test_a_clutch_between_shafts_that_nothing_else_couples_has_no_speed(self) -> None:
        ends = [part("ShaftEnd", "a", given=("w",)), part("ShaftEnd", "b")]
        nets = (("a.flange", "clutch.a"), ("b.flange", "clutch.b"))
        with pytest.raises(StructureError, match=r"b\.w"):
            flatten(Assembly("open", "", (*ends, part("LoadingClutch", "clutch")), nets))


class TestParallelPaths:
    given = {"input.w": W, "output.tau": 300.0}  # the output turns backwards and is braked

    def test_a_clutch_says_what_its_path_carries(self) -> None:
        found = steady(power_split(), self.given | {"clutch.tau": 50.0})
        assert float(found["input.tau"][0]) == pytest.approx(200.0, rel=0.02)
        assert float(found["one.P_loss"][0]) < 0.4 * float(found["two.P_loss"][0])
        assert found.audit.residual < 1e-9

    @pytest.mark.parametrize("share", [0.3, 0.5, 1.0])
    def test_a_split_carries_its_share(self, share: float) -> None:
        found = steady(power_split(share), self.given)
        whole = float(found["input.tau"][0])
        assert whole == pytest.approx(200.0, rel=0.02)
        clutched = steady(power_split(), self.given | {"clutch.tau": share * whole})
        for name in ("input.tau", "one.P_loss", "two.P_loss"):
            assert float(clutched[name][0]) == pytest.approx(float(found[name][0]), rel=1e-6), name

    def test_equal_shares_lose_the_same(self) -> None:
        found = steady(power_split(0.5), self.given)
        assert float(found["one.P_loss"][0]) == pytest.approx(float(found["two.P_loss"][0]), rel=1e-9)
