"""What a diagnosis found, in sentences: verdict, how sure, where it acts. Shared by the screen and the report."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..effects.taxonomy import CAUSES
from .findings import Estimate, Findings, Gain, Joint, Named

#: Probability that the named hypotheses shall reach together.
ENOUGH = 0.9
#: p below which what is left is not noise.
ADEQUATE = 0.01
#: Plain names of the taxonomy.
NAMES = {
    "losses.churning": "churning of the oil",
    "losses.oil_viscosity": "viscosity of the oil",
    "losses.oil_level": "oil level",
    "losses.bearing_preload": "bearing preload",
    "losses.seal_drag": "seal drag",
    "losses.mesh_friction": "friction of the teeth",
    "losses.mesh_direction": "friction of the teeth in one direction",
    "losses.film_starvation": "teeth short of oil film",
    "losses.windage": "windage",
    "heat.external_source": "heat from outside",
    "cooling.air": "cooling by the air",
    "cooling.emissivity": "cooling by radiation",
    "cooling.foundation": "heat into the foundation",
    "cooling.contact": "contact inside the housing wall",
    "cooling.oil_wall": "heat from oil to wall",
    "cooling.humidity": "cooling that follows humidity",
    "thermal.mass": "heat capacities",
    "thermal.split": "where the heat appears",
    "sensor.torque.offset": "zero of a torque transducer",
    "sensor.torque.gain": "gain of a torque transducer",
    "sensor.torque.drift": "drifting zero of a torque transducer",
    "sensor.torque.step": "zero of a torque transducer that jumped",
    "sensor.oil_temp.offset": "offset of the oil probe",
    "sensor.oil_temp.gain": "gain of the oil probe",
    "sensor.oil_temp.position": "place of the oil probe",
    "sensor.wall_temp.offset": "offset of the wall probe",
    "sensor.ambient.bias": "offset of the room probe",
    "sensor.ambient.heated": "room probe warmed by the gearbox",
    "sensor.speed.gain": "gain of the speed reading",
    "procedure.not_stationary": "readings taken before they were steady",
    "procedure.order": "cooling that changes with the running order",
    "procedure.day_scatter": "scatter of the days",
    "model.unexplained": "something outside the library",
}
#: Columns in which a regime is stated -> quantity and unit.
REGIMES = {
    "n_carrier_rpm": ("carrier speed", "rpm"),
    "T_carrier_Nm": ("carrier torque", "N.m"),
    "T_oil_C": ("oil temperature", "°C"),
    "film_mm2_s2": ("carrier speed times viscosity", "mm²/s²"),
}
#: Keys of an impact -> what changes, its unit, and how much more is said.
IMPACTS = {
    "T_oil_K": ("oil temperature", "K", "warmer", "colder"),
    "T_wall_K": ("wall temperature", "K", "warmer", "colder"),
    "loss_Nm": ("loss torque", "N.m", "larger", "smaller"),
}
#: Channels that a rig is played against -> their name and unit.
PLAYED = {"T_oil": ("oil", "K"), "T_wall": ("wall", "K"), "loss": ("loss torque", "N.m")}
SCHEMES = {
    "leave-one-operating-point": "each test left out in turn",
    "leave-one-speed": "each speed left out in turn",
    "leave-one-load": "each torque left out in turn",
    "leave-one-oil": "each oil left out in turn",
    "first-oil-to-others": "the other oils predicted from the first",
    "split": "half of the tests left out",
}


def name_of(cause: str) -> str:
    """A cause in plain words."""
    return NAMES.get(cause, cause)


def names_of(causes: Sequence[str]) -> str:
    """A set of causes in plain words."""
    return " and ".join(name_of(c) for c in causes) or "nothing"


def likes(cause: str) -> list[str]:
    """The other causes of its class, which count as the same answer."""
    like = CAUSES[cause].like if cause in CAUSES else ""
    return [c for c in CAUSES if like and c != cause and CAUSES[c].like == like]


def likes_said(cause: str) -> str:
    """The other causes of its class, as an addition to its name."""
    others = [name_of(c) for c in likes(cause)]
    return f" (or its like: {', '.join(others)})" if others else ""


def sentence(text: str) -> str:
    """A text with a capital at its beginning."""
    return text[:1].upper() + text[1:]


def number(value: float, digits: int = 3) -> str:
    """A number with so many digits, without an exponent where people would not write one."""
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-4 < abs(value) < 1e7:
        text = f"{value:.0f}" if abs(value) >= 1 else f"{value:.{digits + 3}f}"
    return "0" if text == "-0" else text


def percent(probability: float) -> str:
    """A probability as people say it; never sure beyond what is computed."""
    if probability > 0.995:
        return "> 99 %"
    if 0.0 < probability < 0.005:
        return "< 1 %"
    return f"{100 * probability:.0f} %"


def chance(p: float) -> str:
    """How often chance alone does as much."""
    if p >= 0.01:
        return f"about {100 * p:.0f} of 100 campaigns without a fault look like this or worse"
    if p >= 0.001:
        return f"about {1000 * p:.0f} of 1000 campaigns without a fault look like this or worse"
    return "fewer than 1 of 1000 campaigns without a fault look like this"


def estimate(found: Estimate) -> str:
    """A parameter with its unit and interval; without one where it was held."""
    unit = "" if found.unit == "1" else f" {found.unit}"
    return f"{number(found.value)}{unit}" + (f" ({interval(found)})" if found.low < found.high else "")


def interval(found: Estimate) -> str:
    """The interval of a parameter; a parameter that was held has none."""
    return f"{number(found.low)} to {number(found.high)}" if found.low < found.high else "held"


def meaning(cause: str, parameter: str) -> str:
    """What a parameter of a cause means."""
    if cause not in CAUSES:
        return ""
    known = CAUSES[cause]
    return {known.size.name: known.size.doc, **{s.name: s.doc for s in known.shapes}}.get(parameter, "")


def regime(found: Named) -> str:
    """Where a cause acts, as an addition to a sentence; empty where it acts everywhere."""
    parts = []
    for column, (low, high) in found.regime.items():
        quantity, unit = REGIMES.get(column, (column, ""))
        words = ("above", "below") if low != high else ("",)
        ends = [
            f"{w} {number(end)} {unit}".strip() for w, end in zip(words, (low, high), strict=False) if end is not None
        ]
        parts.append(f"{quantity} {' and '.join(ends)}")
    return f"only at {', '.join(parts)}" if parts else ""


def top(findings: Findings) -> Joint | None:
    """The most probable hypothesis with a cause of the library; None where nothing is wrong or found."""
    named = [h for h in findings.hypotheses if h.causes and not h.outside]
    return max(named, key=lambda h: h.probability) if named else None


def applied(findings: Findings) -> Joint | None:
    """The hypothesis that the extended model holds: the library's first, if there is an alarm and it names a cause."""
    first = next((h for h in findings.hypotheses if not h.outside), None)
    return first if first is not None and first.causes and findings.verdict != "consistent" else None


