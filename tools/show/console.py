"""What every command shares: exit codes, problems on stderr, JSON or tables on stdout, files moved into place.

Imports nothing heavy: `gearheat --help` goes through here.
"""

from __future__ import annotations

import errno
import functools
import json
import math
import os
import shutil
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ParamSpec

from ...fmu.compiling import Progress
from ...model.errors import DataError, GearheatError, ScenarioError, visible
from ...model.files import flows, keep_inputs, place, replacing
from ...model.units import refuse_comma
from . import endings
from .ending import INTERRUPTED, SAID

P = ParamSpec("P")

BAD_INPUT = 2
#: Of a device without room.
FULL = (errno.ENOSPC, errno.EDQUOT)
#: Of a path that leads nowhere, or where one may not go.
NO_WAY = (errno.ENAMETOOLONG, errno.EACCES, errno.EPERM, errno.ELOOP, errno.ENOTDIR)
#: Kinds of pictures, by the ending of the file.
PICTURES = (".html", ".svg", ".png")
#: Options of commands that name files to be written.
OUTPUTS = ("out", "json", "plot", "report", "html", "predictions", "extended")
#: Width that a column of words gets at least.
LEAST = 14
#: s, between two lines of progress where stderr is no terminal: a log stays short, and a long run is seen to live.
EVERY = 30.0


def guard(command: Callable[P, None]) -> Callable[P, None]:
    """A command whose problems end it with exit code 2, one problem after the other on stderr and no traceback."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            with keep_inputs():
                _early(kwargs)
                command(*args, **kwargs)
            sys.stdout.flush()
        except GearheatError as error:
            for problem in error.problems:
                note(f"error: {problem}")
            sys.exit(BAD_INPUT)
        except KeyboardInterrupt:
            note("interrupted")
            SAID.set()
            sys.exit(INTERRUPTED)
        except MemoryError:
            note("error: there is not enough memory. Ask for less at once, or give more.")
            sys.exit(BAD_INPUT)
        except BrokenPipeError:  # the reader of stdout, a pager for example, has gone
            _silence()
        except OSError as error:
            if error.errno in NO_WAY and error.filename:
                note(f"error: {error.filename}: {error.strerror}. Check the path.")
                sys.exit(BAD_INPUT)
            if error.errno not in FULL:
                raise
            place = error.filename or "standard output or a temporary file"
            note(f"error: {place}: {error.strerror}. Make room, or set TMPDIR.")
            if error.filename is None:
                _silence()
            sys.exit(BAD_INPUT)

    return run


def _early(options: Mapping[str, Any]) -> None:
    """Refuse, before any work, two outputs of a command in one file, and JSON that cannot be written."""
    named = {name: options.get(name) for name in OUTPUTS}
    first: dict[str, str] = {}
    for name, path in named.items():
        if isinstance(path, str | Path) and str(path) != "-" and not flows(Path(path)):
            other = first.setdefault(os.path.realpath(path), name)
            if other != name:
                raise ScenarioError(f"--{other} and --{name} both name {path}. Give each output a file of its own.")
    if isinstance(asked := options.get("json"), str):
        endings.fitting(file_of(asked), "JSON", "--json")
        writable(file_of(asked))


def _silence() -> None:
    """Nothing more goes to stdout."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def note(text: str) -> None:
    """A message or progress on stderr; stdout carries results only."""
    print(visible(text), file=sys.stderr, flush=True)


@contextmanager
def progress_bar() -> Iterator[Progress]:
    """Progress on stderr while work goes on: a bar on a terminal, elsewhere a line at most every `EVERY` seconds."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        told = time.monotonic()

        def tell(stage: str, share: float) -> None:
            nonlocal told
            bar.update(task, description=stage, completed=share)
            if bar.disable and time.monotonic() - told >= EVERY:
                told = time.monotonic()
                note(f"{stage} ({share:.0%})")

        yield tell


@contextmanager
def counting(things: str, total: int, done: int = 0) -> Iterator[Callable[[int], None]]:
    """Progress of work on many things alike; what it gives is called with the number of things finished since.

    Args:
        things: what they are, for example "rows"
        total: how many there are
        done: how many were finished before
    """
    with progress_bar() as tell:

        def advance(more: int) -> None:
            nonlocal done
            done += more
            tell(f"{done} of {total} {things}", done / max(total, 1))

        advance(0)
        yield advance


def plain(value: Any) -> Any:
    """A value as JSON can hold it: arrays as lists, numbers that are not finite as null."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [plain(v) for v in value]
    return value


