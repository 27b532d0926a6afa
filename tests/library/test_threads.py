"""Batches that OpenMP shares among threads: the same bits for any number of them, also without OpenMP."""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest

from kanegen.errors import KanegenWarning
from kanegen.library import load
from kanegen.library.native import cache, compilers
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
    for threads in ("1", "2", "3", "8"):
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
