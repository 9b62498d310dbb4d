"""Causes, numbers, probabilities and estimates as people write them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from ....model.core.faults import name_all
from ..answer.evidence import Estimate, GrossReading, NuisanceOff, ResidualMean, VarianceComponent
from ..answer.findings import UNEXPLAINED, Answer, Cause, Channel, Findings, Gain, Impact
from ..answer.numbers import LEAST_P
from ..library.entries import TABLE

#: Parts of a value are named where they are not more than these.
FEW_PARTS = 3
#: Share of a cause from which another instrument is named beside the likeliest one.
ANOTHER = 0.1
#: Share by which one error must exceed another to be worse.
NOTICEABLE = 0.005
#: The same played over the data, where a fit of all channels trades a little of one.
WORSE = 0.06
#: Units as they are shown.
SHOWN = {"degC": "°C", "1": ""}
#: How the part of a form's name begins that says where it acts, as the regime says with its numbers.
LIMITED = ("above a", "below a", "from one test on", "from a test on", "from one date on")
#: Scheme of readings left out -> words.
SCHEMES = TABLE["schemes"]
#: How the meaning of a parameter begins that is a logarithm, and the name of one without a meaning.
LOGARITHM = ("logarithm of ", "ln_")


def name_of(cause: str) -> str:
    """A cause in plain words; one of a user's library by the end of its identifier."""
    family, _, rest = cause.partition(".")
    kind, _, fault = rest.partition(".")
    if cause == UNEXPLAINED:
        return "something outside the library"
    if family == "sensor" and fault:
        words = TABLE["faults"].get(fault, f"{fault.replace('_', ' ')} of the {{}}")
        return str(words.format(TABLE["instruments"].get(kind, f"{kind} sensor")))
    return str(TABLE.get(cause, {}).get("name", cause.rpartition(".")[2].replace("_", " ")))


def names_of(causes: Iterable[str], last: str = "and", most: int = 100) -> str:
    """Causes in plain words with commas between and a word before the last one; the rest is counted beyond so many."""
    found = [name_of(c) for c in causes]
    more = [f"{len(found) - most} more"] if len(found) > most else []
    return name_all([*found[:most], *more], last)


def sentence(text: str) -> str:
    """A text with a capital at its beginning."""
    return text[:1].upper() + text[1:]


def number(value: float, digits: int = 3) -> str:
    """A number with so many digits, without an exponent where people would not write one."""
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-4 < abs(value) < 1e7:
        text = f"{value:.0f}" if abs(value) >= 1 else f"{value:.{digits + 3}f}"
    return "0" if text == "-0" else text


def with_unit(value: float | None, unit: str = "1", digits: int = 3) -> str:
    """A number and its unit; empty where there is none."""
    return "" if value is None else f"{number(value, digits)} {SHOWN.get(unit, unit)}".strip()


def percent(probability: float | None, error: float = 0.0) -> str:
    """A probability with its Monte-Carlo error, never surer than it is computed; empty where there is none."""
    if probability is None:
        return ""
    if probability > 0.995:
        return "> 99 %"
    if 0.0 <= probability < 0.005:
        return "< 1 %"
    return f"{100 * probability:.0f} %" if error < 0.005 else f"{100 * probability:.0f} ± {100 * error:.0f} %"


def sigma(distance: float | None) -> str:
    """A distance in standard deviations; empty where there is none."""
    return "" if distance is None else f"{distance:.1f}"


def p_value(p: float | None) -> str:
    """p = 0.03, p = 0.998, p = 2e-5 or p < 1e-6; empty where there is none."""
    if p is None:
        return ""
    if p <= LEAST_P:
        return "p < 1e-6"
    digits = 2 if p < 0.99 else 4
    return f"p = {p:.0e}".replace("e-0", "e-") if p < 1e-3 else f"p = {min(p, 0.9999):.{digits}g}"


def chance(p: float) -> str:
    """How often chance alone does as much."""
    for out_of in (100, 1000):
        if p * out_of >= 1:
            return f"{out_of * p:.0f} of {out_of} campaigns without a fault deviate as much ({p_value(p)})"
    return f"fewer than 1 of 1000 campaigns without a fault deviate as much ({p_value(p).replace('= 1e-3', '< 1e-3')})"


def estimate(found: Estimate) -> str:
    """A parameter with unit and interval, and the bound it sits on; logarithms as factors."""
    value, (low, high) = found.value, found.ci95
    said = with_unit(value, found.unit)
    if (found.doc or found.name).startswith(LOGARITHM):
        value, low, high = (math.exp(v) for v in (value, low, high))
        said = f"{number(value)} times"
    inside = f"{number(low)} to {number(high)}" if low < high else ""
    bound = {"low": "at its lower bound", "high": "at its upper bound"}.get(found.at_bound, "")
    text = "; ".join(filter(None, (inside, bound)))
    return said + (f" ({text})" if text else "")


