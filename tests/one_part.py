"""Each part by itself, with plausible values, between sources on all of its ports."""

from __future__ import annotations

import math

from gearheat.model.core.component import Component, equation
from gearheat.model.core.connect import Assembly
from gearheat.model.core.declare import Input, Port
from gearheat.model.core.flatten import flatten
from gearheat.model.laws.oil import density, kinematic_viscosity, pressure_viscosity, thermoviscosity, walther_constants
from gearheat.model.parts import PARTS as PHYSICS
from gearheat.model.parts.bearings import SkfBearing
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.model.parts.ports import Flange

#: Every class of component: the physics, and the fit terms of the diagnosis.
PARTS = PHYSICS | EXTRA_PARTS

OIL = dict(nu_40=3.2438e-4, nu_100=3.527e-5, rho_15=859.0, alpha_T=-5.6e-4, s_p=7.382, t_p=0.1335, X_L=0.666)
FRICTION = dict(count=2.0, inner_share=0.4)
GREY = FRICTION | dict(a=5000.0, b=0.01, m=1.5, e=0.4, w_ref=188.0, nu_ref=1.5e-4)
BEARING = FRICTION | dict(d_m=0.14, F_r_0=100.0, F_a_0=50.0)
SKF = BEARING | dict(d=0.11, D=0.17, K_Z=6.0, K_rs=6e-8, mu_bl=0.1, mu_EHL=0.002, H=0.03)
THRUST = {k: v for k, v in SKF.items() if k != "F_r_0"}
TEETH = dict(z_1=36.0, z_2=36.0, m_n=0.002, alpha_n=math.radians(20), beta=math.radians(10), b=0.042, a_w=0.073035)
TEETH |= dict(Ra=6e-7, k_mu=1.044, line_load="F_bn/l", E=2.06e11, poisson=0.3)
WHEEL = dict(r=0.08, b=0.024, m_n=0.003)
SURFACE = dict(A=0.8, emissivity=0.9)
BOX = SURFACE | dict(height=0.3, length=0.4, width=0.2, share_top=0.2, share_bottom=0.2)
SPLASH = dict(A=0.3, r=0.08, c_p=2000.0, alpha_T=-6.5e-4)
EXTRA = dict(P_ref=50.0, w_ref=20.0, tau_ref=2000.0, a=2.0, c=0.5, forward=1.0, backward=0.5)
EXTRA |= dict(w_on=10.0, w_side=1.0, w_width=0.5, tau_on=-1e4, tau_side=1.0, tau_width=60.0)
EXTRA |= dict(T_on=340.0, T_side=-1.0, T_width=1.5, oil_share=0.8, inner_share=0.3)
WET = EXTRA | dict(nu_ref=7e-5, b=0.2, film_on=2e-3)
FLANK = dict(w_0=6.4e-4, phi=0.2063, L=0.012, r_convex=0.0192194, r_concave=0.0192307, E_eff=2.308e11, B_tooth=1e-3)
FLANK |= dict(a=2.2, approach=1e-6, Rz_1=4e-7, Rz_2=4e-7, mu_fluid=0.01, mu_boundary=0.1)
SUPPORT = dict(span=0.1, x=0.04, r=0.05, axial_share_a=1.0)
DISC = dict(z_1=13.0, z_2=14.0, n=2.0, e=4e-3, r=0.086, D_0=0.014, d_0=0.008, u=8.0, R_0=0.0475, D_VK=0.014, d_VK=0.007)
DISC |= dict(d_CZ=0.035, D_CZ=0.04, mu_r1=0.005, mu_r2=0.0045, mu_r3=0.0045)
LINEAR = dict(emissivity=0.8, T_1=353.15, T_2=293.15)

