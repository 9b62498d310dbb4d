"""Gear pairs as rating methods see them."""

import math

import pytest
from gearheat.model.parts import PARTS
from gearheat.model.parts.equivalent import pair_of
from gearheat.model.parts.gears import HelicalGearPair
from parts.test_pairs import BEVEL, RING

GIVEN = dict(z_1=20, z_2=77, m_n=0.002, alpha_n=math.radians(20), beta=math.radians(14.069868), b=0.032, a_w=0.1)
GIVEN |= dict(x_1=0.0, x_2=0.0, Ra=5e-7, k_mu=1.0, line_load="F_bn/l", E=206e9, poisson=0.3)


def test_a_helical_pair_is_its_own():
    part = HelicalGearPair("stage", **GIVEN)
    pair = pair_of(part)
    assert pair.outsides == pytest.approx(pair.tips)
    assert sum(pair.pitches) / 2 == pytest.approx(0.1)
    assert sum(pair.contact_ratios) == pytest.approx(part.values["eps_alpha"])
    assert pytest.approx(float(part.number_at(part.contact(1.6, part.z_1, part.z_2).R, part.values))) == pair.R


def test_equivalent_gears_mesh_and_real_gears_dip():
    pair = pair_of(PARTS["BevelGearPair"]("stage", **BEVEL))
    assert pair.z_1 > BEVEL["z_1"] and pair.z_2 > BEVEL["z_2"]
    assert pair.u == pytest.approx((BEVEL["z_2"] / BEVEL["z_1"]) ** 2)  # at right angles
    assert pair.diameters[1] / pair.diameters[0] == pytest.approx(BEVEL["z_2"] / BEVEL["z_1"])
    assert pair.references[0] > pair.diameters[0]


def test_internal_gears_and_other_parts_are_none():
    assert pair_of(PARTS["InternalGearPair"]("stage", **RING)) is None
    assert pair_of(PARTS["FixedFlange"]("held")) is None
