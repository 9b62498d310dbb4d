"""Gear pairs as rating methods see them."""

import math

import pytest
from gearheat.model.parts import PARTS
from gearheat.model.parts.equivalent import pair_of
from gearheat.model.parts.gears import HelicalGearPair

GIVEN = dict(z_1=20, z_2=77, m_n=0.002, alpha_n=math.radians(20), beta=math.radians(14.069868), b=0.032, a_w=0.1)
GIVEN |= dict(x_1=0.0, x_2=0.0, Ra=5e-7, k_mu=1.0, line_load="F_bn/l", E=206e9, poisson=0.3)


class Cones(HelicalGearPair):
    """Gears of which others stand for the mesh, as bevel gears do."""

    def teeth(self):
        return 2 * self.z_1, 3 * self.z_2


class Ring(HelicalGearPair):
    """An internal gear."""

    def teeth(self):
        return self.z_1, -self.z_2


def test_a_helical_pair_is_its_own():
    part = HelicalGearPair("stage", **GIVEN)
    pair = pair_of(part)
    assert pair.outsides == pytest.approx(pair.tips)
    assert sum(pair.pitches) / 2 == pytest.approx(0.1)
    assert sum(pair.contact_ratios) == pytest.approx(part.values["eps_alpha"])
    assert pytest.approx(float(part.number_at(part.contact(1.6, part.z_1, part.z_2).R, part.values))) == pair.R


def test_equivalent_gears_mesh_and_real_gears_dip():
    real, pair = pair_of(HelicalGearPair("stage", **GIVEN)), pair_of(Cones("stage", **GIVEN | {"a_w": 0.1}))
    assert (pair.z_1, pair.z_2, pair.u) == (40, 231, 231 / 40)
    assert pair.diameters == real.diameters and pair.tips == real.tips
    assert pair.references == pytest.approx((2 * real.references[0], 3 * real.references[1]))


def test_internal_gears_and_other_parts_are_none():
    assert pair_of(Ring("stage", **GIVEN)) is None
    assert pair_of(PARTS["FixedFlange"]("held")) is None
