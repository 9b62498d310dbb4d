"""Where the program begins: also a Ctrl-C while it loads ends with one word."""

from __future__ import annotations

import sys


def main() -> None:
    """Entry point of the program."""
    try:
        from .cli import app

        # reading the options of all commands takes as long as a short command
        named = [command for command in app.registered_commands if sys.argv[1:2] == [command.name]]
        app.registered_commands = named or app.registered_commands
        app()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
