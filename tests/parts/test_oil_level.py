"""One oil level for a housing: gears dip by it, and churn the more the deeper they dip."""

import itertools

import casadi as ca
import pytest
from bearing_rig import without_level
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import StructureError
from gearheat.model.laws.gear_churning import gear_churning_torque, immersion
from gearheat.model.machines.spec import PartSpec, assemble
from gearheat.model.run.rows import evaluate_at

#: The wheel of the second stage, its axis at the origin of heights.
WHEEL = dict(count=1, inner_share=1, r=0.0957, b=0.05, m_n=0.003, height=0.0)
NETS = (
    ("wheel.shaft", "output.flange"),
    ("wheel.inner", "wheel.outer", "oil.heat"),
    ("wheel.lubricant", "oil.lubricant"),
    ("wheel.sump", "oil.sump"),
)


def with_wheel(**oil: float):
    spec = without_level().with_parts((PartSpec("wheel", "GearChurning", WHEEL),), NETS)
    return assemble(spec.with_values({f"oil.{k}": v for k, v in oil.items()}))


def test_a_gear_dips_by_the_level_of_its_housing() -> None:
    flat = flatten(with_wheel(level=-0.05))
    p = flat.starts("parameter")
    level = flat.locate("oil.level")[1]
    found = []
    for height in (-0.2, -0.09, -0.05, 0.0):
        p[level] = height
        y = evaluate_at(flat, flat.starts("state"), flat.starts("input"), p)["y"]
        found.append(dict(zip([q.name for q in flat.outputs], y.tolist(), strict=True))["wheel.h"])
    assert found == pytest.approx([0.0, 5.9e-3, 45.7e-3, 95.5e-3], abs=2e-4)


def test_without_a_level_the_way_out_is_said() -> None:
    with pytest.raises(StructureError, match=r"oil\.sump.*Give the OilBath a level"):
        flatten(with_wheel())


def churning(w: float, nu: float, h: float) -> float:
    return float(gear_churning_torque(w, 860.0, nu, h, 2e-3, 0.08, 0.024, 0.003))


def test_a_gear_above_the_oil_has_next_to_no_churning() -> None:
    above, dipping = immersion(-0.12, 0.0, 0.08), immersion(-0.04, 0.0, 0.08)
    for w in (10.0, 100.0, 500.0):
        assert churning(w, 5e-5, above) < 1e-4 * churning(w, 5e-5, dipping)


def test_deeper_faster_and_thicker_never_churns_less() -> None:
    for w, nu in itertools.product((1.0, 50.0, 200.0, 250.0, 600.0), (5e-6, 5e-5, 1e-3)):
        deeper = [churning(w, nu, h) for h in (0.0, 0.01, 0.04, 0.08)]
        assert deeper == sorted(deeper)
        assert churning(1.1 * w, nu, 0.04) > deeper[2]
        assert churning(w, 2 * nu, 0.04) >= deeper[2]


def test_depth_is_smooth_at_the_surface_and_when_submerged() -> None:
    level = ca.SX.sym("level")
    slope = ca.Function("slope", [level], [ca.jacobian(immersion(level, 0.0, 0.08), level)])
    values = [float(slope(x / 5e4)) for x in (*range(-4300, -3700), *range(3700, 5000))]
    assert max(abs(b - a) for a, b in itertools.pairwise(values[:600])) < 0.02
    assert min(values) > 0 and max(values) <= 1 + 1e-9


def drag(own: dict[str, float], nets: tuple[tuple[str, ...], ...] = ()) -> float:
    """Friction torque of a bearing on the output shaft with its axis at the origin of heights, dipping by 20 mm."""
    spec = without_level().with_values({"oil.level": 0.02 - 0.5 * 0.0775 - 0.15 * 0.045})
    values = {k: v for k, v in spec.part("output_bearing_a").values.items() if k != "oil_bath"} | own
    nets = (("bath.shaft", "output.flange"), ("bath.inner", "bath.outer", "oil.heat"), *nets)
    nets += (("bath.lubricant", "oil.lubricant"), ("bath.load", "output_support.load_a"))
    flat = spec.with_parts((PartSpec("bath", "DeepGrooveBallBearing", values),), nets).flat()
    y = evaluate_at(flat, flat.starts("state"), [100.0 for _ in flat.inputs], flat.starts("parameter"))["y"]
    return float(y[[q.name for q in flat.outputs].index("bath.tau_loss")])


def test_a_bearing_dips_by_the_level_of_its_housing() -> None:
    """SKF 6211: d_m = 77.5 mm, balls of 0.3 (D - d) = 13.5 mm."""
    of_housing = drag({"height": 0.0}, (("bath.sump", "oil.sump"),))
    assert of_housing == pytest.approx(drag({"H": 0.02}), rel=1e-4)
    assert of_housing > drag({"H": 0.0})


def test_a_bearing_that_knows_its_height_needs_the_level() -> None:
    with pytest.raises(StructureError, match=r"bath\.sump.*Connect it to the sump of an OilBath with a level"):
        drag({"height": 0.0})
