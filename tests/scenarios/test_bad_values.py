"""Every value of every part, written wrongly: refused with its place, what was found, and what to write instead."""

from for_each import for_each
from gearheat.model.core.declare import Parameter, list_declared
from gearheat.model.parts import PARTS
from gearheat.scenarios.values import part_values, settable

#: What may be written wrongly -> words of the answer.
WRONG = {
    "nan": "not finite",
    "inf": "not finite",
    "about 3": "no number",
    "3 candela": "does not fit",
    "1e280": "",
    "": "",
    True: "is no value",
}


def said_of(kind, raws):
    """What is said of some values of a part, all at once."""
    return part_values("rig.toml [part.x]", "x", PARTS[kind], {**raws, "source": "assumed: test"}).problems


def unit_of(declaration):
    """Its unit as it is written."""
    return declaration.unit.removesuffix("(difference)").strip()


@for_each(PARTS)
def test_values_that_are_none(kind):
    for wrong, words in WRONG.items():
        raws = {}
        for key, declaration in settable(PARTS[kind]).items():
            if wrong == "1e280" and declaration.at_least is None and declaration.above is None:
                continue  # a threshold or an exponent may be anything
            unit = unit_of(declaration)
            raws[key] = f"{wrong} {unit}" if wrong in ("nan", "inf", "1e280") and unit != "1" else wrong
        problems = said_of(kind, raws)
        for key, raw in raws.items():
            told = [p for p in problems if p.startswith(f"rig.toml [part.x]: {key} = ")]
            assert told, (key, raw, problems)
            assert words in told[0], told
            assert any(word in told[0] for word in ("Write", "expected", "must be")), told


@for_each(PARTS)
def test_values_out_of_range(kind):
    for beyond in (-1.0, 1.0):
        raws = {}
        for key, d in list_declared(PARTS[kind], Parameter).items():
            low, high = (d.at_least if d.above is None else d.above), (d.at_most if d.below is None else d.below)
            if (bound := low if beyond < 0 else high) is not None:
                unit = "" if d.unit == "1" else f" {unit_of(d)}"
                raws[key] = f"{bound + beyond * max(1.0, abs(bound))!r}{unit}"
        problems = said_of(kind, raws)
        for key, raw in raws.items():
            assert any(f"{key} = " in p and "out of range. It must be" in p for p in problems), (key, raw, problems)
