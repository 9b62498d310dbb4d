"""The server of the desk: 127.0.0.1 alone, and nothing to those who do not know the token in its address."""

from __future__ import annotations

import secrets
import socket
import webbrowser
from collections.abc import Awaitable, Callable, MutableMapping
from pathlib import Path
from typing import Any

import gearheat as gh
from nicegui import app, ui

from .bench import Bench
from .data import data_sheet
from .machines import map_sheet, rigs_sheet
from .plate import new_sheet

#: Where it listens: nothing of the network comes there.
HOST = "127.0.0.1"
#: Random bytes of the token.
SECRET = 24
#: The sheets in the order of their worth.
SHEETS: dict[str, Callable[[Bench], None]] = {
    "Data": data_sheet,
    "New": new_sheet,
    "Map": map_sheet,
    "Rigs": rigs_sheet,
}

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]


class Guard:
    """Lets through what begins with the token, requests and websockets alike; all else is refused with 403.

    Args:
        inner: the application
        prefix: "/" and the token
    """

    def __init__(self, inner: Callable[[Message, Receive, Send], Awaitable[None]], prefix: str) -> None:
        self.inner, self.prefix = inner, prefix

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Answer a request without what the token adds to its path."""
        if scope["type"] == "lifespan":
            await self.inner(scope, receive, send)
            return
        path = str(scope["path"])
        head, rest = path[: len(self.prefix)], path[len(self.prefix) :]
        if secrets.compare_digest(head.encode(), self.prefix.encode()) and rest.startswith("/"):
            headers = [*scope["headers"], (b"x-forwarded-prefix", self.prefix.encode())]
            await self.inner({**scope, "path": rest, "raw_path": rest.encode(), "headers": headers}, receive, send)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})  # before it is accepted: 403
        else:
            await send({"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain")]})
            await send({"type": "http.response.body", "body": b"The address of this desk has a token.\n"})


def run(folder: Path, port: int, *, browser: bool) -> None:
    """Serve the desk, as `serve` says."""
    port, token = _free(port), secrets.token_urlsafe(SECRET)
    address = f"http://{HOST}:{port}/{token}/"
    Bench(folder)  # a folder that cannot be made is told before anybody looks

    def ready() -> None:
        print(address, flush=True)
        if browser:
            webbrowser.open(address)

    app.add_static_files("/files", folder, max_cache_age=0)
    app.add_middleware(Guard, prefix=f"/{token}")
    app.on_startup(ready)
    ui.page("/", title="gearheat")(lambda: _sheets(Bench(folder)))
    ui.run(host=HOST, port=port, show=False, reload=False, show_welcome_message=False, uvicorn_logging_level="error")


def _free(port: int) -> int:
    """The port, or a free one in place of 0."""
    with socket.socket() as probe:
        try:
            probe.bind((HOST, port))
        except (OSError, OverflowError) as error:
            raise gh.GearheatError(f"--port {port}: cannot be taken ({error}). Give another one, or none.") from None
        return int(probe.getsockname()[1])


def _sheets(bench: Bench) -> None:
    """The page: four sheets, and below them the command that does what was clicked."""
    ui.add_css(".nicegui-content { padding: 0 } iframe { border: 0; width: 100%; height: 75vh }")
    with ui.header().classes("items-center"):
        ui.label("gearheat desk").classes("text-lg")
        with ui.tabs() as tabs:
            for name in SHEETS:
                ui.tab(name).props(f'data-sheet="{name}"')
    with ui.footer().classes("bg-grey-9"):
        ui.label("The command that does it:")
        bench.log = ui.column().classes("font-mono text-xs gap-0")
    with ui.tab_panels(tabs, value=next(iter(SHEETS)), animated=False, keep_alive=True).classes("w-full"):
        for name, sheet in SHEETS.items():
            with ui.tab_panel(name):
                sheet(bench)
