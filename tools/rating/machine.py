"""What a rating method needs of a rig at its operating point: gear pairs, bearings, seals, housing, oil."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ...model.core.component import Component
from ...model.laws.oil import density, kinematic_viscosity
from ...model.parts.equivalent import CylindricalPair


@dataclass(frozen=True)
class Mesh:
    """A gear pair at work: tangential force [N], speeds of its shafts [rad/s], depths to which its gears dip [m]."""

    name: str
    pair: CylindricalPair
    F_t: float
    w: tuple[float, float]
    dips: tuple[float, float]

    @property
    def v(self) -> float:
        """Speed at the reference diameter, where the force acts [m/s]."""
        return abs(self.w[0]) * self.pair.diameters[0] / 2


@dataclass(frozen=True)
class Turning:
    """A bearing or a contact seal at work: the part, its speed [rad/s], loads of a bearing from the gears [N]."""

    part: Component
    w: float
    F_r: float = 0.0
    F_a: float = 0.0


@dataclass(frozen=True)
class Untreated:
    """A part for which a method has no rule, and what it does in the model [W]."""

    part: str
    type: str
    why: str
    power: float


@dataclass(frozen=True)
class Machine:
    """A rig at its operating point.

    Args:
        surfaces: outer ones in the air
        oil: values of the bath
        T_oil: temperature of the oil that the model reaches [K]
        T_room: temperature of the room [K]
        P_in: power into the rig [W]; None where none passes through it
        ours: kind of loss -> part -> loss of the model [W]
        untreated: parts that no method treats
    """

    meshes: tuple[Mesh, ...]
    bearings: tuple[Turning, ...]
    seals: tuple[Turning, ...]
    surfaces: tuple[Component, ...]
    oil: Mapping[str, float]
    T_oil: float
    T_room: float
    P_in: float | None
    ours: Mapping[str, Mapping[str, float]]
    untreated: tuple[Untreated, ...]

    def nu(self, T: float) -> float:
        """Kinematic viscosity of the oil [m2/s] at a temperature [K]."""
        return float(kinematic_viscosity(T, self.oil["nu_40"], self.oil["nu_100"]))

    def eta(self, T: float) -> float:
        """Dynamic viscosity of the oil [Pa.s] at a temperature [K]."""
        return self.nu(T) * float(density(T, self.oil["rho_15"], self.oil["alpha_T"]))

    def loaded(self, share: float) -> Machine:
        """The machine under a multiple of its load, its speeds the same."""
        return replace(
            self,
            meshes=tuple(replace(m, F_t=share * m.F_t) for m in self.meshes),
            bearings=tuple(replace(b, F_r=share * b.F_r, F_a=share * b.F_a) for b in self.bearings),
        )
