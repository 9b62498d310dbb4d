"""The page of a watch: what each machine shows, should show, and whether it has changed; it loads itself again."""

from __future__ import annotations

from collections.abc import Sequence

from ...model.errors import visible
from ..show.event_lines import describe
from ..show.pages import page
from .store import Store

#: Windows of a course.
WINDOWS = 60
#: The page loads itself again so often [s].
AGAIN = 60
#: Width and height of a course, in its own units.
SIZE = (300, 60)


def page_of(store: Store, rig: str) -> str:
    """The page as HTML.

    Args:
        store: with the events so far
        rig: whose machines these are
    """
    machines = []
    for name in store.machines:
        windows = store.last(name, "window", WINDOWS)
        if windows:
            courses = {
                reading: _course([w["readings"].get(reading) for w in windows]) for reading in windows[-1]["readings"]
            }
            named = [describe(cause) for cause in windows[-1]["causes"]]
            machines.append(
                {"name": name, "last": windows[-1], "first": windows[0], "courses": courses, "causes": named}
            )
    warnings = [visible(f"{w['machine']}: {w['text']}") for w in reversed(store.last("", "warning", WINDOWS))]
    machines.sort(key=lambda m: m["last"]["alarm"] is None)
    return page(__package__, "watch.html", rig=rig, machines=machines, warnings=warnings, again=AGAIN, size=SIZE)


def _course(readings: Sequence[dict[str, float] | None]) -> dict[str, str]:
    """Points of the band, and of what was measured and predicted, window by window."""
    known = [(k, r) for k, r in enumerate(readings) if r is not None]
    values = [r[key] for _, r in known for key in ("measured", "low", "high")]
    low, high = min(values), max(values)
    across, down = SIZE[0] / max(len(readings) - 1, 1), (SIZE[1] - 4) / max(high - low, 1e-9)

    def points(key: str) -> list[str]:
        return [f"{k * across:.1f},{2 + (high - r[key]) * down:.1f}" for k, r in known]

    lines = {key: " ".join(points(key)) for key in ("measured", "predicted")}
    return {"band": " ".join([*points("low"), *reversed(points("high"))]), **lines}
