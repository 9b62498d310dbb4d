"""The planetary set: a sun, planets, a ring and their carrier."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca

from ..core.component import Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.gears import tip_diameter
from ..laws.mesh import mesh_loss
from ..laws.smooth import Num, friction_sign, smooth_abs
from .ports import BearingLoad, Flange, ShaftReading
from .relations import require
from .teeth import ToothedPart

#: How far a load may exceed that of all planets, relative: such numbers are inferred from measured losses.
LOAD_LEFT = 0.05


class PlanetarySet(ToothedPart):
    """Sun, planets, ring and carrier. All tooth speeds are those against the carrier.

    The flange `planet` is the rotation of all planets against the carrier: planet bearings brake there. With
    `power_flow` "ideal" all forces follow from the torque at the carrier's shaft end, as if nothing were lost on the
    way; with "successive" each contact carries what arrives at it.
    """

    carrier = Flange()
    sun = Flange()
    ring = Flange()
    planet = Flange()
    carrier_load = BearingLoad()
    sun_load = BearingLoad()
    planet_load = BearingLoad()
    reading = ShaftReading(must_meet=False)  # which "ideal" power flow needs

    power_flow = Choice(
        ("successive", "ideal"),
        "ideal: mesh forces from the input torque; successive: each stage sees upstream losses",
        default="successive",
    )
    N = Parameter("1", "number of planets", above=0.0, whole=True)
    z_3 = Parameter("1", "number of teeth of the ring", above=0.0, whole=True)
    eps_alpha_sp = Parameter("1", "transverse contact ratio sun-planet", above=0.0)
    eps_alpha_pr = Parameter("1", "transverse contact ratio planet-ring", above=0.0)
    H_v_sp = Parameter("1", "tooth loss factor sun-planet", nominal=0.1, at_least=0.0)
    H_v_pr = Parameter("1", "tooth loss factor planet-ring", nominal=0.1, at_least=0.0)
    n_axial_carrier = Parameter("1", "planets whose axial force loads each carrier bearing", at_least=0.0)
    n_axial_sun = Parameter("1", "planets whose axial force loads the sun's bearing", at_least=0.0)
    s_planet = Parameter("m", "distance of the two bearings of a planet", nominal=0.02, above=0.0)
    tau_loss_sp = Output("N.m", "friction torque sun-planet, on the sun", nominal=1.0, at_least=0.0, guess=0.0)
    tau_loss_pr = Output("N.m", "friction torque planet-ring, on the sun", nominal=1.0, at_least=0.0, guess=0.0)
    P_loss_sp = Output("W", "loss of the sun-planet meshes", nominal=100.0, at_least=0.0)
    P_loss_pr = Output("W", "loss of the planet-ring meshes", nominal=100.0, at_least=0.0)
    F_t_sp = Output("N", "tangential force of a sun-planet mesh", nominal=1000.0)
    F_t_pr = Output("N", "tangential force of a planet-ring mesh", nominal=1000.0)
    mu_sp = Output("1", "tooth friction coefficient sun-planet", nominal=0.1)
    mu_pr = Output("1", "tooth friction coefficient planet-ring", nominal=0.1)
    Lambda_sp = Output("1", "specific film thickness sun-planet")
    Lambda_pr = Output("1", "specific film thickness planet-ring")

    def relations(self) -> Iterator[Related]:
        """Sun, planets and ring fit into each other, and the planets beside each other."""
        yield from super().relations()
        yield require(self, "a_w lies near the reference distance", self.shift_sum(), -1.5, 2.5)
        yield require(self, "z_3 fits z_1 + 2 z_2", self.z_3 - self.z_1 - 2 * self.z_2, -4.0, 4.0)
        places = (self.z_1 + self.z_3) / self.N
        yield require(self, "the planets stand at equal angles", places - ca.floor(places + 0.5), -1e-6, 1e-6)
        tip = tip_diameter(2 * self.radius(self.z_2), self.m_n, 0.0)
        apart = 2 * self.a_w * ca.sin(ca.pi / ca.fmax(self.N, 2))
        yield require(self, "neighbouring planets do not touch", apart - tip, 0.0)
        for key in ("n_axial_carrier", "n_axial_sun"):
            yield require(self, "{key} fits N", getattr(self, key) / self.N, 0.0, 1 + LOAD_LEFT, key=key)

    def equations(self) -> Iterator[Equation]:
        """Kinematics, torques, and the two kinds of meshes."""
        w = self.sun.w - self.carrier.w
        i_0, sign = self.z_3 / self.z_1, friction_sign(w)
        losses = sign * (self.tau_loss_sp + self.tau_loss_pr)
        yield equation("Willis", self.sun.w + i_0 * self.ring.w, (1 + i_0) * self.carrier.w)
        yield equation("planets roll on the sun", self.planet.w, -w * self.z_1 / self.z_2)
        yield equation("torques balance", self.sun.tau + self.ring.tau + self.carrier.tau, 0)
        passed = self.ring.tau / i_0 + self.planet.tau * self.z_1 / self.z_2
        yield equation("power against the carrier", self.sun.tau, passed + losses)
        yield from self._meshes(w, sign)
        yield from self._loads()
        yield equation("loss heats the gears", self.gears.Q_flow, -(self.P_loss_sp + self.P_loss_pr))

    def _meshes(self, w: Num, sign: Num) -> Iterator[Equation]:
        """Forces, friction and loss of both kinds of meshes; torques are those of all planets, on the sun."""
        r = self.radius(self.z_1)
        sp, pr = self._transmitted(sign)
        contact_sp = self.contact(self.eps_alpha_sp, self.z_1, self.z_2)
        contact_pr = self.contact(self.eps_alpha_pr, self.z_2, -self.z_3)
        mu_sp, Lambda_sp = self.friction(contact_sp, self.F_t_sp, w)
        mu_pr, Lambda_pr = self.friction(contact_pr, self.F_t_pr, self.planet.w)
        yield equation("force sun-planet", self.F_t_sp, sp / (self.N * r))
        yield equation("force planet-ring", self.F_t_pr, pr / (self.N * r))
        yield equation("friction sun-planet", self.mu_sp, mu_sp)
        yield equation("friction planet-ring", self.mu_pr, mu_pr)
        yield equation("film sun-planet", self.Lambda_sp, Lambda_sp)
        yield equation("film planet-ring", self.Lambda_pr, Lambda_pr)
        half = 0.5 if self.power_flow == "successive" else 0.0
        loss_sp = mesh_loss(sp + half * self.tau_loss_sp, self.mu_sp, self.H_v_sp)
        loss_pr = mesh_loss(pr + half * self.tau_loss_pr, self.mu_pr, self.H_v_pr)
        yield equation("loss sun-planet", self.tau_loss_sp, loss_sp)
        yield equation("loss planet-ring", self.tau_loss_pr, loss_pr)
        yield equation("power sun-planet", self.P_loss_sp, self.tau_loss_sp * sign * w)
        yield equation("power planet-ring", self.P_loss_pr, self.tau_loss_pr * sign * w)

    def _transmitted(self, sign: Num) -> tuple[Num, Num]:
        """Mean of the torques before and behind each kind of mesh, magnitude, on the sun."""
        if self.power_flow == "ideal":
            ideal = smooth_abs(self.reading.tau, self.tau_width) * self.z_1 / (self.z_1 + self.z_3)
            return ideal, ideal
        from_ring = self.ring.tau * self.z_1 / self.z_3
        return (
            smooth_abs(self.sun.tau - sign * self.tau_loss_sp / 2, self.tau_width),
            smooth_abs(from_ring + sign * self.tau_loss_pr / 2, self.tau_width),
        )

    def _loads(self) -> Iterator[Equation]:
        """What the bearings carry; the axial forces of sun and ring tilt a planet at its own radius."""
        F_t, r = (self.F_t_sp + self.F_t_pr) / 2, self.radius(self.z_2)
        tilt = 2 * F_t * ca.tan(self.beta) * r / self.s_planet
        yield equation("carrier radially", self.carrier_load.F_r, 0)
        yield equation("carrier axially", self.carrier_load.F_a, self.n_axial_carrier * F_t * ca.tan(self.beta))
        yield equation("sun radially", self.sun_load.F_r, 0)
        yield equation("sun axially", self.sun_load.F_a, self.n_axial_sun * self.F_t_sp * ca.tan(self.beta))
        yield equation("planet radially", self.planet_load.F_r, ca.sqrt(F_t**2 + tilt**2))
        yield equation("planet axially", self.planet_load.F_a, 0)
