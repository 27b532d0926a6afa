"""The pause of the search for cyclic garbage ends with the work, after errors, and in threads and forks."""

import gc
import os
import subprocess
import sys
import threading

import pytest

import kanegen as kg
from kanegen.errors import OptionError
from kanegen.program.garbage import paused_search
from tests.support.systems import chain

FORKING = """
import gc, os
from kanegen.program.garbage import paused_search

with paused_search():
    child = os.fork()
    if child == 0:
        os.write(1, f"child {gc.isenabled()}\\n".encode())
        os._exit(0)
    os.waitpid(child, 0)
    os.write(1, f"parent {gc.isenabled()}\\n".encode())
os.write(1, f"after {gc.isenabled()}\\n".encode())
"""


@pytest.fixture(autouse=True)
def search():
    gc.enable()
    yield
    gc.enable()


def test_the_search_is_paused_while_code_is_generated_and_goes_on_after_it():
    seen = []
    kg.generate(chain(1), progress=lambda stage: seen.append(gc.isenabled()))
    assert seen
    assert not any(seen)
    assert gc.isenabled()


def test_the_search_goes_on_after_an_error():
    with pytest.raises(OptionError):
        kg.generate(chain(1), ["nothing"])
    assert gc.isenabled()


def test_a_search_that_a_program_has_turned_off_stays_off():
    gc.disable()
    kg.generate(chain(1))
    assert not gc.isenabled()


def test_pauses_of_threads_that_overlap_end_with_the_search_on():
    inside, outside = threading.Event(), threading.Event()

    def other():
        with paused_search():
            inside.set()
            outside.wait(60)

    with paused_search():
        thread = threading.Thread(target=other)
        thread.start()
        assert inside.wait(60)
    outside.set()
    thread.join(60)
    assert gc.isenabled()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_process_that_is_forked_during_a_pause_searches():
    done = subprocess.run([sys.executable, "-c", FORKING], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["child", "True", "parent", "False", "after", "True"]
