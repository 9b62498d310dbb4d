"""How the program ends: soon after Ctrl-C whatever library runs, and with nothing of it left in temporary folders."""

from __future__ import annotations

import os
import re
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from multiprocessing import active_children
from pathlib import Path

from ...model.files import DAY, remove_unfinished

INTERRUPTED = 130
#: From Ctrl-C to the end, at most [s].
PATIENCE = 1.4
#: Set by Ctrl-C.
_HEARD = threading.Event()
#: Set where that has been said.
SAID = threading.Event()
#: Name of the temporary folder of a process.
_FOLDER = re.compile(r"gearheat-(\d+)-\w+")


@contextmanager
def ending_well() -> Iterator[None]:
    """Within the block Ctrl-C ends the program within `PATIENCE`, and temporary files are in a folder of the process.

    What others have left for more than a day is removed.
    """
    listening = _listening() if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN else nullcontext()
    usual, own = tempfile.tempdir, None
    with suppress(OSError):  # a full or missing folder is told where it matters
        _collect(Path(tempfile.gettempdir()))
        tempfile.tempdir = own = tempfile.mkdtemp(prefix=f"gearheat-{os.getpid()}-")
    try:
        with listening:
            yield
    finally:
        tempfile.tempdir = usual
        if own is not None:
            shutil.rmtree(own, ignore_errors=True)
        if _HEARD.is_set():  # without a wait for threads, whatever the exception has become on its way
            _say()
            with suppress(OSError, ValueError):
                sys.stdout.flush()
            _exit()


@contextmanager
def _listening() -> Iterator[None]:
    """Answer Ctrl-C with an exception, and end where a library keeps it: by an alarm, or by a thread."""
    heard, tells = os.pipe()
    os.set_blocking(tells, False)
    signal.set_wakeup_fd(tells, warn_on_full_buffer=False)
    usual = signal.signal(signal.SIGINT, _interrupt)
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, lambda *_: _leave())
    threading.Thread(target=_wait, args=(heard,), daemon=True).start()
    try:
        yield
    finally:
        if not _HEARD.is_set():
            signal.signal(signal.SIGINT, usual)
            signal.set_wakeup_fd(-1)
            os.close(tells)


def _interrupt(*_: object) -> None:
    _HEARD.set()
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    raise KeyboardInterrupt


def _wait(heard: int) -> None:
    while (signals := os.read(heard, 64)) and signal.SIGINT not in signals:
        pass
    if signals:
        time.sleep(PATIENCE)
        _leave()


def _leave() -> None:
    """End at once, with nothing left behind."""
    remove_unfinished()
    if _FOLDER.fullmatch(Path(tempfile.gettempdir()).name):
        shutil.rmtree(tempfile.gettempdir(), ignore_errors=True)
    _say()
    _exit()


def _say() -> None:
    if not SAID.is_set():
        with suppress(OSError):
            os.write(2, b"interrupted\n")


def _exit() -> None:
    """End without a wait for threads, and with the workers."""
    for worker in active_children():
        worker.kill()
    os._exit(INTERRUPTED)


def _collect(folder: Path) -> None:
    """Remove folders of processes that have ended without a word more than a day ago."""
    for left in folder.glob("gearheat-*"):
        found = _FOLDER.fullmatch(left.name)
        with suppress(OSError):
            if found and time.time() - left.stat().st_mtime > DAY and not _lives(int(found[1])):
                shutil.rmtree(left, ignore_errors=True)


def _lives(process: int) -> bool:
    if os.name == "nt":  # signal 0 is Ctrl-C there
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
