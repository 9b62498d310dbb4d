"""The rows of a sweep: what a worker does with a block of them, on this machine or in a Dask cluster.

Imports neither CasADi nor the rig files: a worker compiles C and calls it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...fmu.batch import Batch
from ...model.errors import DataError
from ...model.run.schedule import Schedule

SCHEMA = "gearheat.sweep.rows/1"

#: What stands behind the outputs of a row.
TELLING = ("status", "iterations", "energy_residual", "outside")

#: How long a cluster may take to answer, and to get its first worker [s].
PATIENCE = 20.0

Block = tuple[int, np.ndarray]


@dataclass(frozen=True)
class Job:
    """All that the rows of a sweep share.

    Attributes:
        varied: paths of what is varied, in the order of the columns of the values
        outputs: paths of the states and outputs that are kept
        start: path of a state -> its value at the beginning, or the varied path whose value it takes
        schedule: the duty of a warm-up; None for steady states
        times: output times of a warm-up [s]
    """

    batch: Batch
    varied: tuple[str, ...]
    outputs: tuple[str, ...]
    start: Mapping[str, float | str]
    schedule: Schedule | None = None
    times: tuple[float, ...] = ()

    def key(self, values: np.ndarray, size: int) -> str:
        """Hash of all that the rows with these values, in blocks of some size, depend on."""
        batch, schedule = self.batch, self.schedule
        groups = (batch.states, batch.inputs, batch.parameters, batch.outputs)
        text = repr(
            [SCHEMA, size, [[q.name for q in g] for g in groups], self.varied, self.outputs, self.start, self.times]
        )
        code = batch.steady_source if schedule is None else batch.warmup_source
        digest = hashlib.sha256(f"{text}\0{code}\0{batch.relations_source}\0".encode())
        for array in (*batch.vectors({}), values):
            digest.update(f"{array.shape}".encode() + np.ascontiguousarray(array).tobytes())
        if schedule is not None:
            digest.update(schedule.time.tobytes())
            for name, column in schedule.values.items():
                digest.update(name.encode() + np.asarray(column, dtype=float).tobytes())
        return digest.hexdigest()

    def rows(self, values: np.ndarray, threads: int = 0) -> np.ndarray:
        """Kept outputs and what tells of each row: (rows times output times, outputs and TELLING).

        Args:
            values: what is varied (rows, varied), SI
            threads: threads to use, 0 for one per core
        """
        columns = dict(zip(self.varied, np.ascontiguousarray(values.T), strict=True))
        given: dict[str, Any] = {name: columns[v] if isinstance(v, str) else v for name, v in self.start.items()}
        arrays = self.batch.vectors({**given, **columns})
        if self.schedule is None:
            rows = self.batch.steady(*arrays, threads=threads)
        else:
            rows = self.batch.warmup(self.schedule, *arrays, times=self.times, threads=threads)
        telling = np.column_stack([rows.status, rows.iterations, rows.residual, rows.outside])
        if self.schedule is not None:
            telling = np.repeat(telling, len(self.times), axis=0)
        return np.column_stack([*(rows[name].ravel() for name in self.outputs), telling])


def _rows(job: Job, values: np.ndarray) -> np.ndarray:
    return job.rows(values, threads=1)


def local(job: Job, blocks: Iterable[Block], threads: int) -> Iterator[Block]:
    """The finished blocks, solved on this machine."""
    for number, values in blocks:
        yield number, job.rows(values, threads)


def run_on_cluster(job: Job, blocks: Iterable[Block], address: str) -> Iterator[Block]:
    """The finished blocks in the order in which the workers of a Dask cluster finish them.

    Raises:
        DataError: the scheduler does not answer, has no workers, or a worker cannot do the work
    """
    from distributed import as_completed

    client = _client(address)
    try:
        (shared,) = client.scatter([job], broadcast=True, hash=False)
        limit = 2 * sum(client.nthreads().values())
        numbers: dict[Any, int] = {}
        ready = as_completed(loop=client.loop)

        def finished() -> Block:
            future = next(ready)
            return numbers.pop(future.key), future.result()

        for number, values in blocks:
            if len(numbers) >= limit:
                yield finished()
            future = client.submit(_rows, shared, values, pure=False)
            numbers[future.key] = number
            ready.add(future)
        while numbers:
            yield finished()
    except (GeneratorExit, KeyboardInterrupt):
        raise
    except Exception as error:  # whatever a worker or the network raises
        raise DataError(
            f"--scheduler {address}: a worker cannot do its rows: {type(error).__name__}: {str(error)[:300]}\n"
            "Workers need this version of gearheat in their environment."
        ) from error
    finally:
        client.close()


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
