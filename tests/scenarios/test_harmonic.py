"""The harmonic drive: its printed film and admissible speeds, the regime of its contact, and the physical machine."""

import math

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError, SolveError
from gearheat.model.run.design import design
from gearheat.model.run.result import Result
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

RPM = math.pi / 30


def flat_of(rig: str, **choices: str) -> FlatModel:
    return load(rig).spec.with_values({f"mesh.{k}": v for k, v in choices.items()}).flat()


@pytest.fixture(scope="module")
def printed() -> FlatModel:
    return flat_of("harmonic_printed")


@pytest.fixture(scope="module")
def physical() -> FlatModel:
    return flat_of("harmonic")


class TestPrinted:
    def test_the_film_is_that_of_the_formula(self, printed: FlatModel) -> None:
        assert steady(printed, {})["mesh.h_min"][0] == pytest.approx(1.2651e-6, rel=1e-4)
        by_hand = 1.6 * 2e-8**0.6 * (0.06 * 0.03005965) ** 0.7 * 358.7e9**0.03 * 32.585**0.43 * (0.012 / 240) ** 0.13
        assert steady(printed, {})["mesh.h_min"][0] == pytest.approx(by_hand, rel=1e-5)

    @pytest.mark.parametrize("F_0", [240.0, 120.0, 60.0])
    @pytest.mark.parametrize("eta_0", [0.06, 0.295])
    @pytest.mark.parametrize("speed_factor", [1.0, 2.0, 0.5])
    def test_the_admissible_speed_is_a_design(
        self, printed: FlatModel, F_0: float, eta_0: float, speed_factor: float
    ) -> None:
        """h rises with speed and viscosity to the power 0.7 and falls with the load to the power 0.13."""
        values = {"mesh.F_0": F_0, "mesh.eta_0": eta_0, "mesh.speed_factor": speed_factor}
        found = design(printed, ["wave_generator.w"], {"mesh.h_min": 0.88e-6}, values)
        at_1000 = 1.265126e-6 * (eta_0 / 0.06) ** 0.7 * (240 / F_0) ** 0.13
        expected = 1000 * RPM * (0.88e-6 / at_1000) ** (1 / 0.7) / speed_factor
        assert found.values["wave_generator.w"] == pytest.approx(expected, rel=1e-4)

    def test_the_contact_is_named_with_its_regime(self, printed: FlatModel) -> None:
        duty = join_phases([(600.0, {q.name: q.start for q in printed.inputs})])
        for result in (steady(printed, {}), simulate(printed, duty, times=np.array([0.0, 600.0]))):
            (found,) = [o for o in result.outside if o.regime]
            assert (found.component, found.argument) == ("mesh", "rigid_isoviscous")
            assert found.regime.startswith("rigid-isoviscous (g_V = 0.0409, g_E = 0.138)")

    def test_a_hard_loaded_small_contact_is_elastohydrodynamic(self, printed: FlatModel) -> None:
        """Radius and line load of a gear: inside; with soft flanks and little load, elastic and isoviscous."""
        gear = {"mesh.R": 0.01, "mesh.F_0": 6000.0}
        assert not [o for o in steady(printed, gear).outside if o.regime]
        (soft,) = [o for o in steady(printed, gear | {"mesh.E_eff": 5e6, "mesh.F_0": 20.0}).outside if o.regime]
        assert soft.regime.startswith("elastic-isoviscous")

    def test_the_wedge_alone_is_thin(self) -> None:
        flat = flat_of("harmonic_printed", film="pad")
        for F_0, h in ((240.0, 0.165), (120.0, 0.234), (60.0, 0.331)):
            assert 1e6 * steady(flat, {"mesh.F_0": F_0})["mesh.h_min"][0] == pytest.approx(h, abs=1e-3)
        four = steady(flat, {"wave_generator.w": 4000 * RPM})["mesh.h_min"][0]
        assert four == pytest.approx(2 * steady(flat, {})["mesh.h_min"][0], rel=1e-4)

    def test_moes_knows_rigid_flanks(self) -> None:
        found = steady(flat_of("harmonic_printed", film="moes"), {})
        assert found["mesh.h_min"][0] == pytest.approx(found["mesh.h_rigid"][0], rel=0.01)

    def test_a_film_that_no_speed_reaches_is_refused(self, printed: FlatModel) -> None:
        with pytest.raises(SolveError, match=r"mesh\.h_min reaches .* out of reach"):
            design(printed, ["wave_generator.w"], {"mesh.h_min": 0.088}, {})

    def test_a_contact_without_load_or_a_bad_flank_is_refused(self, printed: FlatModel) -> None:
        with pytest.raises(ScenarioError, match=r"mesh\.F_0 = 0 N is out of range"):
            steady(printed, {"mesh.F_0": 0.0})
        with pytest.raises(ScenarioError, match="r_concave is larger than r_convex"):
            steady(printed, {"mesh.r_convex": 0.0192307, "mesh.r_concave": 0.0192194})


class TestPhysical:
    def test_ratio_and_losses(self, physical: FlatModel) -> None:
        found = steady(physical, {})
        assert found["wave_generator.w"][0] / found["output.w"][0] == pytest.approx(-66.0, rel=1e-12)
        assert 0.75 < found["efficiency.eta"][0] < 0.95
        losses = {q.name: found[q.name][0] for q in physical.outputs if q.name.endswith(".P_loss")}
        del losses["efficiency.P_loss"]
        assert max(losses, key=lambda name: losses[name]) == "wave_bearing.P_loss"
        assert found["mesh.v_slide"][0] == pytest.approx(0.0614, abs=5e-5)
        assert found["mesh.F_0"][0] == pytest.approx(120.0, rel=0.03)

    def test_the_film_balances_wedge_and_squeeze(self, physical: FlatModel) -> None:
        """The squeezed oil carries most of it; without it the film is that of the wedge."""
        here, wedge = steady(physical, {}), steady(physical, {"mesh.approach": 0.0})
        assert here["mesh.h_min"][0] > 2 * wedge["mesh.h_min"][0]
        assert here["mesh.Lambda_Rz"][0] == pytest.approx(here["mesh.h_min"][0] / 0.8e-6)

    def test_it_can_be_driven_from_either_side_or_hold(self) -> None:
        """As a multiplier the output drives; a light torque at the output does not turn it."""
        spec = load("harmonic").spec.driven({"output": ("w", "tau")})
        found = steady(spec.flat(), {"output.w": 15 * RPM, "output.tau": 180.0, "room.T": 293.15})
        assert found["output.P"][0] > -found["wave_generator.P"][0] > 0

    def test_the_circular_spline_may_turn_instead(self) -> None:
        """With the flexspline held the circular spline follows the wave generator at 1/67."""
        spec = load("harmonic").spec
        swap = {"mesh.flexspline": "mesh.circular_spline", "mesh.circular_spline": "mesh.flexspline"}
        turned = tuple(tuple(swap.get(port, port) for port in net) for net in spec.connections)
        flat = type(spec)(spec.name, spec.doc, spec.parts, turned).flat()
        found: Result = steady(flat, {"output.tau": -180.0})
        assert found["wave_generator.w"][0] / found["output.w"][0] == pytest.approx(67.0, rel=1e-12)

    def test_more_teeth_of_the_wrong_spline_are_refused(self, physical: FlatModel) -> None:
        with pytest.raises(ScenarioError, match="z_2 is two more than z_1"):
            steady(physical, {"mesh.z_2": 130.0})
