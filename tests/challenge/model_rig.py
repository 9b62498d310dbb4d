"""Shipped rigs as simulators: the project's own model, with factors on its parameters and heat into its bodies.

Sheet "own" is the planetary rig with unequal parameters and no reference campaign; sheet "rigs" are steady points of
other rigs, in columns of the user's own words. Hidden faults never use causes of the project: they act on factors and
heat flows around the model's equations. Faults and instruments are stated for a rig of the planetary's size, so another
rig runs in scaled units: its speed, torques and powers times fixed factors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cache, partial

import casadi as ca
import numpy as np
from gearheat.model.core.flat import FlatModel
from gearheat.scenarios.load import load

from . import files, forms
from .cases import Drawn
from .columns import Columns
from .instruments import LOAD, N
from .plan import draw_plan, draw_points, hold
from .rig import CHANNELS, FACTORS, PLACES, RATIO, Scene, run

KELVIN = 273.15

#: Newton's corrections of the implicit losses: as many as leave round-off at the loads of a campaign.
NEWTON_STEPS = 3

#: Factor -> parameters that it multiplies in every rig. Emissivity is over the area, which "conv" multiplies.
PARAMETERS: Mapping[str, str] = {
    "bearing": "*_bearing*.k_loss",
    "seal": "*_seal.k_loss",
    "churning": "churning*.k_loss",
    "viscosity": "oil.nu_*",
    "conv": "cooling.A",
    "rad": "cooling.emissivity",
    "foot": "foot.G",
    "cap_oil": "oil.c_p",
}

#: Factors that differ together -> relative standard deviation on the card [1].
PRIOR_SD: Mapping[str, float] = {
    "mesh": files.PRIOR_SD["mu"],
    "bearing": files.PRIOR_SD["brg"],
    "seal": files.PRIOR_SD["seal"],
    "conv": files.PRIOR_SD["hconv"],
    "rad": files.PRIOR_SD["rad"],
    "oil_wall oil_inner": files.PRIOR_SD["gow"],
    "contact": files.PRIOR_SD["gwh"],
    "cap_oil cap_in cap_out": files.PRIOR_SD["cap"],
}
#: The same of the other rigs, which churn more.
STEADY_PRIOR_SD = {**PRIOR_SD, "churning": files.PRIOR_SD["seal"]}


@dataclass(frozen=True)
class Machine:
    """A shipped rig on a bench, and its sizes over those of the scaled rig [1].

    Args:
        rig: its name
        ends: paths of the given speed, of the given torque, and of the torque that shows the losses
        bodies: of the model, one for each of `PLACES`
        parameters: factor -> patterns of the parameters that it multiplies, besides `PARAMETERS`
        speed, torque, other: of what `ends` name; a torque below zero where a reducer's load is positive in the model
        power: that the shafts transmit
        loss: that faults cause, over `power`
        sensors: channel -> sensor of the rig and column of the table; none for the planetary rig's own
    """

    rig: str
    ends: tuple[str, str, str]
    bodies: tuple[str, ...]
    parameters: Mapping[str, str]
    speed: float = 1.0
    torque: float = 1.0
    other: float = 1.0
    power: float = 1.0
    loss: float = 1.0
    sensors: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    @property
    def columns(self) -> Mapping[str, files.Column]:
        """Channel -> how the table shows it, where it is not as the planetary rig's."""
        sizes = {"n_carrier_rpm": self.speed, "T_carrier_Nm": abs(self.torque), "T_sun_Nm": self.other}
        reads = {"T_sun_Nm": self.ends[2]}
        return {c: files.Column(*k, sizes.get(c, 1.0), reads.get(c, "")) for c, k in self.sensors.items()}


def reducer(
    rig: str,
    middle: tuple[float, float, float],
    bodies: tuple[str, ...],
    parameters: Mapping[str, str],
    columns: Mapping[str, str],
    loss: float,
) -> Machine:
    """A rig whose input has a given speed, whose output a given torque, and whose input's torque shows the losses.

    Args:
        rig, bodies, parameters, loss: see `Machine`
        middle: of its campaigns: speed of the input [rpm], torque of the output [N.m], speed of input over output [1]
        columns: sensor of the rig, or of the card for the torque of the input -> column of the table
    """
    speed, torque, ratio = middle[0] / N, middle[1] / LOAD, middle[2]
    shaft = next(iter(columns)).removeprefix("n_")
    return Machine(
        rig=rig,
        ends=(f"{shaft}.w", "output.tau", f"{shaft}.tau"),
        bodies=bodies,
        parameters=parameters,
        speed=speed,
        torque=torque,
        other=RATIO * abs(torque) / ratio,
        power=abs(torque) * speed / ratio,
        loss=loss,
        sensors=dict(zip(CHANNELS, columns.items(), strict=False)),
    )