def meaning(found: Estimate) -> str:
    """What a parameter is, in words; that of a logarithm without the word."""
    return found.doc.removeprefix("logarithm of the ").removeprefix("logarithm of ") or found.name.replace("_", " ")


def size(found: Cause) -> str:
    """The size of a cause; empty where it has none."""
    return estimate(found.parameters[0]) if found.parameters else ""


def impact(found: Impact) -> str:
    """A mean change with its interval: oil temperature 3.2 K higher (2.9 to 3.5)."""
    more, sign = ("higher", 1) if found.value >= 0 else ("lower", -1)
    low, high = sorted(sign * v for v in found.ci95)
    value = with_unit(abs(found.value), found.unit, 2)
    least, most = found.single or found.ci95
    apart = min(-least, most) > high
    ends = f"; {number(-least, 2)} lower to {number(most, 2)} higher at single points" if apart else ""
    return f"{found.what} {value} {more} ({number(low, 2)} to {number(high, 2)}{ends})"


def regime(found: Cause) -> str:
    """Where a cause acts; empty where it acts everywhere."""
    if found.since:
        return f"from {found.since} on"
    parts = []
    for quantity, (low, high) in found.regime.items():
        name, _, unit = quantity.removesuffix("]").partition(" [")
        ends = [("above", low), ("below", high)]
        said = " and ".join(with_unit(end, unit).join((f"{word} ", "")) for word, end in ends if end is not None)
        parts.append(f"{name} {said}")
    return f"only at {', '.join(parts)}" if parts else ""


def where(found: Cause, instruments: Iterable[Channel] = ()) -> str:
    """In which parts and where a cause acts; empty where it acts in all of them everywhere.

    Which other one of the instruments may err instead is told with its share.
    """
    limits = regime(found)
    name = found.forms[0].name if found.forms else ""
    parts = [part for part in name.split(", ") if not (limits and part.startswith(LIMITED))]
    shares = {s.name: sum(f.share for f in found.forms if f.name.partition(", ")[0] == s.name) for s in instruments}
    shares.pop(name.partition(", ")[0], None)
    others = [f"or {other}: {percent(share)}" for other, share in shares.items() if share > ANOTHER]
    return ", ".join(filter(None, (*parts, limits, *others)))


def answer(found: Answer) -> str:
    """The causes of an answer; members of one class with "or" between."""
    classes = [names_of(group, "or") for group in found.causes]
    return ("; and " if any(len(group) > 1 for group in found.causes) else " and ").join(classes)


def scatter(found: VarianceComponent) -> str:
    """What a scatter is and how large, as a sentence."""
    days = found.name == "days"
    what = "The cooling from day to day" if days else f"A reading of {found.channel}" if found.channel else found.name
    factor, unit = (100.0, "%") if found.unit == "1" else (1.0, found.unit)
    scatters, card = with_unit(factor * found.found, unit, 2), with_unit(factor * found.card, unit, 2)
    return f"{what} scatters by {scatters}; the card says {card} ({number(found.ratio, 2)} times)."


def row(found: GrossReading) -> str:
    """The row of a reading, with its file where that is not the data's."""
    _, of, file = found.point.partition(" of ")
    return f"row {found.row}{of}{file}"


def gross(found: GrossReading) -> str:
    """A wrong reading, as a sentence."""
    places = (("line", found.line), ("point", found.point))
    where = ", ".join(f"{name} {value}" for name, value in places if value)
    text = f"Row {found.row}{f' ({where})' if where else ''}: {found.channel}"
    if found.shown is not None and found.expected is not None:
        shown, expected = (with_unit(v, found.unit, 4) for v in (found.shown, found.expected))
        text += f" shows {shown}, the other readings say {expected}"
    also = f" A wrong {name_all(found.instead, 'or')} in this row explains it as well." if found.instead else ""
    return f"{text}, {number(abs(found.size_sd), 2)} standard deviations off. It is set aside.{also}"


def nuisance(found: NuisanceOff) -> str:
    """A value far from that of the file, as the end of a sentence."""
    off = f"{number(abs(found.z), 2)} prior standard deviations {'up' if found.z > 0 else 'down'}"
    values = ""
    if found.file is not None and found.found is not None:
        values = f"{with_unit(found.found, found.unit)} instead of {with_unit(found.file, found.unit)}, "
    elif found.factor is not None:
        values = f"{number(found.factor)} times that of the file, "
    parts = [p for p in dict.fromkeys(path.partition(".")[0] for path in found.paths) if p not in found.name]
    place = f" of {name_all(parts)}" if 0 < len(parts) <= FEW_PARTS else ""
    return f"{found.name}{place} ({values}{off})"


