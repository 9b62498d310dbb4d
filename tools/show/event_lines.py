"""Events as lines: of JSON, each once, or for people."""

from __future__ import annotations

import json as codec
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from ...model.errors import visible
from .console import file_of, writable


@dataclass
class Lines:
    """Where events go.

    Args:
        people: whether they are printed for people
        file: of lines of JSON
        last: number of the last event in that file; None without
    """

    people: bool
    file: IO[str] | None = None
    last: int | None = None

    def write(self, event: Mapping[str, Any]) -> None:
        """Append an event; one without a number does not go into the file."""
        text = codec.dumps(event, ensure_ascii=False)
        if self.file is not None and "number" in event:
            self.file.write(f"{text}\n")
            self.file.flush()
        print(visible(as_text(event)) if self.people else text, flush=True)


@contextmanager
def opened(json: str | None) -> Iterator[Lines]:
    """Lines of JSON on stdout for "-", for people without, both where a file is named, which is gone on with.

    Raises:
        DataError: the file cannot be written
    """
    path = file_of(json)
    if path is None:
        yield Lines(json is None)
        return
    writable(path)
    last = _mended(path)
    with path.open("a", encoding="utf-8", newline="\n") as file:
        yield Lines(True, file, last)


def _mended(path: Path) -> int:
    """Number of the last whole line of a file; half a line after it is cut off."""
    if not path.is_file():
        return 0
    data = path.read_bytes()
    whole = data[: data.rfind(b"\n") + 1]
    if len(whole) < len(data):
        path.write_bytes(whole)
    return int(codec.loads(whole.splitlines()[-1])["number"]) if whole else 0


def as_text(event: Mapping[str, Any]) -> str:
    """One line for people."""
    if event["event"] in ("warning", "waiting"):
        return f"{event['machine']}: {event['event']}: {event['text']}"
    head = f"{event['to']} {event['machine']}"
    named = ", ".join(describe(c) for c in event.get("causes", ())) or "no cause stands out"
    if event["event"] == "alarm":
        return f"{head}: ALARM: {named}"
    if event["event"] == "cleared":
        return f"{head}: alarm over"
    shown = (
        f"{name} {r['measured']:.1f} ({r['predicted']:.1f}, {r['low']:.1f} to {r['high']:.1f})"
        for name, r in event["readings"].items()
    )
    alarm = f", alarm since {event['alarm']}: {named}" if event["alarm"] is not None else ""
    return f"{head}: {', '.join(shown)}; changed {event['changed']:.0%}{alarm}"


def describe(cause: Mapping[str, Any]) -> str:
    """A cause in words: name, probability, since when."""
    since = f" since {cause['since']}" if cause["since"] else ""
    return f"{cause['name']} {cause['probability']:.0%}{since}"
