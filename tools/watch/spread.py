"""Windows of a fleet on the workers of a Dask cluster."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ..solve.cluster import run_on_cluster
from .watch import Answer, Asked, Judge, answer


def on_cluster(address: str, judge: Judge, asked: Iterable[tuple[int, Asked]]) -> Iterator[tuple[int, Answer]]:
    """Answers with the numbers of what was asked, as workers have them; each keeps what it learns of healthy logs.

    Args:
        address: of the scheduler
        judge: what can be pickled
        asked: with numbers

    Raises:
        DataError: as `run_on_cluster`
    """
    spread: Any = run_on_cluster  # as blind to what is asked as to the rows of a sweep
    yield from spread(_Work(pickle.dumps(judge)), asked, address)


@dataclass(frozen=True)
class _Work:
    pickled: bytes

    def rows(self, asked: Asked, threads: int) -> Answer:
        return answer(_kept(self.pickled), asked)


@lru_cache(2)
def _kept(pickled: bytes) -> Judge:
    """A judge with what it has learned of healthy logs, which a worker keeps."""
    judge: Judge = pickle.loads(pickled)
    return judge
