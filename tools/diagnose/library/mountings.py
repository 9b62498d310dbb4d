"""What a mounting or a filling changes: a loss, a cooling or an instrument whose size is drawn anew with each.

The size may be the same at all points, or follow speed, load or direction: a documented change lets every effect do so
from there on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from ....model.laws.smooth import smooth_abs
from .cause import Cause, Form, Num, Row, Theta, Values
from .forms import Context

#: Share of a cause's prior of the forms whose size is drawn anew with each mounting.
ANEW = 0.2
#: What may differ by mounting.
FAMILIES = ("losses", "cooling", "heat")
#: Share of a middle speed or load below which a deviation from it no longer follows.
LOW = 0.1


def with_mountings(causes: Iterable[Cause], at: Context) -> Iterator[Cause]:
    """The same causes, those of machine and instruments with forms for campaigns of several mountings.

    Args:
        causes: of the taxonomy
        at: what they are made for
    """
    for cause in causes:
        family, general = cause.id.partition(".")[0], cause.forms[0]
        if "mounting" not in at.ranges.known:
            yield cause
        elif family in FAMILIES and not general.spread and not general.regime:
            anew = [_drawn(general, cause.size.name, name, by) for name, by in _deviations(at, always=True)]
            yield _joined(cause, anew)
        elif cause.id.endswith(".mounting"):
            by = list(_deviations(at, always=False))
            anew = [_drawn(form, cause.size.name, *one) for form in cause.forms for one in by]
            yield _joined(cause, anew) if anew else cause
        else:
            yield cause


def _joined(cause: Cause, anew: list[Form]) -> Cause:
    """A cause with further forms that share a part of its prior."""
    kept = tuple(replace(form, weight=(1 - ANEW) * form.weight) for form in cause.forms)
    return replace(cause, forms=(*kept, *(replace(form, weight=ANEW / len(anew)) for form in anew)))


def _deviations(at: Context, always: bool) -> Iterator[tuple[str, Callable[[Row], Num]]]:
    """Ways in which a size may follow the point: name, factor; one half of the range is 1.

    Args:
        at: what it is made for
        always: whether the same at all points is one of them
    """
    if always:
        yield "", lambda row: 1.0
    for kind, words in (("speed", "by speed"), ("torque", "by load")):
        name = at.first(kind)
        if name and at.ranges.varies(name):
            yield words, _over(name, at)
    if at.both_ways:
        yield "by direction", lambda row: row.direction


def _over(sensor: str, at: Context) -> Callable[[Row], Num]:
    """How far a magnitude is above its middle, over half of its range."""
    low, mid, high = (by[sensor] for by in (at.ranges.low, at.ranges.mid, at.ranges.high))
    return lambda row: (smooth_abs(row.sensors[sensor], LOW * mid) - mid) / ((high - low) / 2)


def _drawn(form: Form, size: str, name: str, by: Callable[[Row], Num]) -> Form:
    """A form whose size is drawn anew with each mounting and follows the point."""

    def followed(law: Callable[..., Values] | None) -> Callable[..., Values] | None:
        if law is None:
            return None

        def own(theta: Theta, row: Row, *more: Num) -> Values:
            return law({**theta, size: theta[size] * by(row)}, row, *more)

        return own

    words = ", ".join(filter(None, (form.name, name, "anew with each mounting")))
    values, truth, shown = (followed(law) for law in (form.values, form.truth, form.shown))
    return replace(form, name=words, spread="mounting", values=values, truth=truth, shown=shown)