#: Values of one plausible example of every part.
JOINT_METAL = dict(k=45.0, sigma=3e-6, m=0.15, H=2e9)
JOINT = JOINT_METAL | dict(A=0.03, count=4.0, d=0.012, gap=2e-4, k_gap=0.026)
EXAMPLES: dict[str, dict] = {
    "ShaftEnd": dict(given=("w", "tau")),
    "FixedFlange": {},
    "FanLoad": dict(k=0.1),
    "ShaftFan": dict(k_v=0.02, k=1e-5),
    "Inertia": dict(J=0.01),
    "LoadingClutch": {},
    "FrictionClutch": {},
    "OneWayClutch": dict(tau_max=300.0, tau_drag=0.5),
    "Brake": FRICTION,
    "CompliantShaft": dict(c=1e4, d=10.0),
    "TorqueSplit": dict(share=0.4),
    "Efficiency": {},
    "Motor": dict(P_N=2200.0, w_N=298.5, eta=0.82, speed_share=0.35, speed_exponent=1.5),
    "ServoMotor": dict(k_T=0.105, R_20=0.2, tau_c=0.02, d=1e-4),
    "PlanetarySet": TEETH
    | dict(N=3.0, z_3=108.0, eps_alpha_sp=1.666, eps_alpha_pr=1.883, H_v_sp=0.168, H_v_pr=0.062)
    | dict(n_axial_carrier=1.0, n_axial_sun=3.0, s_planet=0.021),
    "HelicalGearPair": TEETH | dict(z_2=72.0, a_w=0.1097, x_1=0.0, x_2=0.0),
    "InternalGearPair": TEETH | dict(z_2=108.0, x_1=-0.0189, x_2=0.0566),
    "BevelGearPair": {k: v for k, v in TEETH.items() if k not in ("m_n", "a_w")}
    | dict(z_1=14.0, z_2=39.0, m_et=4.536e-3, beta=math.radians(35), b=0.0254, x_1=0.4, shaft_angle=math.pi / 2),
    "WormPair": dict(z_1=2.0, z_2=41.0, m_x=4e-3, d_1=0.044, alpha_n=math.radians(20), k_mu=1.0),
    "BeltPull": dict(D=0.32, k_pull=2.0),
    "HarmonicMesh": FLANK | dict(z_1=132.0, z_2=134.0, m_n=6e-4, alpha=math.radians(20), pairs=40.0),
    "HarmonicContact": FLANK | dict(eta_0=0.06, alpha_p=2e-8, F_0=240.0),
    "CycloidalReducer": DISC | dict(mu_ref=0.05, mu_fluid=0.02, mu_bl=0.1, eta_ref=0.03, w_ref=148.7, tau_ref=332.0),
    "MalhotraReducer": DISC
    | dict(mu_s1=0.05, mu_s2=0.05, n_counted=1.0, turns_ring=1.0, P_rated=4000.0, w_rated=148.7, tau_rated=332.0),
    "CycloidPinStage": dict(pin="rolling", disc_torque="output", Zp=40.0, Zc=39.0, Rp=0.064, e=0.0013, r_rp=0.003)
    | dict(b=8.86e-3, N=2.0, a_0=0.04, s_discs=0.012, s_crank=0.04, s_main=0.06, E_eff=230.6e9, sigma=5e-8)
    | dict(mu_fluid=0.03, mu_boundary=0.1, clearance=5e-6, sigma_groove=4e-7),
    "TurningFrame": {},
    "ShaftSupport": SUPPORT,
    "TwoGearSupport": SUPPORT | dict(x_2=0.07, r_2=0.03, phi=2.5),
    "PreloadedPair": dict(arrangement="face-to-face", contact="rollers", F_set=500.0, T_set=293.15, k=1e8, span=0.2)
    | dict(d_m=0.1, alpha=0.25, alpha_s=1.2e-5, alpha_h=2.3e-5),
    "TaperedRollerBearing": SKF | dict(R_1=2.38e-6, R_2=10.9, S_1=0.014, S_2=2.0, Y=1.4, B=0.038, K_L=0.7),
    "DeepGrooveBallBearing": SKF | dict(R_1=3.9e-7, R_2=1.7, S_1=3.23e-3, S_2=36.5, C_0=64e3),
    "CylindricalRollerBearing": SKF | dict(R_1=1e-6, S_1=0.16, S_2=1.5e-3, B=0.038, K_L=0.65),
    "AngularContactBallBearing": SKF
    | dict(R_1=4.33e-7, R_2=2.02, R_3=2.44e-12, S_1=0.0182, S_2=0.71, S_3=2.44e-12, Y=0.57),
    "SphericalRollerBearing": SKF
    | dict(R_1=1.6e-6, R_2=5.84, R_3=2.81e-6, R_4=5.8, S_1=3.62e-3, S_2=508.0, S_3=8.8e-3, S_4=117.0, B=0.028, K_L=0.8),
    "ThrustBallBearing": THRUST | dict(R_1=1.03e-6, S_1=0.016, K_Z=3.8),
    "CylindricalRollerThrustBearing": THRUST | dict(R_1=2.25e-6, S_1=0.154, K_Z=4.4, B=0.013, K_L=0.43),
    "PlainBearing": FRICTION | dict(r=0.03, b=0.05, psi=1e-3, F_r_0=100.0, mu_bl=0.1, C_trans=1.0),
    "NeedleBearing": BEARING | dict(d_m=0.044, f_0=7.0, f_1=2e-4),
    "LipSeal": FRICTION | dict(d_sh=0.14, c_sh=73.4),
    "Churning": FRICTION | dict(c=100.0, a=2.0, b=0.2),
    "OilLipSeal": FRICTION | dict(d_sh=0.14, nu_40=3.2438e-4),
    "LabyrinthSeal": FRICTION | dict(d=0.05, gap=3e-4, L=0.03, oil_share=0.1),
    "GearChurning": FRICTION | WHEEL | dict(height=0.08),
    "GearWindage": FRICTION | WHEEL,
    "MeshSqueezing": FRICTION | WHEEL | dict(r_mate=0.16, fill=0.6, backlash=1e-4),
    "DrumChurning": FRICTION | dict(r=0.05, b=0.03, z=198.0, share_dip=0.4),
    "OilBath": OIL | dict(V=1e-3, c_p=2000.0),
    "DrumOil": OIL | dict(beta=0.7, r=0.15, L=0.25, c_p=2000.0),
    "Grease": OIL,
    "OilSump": OIL | dict(V=1e-3, c_p=2000.0),
    "OilPump": dict(V_disp=1e-5, eta_v=0.9, eta_m=0.8, C_s=1e-8),
    "OilFilter": dict(dp_ref=1e5, m_flow_ref=0.1, nu_ref=1e-4, p_bypass=3e5),
    "OilNozzle": dict(d=2e-3, C_d=0.7),
    "GearJet": dict(d=2e-3, C_d=0.7, r=0.08, height=6.75e-3, A=0.02, along=0.9, c_p=2000.0),
    "OilExchanger": dict(G=300.0, c_p=2000.0),
    "HeatCapacity": dict(C=3600.0),
    "ThermalConductor": dict(G=60.0),
    "PlaneWall": dict(k=50.0, A=0.4, d=0.01),
    "CylinderWall": dict(k=50.0, L=0.3, r_i=0.14, r_o=0.15),
    "JointConductor": JOINT,
    "FootConductor": JOINT | dict(A_base=0.09, k_base=1.4),
    "FrameConductor": JOINT | dict(k_frame=45.0, A_frame=0.2, t_frame=0.016, L_frame=0.1, h_frame=10.0),
    "BearingConductor": JOINT_METAL | dict(d=0.04, D=0.09, B=0.023, p_fit=10e6, gap=10e-6, k_gap=0.13),
    "WettedWall": dict(h=300.0, A=0.5),
    "BeltContact": dict(h=20.0, A=0.7, dT_belt=4.0),
    "BoxCooling": BOX,
    "CylinderCooling": SURFACE | dict(D=0.3, share_ends=0.33),
    "DrumCooling": SURFACE | dict(D=0.32, share_ends=0.2),
    "FinnedBoxCooling": BOX | dict(A_fins=0.5, fin_height=0.03, fin_thickness=0.004, k_fin=50.0),
    "RoundHousing": dict(d=0.011, k=50.0, A_flat_inner=0.074, A_flat_outer=0.083, height=0.23)
    | dict(R_o=0.111, L=0.15, circumference=1.0),
    "OilToHousing": dict(h=200.0),
    "SplashConductor": SPLASH | dict(share=0.5, L=0.3),
    "GearOilConductor": SPLASH,
    "FlatWallCooling": dict(emissivity=0.8),
    "ShellCooling": dict(emissivity=0.8),
    "LinearFlatWallCooling": LINEAR,
    "LinearShellCooling": LINEAR | dict(k_air=0.0257, nu_air=1.511e-5, Pr_air=0.713),
    "Room": {},
    "ClosedRoom": dict(C=2e5),
    "PrescribedTemperature": {},
    "PrescribedHeatFlow": {},
    "Sun": dict(A=0.3, absorptivity=0.7),
    "GreyTeeth": GREY,
    "GreyBearing": GREY,
    "FlowConductor": dict(G_rest=100.0, G_ref=1000.0, e=0.3, w_ref=188.0, nu_ref=1.5e-4),
    "OilJet": dict(G_ref=500.0, e=0.3, w_ref=188.0, nu_ref=1.5e-4),
    "Thermostat": dict(relay=True, T_open=333.0, T_close=328.0, T_width=1.0, t_switch=600.0),
    "Cooler": dict(G_closed=50.0, G_open=900.0, w_on=40.0),
    "ExtraHeat": EXTRA,
    "ExtraDryLoss": EXTRA,
    "ExtraLoss": WET,
    "ExtraHabit": WET | dict(k=1.5),
    "ExtraConductor": dict(G_ref=2.0, dT_ref=35.0, e=0.3, w_ref=20.0, tau_ref=2000.0, c=0.5, forward=1.0, backward=0.5)
    | dict(T_on=330.0, T_side=1.0, T_width=1.5),
    "HeatMove": dict(share=0.2),
    "HeatMoveOfTwo": dict(share=0.2),
}
#: Ports without a source: on them a part gives information, or a temperature of its own.
GIVES = {"DrumOil.heat", "DrumOil.lubricant", "DrumOil.level", "BeltPull.load"} | {
    "OilBath.heat",
    "HeatCapacity.heat",
    "OilBath.lubricant",
    "OilBath.sump",
    "OilSump.heat",
    "OilSump.lubricant",
    "Grease.lubricant",
    "HelicalGearPair.force",
    "InternalGearPair.force",
    "BevelGearPair.pinion_force",
    "BevelGearPair.wheel_force",
    "WormPair.worm_force",
    "WormPair.wheel_force",
}
GIVES |= {"Thermostat.opening"}
#: Heat ports at which a part gives the temperature: heat is pushed into them.
TAKES = {"Room.air", "Room.floor", "ClosedRoom.air", "ClosedRoom.floor", "PrescribedTemperature.heat", "ShaftFan.air"}
GIVES |= {"LoadingClutch.reading"}
GIVES |= {f"PlanetarySet.{k}" for k in ("carrier_load", "sun_load", "planet_load")}
GIVES |= {f"HarmonicMesh.{k}" for k in ("wave_load", "shaft_load")}
GIVES |= {f"CycloidPinStage.{k}" for k in ("eccentric_load", "crank_load", "main_load")}
GIVES |= {f"{s}.{k}" for s in ("ShaftSupport", "TwoGearSupport", "PreloadedPair") for k in ("load_a", "load_b")}
GIVES |= {f"{kind}.thrust" for kind, part in PARTS.items() if issubclass(part, SkfBearing)}
GIVES |= {f"RoundHousing.{k}" for k in ("flat_inside", "flat_outside", "cylinder_inside", "cylinder_outside")}
#: Oil ports at which a part gives the pressure, or leaves it open: oil is pushed into them.
PUSHED = {"OilSump.inlet", "OilSump.outlet", "OilFilter.a", "OilExchanger.a"}
#: What is given at the flanges of a part with several of them; elsewhere the speed (a storage: the torque).
GIVEN = {
    **{
        kind: {"pinion": ("w", "tau"), "wheel": ()} for kind in ("HelicalGearPair", "InternalGearPair", "BevelGearPair")
    },
    "WormPair": {"worm": ("w",), "wheel": ("tau",)},
    "HarmonicMesh": {"wave_generator": ("w",), "flexspline": ("tau",), "circular_spline": ("w",), "wave": ("tau",)},
    "CycloidalReducer": {"input": ("w",), "output": ("tau",)},
    "MalhotraReducer": {"input": ("w",), "output": ("tau",)},
    "PlanetarySet": {"carrier": ("w", "tau"), "sun": (), "ring": ("w",), "planet": ("tau",)},
    "CycloidPinStage": {"crank": (), "carrier": ("w", "tau"), "housing": ("w",)},
    "TurningFrame": {"shaft": ("w", "tau"), "carrier": ("w",), "relative": ()},
    "Inertia": {"flange": ("tau",)},
    "FixedFlange": {"flange": ("tau",)},
    "TorqueSplit": {"flange": ("w", "tau"), "a": ()},
}
#: Flanges that turn alike, because the rest of the closed loop couples them: here they meet on one shaft.
COUPLED = {("LoadingClutch", "b"): "a", ("TorqueSplit", "b"): "a"}


