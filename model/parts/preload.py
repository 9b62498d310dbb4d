"""Bearings set against each other, with a preload that changes as shaft and housing warm."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

from ..core.component import Component, Equation, Faults, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.preload import axial_load_set_against, preload_force, preloaded_axial_load, thermal_interference
from .ports import BearingLoad, HeatPort, OwnThrust
from .supports import LOCATED


class PreloadedPair(Component):
    """Two equal bearings set against each other: their axial loads with a preload that follows the temperatures.

    It stands between a ShaftSupport, one bearing of which locates (`support_a`, `support_b`), and the bearings
    (`load_a`, `load_b`), whose own thrusts under a radial load it reads (`thrust_a`, `thrust_b`). A preload rises when
    the shaft warms against the housing face to face, and falls back to back where the bearings are far apart. A
    light-alloy housing changes it also where all is equally warm.
    """

    faults: ClassVar[Faults] = {"losses.pair_preload": {"F_set": 1.0}}

    inner = HeatPort("the shaft, whose temperature is sensed")
    outer = HeatPort("the housing, whose temperature is sensed")
    support_a = BearingLoad("what the shaft asks of bearing a")
    support_b = BearingLoad("what the shaft asks of bearing b")
    load_a = BearingLoad("what bearing a carries")
    load_b = BearingLoad("what bearing b carries")
    thrust_a = OwnThrust("how bearing a pushes the shaft along")
    thrust_b = OwnThrust("how bearing b pushes the shaft along")

    arrangement = Choice(("face-to-face", "back-to-back"), "how the bearings are set: X or O")
    contact = Choice(("rollers", "balls"), "what the bearings roll on")
    F_set = Parameter("N", "preload as set; negative: clearance times k", nominal=500.0)
    T_set = Parameter("K", "temperature at which it was set", nominal=293.15, above=0.0)
    k = Parameter("N/m", "axial stiffness of the pair with its seats: preload over interference", 1e8, above=0.0)
    span = Parameter("m", "distance of the bearings, centre to centre", nominal=0.1, above=0.0)
    d_m = Parameter("m", "mean diameter, (d + D)/2", nominal=0.1, above=0.0)
    alpha = Parameter("rad", "contact angle", nominal=0.25, above=0.0, below=1.5)
    alpha_s = Parameter("1/K", "thermal expansion coefficient of the shaft", nominal=1.2e-5, above=0.0)
    alpha_h = Parameter("1/K", "thermal expansion coefficient of the housing", nominal=1.2e-5, above=0.0)
    dx = Output("m", "interference by expansion, negative: clearance", nominal=1e-5)
    F_0 = Output("N", "preload without other axial load", nominal=500.0, at_least=0.0)

    def clashes(self, met: Mapping[str, Sequence[Component]]) -> Iterator[str]:
        """The shaft's statics have to leave to the pair how its bearings are set."""
        for part in met["support_a"]:
            if (told := part.choices.get("arrangement", LOCATED)) != LOCATED:
                yield (
                    f"{part.name} is {told} and {self.name} {self.arrangement}: both say how the bearings are set. "
                    f'Give {part.name} arrangement = "{LOCATED}", or leave {self.name} out.'
                )

    def equations(self) -> Iterator[Equation]:
        """Expansion makes the preload; preload and axial force make the loads."""
        span = self.span if self.arrangement == "face-to-face" else -self.span
        expansion = (self.T_set, self.alpha_s, self.alpha_h, self.d_m, self.alpha, span)
        n = 1.5 if self.contact == "balls" else 10 / 9
        a, b = self.support_a, self.support_b
        yield equation("shaft is sensed, not heated", self.inner.Q_flow, 0.0)
        yield equation("housing is sensed, not heated", self.outer.Q_flow, 0.0)
        yield equation("interference", self.dx, thermal_interference(self.inner.T, self.outer.T, *expansion))
        yield equation("preload", self.F_0, preload_force(self.F_set, self.k, self.dx))
        yield equation("bearing a radially", self.load_a.F_r, a.F_r)
        yield equation("bearing b radially", self.load_b.F_r, b.F_r)
        on_a, on_b = preloaded_axial_load(self.F_0, a.F_a, b.F_a, n), preloaded_axial_load(self.F_0, b.F_a, a.F_a, n)
        pushed_a, pushed_b = self.thrust_b.F + a.F_a - b.F_a, self.thrust_a.F + b.F_a - a.F_a
        yield equation("bearing a axially", self.load_a.F_a, axial_load_set_against(on_a, pushed_a))
        yield equation("bearing b axially", self.load_b.F_a, axial_load_set_against(on_b, pushed_b))
