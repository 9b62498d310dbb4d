"""The "foreign" sheet: a gearbox of its own in plain numpy, with a healthy reference campaign.

Other laws, other nodes, other sizes than the project's model. Teeth rub with a constant share and one that falls with
the film, or by a logarithm of it; bearings have a viscous and a load torque after Palmgren; seals rub by viscosity and
speed; convection goes with a power 0.2 to 0.33 of the temperature difference. Three, four or six nodes. Areas,
conductances and capacities lie up to a factor of two from those of the project's rig, either way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from . import files, forms
from .cases import Drawn
from .plan import OIL, draw_plan, draw_points
from .rig import CHANNELS, Scene, run

SIGMA = 5.670374e-8

#: Place -> node, by number of nodes.
NODES: Mapping[int, Mapping[str, int]] = {
    3: {"oil": 0, "gears": 0, "body": 0, "wall": 1, "surface": 2},
    4: {"oil": 0, "gears": 1, "body": 1, "wall": 2, "surface": 3},
    6: {"oil": 0, "gears": 1, "body": 2, "rings": 3, "wall": 4, "surface": 5},
}

#: Conductances between nodes: from, to, size [W/K], factor that scales it.
LINKS: Mapping[int, tuple[tuple[int, int, float, str], ...]] = {
    3: ((0, 1, 220.0, "oil_wall"), (1, 2, 900.0, "contact")),
    4: ((0, 1, 95.0, "oil_inner"), (0, 2, 200.0, "oil_wall"), (1, 2, 55.0, ""), (2, 3, 900.0, "contact")),
    6: (
        (0, 1, 60.0, "oil_inner"),
        (0, 2, 45.0, "oil_inner"),
        (0, 4, 190.0, "oil_wall"),
        (0, 3, 15.0, ""),
        (2, 3, 80.0, ""),
        (3, 4, 120.0, ""),
        (4, 5, 900.0, "contact"),
    ),
}

#: Heat capacities [kJ/K] and the factor that scales each.
CAPACITIES: Mapping[int, tuple[tuple[float, str], ...]] = {
    3: ((15.0, "cap_in"), (9.0, "cap_out"), (6.0, "cap_out")),
    4: ((1.75, "cap_oil"), (13.0, "cap_in"), (9.0, "cap_out"), (6.0, "cap_out")),
    6: ((1.75, "cap_oil"), (3.6, "cap_in"), (8.5, "cap_in"), (2.5, "cap_in"), (8.5, "cap_out"), (6.0, "cap_out")),
}

#: Conditions in the middle of every campaign: speed [rpm], torque [N.m], oil [degC].
MIDDLE = (175.0, 2130.0, 60.0)

#: What is drawn evenly. Losses are torques at the carrier in the middle of the campaign [N.m].
EVEN: Mapping[str, tuple[float, float]] = {
    "mesh": (8.5, 18.0),
    "mesh_film": (0.1, 0.5),
    "mesh_exponent": (0.2, 0.9),
    "mesh_to_oil": (0.0, 0.4),
    "reducer": (-0.02, 0.02),
    "viscous": (0.3, 0.7),
    "bearing": (6.5, 16.0),
    "seal": (2.0, 6.0),
    "seal_slope": (0.2, 1.0),
    "no_load": (0.0, 2.0),
    "vogel": (95.0, 130.0),
    "splash": (0.0, 0.5),
    "conv_exponent": (0.2, 0.33),
    "draught": (0.0, 0.4),
    "rad": (0.25, 0.85),
    "oil_2": (0.0, 0.15),
}


@dataclass(frozen=True)
class Sizes:
    """What is drawn for a rig: even numbers, cooling [W/K], and factors of links and capacities."""

    nodes: int
    even: Mapping[str, float]
    film: bool
    bearing_oil: bool
    conv: float
    foot: float
    links: np.ndarray
    capacities: np.ndarray


def draw_sizes(rng: np.random.Generator) -> Sizes:
    """A rig whose oil stands 22 to 58 K above the room in the middle of a campaign."""
    while True:
        nodes = int(rng.choice(list(NODES)))
        even = {name: float(rng.uniform(*ends)) for name, ends in EVEN.items()}
        scale, capacity, conv, foot = 2.0 ** rng.uniform([-0.7, -0.7, -1.0, -1.0], [0.7, 0.7, 1.0, 1.0])
        links = np.clip(scale * 2.0 ** rng.uniform(-0.6, 0.6, len(LINKS[nodes])), 0.5, 2.0)
        capacities = np.clip(capacity * 2.0 ** rng.uniform(-0.4, 0.4, len(CAPACITIES[nodes])), 0.5, 2.0)
        film, bearing_oil = rng.random(2) < (0.5, 0.3)
        sizes = Sizes(nodes, even, bool(film), bool(bearing_oil), 6.0 * conv, 5.0 * foot, links, capacities)
        watts = sum(even[name] for name in ("mesh", "bearing", "seal", "no_load")) * MIDDLE[0] * np.pi / 30
        if 22.0 < watts / (sizes.conv + 5.5 * even["rad"] + sizes.foot) < 58.0:
            return sizes


class ForeignRig:
    """The rig of some sizes."""

    power_unit = 1.0

    def __init__(self, sizes: Sizes) -> None:
        self.sizes, self.nodes, self._place = sizes, sizes.nodes, NODES[sizes.nodes]
        self._links = [(a, b, G * f, name) for (a, b, G, name), f in zip(LINKS[self.nodes], sizes.links, strict=True)]
        capacities = zip(CAPACITIES[self.nodes], sizes.capacities, strict=True)
        self._capacities = [(1e3 * C * f, name) for (C, name), f in capacities]
        ends, vogel = np.log([OIL["nu40"], OIL["nu100"]]), sizes.even["vogel"]
        self._vogel_B = (ends[0] - ends[1]) / (1 / (40 + vogel) - 1 / (100 + vogel))
        self._vogel_A = ends[0] - self._vogel_B / (40 + vogel)
        self._nu_middle = float(self.viscosity(np.array(MIDDLE[2])))
        inner, outer = (sum(C for C, name in self._capacities if name == f) for f in ("cap_in", "cap_out"))
        self.inner_share = inner / (inner + outer)

    def temperatures(self, T: np.ndarray) -> dict[str, np.ndarray]:
        """Temperature of every place."""
        return {place: T[node] for place, node in self._place.items() if place != "rings"}

    def viscosity(self, T_oil: np.ndarray) -> np.ndarray:
        """Kinematic viscosity after Vogel, through both catalogue values [mm2/s]."""
        return np.asarray(np.exp(self._vogel_A + self._vogel_B / (np.maximum(T_oil, -40.0) + self.sizes.even["vogel"])))

    def second_oil(self, places: Mapping[str, np.ndarray]) -> np.ndarray:
        """Oil nearer to the wall."""
        share = self.sizes.even["oil_2"]
        return (1 - share) * places["oil"] + share * places["wall"]

    def loss_torque(self, T: np.ndarray, scene: Scene) -> np.ndarray:
        """Sum of all torques."""
        return np.asarray(np.add.reduce(self._torques(scene)))

    def _torques(self, s: Scene) -> list[np.ndarray]:
        """Torques of teeth, bearings, seals and stirring at the carrier [N.m]."""
        z, n, load = self.sizes.even, np.maximum(s.n, 2.0) / MIDDLE[0], s.load / MIDDLE[1]
        nu = s.nu * s.factor["viscosity"] / self._nu_middle
        if self.sizes.film:
            mu = (1 - z["mesh_film"]) + z["mesh_film"] * (n * nu) ** -z["mesh_exponent"]
        else:
            mu = np.log(np.maximum(60.0 * (load + 0.02) / (nu * n**2.0 + 1e-3), 2.0)) / np.log(60.0)
        mesh = z["mesh"] * load * mu * s.factor["mesh"] * (1 + z["reducer"] * (s.direction - 1.0))
        thickness = nu if self.sizes.bearing_oil else (s.nu / self._nu_middle) ** 0.8
        viscous = z["viscous"] * (n * thickness) ** (2.0 / 3.0)
        bearing = z["bearing"] * (viscous + (1 - z["viscous"]) * (0.5 + 0.5 * load)) * s.factor["bearing"]
        rubbing = 1 + z["seal_slope"] * np.log(np.log(nu * self._nu_middle + 2.0) / np.log(self._nu_middle + 2.0))
        seal = z["seal"] * rubbing * n**-0.1 * s.factor["seal"]
        stirring = z["no_load"] * n**1.5 * nu**0.2
        return [part * s.running for part in (mesh, bearing, seal, stirring)]

    def rate(self, T: np.ndarray, scene: Scene) -> np.ndarray:
        """Heat balance of every node [K/s]."""
        place, to_oil = self._place, self.sizes.even["mesh_to_oil"]
        flows = np.zeros_like(T)
        mesh, bearing, seal, stirring = (torque * scene.w for torque in self._torques(scene))
        for node, power in (
            (place["gears"], (1 - to_oil) * mesh),
            (place["oil"], to_oil * mesh + stirring),
            (place["body"], 0.5 * (bearing + seal)),
            (place.get("rings", place["wall"]), 0.5 * bearing),
            (place["wall"], 0.5 * seal),
            *((place[name], heat) for name, heat in scene.heat.items()),
        ):
            flows[node] += power
        splash = ((scene.n + 20.0) / MIDDLE[0]) ** self.sizes.even["splash"]
        for a, b, G, name in self._links:
            flow = G * scene.factor.get(name, 1.0) * (T[a] - T[b]) * (splash if name.startswith("oil") else 1.0)
            flows[a] -= flow
            flows[b] += flow
        flows[place["surface"]] -= self.cooling(T[place["surface"]], scene)
        return np.asarray(flows / np.array([C * scene.factor[name] for C, name in self._capacities]))

    def cooling(self, T: np.ndarray, s: Scene) -> np.ndarray:
        """Heat from the surface to the room [W]."""
        z, dT = self.sizes.even, T - s.room
        free = ((dT / 30.0) ** 2 + 1e-3) ** (0.5 * z["conv_exponent"])
        convection = self.sizes.conv * s.factor["conv"] * (z["draught"] + (1 - z["draught"]) * free) * dT
        radiation = z["rad"] * s.factor["rad"] * SIGMA * ((T + 273.15) ** 4 - (s.room + 273.15) ** 4)
        return np.asarray(convection + radiation + self.sizes.foot * s.factor["foot"] * dT)


#: Freedom of a rig of unknown sizes: the diagnosis learns it from the reference.
PRIOR_SD = dict.fromkeys(
    ("mesh", "bearing", "seal", "conv", "rad", "oil_wall oil_inner", "contact", "cap_oil cap_in cap_out"), 0.4
)


def draw(rng: np.random.Generator) -> Drawn:
    """A rig and its campaigns: the data, a reference five weeks earlier, and points to predict."""
    rig, second = ForeignRig(draw_sizes(rng)), bool(rng.random() < 0.5)
    warm, drift = bool(rng.random() < 0.15), round(float(rng.uniform(-1.5, 0.5)), 2)
    plan, reference = (draw_plan(rng, warm_start=warm, room_drift=drift) for _ in range(2))
    if rng.random() < 0.6:  # the reference repeats the campaign's conditions, on other days in another order
        reference = replace(reference, n=plan.n + rng.normal(0, 0.5, plan.columns), load=plan.load)
    a, b = (np.exp(rng.normal(0.0, files.DAY_COOLING_SD, p.columns)) for p in (plan, reference))
    return Drawn(
        run=partial(run, rig, len(CHANNELS) - (not second)),
        plan=plan,
        points=draw_points(rng, plan, room_drift=drift),
        reference=reference,
        days=(a, b),
        prior=PRIOR_SD,
        instruments=files.draw_instruments(rng, 0.7, second_oil=second),
        layout=files.Layout(humidity=True, start=warm, date=bool(rng.random() < 0.5)),
        bearing_oil=rig.sizes.bearing_oil,
        room_drift=drift,
        band=(5.0, 60.0),
        names=forms.names,
        draw=partial(forms.draw, plan, rig.inner_share),
        facts={"nodes": rig.nodes},
    )
