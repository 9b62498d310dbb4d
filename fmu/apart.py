"""FMUs of other tools in a process of their own: code that exits, crashes or hangs takes nothing with it."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from ..model.errors import FmuError
from .grid import Inputs
from .play import Played, Player

#: Longest time without a finished step [s].
PATIENCE = 15.0
#: Shortest time between two signs of life [s].
PULSE = 1.0


def begin_worker(folder: str | None) -> None:
    """Begin a worker process: Ctrl-C is answered by its parent alone, with which it ends.

    Args:
        folder: for temporary files, that of the parent
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = folder
    threading.Thread(target=_end_with, args=(parent_process(),), daemon=True).start()


def _end_with(parent: BaseProcess | None) -> None:
    if parent is not None:
        parent.join()
        os._exit(1)


def play_apart(path: Path, inputs: Inputs, stop: float, step: float, **options: Any) -> Played:
    """Load an FMU in a process of its own and run it once.

    Args:
        path: the FMU
        inputs: name -> (times [s], values in SI)
        stop: end of the run [s]
        step: communication step [s]
        options: of `Player.run`

    Raises:
        FmuError: as `Player` and `Player.run`; its code ends the process, or makes no step in `PATIENCE`
    """
    with tempfile.TemporaryDirectory(prefix="gearheat-") as folder:
        return _play_in(folder, path, inputs, stop, step, options)


def _play_in(folder: str, path: Path, inputs: Inputs, stop: float, step: float, options: Mapping[str, Any]) -> Played:
    context = get_context("spawn")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_work, args=(theirs, folder, path, inputs, stop, step, options))
    process.start()
    theirs.close()
    found: Played | FmuError | None = None
    try:
        while found is None:
            if not ours.poll(PATIENCE):
                raise FmuError(f"{path.name}: has not made a step in {PATIENCE:g} s: its code hangs. Ask its maker.")
            found = ours.recv()
    except EOFError:
        process.join()
        raise FmuError(f"{path.name}: its code {_end(process.exitcode or 0)}. Ask its maker.") from None
    finally:
        process.kill()
        process.join()
    if isinstance(found, FmuError):
        raise found
    return found


def _end(code: int) -> str:
    return f"has crashed (signal {-code})" if code < 0 else f"has ended the program (exit code {code})"


def _work(
    tells: Connection,
    folder: str,
    path: Path,
    inputs: Inputs,
    stop: float,
    step: float,
    options: Mapping[str, Any],
) -> None:
    begin_worker(folder)
    try:
        with Player(path) as player:
            played = player.run(inputs, stop, step, alive=_pulse(tells), **options)
    except FmuError as error:
        tells.send(error)
    else:
        tells.send(played)


def _pulse(tells: Connection) -> Callable[[], None]:
    """Tells the parent at most every `PULSE` that a step was made."""
    last = 0.0

    def alive() -> None:
        nonlocal last
        if (now := time.monotonic()) - last > PULSE:
            last = now
            tells.send(None)

    return alive
