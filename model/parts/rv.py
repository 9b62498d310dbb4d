"""The cycloid-pin stage of an RV reducer: cranks, two discs, the pins of the housing, and the carrier they turn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.cycloid_pin import greatest_curvature, width_coefficient
from ..laws.film_map import FilmMap
from ..laws.smooth import Num, friction_sign, smooth_abs
from .contacts import ContactCase, ContactTable, fits_map
from .pin_mesh import Film, PinContact, PinMesh, pin_case, pin_table
from .ports import BearingLoad, Flange, HeatPort, Lubricant, ShaftReading
from .relations import require

#: Discs of a stage; they stand opposite each other, so that the radial forces of both cancel.
DISCS = 2
#: Moments of a mesh cycle that are told.
MOMENTS = 15
#: Reduced radius of disc and pin at the sharpest place of the disc that counts as undercut, over the pin's radius.
UNDERCUT = 1e-6


class CycloidPinStage(Component):
    """Cranks move two discs round inside a ring of pins; the discs turn the carrier, the pins hold on to the housing.

    The flange `crank` is the rotation of all cranks against the carrier, as that of the planets of a `PlanetarySet`:
    gears that drive the cranks and all bearings of the cranks belong there. It turns Zp times as fast as the carrier
    does against the housing, the other way. Half of the pins of a disc carry, with loads in proportion to their levers.

    What is lost is the friction of a mesh cycle, averaged over the angles of the pins: of the disc that slides over
    pins that are held, or of rolling pins that slide in their grooves. The film decides between the friction of a
    fluid and of touching surfaces. `T_disc` is half of the torque that `reading` tells, as the stage's load is commonly
    given, or follows from the statics of the stage: (Zp - 1)/Zp of half the torque at the carrier.

    `contact_table`, `contact_case` and `mesh_cycle` tell the same contacts in numbers.
    """

    role: ClassVar[str] = "teeth"
    scale: ClassVar[tuple[str, ...]] = ("mu_fluid", "mu_boundary")

    crank = Flange()
    carrier = Flange()
    housing = Flange()
    discs = HeatPort()
    lubricant = Lubricant()
    reading = ShaftReading()
    eccentric_load = BearingLoad()
    crank_load = BearingLoad()
    main_load = BearingLoad()

    pin = Choice(("held", "rolling"), "whether the pins are held, so that the disc slides, or roll in their grooves")
    film = Choice(("moes",), 'film of disc and pin: Moes\' formula, or a map, "map:FILE"', "moes", also=FilmMap)
    disc_torque = Choice(("output", "statics"), "torque of a disc: half of that at the shaft end, or from statics")
    Zp = Parameter("1", "number of pins, one more than lobes of a disc", at_least=3.0, whole=True)
    Zc = Parameter("1", "number of lobes of a disc", at_least=2.0, whole=True)
    Rp = Parameter("m", "radius of the pin circle", nominal=0.05, above=0.0)
    e = Parameter("m", "eccentricity", nominal=1e-3, above=0.0)
    r_rp = Parameter("m", "radius of a pin", nominal=1e-3, above=0.0)
    b = Parameter("m", "width of a disc", nominal=0.01, above=0.0)
    N = Parameter("1", "number of cranks", at_least=2.0, whole=True)
    a_0 = Parameter("m", "distance of the cranks from the middle of the carrier", nominal=0.05, above=0.0)
    s_discs = Parameter("m", "distance of the middles of both discs", nominal=0.01, at_least=0.0)
    s_crank = Parameter("m", "distance of the bearings of a crank", nominal=0.05, above=0.0)
    s_main = Parameter("m", "distance of the main bearings", nominal=0.05, above=0.0)
    E_eff = Parameter("Pa", "effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2", 1e11, above=0.0)
    sigma = Parameter("m", "composite roughness of disc and pin", nominal=1e-7, above=0.0)
    mu_fluid = Parameter("1", "friction coefficient of the full film", nominal=0.1, at_least=0.0, at_most=1.0)
    mu_boundary = Parameter("1", "friction coefficient of touching surfaces", nominal=0.1, at_least=0.0, at_most=1.0)
    clearance = Parameter("m", "radius of a groove less that of its pin", nominal=1e-5, above=0.0)
    sigma_groove = Parameter("m", "composite roughness of pin and groove", nominal=1e-7, above=0.0)
    tau_width = Parameter("N.m", "torque below which the direction of load is blurred", default=0.1, above=0.0)
    T_disc = Output("N.m", "torque of a disc about its centre", nominal=100.0)
    w_crank = Output("rad/s", "speed of the crank's line against the pins", nominal=100.0)
    eta_oil = Output("Pa.s", "dynamic viscosity of the lubricant", nominal=0.1)
    alpha_p = Output("1/Pa", "pressure-viscosity coefficient of the lubricant", nominal=1e-8)
    F_disc = Output("N", "force of all pins on a disc", nominal=1000.0)
    mu = Output("1", "friction coefficient where the pins slide, mean by friction power", nominal=0.1)
    Lambda = Output("1", "specific film thickness of disc and pin, mean by load")
    tau_loss = Output("N.m", "friction torque of both discs, on the carrier", nominal=10.0, at_least=0.0, guess=0.0)
    P_loss = Output("W", "friction power of both discs", nominal=100.0, at_least=0.0)

    def has(self, name: str) -> bool:
        """The groove counts where the pins roll."""
        return self.pin != "held" or name not in ("clearance", "sigma_groove")

    def relations(self) -> Iterator[Related]:
        """The disc has one lobe less than there are pins, no cusps and no undercut, and the pins have room."""
        K = width_coefficient(self.e, self.Zp, self.Rp)
        yield require(self, "Zc is Zp - 1", self.Zp - 1 - self.Zc, 0.0, 0.0)
        yield require(self, "the eccentricity leaves no cusps", K, high=0.99)
        sharpest = 1 - self.r_rp * greatest_curvature(ca.fmin(K, 0.99), self.Zp, self.Rp)
        yield require(self, "the pins do not undercut the disc", sharpest, UNDERCUT)
        apart = self.Rp * ca.sin(ca.pi / ca.fmax(self.Zp, 2))
        yield require(self, "neighbouring pins do not touch", apart / self.r_rp, 1.0)
        if isinstance(self.film, FilmMap):
            yield fits_map(self, self.film, self.E_eff)
        yield require(self, "the cranks are inside the pins", self.a_0 / self.Rp, high=1.0)

    def _mesh(self, value: Mapping[str, Num]) -> PinMesh:
        keys = ("Zp", "Rp", "e", "r_rp", "b", "E_eff", "sigma", "mu_fluid", "mu_boundary")
        law = self.film if isinstance(self.film, FilmMap) else None
        return PinMesh(**{key: value[key] for key in keys}, rolling=self.pin == "rolling", law=law)

    def _sliding(self, mesh: PinMesh, contact: PinContact, film: Film) -> Num:
        """Friction coefficient where a pin slides: on the disc or in its groove [1]."""
        if self.pin == "held":
            return contact.mu
        return mesh.groove_friction(contact, self.clearance, self.sigma_groove, film)

    def _cycle(self, film: Film) -> tuple[Num, Num, Num, Num]:
        """Over a mesh cycle: friction torque of a disc [N.m], force on it [N], mean friction and film [1]."""
        mesh = self._mesh(self.symbols)
        per_pin = self.Zp / (2 * ca.pi)
        rub, load, along, across, films = 0.0, 0.0, 0.0, 0.0, 0.0
        lever_sum = 0.0
        for theta, weight in mesh.quadrature():
            contact = mesh.contact(theta, film)
            share = weight * per_pin * contact.F
            lever = mesh.rubbing_lever(contact)
            x, y = mesh.towards_pole(contact)
            rub += share * lever * self._sliding(mesh, contact, film)
            lever_sum += share * lever
            load, films = load + share, films + share * contact.Lambda
            along, across = along + share * x, across + share * y
        return rub, ca.sqrt(along**2 + across**2), rub / lever_sum, films / load

    def equations(self) -> Iterator[Equation]:
        """Exact kinematics, the loads that follow from the discs' equilibrium, and the friction of a mesh cycle."""
        w = self.carrier.w - self.housing.w
        sign, oil = friction_sign(w), self.lubricant
        statics = (self.Zp - 1) / self.Zp * (self.carrier.tau - sign * self.tau_loss / 2)
        T = statics if self.disc_torque == "statics" else self.reading.tau
        film = Film(self.T_disc, self.w_crank, self.eta_oil, self.alpha_p)
        tau_loss, F_disc, mu, Lambda = self._cycle(film)
        yield equation("the crank turns Zp times", self.crank.w, -self.Zp * w)
        yield equation("torque less loss", self.carrier.tau, self.Zp * self.crank.tau + sign * self.tau_loss)
        yield equation("the pins hold on to the housing", self.housing.tau, -self.carrier.tau)
        yield equation("crank's line against the pins", self.w_crank, -(self.Zp - 1) * w)
        yield equation("torque of a disc", self.T_disc, smooth_abs(T, self.tau_width) / DISCS)
        yield equation("viscosity", self.eta_oil, oil.nu * oil.rho)
        yield equation("pressure-viscosity", self.alpha_p, oil.alpha_p)
        yield equation("friction of a mesh cycle", self.tau_loss, DISCS * tau_loss)
        yield equation("friction power", self.P_loss, self.tau_loss * sign * w)
        yield equation("mean friction", self.mu, mu)
        yield equation("mean film", self.Lambda, Lambda)
        yield equation("force on a disc", self.F_disc, F_disc)
        yield equation("friction heats the discs", self.discs.Q_flow, -self.P_loss)
        yield from self._bearing_loads()

    def _bearing_loads(self) -> Iterator[Equation]:
        """Root mean squares over a turn: a force that turns with the crank, and one that stays across the carrier.

        The forces of both discs cancel but for the couple that their distance makes.
        """
        turning, staying = self.F_disc / self.N, self.T_disc / (self.N * self.a_0)
        couple = self.s_discs / self.s_crank
        eccentric = ca.sqrt(turning**2 + staying**2)
        crank = ca.sqrt((turning * couple) ** 2 + staying**2)
        yield equation("bearing on an eccentric", self.eccentric_load.F_r, eccentric)
        yield equation("bearing of a crank", self.crank_load.F_r, crank)
        yield equation("main bearing", self.main_load.F_r, self.F_disc * self.s_discs / self.s_main)
        for name, port in (("an eccentric", self.eccentric_load), ("a crank", self.crank_load)):
            yield equation(f"no axial load of {name}", port.F_a, 0.0)
        yield equation("no axial load of the main bearings", self.main_load.F_a, 0.0)

    def _in_numbers(self, values: Mapping[str, float]) -> tuple[PinMesh, Film]:
        return self._mesh(values), Film(*(values[key] for key in ("T_disc", "w_crank", "eta_oil", "alpha_p")))

    def contact_table(self, values: Mapping[str, float]) -> ContactTable:
        """The contact of a pin at every degree of the loaded half, see `pin_mesh.COLUMNS`, by values in SI."""
        return replace(pin_table(*self._in_numbers(values)), cycle=self.mesh_cycle(values))

    def contact_case(self, values: Mapping[str, float], theta: float) -> ContactCase:
        """The contact of a pin, for a contact solver.

        Args:
            values: parameters and outputs of the stage at an operating point, by key, in SI
            theta: angle of the pin from the crank's line [rad]
        """
        return pin_case(*self._in_numbers(values), theta)

    def film_contact(self, values: Mapping[str, float]) -> ContactCase:
        """The contact of the pin across the crank's line, by values in SI."""
        return self.contact_case(values, float(ca.pi) / 2)

    def mesh_cycle(self, values: Mapping[str, float]) -> list[ContactCase]:
        """The way of a pin through the loaded half, at middles of equal steps where it carries, by values in SI."""
        return [self.contact_case(values, float(ca.pi) * (k + 0.5) / MOMENTS) for k in range(MOMENTS)]
