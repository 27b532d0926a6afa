"""All chunks of a sweep, computed by an executor and taken as they finish."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from dataclasses import dataclass

from kanegen.errors import KanegenError, SweepError
from kanegen.sweeps.chunk import Finished, Task, compute
from kanegen.sweeps.executors import Workers

_REFRESH = 2.0
"""Time in s after which the number of workers, which may change, is asked for again."""


@dataclass(frozen=True)
class Progress:
    """How far a sweep is.

    Attributes:
        rows: Rows that are finished.
        total: All rows.
        failed: Finished rows with a reason.
        new: Rows that this run has computed.
        seconds: Time of this run, s.
    """

    rows: int
    total: int
    failed: int
    new: int
    seconds: float

    @property
    def rate(self) -> float:
        """Rows per second of this run."""
        return self.new / self.seconds if self.seconds > 0 else 0.0

    @property
    def seconds_left(self) -> float:
        """Time that the remaining rows take at this rate, s; infinite before the first are finished."""
        left = self.total - self.rows
        return left / self.rate if self.rate else float("inf") if left else 0.0


def run(tasks: Iterable[Task], workers: Workers, take: Callable[[Finished], None]) -> None:
    """Compute tasks and take each of them as it finishes, in any order.

    If it is interrupted, or a task fails, the tasks that run are waited for and taken; those that have not
    begun are cancelled.

    Args:
        tasks: The tasks, which are made when there is room for them.
        workers: The executor.
        take: Function that keeps a finished chunk; it is called in this thread.

    Raises:
        SweepError: If a task fails.
        KeyboardInterrupt: If it is interrupted.
    """
    waiting = iter(tasks)
    pending: dict[Future[Finished], int] = {}
    try:
        for room in _rooms(workers, pending):
            for _ in range(room):
                task = next(waiting, None)
                if task is None:
                    break
                pending[workers.executor.submit(compute, task)] = task.number
            if not pending:
                return
            done, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in done:
                take(_result(future, pending.pop(future)))
    except BaseException:
        _finish(pending, take)
        raise


def _rooms(workers: Workers, pending: dict[Future[Finished], int]) -> Iterator[int]:
    """Yield again and again how many further tasks the executor should get."""
    most, asked = workers.in_flight(), time.monotonic()
    while True:
        if time.monotonic() - asked > _REFRESH:
            most, asked = workers.in_flight(), time.monotonic()
        yield max(most - len(pending), 0)


def _result(future: Future[Finished], number: int) -> Finished:
    """Return the result of a task.

    Raises:
        SweepError: If it failed.
    """
    try:
        return future.result()
    except KanegenError as error:
        raise SweepError(f"chunk {number}: {error}") from error
    except BrokenExecutor as error:
        raise SweepError(f"chunk {number}: a worker ended ({error}).") from error
    except CancelledError:
        raise SweepError(
            f"chunk {number}: the executor gave it up, as a cluster does whose scheduler has ended."
        ) from None
    except Exception as error:
        raise SweepError(
            f"chunk {number}: {type(error).__name__}: {' '.join(str(error).split())}."
        ) from error


def _finish(pending: dict[Future[Finished], int], take: Callable[[Finished], None]) -> None:
    """Cancel what has not begun, wait for the rest, and take what is right of it."""
    running = [future for future in pending if not future.cancel()]
    for future in wait(running).done:
        if not future.cancelled() and future.exception() is None:
            take(future.result())
