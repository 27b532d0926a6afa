"""Batches that OpenMP shares among threads: the same bits for any number of them, also without OpenMP."""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from kanegen.errors import KanegenWarning
from kanegen.library import load
from kanegen.library.native import cache, commands, compilers
from tests.support.cases import slow_except
from tests.support.handmade import bits, many_states, source
from tests.support.paths import ROOT
from tests.support.pivot_programs import source_with_pivots


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


def gcc():
    if not compilers.has_openmp(compilers.find("gcc")):
        pytest.fail("gcc has OpenMP wherever it is installed whole")
    return "gcc"


CODE = """
import sys
import numpy as np
from kanegen.library import load
from tests.support.handmade import many_states, source
library = load(source(), "gcc", threads=True)
x, y = many_states()
result = library.evaluate(x, y)
sys.stdout.buffer.write(result.mass_matrix.tobytes() + result.forcing.tobytes())
"""


def test_the_number_of_threads_changes_no_bit():
    result = load(source(), gcc()).evaluate(*many_states())
    expected = result.mass_matrix.tobytes() + result.forcing.tobytes()
    for threads in ("1", "3"):
        environment = {
            **os.environ,
            "OMP_NUM_THREADS": threads,
            "PYTHONPATH": str(ROOT),
        }
        process = subprocess.run(
            [sys.executable, "-c", CODE], env=environment, capture_output=True, check=True
        )
        assert process.stdout == expected, threads


def test_failed_states_are_counted_across_threads():
    x, y = many_states()
    library = load(source_with_pivots(), gcc(), threads=True)
    singular = np.flatnonzero(~((x[:, 1] > 0) & (x[:, 0] - 1 / x[:, 1] > 0)))
    with pytest.warns(KanegenWarning, match=f"in {len(singular)} of {len(x)} states"):
        found = library.forward_dynamics(x, y)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(found).any(axis=1)), singular)


@pytest.mark.parametrize("threads", [True, False])
def test_openmp_is_linked_where_asked_for(threads):
    path = load(source(), gcc(), threads=threads)._native.path
    needed = subprocess.run(["ldd", path], capture_output=True, text=True, check=True).stdout
    assert ("libgomp" in needed) == threads


def test_a_compiler_without_openmp_brings_a_warning_and_one_thread(tmp_path):
    fake = tmp_path / "cc-without-openmp"
    fake.write_text(f'#!/bin/sh\ncase "$*" in *-fopenmp*) exit 1 ;; esac\nexec {shutil.which("gcc")} "$@"\n')
    fake.chmod(0o755)
    with pytest.warns(KanegenWarning, match="cc-without-openmp has no OpenMP, so batches use one thread"):
        library = load(source(), str(fake), threads=True)
    x, y = many_states()
    assert bits(library.forcing(x, y)) == bits(load(source()).forcing(x, y))


DROP = """
import gc
from pathlib import Path
from kanegen.library import load
from tests.support.handmade import many_states, source
library = load(source(), "gcc", threads=True)
library.evaluate(*many_states())
del library
gc.collect()
print("libgomp" in Path("/proc/self/maps").read_text())
"""


def test_the_runtime_of_the_threads_outlives_the_library():
    """The threads wait for more work in code that must stay mapped."""
    environment = {**os.environ, "OMP_NUM_THREADS": "4", "PYTHONPATH": str(ROOT)}
    process = subprocess.run(
        [sys.executable, "-c", DROP], env=environment, capture_output=True, check=True, text=True
    )
    assert process.stdout.strip() == "True"


FORK = """
import multiprocessing, os, pickle, signal, sys
from concurrent.futures import ThreadPoolExecutor
from kanegen.library import load
from tests.support.handmade import many_states, source

def threaded(name):
    return load(source(name), "gcc", "-O0 -fopenmp")

x, y = many_states()
library = threaded("handmade") if sys.argv[1] != "late" else None
expected = load(source(), "gcc", "-O0").forcing(x, y).tobytes()

def is_right(library):
    return library.forcing(x, y).tobytes() == expected

if library is None:
    OPENMP
else:
    assert is_right(library)

def work(_):
    libraries = [threaded("again")]
    if library is not None:
        libraries += [library, pickle.loads(pickle.dumps(library))]
    with ThreadPoolExecutor(2) as pool:
        return all(map(is_right, libraries)) and all(pool.map(is_right, libraries))

if sys.argv[1] == "pool":
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map(work, range(4)) == [True] * 4
else:
    child = os.fork()
    if child == 0:
        right = work(0)
        grandchild = os.fork()
        right = right and work(0)
        os._exit(0 if right and (grandchild == 0 or os.waitpid(grandchild, 0)[1] == 0) else 1)
    assert os.waitpid(child, 0)[1] == 0
assert library is None or is_right(library)
print("whole")
"""

OPENMP = """
    import cffi, ctypes
    gomp = ctypes.CDLL("libgomp.so.1")
    region = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(lambda data: None)
    gomp.GOMP_parallel(region, None, 4, 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.parametrize("way", slow_except(("fork", "pool", "late"), "fork", "late"))
def test_a_forked_process_does_not_wait_for_threads_that_it_has_not(way):
    """Its batches use one thread and have the same bits; the first process keeps its threads.

    In the way "late" something else than kanegen has used the runtime before the fork.
    """
    code = FORK.replace("OPENMP", OPENMP)
    variables = ["OMP_NUM_THREADS=4", f"PYTHONPATH={ROOT}"]
    command = ["env", *variables, sys.executable, "-W", "ignore", "-c", code, way]
    done = commands.run(command, seconds=90)  # and if it hangs, all processes are killed
    assert (done.returncode, done.stdout) == (0, "whole\n"), done.stderr