def residual(found: ResidualMean) -> str:
    """A mean that stands out, as part of a sentence."""
    where = ", ".join(f"{quantity} {group}" for quantity, group in zip(found.by, found.cell, strict=True))
    side = "above" if found.mean > 0 else "below"
    value, error = with_unit(abs(found.mean), found.unit, 2), number(found.sd, 2)
    return f"{found.channel} lies {value} {side} it at {where} (n = {found.n}, standard error {error})"


def list_residuals(found: Iterable[ResidualMean], most: int) -> str:
    """What the calibrated rig leaves, the most unlikely mean of each channel and table first; empty where none does."""
    ranked = sorted((r for r in found if r.stands_out), key=lambda r: -abs(r.mean) / (r.sd or 1.0))
    first: dict[str, ResidualMean] = {}
    for r in ranked:
        first.setdefault(r.channel, r)
    texts = [residual(r) for r in list(first.values())[:most]]
    return f"Against the calibrated rig, before any cause: {'; '.join(texts)}." if texts else ""


def calibration(found: Findings, most: int) -> str:
    """Values of the rig far from those of its file, as the end of a sentence; empty where there are none."""
    off = found.data_quality.nuisances
    more = [f"{len(off) - most} more"] if len(off) > most else []
    return "; ".join([*map(nuisance, off[:most]), *more])


def as_filed(found: Findings) -> str:
    """Temperatures that lie apart from those of the rig as it is filed, where nothing healthy says otherwise."""
    off = {} if found.about.reference else found.data_quality.as_filed
    return ", ".join(f"{n} lies {with_unit(abs(m), 'K')} {'above' if m > 0 else 'below'} it" for n, m in off.items())


def gain(found: Gain) -> str:
    """What the causes gain where they were not fitted, and what plain statistics reach."""
    unit = found.unit
    text = f"{found.channel}: {with_unit(found.rmse_before, unit)} before, {with_unit(found.rmse_after, unit)} after"
    if found.ratio_ci90 is not None:
        low, high = (number(v, 2) for v in found.ratio_ci90)
        text += f" (ratio {number(found.rmse_after / (found.rmse_before or 1.0), 2)}, {low} to {high})"
    said = [f"{text}, {SCHEMES.get(found.scheme, found.scheme)}"]
    if found.before is not None and found.after is not None:
        before, after = number(found.before.with_), with_unit(found.after.with_, unit)
        said.append(f"interpolated from test to test {before} and {after}")
    said += [f"{name} {with_unit(value, unit)}" for name, value in found.rivals.items()]
    if found.noise_floor is not None:
        said.append(f"one reading scatters by {with_unit(found.noise_floor, unit)}")
    return "; ".join(said)


def doubt(findings: Findings) -> str:
    """Why the extended rig must not be trusted, or what is as good; empty where it is better.

    Readings left out decide. Where none were, the rig played over the data does.
    """
    found, useless = findings.gain, "Do not use the extended rig for predictions yet."
    if found is None:
        fixed = {c.name: c.offset_sd for c in findings.channels}  # which a replay knows nothing of
        worse = [
            f"{channel} {number(p.rms_calibrated)} calibrated, {with_unit(p.rms_extended, p.unit)} extended"
            for channel, p in findings.played.items()
            if p.rms_extended > max((1 + WORSE) * p.rms_calibrated, fixed.get(channel) or 0.0)
        ]
        sd = {c.name: c.repeat_sd or 1.0 for c in findings.channels}
        more = sum((p.rms_extended**2 - p.rms_calibrated**2) / sd.get(k, 1.0) ** 2 for k, p in findings.played.items())
        text = f"Played over these data the extended rig is worse than the calibrated one ({'; '.join(worse)})."
        return f"{text} {useless}" if worse and more > 0 else ""
    own = [g for g in (found, *findings.gain_grouped) if g.channel == found.channel]
    errors = [g.leading.without if g.leading else g.rmse_after for g in own]  # the rig holds the likeliest set alone
    before, after = f"{found.channel}: {number(found.rmse_before)}", with_unit(errors[0], found.unit)
    if errors[0] >= found.rmse_before:
        return f"On readings left out the extended rig predicts no better ({before} before, {after} after). {useless}"
    worse = [
        f"{SCHEMES.get(g.scheme, g.scheme)} {number(g.rmse_before)} before, {with_unit(error, g.unit)} after"
        for g, error in zip(own[1:], errors[1:], strict=True)
        if error > (1 + NOTICEABLE) * g.rmse_before
    ]
    if worse:
        text = f"Farther from what was measured the extended rig predicts {found.channel} no better"
        return f"{text} ({'; '.join(worse)}): there do not use the extended rig."
    rival, best = min(((error, name) for name, error in found.rivals.items()), default=(math.inf, ""))
    if rival < errors[0]:
        return f"On readings left out plain statistics ({best}) predict better: {number(rival)} against {after}."
    return ""