def needed(findings: Findings) -> list[Joint]:
    """The most probable hypotheses that together reach 90 %, or all there are."""
    chosen: list[Joint] = []
    for hypothesis in sorted(findings.hypotheses, key=lambda h: -h.probability):
        if sum(h.probability for h in chosen) >= ENOUGH:
            break
        chosen.append(hypothesis)
    return chosen


def named(findings: Findings, cause: str) -> Named | None:
    """What is known of a cause."""
    return next((c for c in findings.causes if c.id == cause), None)


def impact(findings: Findings, key: str = "T_oil_K") -> str:
    """What the top hypothesis does to a reading, as a sentence's end; empty where it is not known."""
    if key not in findings.impact or key not in IMPACTS:
        return ""
    value, low, high = findings.impact[key]
    quantity, unit, more, less = IMPACTS[key]
    word = more if value >= 0 else less
    interval = sorted(abs(v) for v in (low, high)) if low * high > 0 else [low * (1 if value >= 0 else -1), high]
    return f"{quantity} {number(abs(value), 2)} {unit} {word} ({number(interval[0], 2)} to {number(interval[1], 2)})"


def verdict(findings: Findings) -> str:
    """The verdict in one sentence."""
    first = top(findings)
    if findings.verdict == "unexplained":
        return _unexplained(findings)
    if findings.verdict == "consistent" or first is None:
        return f"Nothing beyond the stated accuracies: {chance(findings.p_any)}."
    if findings.verdict == "explained":
        subject = (
            "One cause explains it" if len(first.causes) == 1 else f"{len(first.causes)} causes explain it together"
        )
        named = " and ".join(name_of(c) + likes_said(c) for c in first.causes)
        return f"{subject}: {named}, {percent(first.probability)} sure{_size(findings, first)}."
    sets = [h for h in needed(findings) if h.causes]
    words = "; ".join(f"{names_of(h.causes)} ({percent(h.probability)})" for h in sets[:4])
    more = f"; and {len(sets) - 4} more" if len(sets) > 4 else ""
    return f"Something is wrong, and these data leave open what: {words}{more}."