PLANETARY = Machine(
    rig="planetary",
    ends=("carrier.w", "carrier.tau", "sun.tau"),
    bodies=("oil", "gears", "carrier_body", "wall", "surface"),
    parameters={
        "mesh": "gear_set.k_mu",
        "churning": "",
        "contact": "wall_surface.G",
        "oil_wall": "oil_wall.G",
        "oil_inner": "oil_gears.G oil_carrier_body.G",
        "cap_in": "gears.C carrier_body.C",
        "cap_out": "wall.C surface.C",
    },
)
HELICAL = reducer(
    rig="helical_two_stage",
    middle=(1000.0, 400.0, 12.56),
    bodies=("oil", "gears", "shafts", "wall", "surface"),
    parameters={
        "mesh": "stage_*.k_mu",
        "contact": "wall_surface.G",
        "oil_wall": "oil_wall.G",
        "oil_inner": "oil_gears.G",
        "cap_in": "gears.C shafts.C",
        "cap_out": "wall.C surface.C",
    },
    columns={
        "n_input": "Drehzahl [rpm]",
        "T_output": "Abtrieb [N.m]",
        "T_input": "Antrieb [N.m]",
        "T_oil": "Ölsumpf [degC]",
        "T_wall": "Gehäuse [degC]",
        "T_amb": "Halle [degC]",
    },
    loss=5.0,
)
HARMONIC = reducer(
    rig="harmonic",
    middle=(1000.0, -140.0, 66.0),
    bodies=("oil", "wave_body", "flexspline", "housing", "housing"),
    parameters={
        "mesh": "mesh.mu_*",
        "contact": "circular_housing.G",
        "oil_wall": "oil_housing.G",
        "oil_inner": "oil_wave.G oil_flexspline.G oil_circular.G",
        "cap_in": "wave_body.C flexspline.C circular_spline.C",
        "cap_out": "housing.C",
    },
    columns={
        "n_wave_generator": "speed [rpm]",
        "T_output": "load [N.m]",
        "T_wave_generator": "motor torque [N.m]",
        "T_oil": "sump [degC]",
        "T_wall": "case [degC]",
        "T_amb": "lab [degC]",
    },
    loss=12.0,
)


class ModelRig:
    """The model of a machine, evaluated for many columns at once."""

    def __init__(self, machine: Machine) -> None:
        self.machine, self.power_unit = machine, machine.loss
        scenario = load(machine.rig)
        w, tau, other = machine.ends
        driven = scenario.spec if machine.sensors else scenario.spec.driven({"carrier": ("w", "tau")})
        flat = driven.flat()
        self.nodes = len(flat.states)
        self._state = [flat.locate(f"{body}.T")[1] for body in machine.bodies]
        n, load_torque, room = (ca.SX.sym(name) for name in ("w", "tau", "room"))
        heat, factors = ca.SX.sym("heat", len(PLACES)), ca.SX.sym("factors", len(FACTORS))
        u, p = ca.SX(flat.starts("input")), ca.SX(flat.starts("parameter"))
        inputs = {w: machine.speed * n, tau: machine.torque * load_torque, "room.T": room}
        for name, value in {**scenario.operating_point, **inputs}.items():
            u[flat.locate(name)[1]] = value
        for i, body in enumerate(machine.bodies):
            u[flat.locate(f"{body}.Q_flow_external")[1]] += machine.power * machine.loss * heat[i]
        scaled = {name: self._matching(flat, name) for name in FACTORS}
        for name, parameters in scaled.items():
            factor = factors[FACTORS.index(name)]
            if name == "rad":
                factor = factor / factors[FACTORS.index("conv")]
            for parameter in parameters:
                p[flat.locate(parameter)[1]] *= factor
        y = flat.y[flat.locate(other)[1]] / machine.other
        ode, torque, residual, slope = ca.substitute(
            [flat.ode, y, flat.residual, ca.jacobian(flat.residual, flat.z)], [flat.u, flat.p], [u, p]
        )
        z = ca.SX(flat.starts("algebraic"))
        for _ in range(NEWTON_STEPS):
            z -= ca.solve(*ca.substitute([slope, residual], [flat.z], [z]))
        ode, torque = ca.substitute([ode, torque], [flat.z], [z])
        given = ca.vertcat(n, load_torque, room, heat, factors)
        function = ca.Function("rig", [flat.x, given], [ode, torque], {"cse": True})
        self._columns = Columns(function)
        (nu,) = ca.substitute([flat.y[flat.locate("oil.nu")[1]]], [flat.u, flat.p], [u, p])
        of_T = ca.Function("nu", [flat.x[flat.locate("oil.T")[1]], factors], [nu])
        self._T = np.arange(-20.0, 201.0, 2.0)
        self._log_nu = np.log([1e6 * float(of_T(t + KELVIN, np.ones(len(FACTORS)))) for t in self._T])
        starts = {q.name: q.start for q in flat.parameters}
        inner, outer = (sum(starts[name] for name in scaled[f]) for f in ("cap_in", "cap_out"))
        self.inner_share = inner / (inner + outer)

    def _matching(self, flat: FlatModel, factor: str) -> list[str]:
        """Parameters that a factor multiplies."""
        patterns = {**PARAMETERS, **self.machine.parameters}[factor].split()
        return [q.name for pattern in patterns for q in flat.parameters if fnmatchcase(q.name, pattern)]

    def temperatures(self, T: np.ndarray) -> dict[str, np.ndarray]:
        """Temperature of every place."""
        return {place: T[i] for place, i in zip(PLACES, self._state, strict=True)}

    def viscosity(self, T_oil: np.ndarray) -> np.ndarray:
        """Kinematic viscosity of the oil [mm2/s]."""
        return np.asarray(np.exp(np.interp(T_oil, self._T, self._log_nu)))

    def second_oil(self, places: Mapping[str, np.ndarray]) -> np.ndarray:
        """The model knows one oil temperature."""
        return places["oil"]

    def rate(self, T: np.ndarray, scene: Scene) -> np.ndarray:
        """Slopes of all bodies [K/s]."""
        return self._evaluate(T, scene)[0]

    def loss_torque(self, T: np.ndarray, scene: Scene) -> np.ndarray:
        """What lacks between the torques of carrier and sun [N.m]."""
        other = np.abs(self._evaluate(T, scene)[1][0])
        return np.asarray(np.where(scene.direction == 1, 1.0, -1.0) * (scene.load - RATIO * other))

    def _evaluate(self, T: np.ndarray, scene: Scene) -> list[np.ndarray]:
        tau = np.where(scene.direction == 1, scene.load, -scene.load)
        heats, factors = (scene.heat[p] for p in PLACES), (scene.factor[f] for f in FACTORS)
        given = np.array([scene.w, tau, scene.room + KELVIN, *heats, *factors])
        return self._columns(T + KELVIN, given)


