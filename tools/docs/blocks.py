"""Code blocks of a page, and running them as a reader would: one after the other, in one folder.

| block | what happens |
|---|---|
| `sh` | its commands are run |
| `console` | the commands behind `$` are run; the lines below them stand in the output, numbers to their last digit |
| `python` | is run; blocks of a page share their names |
| any language, then a file name | the file is written |
| `diff FILE` | lines with - and without a sign are looked for in the file; + replaces - |

A block marked `slow` is run only when all are asked for. One marked `read` needs files of the reader's own and is never
run. Of their commands the options are read.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from typer.core import TyperGroup

from ...scenarios.shipped import RIGS
from ..show.console import note

PAGES = Path(__file__).with_name("pages")
FENCE = re.compile(r"^```(\w*) *(.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")
#: Languages that this project has no program for.
SHOWN = {"", "matlab", "text"}
MARKS = {"slow", "read"}


@dataclass(frozen=True)
class Block:
    """A code block: its language, the file it is or changes, its mark, its text and first line."""

    language: str
    file: str
    mark: str
    text: str
    line: int

    @property
    def installs(self) -> bool:
        """Whether it makes an environment of its own."""
        return "-m venv" in self.text

    def commands(self) -> Iterator[tuple[list[str], list[str]]]:
        """Every command with the lines of output that stand below it."""
        lines = self.text.replace("\\\n", " ").splitlines()
        if self.language == "sh":
            yield from ((words, []) for line in lines if (words := shlex.split(line, comments=True)))
            return
        starts = [i for i, line in enumerate(lines) if line.startswith("$ ")]
        for i, end in zip(starts, [*starts[1:], len(lines)], strict=True):
            yield shlex.split(lines[i][2:], comments=True), [line for line in lines[i + 1 : end] if line.strip(" .")]


def blocks(text: str) -> list[Block]:
    """The code blocks of a page in their order."""
    found = []
    for match in FENCE.finditer(text):
        language, rest, body = match.groups()
        if rest.startswith("{"):
            continue
        words = rest.split()
        file, mark = (next((w for w in words if (w in MARKS) == marks), "") for marks in (False, True))
        found.append(Block(language, file, mark, body, text.count("\n", 0, match.start()) + 1))
    return found


def pages() -> list[Path]:
    """All pages, in the order of their names."""
    return sorted(PAGES.rglob("*.md"))


class Reader:
    """Runs the blocks of a page in a folder.

    Args:
        program: the command line
        folder: to work in, empty
        all_: whether blocks that take long are run as well
    """

    def __init__(self, program: TyperGroup, folder: Path, all_: bool = False) -> None:
        self.program, self.folder, self.all = program, folder, all_
        (folder / RIGS.parent.name).symlink_to(RIGS.parent)  # paths as in a checkout
        self.names: dict[str, object] = {}

    def problems(self, page: Path) -> list[str]:
        """What does not run, or does not print what the page says: one text for each."""
        found = []
        with contextlib.chdir(self.folder):
            for block in blocks(page.read_text(encoding="utf-8")):
                found += [f"{page.name} line {block.line}: {problem}" for problem in self._block(block)]
        return found

    def _block(self, block: Block) -> Iterable[str]:
        if block.language == "diff":
            return self._edit(block)
        if block.file:
            Path(block.file).write_text(block.text, encoding="utf-8")
        elif block.language == "python" and self._runs(block):
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile(block.text, "page", "exec"), self.names)
        elif block.language in ("sh", "console") and not block.installs:
            return self._commands(block)
        return []

    def _runs(self, block: Block) -> bool:
        return not block.mark or (self.all and block.mark == "slow")

    def _edit(self, block: Block) -> Iterator[str]:
        lines = block.text.splitlines(keepends=True)
        old, new = ("".join(line[1:] for line in lines if line[0] in signs) for signs in (" -", " +"))
        path = Path(block.file)
        text = path.read_text(encoding="utf-8")
        if text.count(old) != 1:
            yield f"{block.file} holds this {text.count(old)} times, not once: {old!r}"
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    def _commands(self, block: Block) -> Iterator[str]:
        for words, expected in block.commands():
            if not self._runs(block):
                if words[0] == "gearheat":
                    read(self.program, words[1:])
                continue
            code, out = self._run(words)
            if code != 0:
                yield f"{shlex.join(words)} ends with {code}: {out[-2000:]}"
            for line in missing(expected, out):
                near = [printed for printed in out.splitlines() if same(line, printed, numbers=False)]
                now = max(near, key=lambda p: len(set(p.split()) & set(line.split())), default="nothing like it")
                yield f"{shlex.join(words)} does not print {line!r} but {now!r}"

    def _run(self, words: list[str]) -> tuple[int, str]:
        if words[0] != "gearheat":
            path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
            run = subprocess.run(words, env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False)
            return run.returncode, run.stdout + run.stderr
        code, out, said = call(self.program, words[1:])
        return code, out + said


def read(program: TyperGroup, arguments: list[str]) -> None:
    """Read the options of a command without running it. Raises for wrong ones."""
    name, *rest = arguments
    program.commands[name].make_context(name, rest)


def call(program: TyperGroup, arguments: list[str]) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command, run in this process."""
    out, said = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
        try:
            program.main(arguments, prog_name="gearheat")
        except SystemExit as end:
            return int(end.code or 0), out.getvalue(), said.getvalue()
    return 0, out.getvalue(), said.getvalue()


def missing(expected: Iterable[str], out: str) -> Iterator[str]:
    """The lines that do not stand in an output in their order."""
    lines = iter(out.splitlines())
    for line in expected:
        if not any(same(line, printed) for printed in lines):
            yield line
            lines = iter(out.splitlines())


def same(expected: str, printed: str, *, numbers: bool = True) -> bool:
    """Whether two lines hold the same words and, to the last digit shown, the same numbers; `...` is any rest."""
    wanted, given = " ".join(expected.split()), " ".join(printed.split())
    if wanted.endswith("..."):
        wanted = wanted.removesuffix("...").rstrip()
        given = " ".join(given.split(" ")[: wanted.count(" ") + 1])
    if NUMBER.sub("", wanted) != NUMBER.sub("", given):
        return False
    if not numbers:
        return True
    pairs = zip(NUMBER.findall(wanted), NUMBER.findall(given), strict=True)
    return all(abs(float(a) - float(b)) <= 1.001 * last_digit(a) for a, b in pairs)


def last_digit(number: str) -> float:
    """What one more in the last digit of a number is; nothing for a whole number."""
    digits, _, power = number.partition("e")
    decimals = digits.partition(".")[2]
    return 10.0 ** (int(power or 0) - len(decimals)) if decimals else 0.0


def run_pages(program: TyperGroup, all_: bool = False) -> list[str]:
    """Run the blocks of all pages, each in a folder of its own; what is wrong, one text for each problem."""
    found = []
    for page in pages():
        note(f"running {page.relative_to(PAGES)}")
        with tempfile.TemporaryDirectory() as folder:
            found += Reader(program, Path(folder), all_).problems(page)
    return found