def _unexplained(findings: Findings) -> str:
    """The verdict where the best of the library is not enough, or where something outside it is more probable."""
    first, missing = applied(findings), next((h for h in findings.hypotheses if h.outside), None)
    if findings.p_adequacy >= ADEQUATE and missing is not None:
        best = f"; the best within it: {names_of(first.causes)} ({percent(first.probability)})" if first else ""
        return f"Something is wrong, most probably outside the library ({percent(missing.probability)}){best}."
    best = f": the best, {names_of(first.causes)}, leaves more than noise" if first else ""
    return f"Something is wrong, and no cause of the library explains it{best}."


def _size(findings: Findings, hypothesis: Joint) -> str:
    """Size of each cause of a hypothesis, as an addition to a sentence."""
    sizes = []
    for cause in hypothesis.causes:
        found = named(findings, cause)
        if found and found.parameters:
            where = f", {regime(found)}" if found.regime else ""
            sizes.append(
                f"{meaning(cause, found.parameters[0].name) or found.parameters[0].name}: "
                f"{estimate(found.parameters[0])}{where}"
            )
    return f"; {'; '.join(sizes)}" if sizes else ""


def certificate(found: Named) -> str:
    """The q of a cause by the split of the tests; empty where it has none."""
    if found.q is None:
        return ""
    return "< 0.001" if found.q < 0.001 else number(found.q, 2)


def visible(found: Named) -> str:
    """The smallest size of a cause that the data would reveal, with its unit; empty where no possible size is seen."""
    if found.id not in CAUSES:
        return ""
    size = CAUSES[found.id].size
    if not found.detectable <= max(abs(size.low), abs(size.high)):
        return ""
    return f"{number(found.detectable, 2)}{'' if size.unit == '1' else f' {size.unit}'}"


def adequacy(findings: Findings) -> str:
    """Whether what is left after the best hypothesis is noise."""
    left = "what is left after it" if applied(findings) else "what the model leaves"
    if findings.p_adequacy < ADEQUATE:
        return f"{left} is not noise (p = {number(findings.p_adequacy, 2)}): another effect is in the data"
    return f"{left} looks like noise (p = {number(findings.p_adequacy, 2)})"


def gain(g: Gain) -> str:
    """What the extension gains where it was not fitted, the scatter of a reading, and what plain statistics reach."""
    low, high = g.ratio_ci90
    ratio = g.rmse_after / g.rmse_before if g.rmse_before else float("nan")
    text = (
        f"{number(g.rmse_before, 2)} K before, {number(g.rmse_after, 2)} K after (ratio {number(ratio, 2)},"
        f" {number(low, 2)} to {number(high, 2)}), {SCHEMES.get(g.scheme, g.scheme)}"
    )
    said = [] if g.noise_floor is None else [f"one reading scatters by {number(g.noise_floor, 2)} K"]
    said += [f"{name} {number(value, 2)} K" for name, value in g.rivals.items()]
    return "; ".join([text, *said])


def played(findings: Findings) -> str:
    """Root mean square of what the rig leaves on the data it was fitted to, calibrated alone and extended."""
    said = []
    for channel, left in findings.played.items():
        name, unit = PLAYED[channel]
        said.append(f"{name} {number(left[0])} {unit} calibrated, {number(left[1])} {unit} extended")
    return "; ".join(said)


def not_played(findings: Findings) -> str:
    """What the extended rig lacks of the hypothesis and what is left with it, as a sentence; empty where it has all."""
    with_all = []
    for channel, (_, extended) in findings.played.items():
        name, unit = PLAYED[channel]
        measured, _, model = findings.rows.get(channel, (None, None, None))
        if measured is None or model is None:
            continue
        left = math.sqrt(float(((model - measured) ** 2).mean()))
        if number(left) != number(extended):
            with_all.append(f"{name} {number(left)} {unit}")
    if not with_all:
        return ""
    return f"with what the rig cannot hold, such as an instrument's fault, as found: {'; '.join(with_all)}"
