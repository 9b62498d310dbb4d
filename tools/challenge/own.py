"""The project's planetary model as a rig: flattened, with factors on its parameters and heat into its bodies.

Hidden effects never use the parts and effects of the project: they act on factors and heat flows around its equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import casadi as ca
import numpy as np

from ...model.core.flatten import flatten
from ...model.machines.spec import assemble
from ...scenarios.load import load
from .columns import over_columns
from .scene import FACTORS, PLACES, RATIO, Changes, Scene

KELVIN = 273.15

#: Factor -> parameters of the model that it multiplies. Emissivity is over the area, which "conv" multiplies.
PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "mesh": ("gear_set.k_mu",),
    "bearing": ("carrier_bearing.k_loss", "sun_bearing.k_loss", "planet_bearing.k_loss"),
    "seal": ("carrier_seal.k_loss", "sun_seal.k_loss"),
    "viscosity": ("oil.nu_40", "oil.nu_100"),
    "conv": ("cooling.A",),
    "rad": ("cooling.emissivity",),
    "foot": ("foot.G",),
    "contact": ("wall_surface.G",),
    "oil_wall": ("oil_wall.G",),
    "oil_inner": ("oil_gears.G", "oil_carrier_body.G"),
    "cap_oil": ("oil.c_p",),
    "cap_in": ("gears.C", "carrier_body.C"),
    "cap_out": ("wall.C", "surface.C"),
}

#: Place -> body of the model.
#: Newton's corrections of the implicit losses.
NEWTON_STEPS = 3
BODIES: Mapping[str, str] = {
    "oil": "oil",
    "gears": "gears",
    "body": "carrier_body",
    "wall": "wall",
    "surface": "surface",
}


class OwnRig:
    """The model, evaluated for many columns at once."""

    def __init__(self) -> None:
        scenario = load("planetary")
        flat = flatten(assemble(scenario.spec.driven({"carrier": ("w", "tau")})))
        self.nodes = len(flat.states)
        self._state = [flat.locate(f"{BODIES[place]}.T")[1] for place in PLACES]
        n, tau, room = (ca.SX.sym(name) for name in ("w", "tau", "room"))
        heat, factors = ca.SX.sym("heat", len(PLACES)), ca.SX.sym("factors", len(FACTORS))
        u, p = ca.SX(flat.starts("input")), ca.SX(flat.starts("parameter"))
        inputs = {"carrier.w": n, "carrier.tau": tau, "room.T": room}
        inputs |= {f"{BODIES[place]}.Q_flow_external": heat[i] for i, place in enumerate(PLACES)}
        for name, value in {**scenario.operating_point, **inputs}.items():
            u[flat.locate(name)[1]] = value
        for name, parameters in PARAMETERS.items():
            factor = factors[FACTORS.index(name)]
            if name == "rad":
                factor = factor / factors[FACTORS.index("conv")]
            for parameter in parameters:
                p[flat.locate(parameter)[1]] *= factor
        y = flat.y[flat.locate("sun.tau")[1]]
        ode, sun, residual, slope = ca.substitute(
            [flat.ode, y, flat.residual, ca.jacobian(flat.residual, flat.z)], [flat.u, flat.p], [u, p]
        )
        z = ca.SX(flat.starts("algebraic"))
        for _ in range(NEWTON_STEPS):  # as many as leave round-off at the loads of a campaign
            z -= ca.solve(*ca.substitute([slope, residual], [flat.z], [z]))
        ode, sun = ca.substitute([ode, sun], [flat.z], [z])
        given = ca.vertcat(n, tau, room, heat, factors)
        self._rows = given.numel()
        self._function = ca.Function("own", [flat.x, given], [ode, sun], {"cse": True})
        nu = flat.y[flat.locate("oil.nu")[1]]
        (nu,) = ca.substitute([nu], [flat.u, flat.p], [u, p])
        parts = [flat.x[flat.locate("oil.T")[1]], factors]
        self._nu_function = ca.Function("nu", parts, [nu])
        self._viscosities = self._table()
        starts = {q.name: q.start for q in flat.parameters}
        inner, outer = (sum(starts[name] for name in PARAMETERS[f]) for f in ("cap_in", "cap_out"))
        self.inner_share = inner / (inner + outer)

    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        """Temperatures [degC] and the logarithm of the oil's viscosity [mm2/s] there."""
        T = np.arange(-20.0, 201.0, 2.0)
        nu = [float(self._nu_function(t + KELVIN, np.ones(len(FACTORS)))) for t in T]
        return T, np.log(1e6 * np.array(nu))

    def temperatures(self, T: np.ndarray) -> dict[str, np.ndarray]:
        """Temperature of every place."""
        return {place: T[i] for place, i in zip(PLACES, self._state, strict=True)}

    def viscosity(self, T_oil: np.ndarray) -> np.ndarray:
        """Kinematic viscosity of the oil [mm2/s]."""
        T, log_nu = self._viscosities
        nu: np.ndarray = np.exp(np.interp(T_oil, T, log_nu))
        return nu

    def second_oil(self, places: Mapping[str, np.ndarray]) -> np.ndarray:
        """The model knows one oil temperature."""
        return places["oil"]

    def rate(self, T: np.ndarray, scene: Scene, changes: Changes) -> np.ndarray:
        """Slopes of all bodies [K/s]."""
        return self._evaluate(T, scene, changes)[0]

    def loss_torque(self, T: np.ndarray, scene: Scene, changes: Changes) -> np.ndarray:
        """What lacks between the torques of carrier and sun [N.m]."""
        sun = np.abs(self._evaluate(T, scene, changes)[1])
        sign = 1.0 if scene.direction == 1 else -1.0
        loss: np.ndarray = sign * (scene.load - RATIO * sun)
        return loss

    def _evaluate(self, T: np.ndarray, scene: Scene, changes: Changes) -> tuple[np.ndarray, np.ndarray]:
        m = T.shape[1]
        given = np.empty((self._rows, m))
        given[0] = scene.w
        given[1] = scene.load if scene.direction == 1 else -scene.load
        given[2] = scene.room + KELVIN
        for i, place in enumerate(PLACES):
            given[3 + i] = changes.heat.get(place, 0.0)
        for i, name in enumerate(FACTORS):
            given[3 + len(PLACES) + i] = changes.factor(name)
        ode, sun = over_columns(self._function, m)(T + KELVIN, given)
        return ode, sun[0]


@cache
def own_rig() -> OwnRig:
    """The one rig of this sheet; flattened once."""
    return OwnRig()