@cache
def rig_of(machine: str) -> ModelRig:
    """The simulator of a shipped rig; flattened once."""
    return ModelRig({m.rig: m for m in (PLANETARY, HELICAL, HARMONIC)}[machine])


def draw(rng: np.random.Generator) -> Drawn:
    """A case of the sheet "own": the planetary rig with unequal parameters, and its campaign."""
    rig, second = rig_of("planetary"), bool(rng.random() < 0.5)
    warm = bool(rng.random() < 0.15)
    plan = draw_plan(rng, warm_start=warm)
    base = _draw_base(rng, PRIOR_SD)
    day = np.exp(rng.normal(0.0, files.DAY_COOLING_SD, plan.columns))
    return Drawn(
        run=partial(run, rig, len(CHANNELS) - (not second)),
        plan=plan,
        points=draw_points(rng, plan),
        base=base,
        days=(day, day),
        prior=PRIOR_SD,
        instruments=files.draw_instruments(rng, 0.25, second_oil=second),
        layout=files.Layout(humidity=True, start=warm, date=bool(rng.random() < 0.5)),
        band=(5.0, 40.0),
        names=forms.names,
        draw=partial(forms.draw, plan, rig.inner_share),
        facts={"nodes": rig.nodes},
    )


def draw_steady(rng: np.random.Generator, machine: str = "") -> Drawn:
    """A case of the sheet "rigs": steady points of a machine, or of one that is drawn."""
    name = machine or str(rng.choice([HELICAL.rig, HARMONIC.rig]))
    rig, plan = rig_of(name), hold(draw_plan(rng), rng)
    base = _draw_base(rng, STEADY_PRIOR_SD)
    day = np.exp(rng.normal(0.0, files.DAY_COOLING_SD, plan.columns))
    return Drawn(
        run=partial(run, rig, len(CHANNELS) - 1),
        plan=plan,
        points=hold(draw_points(rng, plan), rng),
        base=base,
        days=(day, day),
        prior=STEADY_PRIOR_SD,
        instruments=files.draw_instruments(rng, 0.25, second_oil=False, gross=0.4),
        layout=files.Layout(shown=rig.machine.columns),
        band=(5.0, 40.0),
        names=forms.steady_names,
        draw=partial(forms.draw, plan, rig.inner_share),
        facts={"nodes": rig.nodes, "name": name},
    )


def _draw_base(rng: np.random.Generator, prior_sd: Mapping[str, float]) -> dict[str, float]:
    """Factors of a rig's parameters, as uncertain as the card says."""
    return {name: f for names, sd in prior_sd.items() for f in [np.exp(rng.normal(0.0, sd))] for name in names.split()}
