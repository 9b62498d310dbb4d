"""What flanks feel along their path of contact, and the standards' safeties against scuffing and micropitting."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import acos, cos, pi, radians

from ...model.laws.cycloid_pin import hertz_line_pressure
from ...model.laws.mesh import tooth_loss_factor
from ...model.laws.oil import T_0
from ...model.laws.tooth_flanks import (
    HERTZIAN,
    ROUNDED,
    bulk_rise,
    contact_ratio_factor,
    flash_temperature,
    friction_flash,
    friction_integral,
    helical_load_factor,
    integral_scuffing_temperature,
    load_share,
    scuffing_temperature,
    sliding_film,
    tip_relief_factor,
)
from ...model.parts.flanks import Flanks
from .case import Oil

#: Points along the path of contact.
POINTS = 101
#: Structural factor of case-hardened steel of usual austenite in the scuffing methods [1].
X_W = 1.0
#: Share of the mean flash by which the teeth are hotter than the oil, dip lubrication, flash method [1].
FLASH_SHARE = 0.47
#: The same of the integral method [1].
INTEGRAL_SHARE = 0.70
#: Weight of the mean flash in the integral temperature [1].
WEIGHT = 1.5
#: Torque on the pinion of the FZG test A/8,3/90 over the square of its load stage [N.m].
SCUFFING_TEST = 3.726
#: Permissible over tested specific film thickness, case-hardened steel [1].
PERMISSIBLE = 1.4


@dataclass(frozen=True)
class MicropittingTest:
    """Test C-GF/8,3/90 of FVA 54/7: what a gear of type FZG C feels at the stage at which its flanks fail.

    A report of KISSsoft prints torque, oil temperature and line load of stage 10, and 0.051 um of film; with its oil it
    is 0.054 um here, so that safeties are 5 % less. Torques of the other stages are as GEARpie has them.
    """

    tau: tuple[float, ...] = (70.0, 98.9, 132.5, 171.6, 215.6, 265.1)  # on the pinion, from stage 5 [N.m]
    first: int = 5  # the first of these stages
    z: tuple[float, float] = (16.0, 24.0)  # numbers of teeth [1]
    m: float = 4.5e-3  # module [m]
    a_w: float = 91.5e-3  # centre distance [m]
    b: float = 14e-3  # face width [m]
    eps: tuple[float, float] = (0.722, 0.715)  # addendum contact ratios [1]
    Ra: float = 0.5e-6  # roughness [m]
    speed: float = 2250 * pi / 30  # of the pinion [rad/s]
    B_M: float = 12427.0  # root of 45 W/(m.K), 440 J/(kg.K) and 7800 kg/m3 [J/(m2.K.s0.5)]
    T_oil: float = 363.15  # injected [K]
    X_S: float = 1.2  # injected oil [1]
    share: float = 0.4222  # line load at the begin of contact over that of the mesh, 236.3 N/mm at stage 10 [1]

    def flanks(self, stage: int, E_eff: float) -> Flanks:
        """The flanks of the test gears at a load stage."""
        alpha = radians(20.0)
        r_b = self.m * self.z[0] / 2 * cos(alpha)
        alpha_wt = acos(r_b * (1 + self.z[1] / self.z[0]) / self.a_w)
        F_bt = self.tau[stage - self.first] / r_b
        return Flanks(
            name="FZG C",
            z=self.z,
            alpha_t=alpha,
            alpha_wt=alpha_wt,
            beta_b=0.0,
            r_b=r_b,
            eps=self.eps,
            eps_beta=0.0,
            b=self.b,
            a_w=self.a_w,
            Ra=self.Ra,
            E_eff=E_eff,
            F_bt=F_bt,
            w=self.speed,
            mu=0.0,
            B_M=self.B_M,
        )


@dataclass(frozen=True)
class Point:
    """A point of the path of contact: place from the pitch point [m], load share, pressure [Pa], sliding [m/s].

    Further the flash temperature [K], that of the contact [K] and the film over the roughness [1].
    """

    y: float
    share: float
    p: float
    v_slide: float
    flash: float
    T: float
    Lambda: float


def contact(f: Flanks, oil: Oil, mu: float, T_bulk: float, g: float, share: float, factor: float = HERTZIAN) -> Point:
    """What flanks feel at a point.

    Args:
        f: the flanks
        oil: viscosity and its rise with pressure, at a temperature
        mu: friction coefficient [1]
        T_bulk: temperature of the teeth [K]
        g: distance from the begin of the path of contact [m]
        share: of the mesh force [1]
        factor: of the flash temperature [1]
    """
    R, v_1, v_2 = f.at(g)
    w_l = f.F_bt * share / f.b
    flash = float(flash_temperature(mu, w_l, R, f.E_eff, v_1, v_2, f.B_M, factor=factor))
    (eta, alpha_p), (eta_B, alpha_B) = oil(T_bulk), oil(T_bulk + flash)
    h = sliding_film(eta, v_1 + v_2, alpha_p, w_l, R, f.E_eff, eta_B, alpha_B)
    p = hertz_line_pressure(w_l, R, f.E_eff)
    y = g - f.eps[1] * f.p_et
    return Point(y, share, float(p), v_1 - v_2, flash, T_bulk + flash, float(h) / f.Ra)


def along(f: Flanks, oil: Oil, mu: float, T_bulk: float, factor: float = HERTZIAN) -> list[Point]:
    """What flanks feel from the begin of the path of contact to its end, equally spaced. Arguments of `contact`."""
    points = []
    for i in range(POINTS):
        g = f.path * i / (POINTS - 1)
        share = float(load_share(g, f.path, f.p_et, f.eps_beta, f.beta_b, f.rho_C))
        points.append(contact(f, oil, mu, T_bulk, g, share, factor))
    return points


def mean_flash(points: Sequence[Point]) -> float:
    """Mean flash temperature [K]."""
    return sum(point.flash for point in points) / len(points)


@dataclass(frozen=True)
class Rating:
    """What the standards ask besides a mesh: factor on its load, load stages of the oil, oil and its temperature.

    Args:
        K: factor on the load of the flanks, K_A K_V K_Hb K_Ha [1]
        scuffing, micropitting: failure load stages of the oil in the FZG tests A/8,3/90 and C-GF/8,3/90
        at: viscosity and its rise with pressure, at a temperature
        T_oil: temperature of the oil [K]
        X_L: lubricant factor [1]
        nu_40: kinematic viscosity at 40 degC [m2/s]
    """

    K: float
    scuffing: int
    micropitting: int
    at: Oil
    T_oil: float
    X_L: float
    nu_40: float

    def limits(self, E_eff: float) -> dict[str, float]:
        """Scuffing temperatures of both methods [degC], permissible specific film thickness [1]."""
        test = MicropittingTest()
        f = test.flanks(self.micropitting, E_eff)
        mu = _friction(f, self, test.T_oil, 1.0)
        T_bulk = test.T_oil + _bulk(f, mu, test.X_S)
        tested = contact(f, self.at, mu, T_bulk, 0.0, test.share)
        tau = SCUFFING_TEST * self.scuffing**2
        return {
            "T_scuffing_C": float(scuffing_temperature(self.scuffing, X_W, self.X_L, self.at(self.T_oil)[0])),
            "T_integral_C": float(integral_scuffing_temperature(tau, X_W, self.X_L, self.nu_40)),
            "lambda_GF": PERMISSIBLE * tested.Lambda,
        }


def rate(f: Flanks, T_bulk: float, oil: Rating) -> tuple[list[Point], dict[str, dict[str, float]]]:
    """A mesh along its path of contact, and temperatures, films and safeties by the network and by the standards.

    Args:
        f: the flanks
        T_bulk: temperature of the gears in the network [K]
        oil: the oil, its limits and the factor on the load
    """
    loaded, limits = replace(f, F_bt=oil.K * f.F_bt), oil.limits(f.E_eff)
    helical = float(helical_load_factor(f.path / f.p_et + f.eps_beta))
    mu = _friction(loaded, oil, oil.T_oil, helical)
    points = along(loaded, oil.at, f.mu, T_bulk)
    mean = mean_flash(points)
    network = {**_told(points, f.mu, T_bulk), "T_integral_C": T_bulk + WEIGHT * mean - T_0}
    found = {
        "network": network,
        "flash": _by_flash(loaded, oil),
        "integral": _by_integral(loaded, oil, mu, helical),
        "micropitting": _by_film(loaded, oil, mu, oil.T_oil + _bulk(f, mu, 1.0)),
        "limit": limits,
    }
    for name, column in found.items():
        if name != "limit":
            column.update(_safeties(column, limits, oil.T_oil - T_0))
    return points, found


def _safeties(told: Mapping[str, float], limits: Mapping[str, float], T_oil_C: float) -> dict[str, float]:
    """The safeties that what a method tells allows; none of a contact below the oil, or below 0 degC on average."""
    found = {}
    if told.get("T_contact_C", T_oil_C) > T_oil_C:
        found["S_flash"] = (limits["T_scuffing_C"] - T_oil_C) / (told["T_contact_C"] - T_oil_C)
    if told.get("T_integral_C", 0.0) > 0:
        found["S_integral"] = limits["T_integral_C"] / told["T_integral_C"]
    if "lambda_GF" in told:
        found["S_micropitting"] = told["lambda_GF"] / limits["lambda_GF"]
    return found


def _told(points: Sequence[Point], mu: float, T_bulk: float, leave: str = "") -> dict[str, float]:
    """What stands in a table of a path of contact, but for what a method does not ask."""
    told = {
        "T_bulk_C": T_bulk - T_0,
        "mu": mu,
        "flash_K": max(point.flash for point in points),
        "T_contact_C": max(point.T for point in points) - T_0,
        "lambda_GF": min(point.Lambda for point in points),
    }
    return {key: value for key, value in told.items() if key != leave}


def _friction(f: Flanks, oil: Rating, T_oil: float, helical: float) -> float:
    """Friction of the integral temperature method and of micropitting [1]."""
    R, v_1, v_2 = f.at(f.eps[1] * f.p_et)
    line_load = helical * f.F_bt * cos(f.alpha_t) / f.b
    return float(friction_integral(line_load, v_1 + v_2, R, oil.at(T_oil)[0], f.Ra, oil.X_L))


def _bulk(f: Flanks, mu: float, X_S: float) -> float:
    """Rise of the teeth above the oil after the micropitting method [K]."""
    H_v = float(tooth_loss_factor(f.z[0], f.u, f.beta_b, *f.eps))
    return float(bulk_rise(f.P, mu, H_v, f.a_w, f.b, X_S))


def _by_flash(f: Flanks, oil: Rating) -> dict[str, float]:
    """The flash temperature method, by its own friction and temperature of the teeth."""
    R, v_1, v_2 = f.at(f.eps[1] * f.p_et)
    line_load, eta = f.F_bt * cos(f.alpha_t) / f.b, oil.at(oil.T_oil)[0]
    mu = float(friction_flash(line_load, v_1 + v_2, R * cos(f.beta_b), eta, f.Ra, oil.X_L))
    mean = mean_flash(along(f, oil.at, mu, oil.T_oil, ROUNDED))
    T_bulk = oil.T_oil + FLASH_SHARE * mean
    return _told(along(f, oil.at, mu, T_bulk, ROUNDED), mu, T_bulk, leave="lambda_GF")


def _by_film(f: Flanks, oil: Rating, mu: float, T_bulk: float) -> dict[str, float]:
    """The micropitting method: the thinnest film."""
    return _told(along(f, oil.at, mu, T_bulk), mu, T_bulk, leave="T_contact_C")


def _by_integral(f: Flanks, oil: Rating, mu: float, helical: float) -> dict[str, float]:
    """The integral temperature method: flash at the tip of the first gear under full load, and its share."""
    tip = contact(f, oil.at, mu, oil.T_oil, f.path, helical, ROUNDED).flash
    approach = max(f.eps) / min(f.eps)
    X_Q = min(1.0, max(0.6, 1.4 - 4 / 15 * approach))
    mean = tip * float(contact_ratio_factor(*f.eps)) / X_Q / float(tip_relief_factor(max(f.eps), 0.0))
    T_bulk = oil.T_oil + INTEGRAL_SHARE * mean
    return {"T_bulk_C": T_bulk - T_0, "mu": mu, "T_integral_C": T_bulk + WEIGHT * mean - T_0}
