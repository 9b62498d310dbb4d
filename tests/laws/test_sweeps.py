"""Every law over the range of each argument, 100 points: no step, no kink, monotone where `monotone.toml` says so."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from for_each import for_each
from laws.test_every_law import FUNCTIONS, nominal, symbolic, vector

#: Points over the range of an argument.
POINTS = 100
#: Narrowest corner that is rounded, and smallest one that counts: over the range of the argument or the law.
NARROWEST = 1e-6
#: Share of a corner's change of slope that is left within `NARROWEST`: a true kink keeps all of it.
LEFT = 0.3
#: Range of temperatures without a declared one [K].
WARM = (243.15, 423.15)
#: How far either side of `NOMINAL` an argument goes that has no declared range: what a machine does, and what it is.
FAR, NEAR = 30.0, 1.03
OPERATION = {"w", "v", "v_sum", "u_sum", "v_slide", "w_rel", "w_in", "m_flow", "Q", "dp", "P", "tau", "slide_roll"}
OPERATION |= {"F_r", "F_a", "F_bt", "F_bn", "F_n_l", "F_t", "F_n", "F", "F_N", "P_1", "P_a", "line_load"}
OPERATION |= {"nu", "eta_oil", "eta_0", "Re", "Ra", "Pr", "M", "L", "U", "W", "Lambda"}
#: Range of an argument whose declared one has a gap.
OWN_RANGE = {
    "drum.power_law_exponent.T_oil": (333.15, 393.15),  # 0/0 at 50 degC, which is the law's reference
    "mesh.tooth_loss_factor.eps_1": (0.3, 2.0),  # no contact ratio below 1 in all
    "mesh.tooth_loss_factor.eps_2": (0.3, 2.0),
}
#: Kinks that their sources print, of numbers that no equation of a model is solved with.
PRINTED = {
    "mesh.tooth_loss_factor": "whole numbers of pairs of teeth",
    "regimes.elastohydrodynamic": "the largest of three leads",
    "tooth_flanks.load_share": "from two pairs of teeth to one",
    "tooth_flanks.contact_ratio_factor": "where one addendum contact ratio reaches 1",
}
MONOTONE = {
    f"{module}.{name}": {word[1:]: word[0] for word in words.split()}
    for module, laws in tomllib.loads((Path(__file__).parent / "monotone.toml").read_text("utf-8")).items()
    for name, words in laws.items()
}
#: Largest step against the declared direction over the largest value: roundings of 1e-9; the blend of this law
#: of two exponents of d_m goes back by that little in F_r where the axial load carries.
SLACK = {"rolling.dgb_sliding_variable": 1e-7}


def places(name: str, argument: str) -> np.ndarray:
    """The points of an argument: its declared range, else what a machine meets; by factors where it spans decades."""
    info, value = getattr(FUNCTIONS[name], "law", None), nominal(name)[argument]
    declared = info.ranges.get(argument) if info else None
    around = FAR if argument in OPERATION else NEAR
    low, high = OWN_RANGE.get(f"{name}.{argument}") or declared or sorted((value / around, value * around))
    if declared is None and (argument == "T" or argument.startswith("T_")):
        low, high = WARM
    low = low or NARROWEST * high
    return np.geomspace(low, high, POINTS) if low > 0 and high / low > POINTS else np.linspace(low, high, POINTS)


def sweep(name: str, argument: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, and values and slopes of every result there."""
    function, free = symbolic(name)
    x, i = places(name, argument), free.index(argument)
    points = np.tile(vector(name, nominal(name), free)[:, None], len(x))
    points[i] = x
    values, slopes = (found.full() for found in function(points))  # a column a point, and a Jacobian a point
    return x, values, slopes.reshape(len(values), len(x), len(free))[:, :, i]


def kink(name: str, argument: str, x: np.ndarray, slopes: np.ndarray, result: int) -> float:
    """Largest share of a change of slope that is left within the narrowest corner; bisects towards the larger half."""
    function, free = symbolic(name)
    i, worst, span = free.index(argument), 0.0, x[-1] - x[0]
    values = nominal(name)

    def slope(at: float) -> float:
        return float(function(vector(name, values | {argument: at}, free))[1][result, i])

    change = np.abs(np.diff(slopes))
    beside = np.convolve(np.pad(change, 1, mode="edge"), (1, 0, 1), mode="valid") + 1e-300
    for k in {
        *np.argsort(change)[-3:],
        *np.argsort(change / beside)[-3:],
    }:  # where it is largest, and where it stands out
        a, b, s_a, s_b = x[k], x[k + 1], slopes[k], slopes[k + 1]
        most, end = abs(s_b - s_a), NARROWEST * min(span, POINTS * (b - a))
        while b - a > end:
            middle = (a + b) / 2
            s = slope(middle)
            a, b, s_a, s_b = (middle, b, s, s_b) if abs(s - s_a) < abs(s_b - s) else (a, middle, s_a, s)
            most = max(most, abs(s_b - s_a))
        if most > NARROWEST * np.abs(slopes).max():
            worst = max(worst, abs(s_b - s_a) / most)
    return worst


@for_each(FUNCTIONS)
def test_no_step_and_no_kink(name: str) -> None:
    for argument in symbolic(name)[1]:
        x, values, slopes = sweep(name, argument)
        assert np.isfinite(values).all(), argument
        assert np.isfinite(slopes).all(), argument
        for result, (y, s) in enumerate(zip(values, slopes, strict=True)):
            if np.ptp(s) * (x[-1] - x[0]) > NARROWEST * np.abs(y).max() and name not in PRINTED:
                assert kink(name, argument, x, s, result) < LEFT, argument


@for_each(MONOTONE)
def test_more_is_more(name: str) -> None:
    for argument, sign in MONOTONE[name].items():
        x, values, _ = sweep(name, argument)
        forward = values[0][x >= 0 if x[0] == -x[-1] else slice(None)]  # of an argument of either sign one half
        steps = np.diff(forward) * (1 if sign == "+" else -1)
        assert steps.min() >= -SLACK.get(name, 1e-9) * np.abs(values[0]).max(), (argument, sign)
        assert steps.max() > 0, argument


def test_a_kink_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The drag of a bearing has no kink in its viscosity; with a corner of a tenth of its slope it has."""
    name = "rolling.drag_torque_ball"
    x, _, slopes = sweep(name, "nu")
    assert kink(name, "nu", x, slopes[0], 0) < LEFT
    function, free = symbolic(name)
    middle = float(np.median(x))
    i = free.index("nu")

    def bent(point: np.ndarray) -> tuple[object, np.ndarray]:
        y, s = function(point)
        s = s.full()
        s[0, i] *= 1.1 if point[i] > middle else 1.0
        return y, s

    monkeypatch.setattr(f"{__name__}.symbolic", lambda _: (bent, free))
    assert kink(name, "nu", x, np.where(x > middle, 1.1, 1.0) * slopes[0], 0) > LEFT
