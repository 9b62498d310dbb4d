"""The first sentences of a report: how close the simulation is, where it is worst, and what to do."""

from __future__ import annotations

from .errors import GROUPINGS, Comparison

#: Readings from which on a group counts as a place where the model may be wrong.
ENOUGH = 3
#: Errors up to so many noise floors are what readings scatter by.
SCATTER = 2.0


def opening(rig: str, comparison: Comparison) -> list[str]:
    """Three sentences.

    Args:
        rig: its name
        comparison: errors of its readings
    """
    rmse, noise = comparison.rmse()["overall"], comparison.noise_floor
    known = [c for c in comparison.channels if rmse.get(c.key) is not None]
    close = ", ".join(f"{c.label} {rmse[c.key]:.3g} {c.unit}{_floor(noise.get(c.key))}" for c in known)
    said = [f"The simulation is this close to {len(comparison.rows)} readings, root mean square: {close}."]
    units = {c.key: c for c in known}
    scale = {c.key: noise.get(c.key) or rmse[c.key] for c in known}
    groups = [g for g in comparison.groups if g.by != "all" and g.n >= ENOUGH and scale.get(g.channel)]
    if groups:
        worst = max(groups, key=lambda g: abs(g.mean) / scale[g.channel])
        value = f"{worst.value:g}" if isinstance(worst.value, float) else worst.value
        where, c = f"{GROUPINGS[worst.by]} {value}", units[worst.channel]
        said.append(
            f"It is worst for the {c.label} at {where}: {worst.mean:+.3g} {c.unit} on average of {worst.n} readings,"
            " simulated minus measured."
        )
    left = [c for c in known if noise.get(c.key) and rmse[c.key] > SCATTER * noise[c.key]]
    what = " and ".join(c.label for c in left)
    if left or not any(noise.get(c.key) for c in known):
        why = f"The {what} err by more than readings scatter" if left else "No repeated point tells errors from scatter"
        said.append(
            f"{why}: gearheat diagnose TABLE --rig {rig} names the causes with their sizes, and what to measure next."
        )
    else:
        said.append("The errors are within the scatter of the readings: there is nothing to correct.")
    return said


def _floor(noise: float | None) -> str:
    return f" (one reading scatters by {noise:.2g})" if noise else ""
