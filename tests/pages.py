"""What an HTML page must have so that nothing of it runs over the edge of a narrow screen, and a picture to be read."""

from __future__ import annotations

import itertools
import re
from html.parser import HTMLParser
from unittest import mock

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

#: Elements that never have an end.
VOID = {"meta", "br", "img", "link", "input", "hr"}


class Page(HTMLParser):
    """The elements of a page with what they stand in."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[tuple[str, str]] = []
        self.found: list[tuple[str, dict[str, str], list[tuple[str, str]]]] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        known = {key: value or "" for key, value in attrs}
        self.found.append((tag, known, list(self.open)))
        if tag not in VOID:
            self.open.append((tag, known.get("class", "")))

    def handle_startendtag(self, tag, attrs):
        self.found.append((tag, dict(attrs), list(self.open)))

    def handle_endtag(self, tag):
        assert self.open and self.open[-1][0] == tag, f"</{tag}> closes {self.open[-1:]}"
        self.open.pop()


def problems_of(text: str) -> list[str]:
    """Why a page may be wider than its screen: wide tables and pictures without a frame, fixed widths, outer files."""
    page, found = Page(text), []
    css = " ".join(re.findall(r"<style>(.*?)</style>", text, re.DOTALL))
    tags = {tag for tag, _, _ in page.found}
    if 'name="viewport"' not in text:
        found.append("no viewport")
    if "svg" in tags and not re.search(r"svg[^{]*{[^}]*max-width: ?100%", css):
        found.append("pictures may be wider than the page")
    if "table" in tags and not re.search(r"\.scroll ?{[^}]*overflow-x: ?auto", css):
        found.append("tables cannot scroll")
    for tag, known, around in page.found:
        if tag == "table" and ("div", "scroll") not in around:
            found.append("a table outside of a frame that scrolls")
        if tag == "svg" and not any(name == "figure" for name, _ in around):
            found.append("a picture outside of a figure")
        if tag == "img" and not re.search(r"img[^{]*{[^}]*max-width: ?100%", css):
            found.append("an image may be wider than the page")
        if tag == "pre" and not re.search(r"pre[^{]*{[^}]*(overflow-x: ?auto|white-space: ?pre-wrap)", css):
            found.append("text as it is typed may be wider than the page")
        if re.search(r"(?<!max-)width:\s*\d+px", known.get("style", "")):
            found.append(f"<{tag}> has a fixed width")
        if re.match(r"https?:", known.get("src", "")) or (tag == "link" and known.get("href")):
            found.append(f"<{tag}> needs a file from outside")
    found += [f"{wide} in the style" for wide in re.findall(r"(?<!max-)width: ?(?:[89]\d\d|7[6-9]\d|\d{4,})px", css)]
    return found


def words_that_collide(figure: Figure) -> list[str]:
    """Words of a picture that lie over each other or beyond its edge; slanted ones, as on contours, are left out."""
    canvas, drawn = FigureCanvasAgg(figure), {}
    with mock.patch.object(Text, "draw", autospec=True, side_effect=lambda text, _: drawn.setdefault(id(text), text)):
        canvas.draw()
    texts = [t for t in drawn.values() if t.get_visible() and t.get_text().strip() and t.get_rotation() % 90 == 0]
    boxes = [(t.get_text(), t.get_window_extent(canvas.get_renderer())) for t in texts]
    width, height = canvas.get_width_height()
    cut = [w for w, b in boxes if b.x0 < -1 or b.y0 < -1 or b.x1 > width + 1 or b.y1 > height + 1]
    pairs = itertools.combinations(boxes, 2)
    return cut + [f"{a!r} over {b!r}" for (a, p), (b, q) in pairs if p.shrunk(0.98, 0.9).overlaps(q.shrunk(0.98, 0.9))]