def heater(port: Port, name: str) -> Component:
    """A part that pushes a given heat flow into a port."""
    members: dict = {"port": type(port)(), "P": Input("W", "heat flow rate", 100.0), "__doc__": "Gives a heat flow."}
    members["equations"] = lambda self: iter([equation("heat", self.port.Q_flow, -self.P)])
    members["supplied_power"] = lambda self: (self.P,)
    return type(f"Heater{type(port).__name__}", (Component,), members)(name)


def source(port: Port, name: str, pushes: bool = False) -> Component:
    """A part that gives the potentials of a port as inputs, and takes whatever flows; or pushes a mass flow."""
    quantities = {**type(port).potentials(), **type(port).flows()}
    known = ("m_flow", "h") if pushes else type(port).potentials()
    members: dict = {"port": type(port)(), "__doc__": "Gives the potentials of a port."}
    members |= {k: Input(d.unit, d.doc, d.nominal, start=d.nominal) for k, d in quantities.items() if k in known}
    members["equations"] = lambda self: (equation(k, getattr(self.port, k), self.symbols[k]) for k in known)
    members["supplied_power"] = lambda self: (-self.port.power(),)
    return type(f"Fixed{type(port).__name__}", (Component,), members)(name)


def between_sources(kind: str, **choices):
    part = PARTS[kind]("part", **EXAMPLES[kind] | choices)
    if kind == "ShaftEnd":
        load = PARTS["FanLoad"]("load", k=0.1)
        end = PARTS[kind]("part", given=("w",))
        return flatten(Assembly(kind, "", (end, load), (("part.flange", "load.flange"),)))
    parts, nets = [part], []
    for key, port in part.ports.items():
        if f"{kind}.{key}" in GIVES:
            continue
        if (twin := COUPLED.get((kind, key))) is not None:
            nets.append((port.name, f"part.{twin}"))
        elif isinstance(port, Flange):
            given_here = ("w",) if choices.get("dynamic") is False else GIVEN.get(kind, {}).get(key, ("w",))
            parts.append(PARTS["ShaftEnd"](key, given=given_here))
            nets.append((port.name, f"{key}.flange"))
        else:
            pushes = f"{kind}.{key}" in PUSHED and not (choices.get("runs_over") and key == "outlet")
            parts.append(heater(port, key) if f"{kind}.{key}" in TAKES else source(port, key, pushes))
            nets.append((port.name, f"{key}.port"))
    return flatten(Assembly(kind, "", tuple(parts), tuple(nets)))


def oil_at(T: float) -> dict[str, float]:
    """What a lubricant port tells of an ISO VG 320 PAO."""
    nu = float(kinematic_viscosity(T, OIL["nu_40"], OIL["nu_100"]))
    _, n = walther_constants(OIL["nu_40"], OIL["nu_100"])
    found = {"nu": nu, "rho": float(density(T, OIL["rho_15"], OIL["alpha_T"])), "k": 0.13, "X_L": OIL["X_L"]}
    return found | {"alpha_p": float(pressure_viscosity(nu, 7.382, 0.1335)), "beta_T": float(thermoviscosity(T, nu, n))}
