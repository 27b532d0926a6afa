"""Executors by name: threads on this machine, a Dask cluster by its address, processes of MPI."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, InvalidStateError, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from kanegen.errors import MissingError, OptionError, quoted
from kanegen.extras import is_installed, module
from kanegen.library.native import processor

DASK = "dask"
"""The extra that installs `dask.distributed`."""

MPI = "mpi"
"""The name of the executor whose workers are the processes of `mpiexec`, and the extra that installs it."""

SECONDS = 20.0
"""Time limit for the connection to a scheduler of Dask, s."""

_GRACE = 1.0
"""Time in s after the limit in which a client may still say why it has no connection."""

_ADDRESSES = ("tcp://", "tls://", "ucx://", "ws://", "wss://", "inproc://")
"""Beginnings of addresses of schedulers."""

_IN_FLIGHT = 4
"""Chunks that wait or run for each worker."""


@dataclass(frozen=True)
class Workers:
    """An executor, and how many chunks it should hold at once.

    Attributes:
        executor: The executor.
        in_flight: Function that returns how many chunks should wait or run, so that no worker is idle and few
            chunks are lost when the sweep ends early.
        name: What it is, in words.
    """

    executor: Executor
    in_flight: Callable[[], int]
    name: str


@contextmanager
def workers_of(executor: Any, workers: int | None = None, seconds: float = SECONDS) -> Iterator[Workers]:
    """Yield the workers that a user asks for; what was started for them ends afterwards.

    Args:
        executor: None for threads of this process; any `concurrent.futures.Executor`; a client of Dask, or
            the address of its scheduler, such as "tcp://10.0.0.1:8786"; or "mpi", in a process that
            `mpiexec -n N python -m mpi4py.futures` has started.
        workers: Number of threads, by default one for each processor that the process may use; only for
            threads.
        seconds: Time limit for the connection to a scheduler, s.

    Raises:
        OptionError: If it is none of these, or the scheduler does not answer in time.
        MissingError: If a package is not installed.
    """
    if workers is not None and executor is not None:
        raise OptionError("workers: the number of threads goes with no other executor. Leave it out.")
    if executor is None:
        count = _count(workers)
        with ThreadPoolExecutor(count, "kanegen-sweep") as pool:
            yield Workers(pool, lambda: _IN_FLIGHT * count, f"{count} threads" if count > 1 else "one thread")
    elif isinstance(executor, Executor):
        yield _given(executor)
    elif executor == MPI:
        with _mpi() as found:
            yield found
    elif isinstance(executor, str):
        with _dask(executor, seconds) as client:
            yield _of_client(client, executor)
    elif hasattr(executor, "get_executor"):
        yield _of_client(executor, "Dask")
    else:
        raise OptionError(
            f"executor: {quoted(executor)} runs nothing. Give an executor of concurrent.futures, a client of "
            'Dask, the address of its scheduler such as "tcp://10.0.0.1:8786", or "mpi".'
        )


def _count(workers: int | None) -> int:
    """Return the number of threads."""
    if workers is None:
        return processor.usable()
    if isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= 10_000:
        raise OptionError(f"workers: {quoted(workers)} is no number of threads from 1 to 10000.")
    return workers


def _given(executor: Executor) -> Workers:
    """Return the workers of an executor that a user has made."""
    count = getattr(executor, "_max_workers", None) or os.cpu_count() or 1
    return Workers(executor, lambda: _IN_FLIGHT * int(count), type(executor).__name__)


@contextmanager
def _mpi() -> Iterator[Workers]:
    """Yield the processes of MPI as workers."""
    pool_of = module("mpi4py.futures", extra=MPI).MPIPoolExecutor
    comm = module("mpi4py.MPI", extra=MPI).COMM_WORLD
    with pool_of() as pool:
        others = max(comm.Get_size() - 1, getattr(pool, "num_workers", 0) or 1)
        yield Workers(pool, lambda: _IN_FLIGHT * others, f"{others} processes of MPI")


@contextmanager
def _dask(address: str, seconds: float) -> Iterator[Any]:
    """Yield a client of the scheduler at an address, and close it."""
    if not address.startswith(_ADDRESSES):
        raise OptionError(
            f"executor: {quoted(address)} is neither {MPI!r} nor the address of a scheduler of Dask, such as "
            '"tcp://10.0.0.1:8786".'
        )
    if not is_installed("distributed"):
        raise MissingError(f"the Python package distributed is not installed (pip install 'kanegen[{DASK}]')")
    try:
        client = _connected(address, seconds)
    except (OSError, ValueError, TimeoutError) as error:
        why = " ".join(str(error).split()) or type(error).__name__
        raise OptionError(
            f"executor: the scheduler {address} of Dask does not answer within {seconds:g} s: {why}"
        ) from None
    try:
        yield client
    finally:
        with suppress(Exception), _silent("distributed.client"):  # a scheduler that has ended meanwhile
            client.close()


def _connected(address: str, seconds: float) -> Any:
    """Return a client of the scheduler at an address.

    The client itself waits without end for one that takes the connection and says nothing, so it is made in a
    thread of its own, which is given up.

    Raises:
        OSError, ValueError, TimeoutError: If there is no answer in time.
    """
    distributed = module("distributed", extra=DASK)
    made: Future[Any] = Future()

    def connect() -> None:
        """Make the client, and close it if nobody waits any more."""
        try:
            client = distributed.Client(address, timeout=seconds, set_as_default=False)
        except Exception as error:
            with suppress(InvalidStateError):
                made.set_exception(error)
            return
        try:
            made.set_result(client)
        except InvalidStateError:
            client.close()

    threading.Thread(target=connect, name="kanegen-dask", daemon=True).start()
    try:
        return made.result(seconds + _GRACE)
    except TimeoutError as error:
        if made.cancel():
            raise TimeoutError("it takes the connection and says nothing") from None
        raise error


@contextmanager
def _silent(name: str) -> Iterator[None]:
    """Suppress what a package logs, such as that a connection is lost that is given up anyway."""
    logger = logging.getLogger(name)
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(level)


def _of_client(client: Any, name: str) -> Workers:
    """Return the workers of a client of Dask."""

    def in_flight() -> int:
        """Return how many chunks the threads of all workers should hold, which may come and go."""
        with suppress(Exception):
            return max(_IN_FLIGHT * int(sum(client.nthreads().values())), _IN_FLIGHT)
        return _IN_FLIGHT

    return Workers(client.get_executor(pure=False), in_flight, name)
