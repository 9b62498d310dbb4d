"""What an HTML page must have so that nothing of it runs over the edge of a narrow screen."""

from __future__ import annotations

import re
from html.parser import HTMLParser

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
        if re.search(r"(?<!max-)width:\s*\d+px", known.get("style", "")):
            found.append(f"<{tag}> has a fixed width")
        if re.match(r"https?:", known.get("src", "")) or (tag == "link" and known.get("href")):
            found.append(f"<{tag}> needs a file from outside")
    return found
