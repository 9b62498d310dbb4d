"""The rows of a sweep on the workers of a Dask cluster, which may come and go."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np

from ...model.errors import DataError
from ..show.console import note
from .sweep_rows import Block, Job

#: How long a cluster may take to answer, and to get its first worker [s].
PATIENCE = 20.0
#: Between two looks at which workers there are [s].
LOOK = 1.0
#: Blocks of a task at most: a task costs 20 ms.
TOGETHER = 8
#: Tasks that each thread of a worker gets at least, where there are as many blocks.
SHARES = 4


def run_on_cluster(job: Job, blocks: Iterable[Block], address: str) -> Iterator[Block]:
    """The finished blocks in the order in which the workers of a Dask cluster finish them.

    The rows of a worker that is lost are solved again by others; without any, the run waits until one comes.

    Raises:
        DataError: the scheduler does not answer, has no workers, or a worker cannot do the work
    """
    client = _client(address)
    try:
        shared = client.submit(_same, job, pure=False)  # what is computed comes back with another worker
        threads, waiting = sum(client.nthreads().values()), list(blocks)
        size = min(max(len(waiting) // (SHARES * threads), 1), TOGETHER)
        numbers: dict[Any, Sequence[int]] = {}
        ended = _Ended(client, address)
        for group in (waiting[first : first + size] for first in range(0, len(waiting), size)):
            if len(numbers) >= 2 * threads:
                yield from ended.blocks(numbers)
            future = client.submit(_rows, shared, [values for _, values in group], pure=False)
            numbers[future.key] = [number for number, _ in group]
            future.add_done_callback(ended.put)
        while numbers:
            yield from ended.blocks(numbers)
    except (GeneratorExit, KeyboardInterrupt, DataError):
        raise
    except Exception as error:  # whatever a worker or the network raises
        said = f"{type(error).__name__}: {str(error)[:300]}"
        if type(error).__name__ == "KilledWorker":
            said = "workers end while they solve them, for want of memory for example"
        raise DataError(
            f"--scheduler {address}: a worker cannot do its rows: {said}\n"
            "Workers need this version of gearheat in their environment."
        ) from error
    finally:
        client.close()


class _Ended:
    """Tasks that have ended, and a look at the workers while none does."""

    def __init__(self, client: Any, address: str) -> None:
        self._client, self._address = client, address
        self._workers = set(client.nthreads())
        self._queue: SimpleQueue[Any] = SimpleQueue()
        self.put = self._queue.put

    def blocks(self, numbers: dict[Any, Sequence[int]]) -> Iterable[Block]:
        """The next finished blocks, of those that are under way by the keys of their tasks."""
        while True:
            try:
                future = self._queue.get(timeout=LOOK)
            except Empty:
                self._look()
                continue
            return zip(numbers.pop(future.key), future.result(), strict=True)

    def _look(self) -> None:
        if self._client.status != "running":
            raise DataError(f"--scheduler {self._address}: the scheduler has gone. Start it and repeat the command.")
        workers = set(self._client.nthreads())
        for lost in sorted(self._workers - workers):
            note(f"worker {lost} has gone: others solve its rows again")
        if self._workers and not workers:
            note(f'no worker is left: start one with "dask worker {self._address}", and the run goes on')
        self._workers = workers


def _same(job: Job) -> Job:
    return job


def _rows(job: Job, blocks: Sequence[np.ndarray]) -> list[np.ndarray]:
    return [job.rows(values, threads=1) for values in blocks]


def _client(address: str) -> Any:
    """A connection to a scheduler that has workers."""
    from distributed import Client

    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise DataError(
            f"--scheduler {address}: no answer ({str(error)[:200] or type(error).__name__}).\n"
            'Start one with "dask scheduler" and give the address it prints, like tcp://host:8786.'
        ) from None
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        client.close()
        raise DataError(f'--scheduler {address}: no workers came. Start some with "dask worker {address}".') from None
    return client
