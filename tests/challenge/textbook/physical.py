"""Faults of losses and coolings of the textbook rig, in forms of their own. FROZEN, see the package."""

from __future__ import annotations

import numpy as np

from .rig import LOAD0, N0, Around, Fault, Now


def churning(rng: np.random.Generator, around: Around) -> Fault:
    """Splash of planets and carrier: a power of speed, slightly of viscosity."""
    p, q, share = rng.uniform(1.4, 2.6), rng.uniform(0.0, 0.4), rng.uniform(0.7, 1.0)

    def loss(now: Now, a: np.ndarray) -> None:
        now.lose(a * (now.n / N0) ** p * (now.nu / 100.0) ** q, "oil", "wall", share)

    return Fault("losses.churning", 700.0, "W", {"loss": loss}, {"p": p, "q": q, "share": share})


def windage(rng: np.random.Generator, around: Around) -> Fault:
    """Drag of the mist: nearly cubic."""
    p, share = rng.uniform(2.5, 3.0), rng.uniform(0.5, 0.9)

    def loss(now: Now, a: np.ndarray) -> None:
        now.lose(a * (now.n / N0) ** p, "oil", "carrier", share)

    return Fault("losses.windage", 500.0, "W", {"loss": loss}, {"p": p, "share": share})


def oil_level(rng: np.random.Generator, around: Around) -> Fault:
    """Overfilled: more splash in proportion to the wetted depth, better contact of oil and wall."""
    wet = rng.uniform(0.0, 0.06)

    def loss(now: Now, a: np.ndarray) -> None:
        now.P["splash"] *= 1.0 + a

    def cool(now: Now, a: np.ndarray) -> None:
        now.G["oil_wall"] *= 1.0 + wet * a

    return Fault("losses.oil_level", 12.0, "1", {"loss": loss, "cool": cool}, {"wet": wet})


def oil_viscosity(rng: np.random.Generator, around: Around) -> Fault:
    """Another oil: viscosity and its index differ."""
    slope = rng.uniform(-0.4, 0.4)

    def oil(now: Now, a: np.ndarray) -> None:
        now.nu *= np.exp(a * (1.0 + slope * (now.temperature("oil") - 60.0) / 40.0))

    return Fault("losses.oil_viscosity", 1.1, "ln", {"oil": oil}, {"slope": slope}, (1, -1))


def bearing_preload(rng: np.random.Generator, around: Around) -> Fault:
    """Tapered bearings set too tight: a constant torque that grows while the carrier is warmer than the wall."""
    c, share = rng.uniform(0.0, 0.03), rng.uniform(0.35, 0.65)

    def loss(now: Now, a: np.ndarray) -> None:
        warmer = now.temperature("carrier") - now.temperature("wall")
        now.lose(a * now.w * np.clip(1.0 + c * warmer, 0.5, 2.0), "carrier", "wall", share)

    return Fault("losses.bearing_preload", 45.0, "N.m", {"loss": loss}, {"c": c, "share": share})


def seal_drag(rng: np.random.Generator, around: Around) -> Fault:
    """A lip that presses too hard: less torque when fast or warm."""
    e, k, share = rng.uniform(0.0, 0.25), rng.uniform(0.0, 0.5), rng.uniform(0.4, 0.8)
    body = str(rng.choice(["carrier", "gears"]))

    def loss(now: Now, a: np.ndarray) -> None:
        soft = np.exp(-k * (now.temperature("skin") - 40.0) / 40.0)
        now.lose(a * now.w * (np.maximum(now.n, 1.0) / N0) ** -e * soft, body, "skin", share)

    form = {"e": e, "k": k, "share": share, "shaft": body}
    return Fault("losses.seal_drag", 45.0, "N.m", {"loss": loss}, form)


def mesh_friction(rng: np.random.Generator, around: Around) -> Fault:
    """Rougher or smoother flanks: a factor that depends on torque and speed."""
    p, q = rng.uniform(-0.3, 0.5), rng.uniform(-0.4, 0.2)

    def loss(now: Now, a: np.ndarray) -> None:
        now.P["mesh"] *= 1.0 + a * (now.load / LOAD0) ** p * (np.maximum(now.n, 1.0) / N0) ** q

    return Fault("losses.mesh_friction", 0.8, "1", {"loss": loss}, {"p": p, "q": q}, (1, -1))


def mesh_direction(rng: np.random.Generator, around: Around) -> Fault:
    """Approach and recess: one flank side has more friction."""
    side = int(rng.integers(1, 3))

    def loss(now: Now, a: np.ndarray) -> None:
        now.P["mesh"] *= 1.0 + a * (now.direction == side)

    return Fault("losses.mesh_direction", 0.6, "1", {"loss": loss}, {"side": side}, (1, -1))


