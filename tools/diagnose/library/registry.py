"""All causes of a machine and a campaign: our own, those of installed packages, and those of a user's files."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib.metadata import entry_points
from pathlib import Path

from ....model.errors import DataError, suggestion
from ....model.machines.roles import Roles
from ....scenarios.measured.table import Sensor
from . import cooling, losses, procedure, sensors as instruments, thermal
from .cause import Cause, Ranges
from .check import problems
from .forms import Context
from .mountings import with_mountings

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


def library(
    roles: Roles, ranges: Ranges, sensors: Sequence[Sensor], extra_files: Sequence[Path] = ()
) -> tuple[Cause, ...]:
    """All causes that the machine and its instruments allow, in the order of the taxonomy.

    Args:
        roles: of the machine
        ranges: of the data
        sensors: of the campaign
        extra_files: files of the user that define `causes(roles, ranges, sensors)`

    Raises:
        DataError: files and packages without causes, and causes that are none, all at once
    """
    at = Context(roles, ranges, sensors)
    found = {cause.id: cause for family in FAMILIES for cause in with_mountings(family(at), at)}
    wrong: list[str] = []
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
    if wrong:
        raise DataError(wrong)
    return tuple(found.values())


def _others(files: Iterable[Path], wrong: list[str]) -> Iterator[tuple[str, Family]]:
    """Functions of installed packages and of files, by where they are from."""
    for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name):
        try:
            yield f"package {entry.name}", entry.load()
        except Exception as error:  # a package may fail in any way
            wrong.append(f"package {entry.name} ({entry.value}): cannot be loaded: {type(error).__name__}: {error}.")
    for path in files:
        if (family := _from_file(path, wrong)) is not None:
            yield path.name, family


def _from_file(path: Path, wrong: list[str]) -> Family | None:
    """The function `causes` of a file."""
    spec = importlib.util.spec_from_file_location(f"gearheat_causes_{path.stem}", path)
    if spec is None or spec.loader is None:
        wrong.append(f"--library {path.name}: is no Python file. Give a file FILE.py that defines causes().")
        return None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except OSError as error:
        wrong.append(f"--library {path.name}: cannot be read ({error.strerror}). Check the path.")
        return None
    except Exception as error:  # a user's file may fail in any way
        wrong.append(f"--library {path.name}: fails: {type(error).__name__}: {error}.")
        return None
    family = getattr(module, "causes", None)
    if not callable(family):
        known = [name for name, value in vars(module).items() if callable(value)]
        close = suggestion("causes", known)
        wrong.append(f"--library {path.name}: there is no function causes(roles, ranges, sensors).{close} Add it.")
        return None
    return family  # type: ignore[no-any-return]
