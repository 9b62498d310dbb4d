"""A gearbox of its own in plain numpy: other laws, other nodes, other sizes than the project's model.

Teeth rub with a constant share and one that falls with the film, or by the logarithm of Benedict and Kelley; bearings
have a viscous and a load torque after Palmgren; seals rub by viscosity and speed as Freudenberg states; convection goes
with a power 0.2 to 0.33 of the temperature difference. Three, four or six nodes. Areas, conductances and capacities lie
up to a factor of two from those of the project's rig, either way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .plan import OIL
from .scene import Changes, Scene

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

#: Heat capacities [J/K] and the factor that scales each.
CAPACITIES: Mapping[int, tuple[tuple[float, str], ...]] = {
    3: ((15000.0, "cap_in"), (9000.0, "cap_out"), (6000.0, "cap_out")),
    4: ((1750.0, "cap_oil"), (13000.0, "cap_in"), (9000.0, "cap_out"), (6000.0, "cap_out")),
    6: (
        (1750.0, "cap_oil"),
        (3600.0, "cap_in"),
        (8500.0, "cap_in"),
        (2500.0, "cap_in"),
        (8500.0, "cap_out"),
        (6000.0, "cap_out"),
    ),
}

#: Conditions in the middle of every campaign: speed [rpm], torque [N.m], oil [degC].
MIDDLE = (175.0, 2130.0, 60.0)


@dataclass(frozen=True)
class Sizes:
    """What is drawn for a rig. Losses are stated as torques at the carrier in the middle of the campaign [N.m]."""

    nodes: int
    mesh: float
    mesh_law: str
    mesh_film: float
    mesh_exponent: float
    mesh_to_oil: float
    reducer: float
    viscous: float
    bearing: float
    bearing_oil: bool
    seal: float
    seal_slope: float
    no_load: float
    vogel: float
    links: tuple[float, ...]
    splash: float
    capacities: tuple[float, ...]
    conv: float
    conv_exponent: float
    draught: float
    rad: float
    foot: float
    oil_2: float


def _factor(rng: np.random.Generator, octaves: float) -> float:
    return float(2.0 ** rng.uniform(-octaves, octaves))


def draw_sizes(rng: np.random.Generator) -> Sizes:
    """A rig whose oil stands 22 to 58 K above the room in the middle of a campaign."""
    while True:
        nodes = int(rng.choice(list(NODES)))
        scale, capacity = _factor(rng, 0.7), _factor(rng, 0.7)
        sizes = Sizes(
            nodes=nodes,
            mesh=rng.uniform(8.5, 18.0),
            mesh_law=str(rng.choice(["film", "logarithm"])),
            mesh_film=rng.uniform(0.1, 0.5),
            mesh_exponent=rng.uniform(0.2, 0.9),
            mesh_to_oil=rng.uniform(0.0, 0.4),
            reducer=rng.uniform(-0.02, 0.02),
            viscous=rng.uniform(0.3, 0.7),
            bearing=rng.uniform(6.5, 16.0),
            bearing_oil=bool(rng.random() < 0.3),
            seal=rng.uniform(2.0, 6.0),
            seal_slope=rng.uniform(0.2, 1.0),
            no_load=rng.uniform(0.0, 2.0),
            vogel=rng.uniform(95.0, 130.0),
            links=tuple(float(np.clip(scale * _factor(rng, 0.6), 0.5, 2.0)) for _ in LINKS[nodes]),
            splash=rng.uniform(0.0, 0.5),
            capacities=tuple(float(np.clip(capacity * _factor(rng, 0.4), 0.5, 2.0)) for _ in CAPACITIES[nodes]),
            conv=6.0 * _factor(rng, 1.0),
            conv_exponent=rng.uniform(0.2, 0.33),
            draught=rng.uniform(0.0, 0.4),
            rad=rng.uniform(0.25, 0.85) * _factor(rng, 0.5),
            foot=5.0 * _factor(rng, 1.0),
            oil_2=rng.uniform(0.0, 0.15),
        )
        watts = (sizes.mesh + sizes.bearing + sizes.seal + sizes.no_load) * MIDDLE[0] * np.pi / 30
        rise = watts / (sizes.conv + 5.5 * sizes.rad + sizes.foot)
        if 22.0 < rise < 58.0:
            return sizes


class ForeignRig:
    """The rig of some sizes."""

    def __init__(self, sizes: Sizes) -> None:
        self.sizes = sizes
        self.nodes = sizes.nodes
        self._place = NODES[sizes.nodes]
        self._links = [(a, b, G * f, name) for (a, b, G, name), f in zip(LINKS[sizes.nodes], sizes.links, strict=True)]
        self._capacities = [
            (C * f, name) for (C, name), f in zip(CAPACITIES[sizes.nodes], sizes.capacities, strict=True)
        ]
        ends = np.log([OIL["nu40"], OIL["nu100"]])
        self._vogel_B = (ends[0] - ends[1]) / (1 / (40 + sizes.vogel) - 1 / (100 + sizes.vogel))
        self._vogel_A = ends[0] - self._vogel_B / (40 + sizes.vogel)
        self._nu_middle = float(self.viscosity(np.array(MIDDLE[2])))

    @property
    def inner_share(self) -> float:
        """Share of gears and shafts in the heat capacity of all but the oil."""
        inner = sum(C for C, name in self._capacities if name == "cap_in")
        outer = sum(C for C, name in self._capacities if name == "cap_out")
        return inner / (inner + outer)

    def temperatures(self, T: np.ndarray) -> dict[str, np.ndarray]:
        """Temperature of every place."""
        return {place: T[node] for place, node in self._place.items() if place != "rings"}

    def viscosity(self, T_oil: np.ndarray) -> np.ndarray:
        """Kinematic viscosity after Vogel, through both catalogue values [mm2/s]."""
        nu: np.ndarray = np.exp(self._vogel_A + self._vogel_B / (np.maximum(T_oil, -40.0) + self.sizes.vogel))
        return nu

    def second_oil(self, places: Mapping[str, np.ndarray]) -> np.ndarray:
        """Oil nearer to the wall."""
        share = self.sizes.oil_2
        return (1 - share) * places["oil"] + share * places["wall"]

    def loss_torque(self, T: np.ndarray, scene: Scene, changes: Changes) -> np.ndarray:
        """Sum of all torques."""
        loss: np.ndarray = np.add.reduce(self._torques(scene, changes))
        return loss

    def _torques(self, s: Scene, c: Changes) -> list[np.ndarray]:
        """Torques of teeth, bearings, seals and stirring at the carrier [N.m]."""
        z, n = self.sizes, np.maximum(s.n, 2.0) / MIDDLE[0]
        nu = s.nu * c.factor("viscosity") / self._nu_middle
        load = s.load / MIDDLE[1]
        if z.mesh_law == "film":
            mu = (1 - z.mesh_film) + z.mesh_film * (n * nu) ** -z.mesh_exponent
        else:
            argument = 60.0 * (load + 0.02) / (nu * n**2.0 + 1e-3)
            mu = np.log(np.maximum(argument, 2.0)) / np.log(60.0)
        mesh = z.mesh * load * mu * c.factor("mesh") * (1 + z.reducer * (s.direction - 1.0))
        thickness = nu if z.bearing_oil else (s.nu / self._nu_middle) ** 0.8
        viscous = z.viscous * (n * thickness) ** (2.0 / 3.0)
        bearing = z.bearing * (viscous + (1 - z.viscous) * (0.5 + 0.5 * load)) * c.factor("bearing")
        rubbing = 1 + z.seal_slope * np.log(np.log(nu * self._nu_middle + 2.0) / np.log(self._nu_middle + 2.0))
        seal = z.seal * rubbing * n**-0.1 * c.factor("seal")
        stirring = z.no_load * n**1.5 * nu**0.2
        return [part * s.running for part in (mesh, bearing, seal, stirring)]

    def rate(self, T: np.ndarray, scene: Scene, changes: Changes) -> np.ndarray:
        """Heat balance of every node [K/s]."""
        z, place = self.sizes, self._place
        flows = np.zeros_like(T)
        mesh, bearing, seal, stirring = (torque * scene.w for torque in self._torques(scene, changes))
        rings, body = place.get("rings", place["wall"]), place["body"]
        for node, power in (
            (place["gears"], (1 - z.mesh_to_oil) * mesh),
            (place["oil"], z.mesh_to_oil * mesh + stirring),
            (body, 0.5 * (bearing + seal)),
            (rings, 0.5 * bearing),
            (place["wall"], 0.5 * seal),
        ):
            flows[node] += power
        for name, heat in changes.heat.items():
            flows[place[name]] += heat
        splash = ((scene.n + 20.0) / MIDDLE[0]) ** z.splash
        for a, b, G, name in self._links:
            flow = G * changes.factor(name) * (T[a] - T[b])
            flow = flow * splash if name.startswith("oil") else flow
            flows[a] -= flow
            flows[b] += flow
        flows[place["surface"]] -= self._cooling(T[place["surface"]], scene.room, changes)
        for node, (C, name) in enumerate(self._capacities):
            flows[node] /= C * changes.factor(name)
        return flows

    def _cooling(self, T: np.ndarray, room: np.ndarray, c: Changes) -> np.ndarray:
        """Heat from the surface to the room [W]."""
        z, dT = self.sizes, T - room
        free = ((dT / 30.0) ** 2 + 1e-3) ** (0.5 * z.conv_exponent)
        convection = z.conv * c.factor("conv") * (z.draught + (1 - z.draught) * free) * dT
        radiation = z.rad * c.factor("rad") * SIGMA * ((T + 273.15) ** 4 - (room + 273.15) ** 4)
        flow: np.ndarray = convection + radiation + z.foot * c.factor("foot") * dT
        return flow
