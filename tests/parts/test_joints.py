"""Conductances of joints, feet and bearings: from their geometry, or given."""

from __future__ import annotations

import math

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.run.rows import evaluate_at
from one_part import EXAMPLES, PARTS, between_sources

FOOT = EXAMPLES["FootConductor"]


def G_of(kind: str, **values: float) -> float:
    part = PARTS[kind]("part", **values)
    return part.number_at(part.conductance(), part.values)


def test_a_floor_of_concrete_is_the_resistance_of_a_foot() -> None:
    """A disc on a half-space is 4 k r; bolts and faces conduct a hundred times as much."""
    floor = 4 * 1.4 * math.sqrt(0.09 / math.pi)
    assert 0.98 * floor < G_of("FootConductor", **FOOT) < floor


def test_a_frame_is_a_fin() -> None:
    m = math.sqrt(2 * 10.0 / (45.0 * 0.016))
    fin = 10.0 * 0.2 * math.tanh(0.1 * m) / (0.1 * m)
    assert 0.97 * fin < G_of("FrameConductor", **EXAMPLES["FrameConductor"]) < fin


def test_paint_and_bolts_are_side_by_side() -> None:
    joint = EXAMPLES["JointConductor"]
    bare, painted = G_of("JointConductor", **joint | {"count": 0.0}), G_of("JointConductor", **joint)
    assert bare == pytest.approx(0.026 * 0.03 / 2e-4)
    metal = 4 * math.pi / 4 * (3**2 - 1.1**2) * 0.012**2
    assert painted == pytest.approx(
        bare * (1 - metal / 0.03) + metal * 1.25 * 45 * 0.15 / 3e-6 * (296e6 / 6.118 / 2e9) ** 0.95, rel=1e-3
    )


@pytest.mark.parametrize("kind", ["JointConductor", "FootConductor", "FrameConductor"])
def test_a_known_conductance_stands_for_the_geometry(kind: str) -> None:
    assert G_of(kind, G=2.5) == 2.5
    assert G_of(kind, **EXAMPLES[kind] | {"G": 2.5, "k_G": 2.0}) == 5.0


def test_more_bolts_than_fit_are_refused() -> None:
    with pytest.raises(ScenarioError, match="area that the bolts press over A"):
        PARTS["JointConductor"]("flange", **EXAMPLES["JointConductor"] | {"count": 50.0})
    with pytest.raises(ScenarioError, match="diameter of a ball"):
        PARTS["BearingConductor"]("seat", **EXAMPLES["BearingConductor"] | {"D_w": 0.03})


def test_a_bearing_conducts_as_much_as_its_balls_and_more_as_it_turns() -> None:
    """A 6308: about 2 W/K, of which balls are the resistance; a loose ring in air takes a tenth of it."""

    def G(w: float, **values: float) -> float:
        flat = between_sources("BearingConductor", **values)
        inputs = [w if q.name == "shaft.w" else 300.0 for q in flat.inputs]
        found = evaluate_at(flat, [], inputs, flat.starts("parameter"))
        return float(found["y"][[q.name for q in flat.outputs].index("part.G")])

    assert G(0.0) < G(5.0) < G(150.0)
    assert G(-5.0) == pytest.approx(G(5.0))
    assert 1.5 < G(39.5) < 2.5
    assert G(39.5, G_balls=1.0) == pytest.approx(G(0.0, G_balls=1.0)) == pytest.approx(0.97, abs=0.03)
    assert 0.8 * G(39.5) < G(39.5, gap=20e-6, k_gap=0.026) < G(39.5)
