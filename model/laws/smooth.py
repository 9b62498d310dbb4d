"""Smooth stand-ins for |x|, sign, max and min, for floats and CasADi expressions alike.

Every one of them has a width: the size of x over which the corner is rounded. Far from the corner the relative
deviation falls as (width/x)^2, so a width of a thousandth of the nominal value is invisible. Two rules for users:

- under a power below 1 take `smooth_abs`, which is never zero, so value and slope stay finite at x = 0;
- where a loss must vanish with x take `smooth_magnitude` or `smooth_power`, or multiply a magnitude by
  `friction_sign(w)`: the power w * friction_sign(w) is never negative, and a shaft at rest is held.
"""

from __future__ import annotations

import math
from typing import Any

import casadi as ca

#: A float or a CasADi expression.
Num = Any

#: Width [rad/s] of every rounding in a magnitude of speed: 0.1 rpm, so 100 rpm is met to 5e-7.
SPEED_WIDTH = 1e-2
#: Of a speed along a surface [m/s].
V_WIDTH = 1e-3
#: Of the speed at which surfaces draw oil in [m/s].
U_WIDTH = 1e-4
#: Of that speed where it sorts a contact into its regime [m/s].
SLOW_WIDTH = 1e-6
#: Of a force [N].
F_WIDTH = 1.0
#: Of a force per length of contact line [N/m].
LINE_WIDTH = 10.0

#: Speed [rad/s] at which friction holds against its full torque: what a shaft at rest creeps with at most, 5e-4 rpm.
#: Not far below the error that a solver tolerates in a speed: much narrower, it oscillates about rest in tiny steps.
HOLD_WIDTH = 5e-5


def smooth_abs(x: Num, width: float = SPEED_WIDTH) -> Num:
    r""":math:`\sqrt{x^2 + width^2}`, in the unit of x: never zero, even, exact to (width/x)^2/2 far from zero.

    Args:
        x: any quantity
        width: size of x over which the corner is rounded, in its unit
    """
    return ca.sqrt(x * x + width * width)


def smooth_sign(x: Num, width: float = SPEED_WIDTH) -> Num:
    """The slope of `smooth_abs`: odd, zero at x = 0, between -1 and 1; x * smooth_sign(x) is never negative.

    Args:
        x: any quantity
        width: size of x over which the corner is rounded, in its unit
    """
    return x / smooth_abs(x, width)


def friction_sign(w: Num, width: float = HOLD_WIDTH, sharpness: int = 8) -> Num:
    r""":math:`(w/width) (1 + (w/width)^s)^{-1/s}`: the share of its torque with which friction opposes a rotation.

    Odd, between -1 and 1, and all but linear within the width, so that a shaft under less than its breakaway torque
    stays at rest but for a creep below the width: a rounded sign like `smooth_sign` lets it creep at several widths.

    Args:
        w: speed of the shaft, either direction [rad/s]
        width: speed at which the full torque is all but reached [rad/s]
        sharpness: exponent s, even
    """
    x = w / width
    return x * (1 + x**sharpness) ** (-1 / sharpness)


def smooth_magnitude(x: Num, width: float = SPEED_WIDTH) -> Num:
    """x * smooth_sign(x), in the unit of x: zero at x = 0, even, never above |x|.

    Args:
        x: any quantity
        width: size of x over which the corner is rounded, in its unit
    """
    return x * smooth_sign(x, width)


def smooth_positive(x: Num, width: float = SPEED_WIDTH) -> Num:
    """x where it is positive, next to nothing where it is not, in the unit of x: zero at x = 0, never against its sign.

    Args:
        x: any quantity
        width: size of x over which the corner is rounded, in its unit
    """
    return x * (1 + smooth_sign(x, width)) / 2


def smooth_power(x: Num, exponent: Num, width: float = SPEED_WIDTH) -> Num:
    """|x|^exponent as x^2 (x^2 + width^2)^(exponent/2 - 1): even, zero with zero slope at x = 0; exponent above 0.

    Args:
        x: any quantity
        exponent: above 0 [1]
        width: size of x over which the corner is rounded, in its unit
    """
    return x * x * (x * x + width * width) ** (0.5 * exponent - 1)


def smooth_max(a: Num, b: Num, width: float) -> Num:
    """The larger of two, in their unit: never below either, above it by at most width/2, where they are equal.

    Args:
        a: any quantity
        b: the other one, in the same unit
        width: size of their difference over which the corner is rounded, in their unit
    """
    return 0.5 * (a + b + smooth_abs(a - b, width))


def smooth_min(a: Num, b: Num, width: float) -> Num:
    """The smaller of two, in their unit: never above either, below it by at most width/2, where they are equal.

    Args:
        a: any quantity
        b: the other one, in the same unit
        width: size of their difference over which the corner is rounded, in their unit
    """
    return 0.5 * (a + b - smooth_abs(a - b, width))


def smooth_cap(x: Num, limit: Num, sharpness: float = 8.0) -> Num:
    r""":math:`x (1 + (x/limit)^s)^{-1/s}`, in the unit of x: x far below the limit, the limit far above it.

    For positive quantities that span decades: the relative deviation is (x/limit)^s / s below the limit, and rises
    to 1 - 2^(-1/s) at it. Rising in x and in the limit, never above either.

    Args:
        x: the quantity, not negative
        limit: what it does not exceed, above 0
        sharpness: exponent s; the cap takes hold within a factor of about 10^(1/s) of the limit
    """
    return x * (1 + (x / limit) ** sharpness) ** (-1 / sharpness)


def to_rpm(w: Num) -> Num:
    """Angular velocity [rad/s] in revolutions per minute."""
    return w * (30 / math.pi)
