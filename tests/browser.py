"""Chromium driven by its own protocol: opens a page, clicks, runs JavaScript, waits for what shall come."""

from __future__ import annotations

import base64
import itertools
import json
import os
import re
import shutil
import subprocess
import time
from io import BytesIO
from pathlib import Path
from types import TracebackType
from typing import Any
from urllib.request import urlopen

import pytest
from gearheat.tools.docs.blocks import PAGES
from PIL import Image

#: Widths of a telephone, of half a screen and of a screen [px].
WIDTHS = (360, 800, 1400)
#: What is wrong with what is seen of a page: wider than its screen, words beyond their box, pictures without content.
FAULTS = """(() => {
  const found = [], wide = document.documentElement.scrollWidth, name = (e) => `${e.tagName} ${e.innerText ?? ""}`;
  if (wide > innerWidth) found.push(`the page is ${wide} px wide`);
  const seen = (e) => e.getClientRects().length > 0;
  const scrolls = (e) => e && (getComputedStyle(e).overflowX !== "visible" || scrolls(e.parentElement));
  const words = "h1, h2, h3, p, li, dt, dd, td, th, summary, figcaption, button, .card";
  for (const e of document.querySelectorAll(words))
    if (seen(e) && e.scrollWidth > e.clientWidth + 1 && !scrolls(e)) found.push(`beyond its box: ${name(e)}`);
  for (const e of document.querySelectorAll("figure svg, img:not(.toggler), canvas")) {
    if (!seen(e)) continue;
    const box = e.getBoundingClientRect();
    const drawn = e.naturalWidth ?? (e.tagName === "CANVAS" ? e.width : e.querySelectorAll("path, use").length);
    if (box.width < 100 || box.height < 40 || drawn < 5) found.push(`empty: ${e.tagName} ${box.width} x ${box.height}`);
  }
  return found;
})()"""

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), "")


class Browser:
    """A page in a browser without a screen; a context that ends it."""

    def __init__(self, folder: Path) -> None:
        client = pytest.importorskip("websockets.sync.client", reason="websockets drive the browser")
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--hide-scrollbars"]
        options += [f"--user-data-dir={folder}", "--window-size=1280,900", "about:blank"]
        self.process = subprocess.Popen([CHROMIUM, *options], stderr=subprocess.PIPE, text=True)
        assert self.process.stderr
        found = next(m for line in self.process.stderr if (m := re.search(r"ws://([^/]*)/", line)))
        with urlopen(f"http://{found[1]}/json/list") as answer:
            page = next(p for p in json.load(answer) if p["type"] == "page")
        self.socket = client.connect(page["webSocketDebuggerUrl"], max_size=None)
        self.numbers = itertools.count()

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        self.socket.close()
        self.process.terminate()
        self.process.communicate()

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """The answer to a command of the protocol."""
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while (answer := json.loads(self.socket.recv(timeout=60))).get("id") != number:
            pass
        assert "error" not in answer, answer
        result: dict[str, Any] = answer["result"]
        return result

    def open(self, address: str) -> None:
        """Go to an address."""
        self.call("Page.navigate", url=address)

    def wide(self, width: int, height: int = 900) -> None:
        """Show the next page in so many pixels."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def faults(self, page: Path, width: int) -> list[str]:
        """What is wrong with a page on a screen of a width, see `FAULTS`."""
        self.wide(width)
        self.open(page.as_uri())
        self.wait(f"document.readyState === 'complete' && location.href === {json.dumps(page.as_uri())}")
        return [f"{page.name} at {width} px: {fault}" for fault in self.js(FAULTS)]

    def js(self, code: str) -> Any:
        """The value of an expression of JavaScript."""
        found = self.call("Runtime.evaluate", expression=code, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def wait(self, code: str, seconds: float = 90.0) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + seconds
        while not self.js(f"Boolean({code})"):
            assert time.monotonic() < end, f"never true: {code}\n{self.js('document.body.innerText')}"
            time.sleep(0.1)

    def click(self, text: str) -> None:
        """Click the button or tab that says a text, as soon as it is seen."""
        button = (
            '[...document.querySelectorAll("button, .q-tab, [role=tab]")].find((b) => b.offsetParent && !b.disabled'
            f" && b.innerText.trim().toLowerCase() === {json.dumps(text.lower())})"
        )
        self.wait(button)
        self.js(f"{button}.click()")

    def drop(self, place: str, name: str, text: str) -> None:
        """Give a file to the field for files below an element."""
        file = f"new File([{json.dumps(text)}], {json.dumps(name)})"
        field = f"document.querySelector({json.dumps(place + ' input[type=file]')})"
        self.wait(field)
        self.js(
            f"(() => {{ const held = new DataTransfer(), field = {field}; held.items.add({file});"
            ' field.files = held.files; field.dispatchEvent(new Event("change", { bubbles: true })); })()'
        )

    def show(self, name: str) -> None:
        """What is seen, as a picture of the documentation, where the pictures are written anew."""
        if os.environ.get("SNAPSHOTS") != "write":
            return
        time.sleep(1.0)
        image = Image.open(BytesIO(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])))
        image.quantize(64).save(PAGES / "howto" / name, optimize=True)
