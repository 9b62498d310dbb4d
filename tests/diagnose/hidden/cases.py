"""What is hidden where: single causes by rig, clean campaigns, and campaigns with one reading that is wrong."""

from diagnose.hidden.effects import (
    Effect,
    churned,
    cooled,
    dragged,
    factors,
    gain,
    heated,
    offset,
    stepped,
    warmed,
)
from diagnose.hidden.maker import Gross

VISCOSITY = {"oil__nu_40": 0.6, "oil__nu_100": 0.65}

HELICAL: dict[str, Effect] = {
    "seals": factors("losses.seal_drag", "seals x 1.5", **{"_seal__k_loss": 1.5}),
    "seals by torque": dragged("input.w", 0.25, {"shafts": 0.5, "wall": 0.5}),
    "churning": churned("input.w", 60.0, 150.0, 2.2, {"oil": 0.9, "gears": 0.1}),
    "preload": Effect("losses.bearing_preload", "1.5 kN on the input shaft", added={"input_bearing_*.F_a_0": 1500}),
    "tooth friction": factors("losses.mesh_friction", "friction x 1.7", stage_1__k_mu=1.7, stage_2__k_mu=1.7),
    "viscosity": factors("losses.oil_viscosity", "viscosity x 0.3", oil__nu_40=0.3, oil__nu_100=0.35),
    "air": cooled("cooling.air", "surface to the room 3 W/K less", "surface", -3.0, 0.25),
    "foundation": factors("cooling.foundation", "foot x 3", foot__G=3.0),
    "emissivity": factors("cooling.emissivity", "0.9 to 0.18", cooling__emissivity=0.2),
    "oil probe": offset("sensor.oil_temp.offset", "T_oil", 2.0),
    "oil probe since a test": stepped("sensor.oil_temp.since", "T_oil", 1.0, 0.55),
    "torque gain": gain("sensor.torque.gain", "T_input", 0.012),
    "room probe heated": warmed("T_amb", "T_oil", 0.3),
    "neighbour": heated(25.0, {"surface": 0.8, "wall": 0.2}),
}

HARMONIC: dict[str, Effect] = {
    "seals": factors("losses.seal_drag", "seals x 2.5", **{"_seal__k_loss": 2.5}),
    "churning": churned("wave_generator.w", 10.0, 105.0, 2.2, {"oil": 1.0}),
    "preload": Effect("losses.bearing_preload", "400 N on the input's bearing", added={"input_bearing.F_a_0": 400}),
    "tooth friction": factors("losses.mesh_friction", "friction x 4", mesh__mu_fluid=4.0, mesh__mu_boundary=2.0),
    "viscosity": factors("losses.oil_viscosity", "viscosity x 0.6", **VISCOSITY),
    "air": cooled("cooling.air", "surface to the room 0.6 W/K less", "housing", -0.6, 0.25),
    "foundation": factors("cooling.foundation", "foot x 3", foot__G=3.0),
    "oil probe": offset("sensor.oil_temp.offset", "T_oil", -2.0),
    "torque offset": offset("sensor.torque.offset", "T_wave_generator", 0.08),
    "neighbour": heated(15.0, {"housing": 1.0}),
}

PLANETARY: dict[str, Effect] = {
    "seals": factors("losses.seal_drag", "seals x 2.2", **{"_seal__k_loss": 2.2}),
    "churning": churned("carrier.w", 120.0, 20.0, 1.8, {"oil": 0.85, "gears": 0.15}),
    "preload": factors("losses.bearing_preload", "preload x 2", carrier_bearing__F_a_0=2.0),
    "tooth friction": factors("losses.mesh_friction", "friction x 1.7", gear_set__k_mu=1.7),
    "viscosity": factors("losses.oil_viscosity", "viscosity x 0.3", oil__nu_40=0.3, oil__nu_100=0.35),
    "air": cooled("cooling.air", "surface to the room 3 W/K less", "surface", -3.0, 0.25),
    "foundation": factors("cooling.foundation", "foot x 2.5", foot__G=2.5),
    "emissivity": factors("cooling.emissivity", "0.92 to 0.09", cooling__emissivity=0.1),
    "contact": factors("cooling.contact", "wall to surface x 0.025", wall_surface__G=0.025),
    "capacity": Effect("thermal.mass", "capacities x 2.2", {"*.C": 2.2}),
    "early": Effect("procedure.not_stationary", "dwells at 0.6 of the time", pace=(0.6, 0.6)),
    "oil probe": offset("sensor.oil_temp.offset", "T_oil", 2.5),
    "torque offset": offset("sensor.torque.offset", "T_sun", 6.0),
    "torque gain": gain("sensor.torque.gain", "T_sun", 0.006),
    "room probe heated": warmed("T_amb", "T_oil", 0.35),
    "neighbour": heated(90.0, {"surface": 0.8, "wall": 0.2}),
}

#: Bench -> what is hidden there.
HIDDEN = {
    "helical": HELICAL,
    "helical_fine": {"seals": HELICAL["seals"]},
    "harmonic": HARMONIC,
    "planetary": PLANETARY,
}

#: Campaigns with a cause and one reading that is wrong besides: rig, case, reading.
GROSS: tuple[tuple[str, str, Gross], ...] = (
    ("helical", "churning", Gross(5, "T_oil", 14)),
    ("helical", "seals by torque", Gross(11, "T_wall", -18)),
    ("helical", "air", Gross(17, "T_input", 22)),
    ("helical", "oil probe", Gross(2, "T_oil", -12)),
    ("helical", "neighbour", Gross(20, "T_amb", 25)),
    ("helical", "torque gain", Gross(9, "T_wall", 15)),
    ("harmonic", "neighbour", Gross(7, "T_oil", 20)),
    ("harmonic", "churning", Gross(14, "T_wave_generator", -16)),
    ("harmonic", "tooth friction", Gross(3, "T_wall", 13)),
    ("planetary", "churning", Gross(12, "T_oil", 24)),
    ("planetary", "torque gain", Gross(21, "T_wall", -14)),
    ("planetary", "neighbour", Gross(30, "T_sun", 17)),
)

#: Campaigns whose first name must not depend on the seed of the diagnosis: rig, case ("" for a clean one), seed.
STABLE: tuple[tuple[str, str, int], ...] = (
    *(("helical", name, 100) for name in HELICAL),
    *(("harmonic", name, 200) for name in HARMONIC),
    *(("planetary", name, 300) for name in ("seals", "churning", "early", "torque gain")),
    ("helical", "", 400),
    ("harmonic", "", 400),
)
