"""Drum motors: cooling of the turning drum, losses of the motor, oil in a partly filled drum, the source's forms."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .convection import SEA_LEVEL, air_properties
from .smooth import SPEED_WIDTH, V_WIDTH, Num, smooth_abs, smooth_power


@law(
    source="Becker1963",
    where="correlation of all tests",
    valid="horizontal cylinder that turns in a fluid at rest; measured in water, Re_w 1e3-4.6e4",
    ranges={"Re_w": (0.0, 4.3e5)},
    verified=False,
)
def nusselt_rotating_cylinder(Re_w: Num, Pr: Num) -> Num:
    r"""Mean Nusselt number of a rotating horizontal cylinder [1], length its diameter.

    .. math:: Nu = 0.133 Re_\omega^{2/3} Pr^{1/3},\quad Re_\omega = \frac{\omega D^2}{2 \nu}

    It vanishes at rest, where free convection takes over; both are joined by `convection.mixed`.

    Args:
        Re_w: Reynolds number of the surface speed and the diameter, above 0 [1]
        Pr: Prandtl number [1]
    """
    return 0.133 * Re_w ** (2 / 3) * Pr ** (1 / 3)


def forced_rotating_cylinder(w: Num, T_film: Num, D: Num, *, p: Num = SEA_LEVEL) -> Num:
    """Heat transfer coefficient [W/(m2.K)] of a cylinder that turns in air at rest.

    Args:
        w: speed of the cylinder, either direction [rad/s]
        T_film: mean temperature of cylinder and air [K]
        D: diameter [m]
        p: pressure of the air [Pa]
    """
    k, nu, Pr, _ = air_properties(T_film, p=p)
    return nusselt_rotating_cylinder(smooth_abs(w) * D**2 / (2 * nu), Pr) * k / D


@law(
    source="DrumMotor",
    where="heat transfer coefficient of the drum",
    valid="as printed, with D in metres; 58-72 W/(m2.K), four to five times a bare drum",
    verified=False,
)
def source_coefficient(P: Num, D: Num, v: Num) -> Num:
    r"""Heat transfer coefficient of a drum with its belt as the source computes it [W/(m2.K)].

    .. math:: K = 21 - 2 P/D + 36 \sqrt{1 + v}

    Args:
        P: rated shaft power; the number counts kilowatts [W]
        D: diameter of the drum; the source writes mm, its numbers need metres [m]
        v: speed of the belt, either direction [m/s]
    """
    P_kW = 1e-3 * P
    return 21 - 2 * P_kW / D + 36 * ca.sqrt(1 + smooth_abs(v, V_WIDTH))


@law(source="DrumMotor", where="cooling area", verified=False)
def cooling_area(S_1: Num, S_2: Num, S_3: Num, S_4: Num, psi_1: Num, psi_2: Num) -> Num:
    r"""Area that gives the heat of a drum away [m2].

    .. math:: S = S_1 + S_2 + [S_3 - S_4 (1 - \psi_1)] \psi_2

    Args:
        S_1: area of one end cover [m2]
        S_2: area of the other end cover [m2]
        S_3: area of the drum's shell [m2]
        S_4: area of the shell under the belt [m2]
        psi_1: share of its heat that the covered shell passes on to the belt [1]
        psi_2: share of the shell that the oil inside keeps warm [1]
    """
    return S_1 + S_2 + (S_3 - S_4 * (1 - psi_1)) * psi_2


@law(
    source="DrumMotor",
    where="heat of the drum",
    valid="P is the power of the motor's shaft; as printed, 1000 P (1 - eta_N eta_g), P would be the electric power",
    verified=False,
)
def drum_heat(P: Num, eta_N: Num, eta_g: Num) -> Num:
    r"""Heat that motor and gear of a drum motor make [W].

    .. math:: Q = P \left(\frac{1}{\eta_N} - \eta_g\right)

    Args:
        P: power of the motor's shaft [W]
        eta_N: rated efficiency of the motor [1]
        eta_g: efficiency of the gear [1]
    """
    return P * (1 / eta_N - eta_g)


@law(source="DrumMotor", where="temperature of the drum in equilibrium", verified=False)
def lumped_temperature(Q: Num, h: Num, S: Num, T_room: Num) -> Num:
    r"""Temperature of a drum motor as one body [K].

    .. math:: T = T_{room} + \frac{Q}{h S}

    Args:
        Q: heat that motor and gear make [W]
        h: heat transfer coefficient in all [W/(m2.K)]
        S: area that gives the heat away [m2]
        T_room: temperature of the room [K]
    """
    return T_room + Q / (h * S)


@law(
    source="IEC60034-31",
    where="efficiency at part load, from a constant loss and one that grows with the square of the load",
    valid="induction motors; the fall of the first with speed is assumed",
    verified=False,
)
def motor_loss(w: Num, tau: Num, P_N: Num, w_N: Num, eta: Num, share: Num, a: Num) -> tuple[Num, Num]:
    r"""Losses of an electric motor [W]: that of the speed (iron, fan, friction) and that of the load (windings).

    .. math:: P_w = s P_V \left|\frac{\omega}{\omega_N}\right|^a,\quad
        P_\tau = (1 - s) P_V \left(\frac{\tau}{\tau_N}\right)^2,\quad
        P_V = P_N \left(\frac{1}{\eta} - 1\right),\quad \tau_N = \frac{P_N}{\omega_N}

    At the rated point the sum is P_V. Both are even in their argument: a generator loses what a motor does.

    Args:
        w: speed of the rotor, either direction [rad/s]
        tau: torque of the rotor, either direction [N.m]
        P_N: rated power of the shaft [W]
        w_N: rated speed [rad/s]
        eta: rated efficiency, above 0 and below 1 [1]
        share: share of the rated loss that depends on the speed [1]
        a: exponent of the speed [1]
    """
    P_V = P_N * (1 / eta - 1)
    by_speed = share * P_V * smooth_power(w / w_N, a, SPEED_WIDTH / w_N)
    return by_speed, (1 - share) * P_V * (tau * w_N / P_N) ** 2


@law(
    source="DrumMotor",
    where="efficiency of churning, with the power of ten and the root of the handbooks it is taken from",
    valid="a gear that dips into oil; 12-24 times too large with z not inverted",
    verified=False,
)
def gear_churning_loss(v: Num, b: Num, nu: Num, z: Num, *, v_width: float = V_WIDTH) -> Num:
    r"""Power of a gear that dips into oil [W], whatever its load.

    .. math:: P = 0.0075\, v\, b \sqrt{\frac{200}{z} v \nu}

    Args:
        v: speed at the pitch circle, either direction [m/s]
        b: width that dips [m]
        nu: kinematic viscosity of the oil [m2/s]
        z: sum of the teeth of both gears [1]
        v_width: rounding at rest [m/s]
    """
    b_mm, nu_cSt = 1e3 * b, 1e6 * nu
    return 7.5e-3 * smooth_power(v, 1.5, v_width) * b_mm * ca.sqrt(200 * nu_cSt / z)


@law(source="DrumMotor", where="efficiency of churning", verified=False)
def churning_efficiency(v: Num, b: Num, nu: Num, z: Num, P: Num) -> Num:
    r"""Efficiency of churning at a given power [1].

    .. math:: \eta = 1 - \frac{0.75\, v\, b \sqrt{200 v \nu / z}}{10^5 P}

    The loss does not vanish with the load, so that the efficiency of a gear without load is no number: the model
    takes the loss.

    Args:
        v: speed at the pitch circle, either direction [m/s]
        b: width that dips [m]
        nu: kinematic viscosity of the oil [m2/s]
        z: sum of the teeth of both gears [1]
        P: power of the shaft [W]
    """
    return 1 - gear_churning_loss(v, b, nu, z) / P


@law(
    source="DrumMotor",
    where="viscosity over temperature, power law",
    valid="within 5 % from 40 to 80 degC with one exponent; not below 30 degC",
    ranges={"T_oil": (303.15, 393.15)},
    verified=False,
)
def power_law_exponent(T_oil: Num, nu: Num, nu_50: Num) -> Num:
    r"""Exponent of the power law of viscosity that meets a viscosity at a temperature [1].

    .. math:: n = \frac{\ln (\nu_{50}/\nu)}{\ln (t/50)}

    With one exponent for all temperatures the law would be a power; on the Walther line the exponent drifts.

    Args:
        T_oil: temperature, not 50 degC [K]
        nu: kinematic viscosity at that temperature [m2/s]
        nu_50: kinematic viscosity at 50 degC [m2/s]
    """
    t = T_oil - 273.15
    return ca.log(nu_50 / nu) / ca.log(t / 50)


@law(source="DrumMotor", where="ratio of film and roughness, with 1.13 or 1.27 for the printed 1.6")
def film_ratio(h: Num, Ra_1: Num, Ra_2: Num, c_q: Num) -> Num:
    r"""Film thickness over the root mean square of both roughnesses [1].

    .. math:: \lambda = \frac{h}{\sqrt{R_{q1}^2 + R_{q2}^2}},\quad R_q = c_q R_a

    Args:
        h: film thickness [m]
        Ra_1: mean roughness of one surface [m]
        Ra_2: mean roughness of the other [m]
        c_q: root mean square over mean roughness, 1.25 of ground surfaces, 1.11 of a sine [1]
    """
    return h / (c_q * ca.sqrt(Ra_1**2 + Ra_2**2))
