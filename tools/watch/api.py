"""A watch over growing logs: its files and options, and its events one after the other."""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ...model.errors import DataError
from ...scenarios.frames import Table, Tables, path_of, paths_of, rows_told
from ...scenarios.given import RigLike
from ...scenarios.measured.sensors import sensors_of
from ..diagnose.request import Inputs, PlanRequest, Request, read_plan
from ..show.console import write
from .broker import PORTS, Broker
from .page import page_of
from .sources import Files, Source, Stream
from .spread import on_cluster
from .store import Store
from .watch import WINDOW, Watch, identity, one_by_one

File = str | Path
#: Where the store notes which events have been taken.
TAKEN = " taken"


@rows_told()
def watch(
    rig: RigLike,
    source: Table,
    *,
    card: File | None = None,
    reference_logs: Tables = (),
    sibling_logs: Tables = (),
    state: File | None = None,
    every: int = WINDOW,
    once: bool = False,
    alpha: float = Request.alpha,
    page: File | None = None,
    publish: str = "",
    after: int | None = None,
    scheduler: str | None = None,
) -> Iterator[dict[str, Any]]:
    """Follow logs while they grow, and diagnose all that has come with every window of samples.

    Args:
        rig: name of a shipped rig, or path of a rig file
        source: CSV or Parquet file that grows, a DataFrame, a folder whose files and sub-folders are a machine each,
            "-" for standard input, or mqtt://HOST/TOPIC
        card: columns, units and accuracies
        reference_logs: healthy logs of the one machine that is watched
        sibling_logs: a healthy log of each of other machines; a watched machine with the name of such a file has it
            as its own past
        state: file that keeps what has come; with it a restart goes on where the last watch ended
        every: samples of a window
        once: end with the source instead of waiting for more
        alpha: rate of false alarms of each diagnosis
        page: HTML file that is written anew with every window, and loads itself again
        publish: topic of the broker of the source under which events go out, each at least once
        after: number of the last event that is known; without it, that of the last one that was taken
        scheduler: address of a Dask scheduler whose workers diagnose the windows of a fleet

    Returns:
        its events in order: "window", "alarm", "cleared", "warning"; where the source ends, and without a number,
        "waiting" of samples that are no whole window

    Raises:
        GearheatError: all problems of files and options at once

    Example:
        >>> import gearheat as gh
        >>> for event in gh.watch("wind_turbine", "log.csv", once=True):  # doctest: +SKIP
        ...     print(event["event"], event["machine"])
    """
    source = source if isinstance(source, str) else path_of(source, name="source")
    problems = [] if every >= 3 else [f"--every {every}: a window has three samples or more."]
    broker = str(source).startswith(tuple(f"{scheme}://" for scheme in PORTS))
    if not broker and str(source) != "-" and not Path(source).exists():
        problems.append(f"{source}: there is no such file or folder.")
    if broker and once:
        problems.append("--once: a broker has no end. Leave it out.")
    if publish and not broker:
        problems.append("--publish: only the broker of a source mqtt://HOST/TOPIC takes events.")
    if scheduler is not None and find_spec("distributed") is None:
        problems.append('--scheduler needs distributed. Run pip install "gearheat[dask]".')
    places = {"--state": state, "--page": page}
    written = {option: Path(file) for option, file in places.items() if file is not None}
    found = read_plan(PlanRequest(rig, card=None if card is None else Path(card)), written, problems)
    references, siblings = paths_of(reference_logs), paths_of(sibling_logs)
    request = Request(rig, card=found.request.card, reference_logs=references, sibling_logs=siblings, alpha=alpha)
    inputs = Inputs(request, found.scenario, found.card, None, None, None)
    from ..diagnose.logs import read_logs  # what it needs loads slowly
    from .judge import Judge

    healthy = read_logs(inputs)
    judge = Judge(inputs, healthy.reference, healthy.siblings)
    store = Store(None if state is None else Path(state), f"{identity(request)} {every}")
    spread = one_by_one if scheduler is None else partial(on_cluster, scheduler)
    own = Watch(sensors_of(inputs.scenario, inputs.card), inputs.card, store, judge.answer, every, time.time, spread)
    taken: Source = Stream() if str(source) == "-" else Files(Path(source), store.place, once)
    if broker:
        kept = None if state is None else hashlib.sha256(f"{Path(state).resolve()} {source}".encode()).hexdigest()
        taken = Broker(str(source), kept and f"gearheat-{kept[:12]}", publish, inputs.card.columns.get("time", ""))
    return _events(own, store, taken, after, None if page is None else Path(page), inputs.scenario.name)


def _events(
    own: Watch, store: Store, source: Source, after: int | None, page: Path | None, rig: str
) -> Iterator[dict[str, Any]]:
    """Events as they are written."""
    shown = -1
    last: int = (store.place(TAKEN) or 0) if after is None else after
    for _ in own.follow(source):
        for number, text in list(store.events(last)):
            event = json.loads(text)
            if isinstance(source, Broker):
                source.tell(event, text)
            yield event
            store.move(TAKEN, last := number)
        if page is not None and shown != last:
            shown = last
            write(page, page_of(store, rig))
    store.commit()
    if not any(m.count or math.isfinite(m.answered) for m in store.machines.values()):
        raise DataError("no sample came that can be used. Check the source, and the columns of its card.")
    yield from own.waiting()