def as_json(payload: Mapping[str, Any]) -> str:
    """One JSON object, the same text for the same values."""
    return json.dumps(plain(payload), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def answer(payload: Mapping[str, Any], to: str | None, human: Callable[[], None]) -> None:
    """Give a result: JSON to stdout for "-", JSON to a file for a name, else what `human` prints."""
    if to == "-":
        sys.stdout.write(as_json(payload))
        return
    if to is not None:
        write(Path(to), as_json(payload))
    human()


def file_of(json: str | None) -> Path | None:
    """The file that `--json` names, if it names one."""
    return None if json is None or json == "-" else Path(json)


def write(path: Path, content: str | bytes) -> None:
    """Write a file beside its place and move it there, so that a reader never sees half of it.

    Raises:
        DataError: the folder does not exist or cannot be written
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        with replacing(path) as beside:
            beside.write_bytes(data)
    except OSError as error:
        raise DataError(_cannot_write(path, error)) from None


def writable(*paths: Path | None) -> None:
    """Check before long work that files can be written to these places.

    Raises:
        DataError: one problem for each place that cannot be written
    """
    problems = []
    for path in (p for p in paths if p is not None):
        try:
            goes = place(path)
            if not flows(goes):
                tempfile.TemporaryFile(dir=goes.parent).close()
        except OSError as error:
            problems.append(_cannot_write(path, error))
    if problems:
        raise DataError(problems)


def lasting(path: Path) -> None:
    """Check before long work that what is written to a place can be read again, as it cannot from a device.

    Raises:
        DataError: it cannot
    """
    if path.exists() and not path.is_file():
        raise DataError(f"{path}: cannot be read again (it is a device). Give the output another name.")


def plottable(path: Path | None, option: str = "--plot") -> None:
    """Check before long work that a picture can be written to a place.

    Raises:
        ScenarioError: its ending is that of no kind of picture
        DataError: it cannot be written
    """
    if path is not None and path.suffix.lower() not in PICTURES:
        raise ScenarioError(f"{option} {path}: unknown kind of picture. Its name must end in {' or '.join(PICTURES)}.")
    writable(path)


def folder(path: Path) -> Path:
    """Make a folder for output, with its parents.

    Raises:
        DataError: it cannot be made or written
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        raise DataError(_cannot_write(path, error)) from None


def _cannot_write(path: Path, error: OSError) -> str:
    if isinstance(error, FileExistsError):
        return f"{path}: cannot be written ({error.strerror}). Give the output another name."
    if isinstance(error, IsADirectoryError):
        return f"{path}: cannot be written ({error.strerror}). Name a file in it."
    return f"{path}: cannot be written ({error.strerror or error}). Give a folder that exists and may be written."


def screen_width() -> int | None:
    """Columns of the screen: of the terminal, or as COLUMNS says; None where nothing says it, as in a pipe."""
    if not sys.stdout.isatty() and "COLUMNS" not in os.environ:
        return None
    return shutil.get_terminal_size().columns


def say(text: str) -> None:
    """Print sentences, broken between words where the screen ends; whole into files and pipes."""
    text, width = visible(text), screen_width()
    if width is None:
        print(text)
        return
    for line in text.split("\n"):
        print(textwrap.fill(line, width, break_long_words=False, break_on_hyphens=False))


def number(text: str) -> float:
    """A number as a user writes it. Raises ScenarioError where it is none, or has a decimal comma."""
    refuse_comma(text, "the number")
    try:
        return float(text)
    except ValueError:
        raise ScenarioError(f'"{text}" is no number.') from None


def table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[Any]],
    *,
    wrapped: bool = False,
    width: int | None = None,
) -> None:
    """Print a table: columns of numbers to the right, columns of words to the left.

    Numbers and names are never broken into lines. Where there is no room for all columns, the last ones of words are
    left out, and said so; numbers go on in further tables.

    Args:
        title: above it
        columns: names of the columns
        rows: a value per column
        wrapped: whether the first column may be broken into lines; names that are typed must not
        width: of the screen, see `screen_width`; 160 where nothing says it
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    body = [[cell(value) for value in row] for row in rows]
    words = [any(not is_number(row[i]) for row in body) for i in range(len(columns))]
    whole = [not words[i] or (i == 0 and not wrapped) for i in range(len(columns))]
    screen = Console(width=width or screen_width() or 160, markup=False, emoji=False)
    widest = [max(len(text) for text in (name, *(row[i] for row in body))) for i, name in enumerate(columns)]
    least = [n if stiff else min(n, LEAST) for n, stiff in zip(widest, whole, strict=True)]
    kept, *others = fitting(least, whole, screen.width, repeated=words[0])
    screen.print(visible(title), style="italic")
    drawn_plain = not (screen.is_terminal or screen.options.ascii_only)
    plain = drawn_plain and all(text.isascii() and text.isprintable() for row in (columns, *body) for text in row)
    for group in (kept, *others):
        if plain and sum(widest[i] + 3 for i in group) < screen.width:
            print(_plain([columns, *body], [(i, widest[i], words[i]) for i in group]))
            continue
        drawn = Table(box=box.SIMPLE_HEAD)
        for i in group:
            drawn.add_column(
                columns[i],
                justify="left" if words[i] else "right",
                overflow="fold",
                no_wrap=whole[i],
                min_width=min(4, widest[i]),
            )
        for row in body:
            drawn.add_row(*(row[i] for i in group))
        screen.print(drawn)
    if left := [name for i, name in enumerate(columns) if not any(i in group for group in (kept, *others))]:
        say(f"left out for want of room: {', '.join(left)}; widen the screen, or take --json\n")


def _plain(rows: Sequence[Sequence[str]], columns: Sequence[tuple[int, int, bool]]) -> str:
    """A table that has room, as rich draws it without styles, in a tenth of its time.

    Args:
        rows: head and body
        columns: number, width, and whether words, of each
    """
    lines = [
        "  " + "   ".join(row[i].ljust(n) if words else row[i].rjust(n) for i, n, words in columns) + "  "
        for row in rows
    ]
    blank = " " * len(lines[0])
    return "\n".join([blank, lines[0], f" {'─' * (len(blank) - 2)} ", *lines[1:], blank])


def fitting(widths: Sequence[int], whole: Sequence[bool], room: int, *, repeated: bool) -> list[list[int]]:
    """Columns that fit beside each other: those of words go first, from the last on; numbers go on in further tables.

    Args:
        widths: of the columns at least
        whole: which of them are numbers or names
        room: of the screen
        repeated: whether further tables begin with the first column
    """

    def size(kept: Sequence[int]) -> int:
        return sum(widths[k] + 3 for k in kept) + 1  # what is drawn around a column

    kept = list(range(len(widths)))
    for i in (i for i in reversed(range(1, len(widths))) if not whole[i]):
        if size(kept) <= room:
            break
        kept.remove(i)
    groups: list[list[int]] = [[]]
    for i in kept:
        if groups[-1] and size([*groups[-1], i]) > room:
            groups.append([0] if repeated else [])
        groups[-1].append(i)
    return groups


def is_number(text: str) -> bool:
    """Whether a cell holds a number or nothing."""
    try:
        float(text or 0)
    except ValueError:
        return False
    return True


def cell(value: Any) -> str:
    """A value as a table shows it: numbers with four digits or all before the point, nothing for a missing one."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    if not isinstance(value, float):
        return visible(str(value))
    value += 0.0  # no zero is negative
    return f"{value:.0f}" if 1e4 <= abs(value) < 1e7 else f"{value:.4g}"
