"""All causes of a machine and a campaign: our own, those of installed packages, and those of a user's files.

A mounting or a filling changes a loss, a cooling or an instrument whose size is drawn anew with each. The size may be
the same at all points, or follow speed, load or direction: a documented change lets every effect do so from there on.
"""

from __future__ import annotations

import runpy
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from importlib.metadata import entry_points
from pathlib import Path

from ....model.errors import DataError, Problems, suggestion
from ....model.laws.smooth import smooth_abs
from ....model.machines.roles import Roles
from ....scenarios.measured.table import Sensor
from . import cooling, losses, procedure, sensors as instruments, thermal
from .cause import Cause, Form, Num, Ranges, Row, Theta, Values
from .check import problems
from .forms import Context

#: What makes the causes of a user's family.
Family = Callable[[Roles, Ranges, Sequence[Sensor]], Iterable[Cause]]
#: Our own, in the order of the taxonomy.
FAMILIES: tuple[Callable[[Context], Iterable[Cause]], ...] = (
    losses.causes,
    thermal.heat_causes,
    cooling.causes,
    thermal.causes,
    instruments.causes,
    procedure.causes,
)
#: Entry points under which installed packages offer functions such as ours.
GROUP = "gearheat.causes"
#: Share of a cause's prior of the forms whose size is drawn anew with each mounting.
ANEW = 0.2
#: What may differ by mounting.
REMOUNTED = ("losses", "cooling", "heat")
#: Share of a middle speed or load below which a deviation from it no longer follows.
LOW = 0.1


def library(
    roles: Roles, ranges: Ranges, sensors: Sequence[Sensor], extra_files: Sequence[Path] = ()
) -> tuple[Cause, ...]:
    """All causes that the machine and its instruments allow, in the order of the taxonomy.

    Files of the user, `extra_files`, define `causes(roles, ranges, sensors)`.

    Raises:
        DataError: files and packages without causes, and causes that are none, all at once
    """
    at = Context(roles, ranges, sensors)
    own = [cause for family in FAMILIES for cause in family(at)]
    found = {cause.id: cause for cause in (with_mountings(own, at) if "mounting" in ranges.known else own)}
    wrong = Problems()
    for name, family in _others(extra_files, wrong):
        try:
            added = list(family(roles, ranges, sensors))
        except Exception as error:  # a user's function may fail in any way
            wrong.append(f"{name}: causes(roles, ranges, sensors) fails: {type(error).__name__}: {error}.")
            continue
        for cause in added:
            if not isinstance(cause, Cause):
                wrong.append(
                    f"{name}: causes() gives {type(cause).__name__}. Give gearheat.tools.diagnose.library.Cause."
                )
            elif cause.id in found:
                wrong.append(f'{name}: there is a cause "{cause.id}" already. Give it another id.')
            else:
                wrong += [f"{name}: {text}" for text in problems(cause, roles.spec, sensors, ranges)]
                found[cause.id] = cause
    wrong.check(DataError)
    return tuple(found.values())


def _others(files: Iterable[Path], wrong: Problems) -> Iterator[tuple[str, Family]]:
    """Functions of installed packages and of files, by where they are from."""
    for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name):
        try:
            yield f"package {entry.name}", entry.load()
        except Exception as error:  # a package may fail in any way
            wrong.append(f"package {entry.name} ({entry.value}): cannot be loaded: {type(error).__name__}: {error}.")
    for path in files:
        if (family := wrong.of(partial(_from_file, path))) is not None:
            yield path.name, family


def _from_file(path: Path) -> Family:
    """The function `causes` of a file. Raises DataError where there is none."""
    if path.suffix != ".py":
        raise DataError(f"--library {path.name}: is no Python file. Give a file FILE.py that defines causes().")
    try:
        found = runpy.run_path(str(path), run_name=f"gearheat_causes_{path.stem}")
    except OSError as error:
        raise DataError(f"--library {path.name}: cannot be read ({error.strerror}). Check the path.") from error
    except Exception as error:  # a user's file may fail in any way
        raise DataError(f"--library {path.name}: fails: {type(error).__name__}: {error}.") from error
    family = found.get("causes")
    if not callable(family):
        close = suggestion("causes", [name for name, value in found.items() if callable(value)])
        raise DataError(f"--library {path.name}: there is no function causes(roles, ranges, sensors).{close} Add it.")
    return family  # type: ignore[no-any-return]


def with_mountings(causes: Iterable[Cause], at: Context) -> Iterator[Cause]:
    """The same causes, those of machine and instruments with forms for campaigns of several mountings."""
    for cause in causes:
        family, general = cause.id.partition(".")[0], cause.forms[0]
        if family in REMOUNTED and not general.spread and not general.regime:
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
    """Ways in which a size may follow the point, or always be the same: name, factor; one half of the range is 1."""
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