def film_starvation(rng: np.random.Generator, around: Around) -> Fault:
    """A thin film: friction rises where viscosity times speed is small."""
    level, power = rng.uniform(0.5, 1.6), rng.uniform(0.6, 0.8)

    def loss(now: Now, a: np.ndarray) -> None:
        thickness = (np.maximum(now.n, 1.0) / 150.0 * now.nu / 90.0) ** power
        now.P["mesh"] *= 1.0 + a * np.exp(-thickness / level)

    return Fault("losses.film_starvation", 3.0, "1", {"loss": loss}, {"level": level, "power": power})


def torque_only(rng: np.random.Generator, around: Around) -> Fault:
    """A coupling beyond the gearbox drags: torque without heat here."""

    def loss(now: Now, a: np.ndarray) -> None:
        now.extra += a * now.w

    return Fault("losses.torque_only", 30.0, "N.m", {"loss": loss})


# --------------------------------------------------------------------------------------------- heat and cooling


def external_source(rng: np.random.Generator, around: Around) -> Fault:
    """A warm neighbour: constant heat, or heat that grows with its speed."""
    body = str(rng.choice(["skin", "bed", "wall"]))
    p = float(rng.choice([0.0, rng.uniform(0.5, 1.6)]))

    def loss(now: Now, a: np.ndarray) -> None:
        now.heat(a * (np.maximum(now.n, 1e-6) / N0) ** p, body)

    return Fault("heat.external_source", 600.0, "W", {"loss": loss}, {"body": body, "p": p})


def air(rng: np.random.Generator, around: Around) -> Fault:
    """Air carries more or less heat, by a factor that depends on the excess temperature."""
    p = rng.uniform(-0.3, 0.4)

    def cool(now: Now, a: np.ndarray) -> None:
        excess = np.maximum(now.temperature("skin") - now.room, 1.0) / 30.0
        now.G["air"] *= np.exp(a * excess**p)

    return Fault("cooling.air", 1.0, "ln", {"cool": cool}, {"p": p}, (1, -1))


def emissivity(rng: np.random.Generator, around: Around) -> Fault:
    """Bright paint or foil on a share of the surface."""

    def cool(now: Now, a: np.ndarray) -> None:
        now.G["radiation"] *= 1.0 - a

    return Fault("cooling.emissivity", 0.95, "1", {"cool": cool})


def foundation(rng: np.random.Generator, around: Around) -> Fault:
    """Feet on shims, or grouted."""

    def cool(now: Now, a: np.ndarray) -> None:
        now.G["feet"] *= np.exp(a)

    return Fault("cooling.foundation", 2.0, "ln", {"cool": cool}, {}, (1, -1))


def contact(rng: np.random.Generator, around: Around) -> Fault:
    """A gap in the joint of ring and shell, that may open with temperature."""
    c = rng.uniform(-0.2, 0.4)

    def cool(now: Now, a: np.ndarray) -> None:
        now.G["joint"] *= np.exp(-a * (1.0 + c * (now.temperature("wall") - 60.0) / 40.0))

    return Fault("cooling.contact", 3.0, "ln", {"cool": cool}, {"c": c})


def oil_wall(rng: np.random.Generator, around: Around) -> Fault:
    """Sludge, or jets of oil: another coefficient on the oil's side, of the wall or of all bodies."""
    paths = ("oil_wall",) if rng.random() < 0.6 else ("oil_wall", "oil_gears", "oil_carrier")

    def cool(now: Now, a: np.ndarray) -> None:
        for path in paths:
            now.G[path] *= np.exp(-a)

    return Fault("cooling.oil_wall", 1.8, "ln", {"cool": cool}, {"paths": list(paths)}, (1, -1))


def humidity(rng: np.random.Generator, around: Around) -> Fault:
    """Cooling that follows the humidity of the room."""

    def cool(now: Now, a: np.ndarray) -> None:
        now.G["air"] *= np.maximum(1.0 + a * (now.humidity - 50.0) / 50.0, 0.1)

    return Fault("cooling.humidity", 0.9, "1", {"cool": cool}, {}, (1, -1))


def mass(rng: np.random.Generator, around: Around) -> Fault:
    """Heavier or lighter than in the drawings: outside, or everything."""
    first = 3 if rng.random() < 0.5 else 0

    def capacities(C: np.ndarray, a: np.ndarray) -> None:
        C[first:] *= np.exp(a)

    return Fault("thermal.mass", 0.9, "ln", {"mass": capacities}, {"bodies": "outer" if first else "all"}, (1, -1))


def split(rng: np.random.Generator, around: Around) -> Fault:
    """Heat of the teeth, or of bearings and seals as well, goes elsewhere than assumed."""
    parts = ("mesh",) if rng.random() < 0.5 else ("mesh", "carrier_bearing", "sun_bearing", "carrier_seal", "sun_seal")

    def loss(now: Now, a: np.ndarray) -> None:
        for part in parts:
            np.clip(now.share[part] + a, 0.0, 1.0, out=now.share[part])

    return Fault("thermal.split", 0.55, "1", {"loss": loss}, {"parts": list(parts)}, (1, -1))
