"""Entry point: Ctrl-C, also while the program loads, and a closed or full standard output end with one line."""

from __future__ import annotations

import errno
import gc
import os
import signal
import sys
from contextlib import suppress

INTERRUPTED = 130
#: Linear algebra uses one thread: matrices here are small, and more threads only wait for each other.
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
#: Objects until Python looks for circles of them that nothing uses: parts and equations of a rig are used to the end.
COLLECT = (100_000, 50, 1000)


def _leave(*_: object) -> None:
    """End at once: an exception is lost in the middle of an import, or becomes another one."""
    with suppress(OSError):
        os.write(2, b"interrupted\n")
    os._exit(INTERRUPTED)


def main() -> None:
    """Entry point of the program."""
    gc.set_threshold(*COLLECT)
    for name in THREADS:  # before anything loads numpy
        os.environ.setdefault(name, "1")
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _leave)  # while the program loads; there is nothing yet to be tidied up
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by who has started the program
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w", encoding="utf-8"))
        with suppress(AttributeError):
            getattr(sys, name).reconfigure(errors="backslashreplace")
    try:
        from ..show.ending import ending_well

        with ending_well():
            try:
                from .app import program

                program()
            finally:
                sys.stdout.flush()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
    except OSError as error:  # what typer itself prints: help, version, completion
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EPIPE):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if error.errno == errno.EPIPE:  # the reader of stdout, a pager for example, has gone
            sys.exit(0)
        print(f"error: standard output: {error.strerror}. Make room.", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
