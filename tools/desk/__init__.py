"""The desk: a local web app for those who would rather look and click than type. It calls `import gearheat` only."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import gearheat as gh


def serve(folder: Path, port: int, *, browser: bool) -> None:
    """Serve the desk to this machine until it is interrupted.

    Args:
        folder: where tables, cards, rigs and reports go
        port: 0 takes a free one
        browser: whether a browser is opened

    Raises:
        GearheatError: NiceGUI is not installed, the port is taken, or the folder cannot be made
    """
    if find_spec("nicegui") is None:
        raise gh.GearheatError('desk: NiceGUI is not installed. Run pip install "gearheat[desk]".')
    from .app import run

    run(folder, port, browser=browser)
