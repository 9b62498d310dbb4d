"""Several gears in one sump: what they throw leaves less for all of them, walls brake in thick oil, air makes light."""

import pytest
from bearing_rig import without_level
from gearheat.model.errors import StructureError
from gearheat.model.laws.gear_churning import gear_churning_torque
from gearheat.model.machines.spec import PartSpec
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

WHEEL = dict(count=1, inner_share=1, b=0.05, m_n=0.003)
STANDING = dict(level=-0.06, A_oil=0.08, width=0.4, height=0.2)


def run(speed: float, wheels: int = 2, **oil: float) -> dict[str, float]:
    """A sump of 4 l with a wheel on the output shaft and a smaller one on the middle shaft."""
    sizes = (("slow", "output.flange", 0.0957), ("fast", "stage_1.wheel", 0.0794))[:wheels]
    parts = [PartSpec(n, "GearChurning", WHEEL | {"r": r, "height": r - 0.0957}) for n, _, r in sizes]
    nets = [(f"{n}.shaft", shaft) for n, shaft, _ in sizes]
    nets += [(f"{n}.{port}", f"oil.{net}") for n, *_ in sizes for port, net in (("lubricant",) * 2, ("sump",) * 2)]
    nets += [(f"{n}.{port}", "oil.heat") for n, *_ in sizes for port in ("inner", "outer")]
    scenario = load("helical_two_stage")
    spec = without_level().with_parts(parts, nets).with_values({f"oil.{k}": v for k, v in oil.items()})
    found = steady(spec.flat(), scenario.operating_point | {"input.w": speed})
    return {name: float(values[0]) for name, values in found.columns.items()}


def test_the_level_falls_with_speed_and_every_gear_dips_less() -> None:
    depths = [run(w, in_motion=True, **STANDING) for w in (1.0, 150.0, 300.0, 600.0)]
    slow, fast = ([found[f"{name}.h"] for found in depths] for name in ("slow", "fast"))
    assert slow == sorted(slow, reverse=True)
    assert fast == sorted(fast, reverse=True)
    assert slow[0] == pytest.approx(run(1.0, level=-0.06)["slow.h"], rel=1e-4)
    assert slow[0] - slow[-1] == pytest.approx(fast[0] - fast[-1], rel=0.01)  # one level
    assert 1e-4 < 0.08 * (slow[0] - slow[-1]) < 2e-3  # of 4 l


def test_another_gear_in_the_sump_takes_oil_from_the_first() -> None:
    alone, both = (run(600.0, wheels=n, in_motion=True, **STANDING) for n in (1, 2))
    assert both["slow.h"] < alone["slow.h"] - 5e-4


def test_air_lifts_the_level_and_lightens_the_oil() -> None:
    pure, foaming = (run(1.0, in_motion=True, share_air=x, **STANDING) for x in (0.0, 0.1))
    assert foaming["slow.h"] - pure["slow.h"] == pytest.approx(4e-3 * 0.1 / 0.9 / 0.08, rel=0.01)


def test_a_level_that_moves_is_given() -> None:
    moving = {f"oil.{k}": v for k, v in STANDING.items() if k != "level"} | {"oil.in_motion": True}
    with pytest.raises(StructureError, match=r"oil is in_motion and has no level\. Give it"):
        without_level().with_values(moving).flat()


def test_a_wall_brakes_in_thick_oil_only() -> None:
    def torque(nu: float, **wall: float) -> float:
        return float(gear_churning_torque(30.0, 860.0, nu, 0.04, 2e-3, 0.08, 0.024, 0.003, **wall))

    assert torque(2e-3, gap=2e-3) > 2 * torque(2e-3)
    assert torque(2e-5, gap=8e-3) == pytest.approx(torque(2e-5), rel=0.01)
    near = [torque(1e-3, gap=gap) for gap in (0.016, 8e-3, 4e-3, 2e-3)]
    assert near == sorted(near)
