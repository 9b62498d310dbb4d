"""The "own" sheet: the project's planetary model as a rig, with unequal parameters and no reference campaign.

The model is flattened, with factors on its parameters and heat into its bodies. Hidden faults never use causes of the
project: they act on factors and heat flows around its equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, lru_cache, partial

import casadi as ca
import numpy as np

from ...model.core.flatten import flatten
from ...model.machines.spec import assemble
from ...scenarios.load import load
from . import files, forms
from .cases import Drawn
from .columns import Columns
from .plan import draw_plan, draw_points
from .rig import CHANNELS, FACTORS, PLACES, RATIO, Scene, run

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
BODIES = dict(zip(PLACES, ("oil", "gears", "carrier_body", "wall", "surface"), strict=True))

#: Newton's corrections of the implicit losses: as many as leave round-off at the loads of a campaign.
NEWTON_STEPS = 3

#: Factors that belong together, and how uncertain the card says they are.
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
        for _ in range(NEWTON_STEPS):
            z -= ca.solve(*ca.substitute([slope, residual], [flat.z], [z]))
        ode, sun = ca.substitute([ode, sun], [flat.z], [z])
        given = ca.vertcat(n, tau, room, heat, factors)
        function = ca.Function("own", [flat.x, given], [ode, sun], {"cse": True})
        self._columns = lru_cache(8)(partial(Columns, function))
        (nu,) = ca.substitute([flat.y[flat.locate("oil.nu")[1]]], [flat.u, flat.p], [u, p])
        of_T = ca.Function("nu", [flat.x[flat.locate("oil.T")[1]], factors], [nu])
        self._T = np.arange(-20.0, 201.0, 2.0)
        self._log_nu = np.log([1e6 * float(of_T(t + KELVIN, np.ones(len(FACTORS)))) for t in self._T])
        starts = {q.name: q.start for q in flat.parameters}
        inner, outer = (sum(starts[name] for name in PARAMETERS[f]) for f in ("cap_in", "cap_out"))
        self.inner_share = inner / (inner + outer)

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
        sun = np.abs(self._evaluate(T, scene)[1][0])
        return np.asarray(np.where(scene.direction == 1, 1.0, -1.0) * (scene.load - RATIO * sun))

    def _evaluate(self, T: np.ndarray, scene: Scene) -> list[np.ndarray]:
        tau = np.where(scene.direction == 1, scene.load, -scene.load)
        heats, factors = (scene.heat[p] for p in PLACES), (scene.factor[f] for f in FACTORS)
        given = np.array([scene.w, tau, scene.room + KELVIN, *heats, *factors])
        return self._columns(T.shape[1])(T + KELVIN, given)


@cache
def own_rig() -> OwnRig:
    """The one rig of this sheet; flattened once."""
    return OwnRig()


def draw(rng: np.random.Generator) -> Drawn:
    """The rig with unequal parameters, and its campaign."""
    rig, second = own_rig(), bool(rng.random() < 0.5)
    warm = bool(rng.random() < 0.15)
    plan = draw_plan(rng, warm_start=warm)
    base = {name: f for names, sd in PRIOR_SD.items() for f in [np.exp(rng.normal(0.0, sd))] for name in names.split()}
    day = np.exp(rng.normal(0.0, files.DAY_COOLING_SD, plan.columns))
    return Drawn(
        run=partial(run, rig, len(CHANNELS) - (not second)),
        plan=plan,
        points=draw_points(rng, plan),
        reference=None,
        base=base,
        cooling=("conv", "rad"),
        days=(day, day),
        day_sd=files.DAY_COOLING_SD,
        prior=PRIOR_SD,
        instruments=files.draw_instruments(rng, 0.25, second_oil=second),
        columns=files.Columns(humidity=True, start=warm, date=bool(rng.random() < 0.5)),
        bearing_oil=False,
        room_drift=0.0,
        band=(5.0, 40.0),
        names=forms.names,
        draw=partial(forms.draw, plan, rig.inner_share),
        facts={"nodes": rig.nodes},
    )
