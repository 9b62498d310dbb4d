"""Bearings without load: their load alone brakes them, or what their maker asks for, or what Palmgren measured."""

import math

import pytest
from gearheat.model.parts import PARTS

#: A 6306 above the oil level, in oil of 220 mm2/s at 1450 rpm.
BEARING = dict(count=1.0, inner_share=0.5, d=0.030, D=0.072, F_r_0=0.0, F_a_0=0.0, K_rs=0.0, K_Z=3.1, C_0=16e3)
BEARING |= dict(R_1=3.7e-7, R_2=1.7, S_1=2.84e-3, S_2=92.8, mu_bl=0.12, mu_EHL=0.05, oil_bath=False)
RUNNING = {"shaft.w": 1450 * math.pi / 30, "lubricant.nu": 220e-6, "load.F_a": 0.0, "mu_sl": 0.05}


def moment(F_r: float, **choice: object) -> float:
    """Rolling moment [N.m] under a radial load [N]."""
    part = PARTS["DeepGrooveBallBearing"]("bearing", **BEARING, **choice)
    rolling = next(e for e in part.equations() if e.name == "rolling moment")
    return float(part.number_at(rolling.rhs, part.values | RUNNING | {"load.F_r": F_r}))


def test_an_unloaded_bearing_runs_as_under_its_minimum_load() -> None:
    """0.025 (319)^(2/3) 0.51^2 = 303.6 N."""
    assert moment(0.0, idle="minimum load", k_r=0.025) == pytest.approx(moment(303.58), rel=1e-3)
    assert moment(3000.0, idle="minimum load", k_r=0.025) == pytest.approx(moment(3000.0), rel=1e-6)


def test_an_unloaded_bearing_has_the_moment_of_palmgren() -> None:
    """1e-7 x 2 (319000)^(2/3) 51^3 N.mm = 123.9 N.mm; of its load alone it has nothing."""
    assert moment(0.0) < 1e-3
    assert moment(0.0, idle="M_0", f_0=2.0) == pytest.approx(0.12386, rel=1e-3)
    assert moment(20e3, idle="M_0", f_0=2.0) == pytest.approx(moment(20e3), rel=1e-2)
