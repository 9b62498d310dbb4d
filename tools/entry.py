"""Where the program begins: also a Ctrl-C while it loads ends with one word."""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of the program."""
    try:
        from .cli import program

        program()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
