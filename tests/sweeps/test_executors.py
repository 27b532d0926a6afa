"""Where rows are computed: threads, processes, Dask and MPI, and what happens when a worker is missing."""

from __future__ import annotations

import multiprocessing
import os
import signal
import socket
import stat
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from distributed import Client, LocalCluster

import kanegen as kg
from kanegen.sweeps.executors import workers_of
from tests.support.paths import ROOT
from tests.support.sweeps import digests, swept

COMPILER = """#!/bin/sh
echo "$@" >> {log}
exec gcc "$@"
"""

MPI = """
from pathlib import Path
from tests.support.sweeps import digests, swept
if __name__ == "__main__":
    swept("mpi", folder="mpi")
    assert digests(Path("mpi")) == digests(Path("threads"))
    print("same")
"""


@pytest.fixture(scope="module")
def by_threads(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("threads")
    swept(folder=folder)
    return folder


def test_any_executor_of_threads(by_threads: Path, tmp_path: Path) -> None:
    with ThreadPoolExecutor(3) as pool:
        swept(pool, folder=tmp_path)
    assert digests(tmp_path) == digests(by_threads)


def test_dask_in_this_process(by_threads: Path, tmp_path: Path) -> None:
    """A client, and the address of its scheduler; the scheduler stays for its owner."""
    with Client(processes=False, n_workers=1, threads_per_worker=2, dashboard_address=None) as client:
        swept(client, folder=tmp_path / "client")
        with workers_of(client.scheduler.address) as workers:
            assert workers.in_flight() == 8
        swept(client.scheduler.address, folder=tmp_path / "address")
        assert client.submit(lambda: 7).result() == 7
    assert digests(tmp_path / "client") == digests(tmp_path / "address") == digests(by_threads)


def test_a_scheduler_that_does_not_answer() -> None:
    with pytest.raises(kg.OptionError) as caught, workers_of("tcp://127.0.0.1:9", seconds=0.3):
        pass
    message = "executor: the scheduler tcp://127.0.0.1:9 of Dask does not answer within 0.3 s: "
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_a_scheduler_that_takes_the_connection_and_says_nothing() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(kg.OptionError) as caught, workers_of(address, seconds=0.3):
            pass
    assert str(caught.value).startswith(
        f"executor: the scheduler {address} of Dask does not answer within 0.3 s"
    )


def _with_own_cache(cache: str, compiler: str) -> None:
    """Make a process one of another machine, whose cache is empty."""
    os.environ |= {"KANEGEN_CACHE": cache, "KANEGEN_CC": compiler}


def _spawning(count: int, *arguments: str) -> ProcessPoolExecutor:
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(count, context, _with_own_cache, arguments)


@pytest.mark.slow
def test_processes_of_another_machine_compile_once(by_threads: Path, tmp_path: Path) -> None:
    """Every source file is compiled once for both, from what the workers are sent."""
    compiler, log, cache = tmp_path / "cc", tmp_path / "log", tmp_path / "cache"
    compiler.write_text(COMPILER.format(log=log))
    compiler.chmod(compiler.stat().st_mode | stat.S_IXUSR)
    cache.mkdir(mode=0o700)
    with _spawning(2, str(cache), str(compiler)) as pool:
        swept(pool, folder=tmp_path / "out")
    assert digests(tmp_path / "out") == digests(by_threads)
    compiled = [line for line in log.read_text().splitlines() if " -c double_pendulum" in line]
    assert len(compiled) == len(set(compiled)) > 0


@pytest.mark.slow
def test_a_dask_cluster_of_two_processes(by_threads: Path, tmp_path: Path) -> None:
    with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        swept(cluster.scheduler_address, folder=tmp_path)
    assert digests(tmp_path) == digests(by_threads)


@pytest.mark.slow
def test_a_killed_worker_ends_the_sweep_with_one_line(tmp_path: Path) -> None:
    """The chunks that were finished are kept, and the sweep goes on with other workers."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        pool.submit(int).result()
        (worker,) = pool._processes.values()

        def kill(done: object) -> None:
            if worker.pid and kg.open_sweep(tmp_path).finished == 16:
                os.kill(worker.pid, signal.SIGKILL)

        with pytest.raises(kg.SweepError, match=r"chunk \d: a worker ended .* Finished chunks are kept"):
            swept(pool, folder=tmp_path, progress=kill)
    kept = kg.open_sweep(tmp_path)
    assert kept.finished >= 16
    found = swept(folder=tmp_path)
    np.testing.assert_array_equal(found.column("row"), np.arange(48))


@pytest.mark.slow
def test_processes_of_mpi(tmp_path: Path) -> None:
    swept(folder=tmp_path / "threads")
    (tmp_path / "run.py").write_text(MPI)
    mpiexec = str(Path(sys.executable).parent / "mpiexec")
    command = [mpiexec, "-n", "3", sys.executable, "-m", "mpi4py.futures", "run.py"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout == "same\n", done.stderr
