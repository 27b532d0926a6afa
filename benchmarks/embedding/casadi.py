"""CasADi: calls of an external function from C, of many states in CasADi itself, and from Python."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np

import kanegen as kg
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import SECONDS, Row, in_turns, turn_of
from kanegen.artifacts.casadi import casadi as casadi_files
from kanegen.artifacts.casadi import file_name
from kanegen.c import Source
from kanegen.extras import CASADI, module
from kanegen.library.native.build import build
from kanegen.library.native.facade import Facade
from kanegen.model.arguments import Floats

LENGTH = 1000
"""States of a call of `map`."""

TIMED = """\
#define _POSIX_C_SOURCE 199309L
#include <stddef.h>
#include <time.h>

int panda_arm_casadi_forward_dynamics(
    const double **arg, double **res, long long int *iw, double *w, int mem);
double nanoseconds(double seconds, const double **arg, double **res, double *w);

/* Time of a call: calls are repeated, twice as many each time, until they take some seconds. */
double nanoseconds(double seconds, const double **arg, double **res, double *w)
{
    for (size_t count = 1;; count *= 2) {
        struct timespec start, end;
        clock_gettime(CLOCK_MONOTONIC, &start);
        for (size_t i = 0; i < count; i++) {
            panda_arm_casadi_forward_dynamics(arg, res, NULL, w, 0);
        }
        clock_gettime(CLOCK_MONOTONIC, &end);
        const double taken =
            (double)(end.tv_sec - start.tv_sec) * 1e9 + (double)(end.tv_nsec - start.tv_nsec);
        if (taken >= 1e9 * seconds) {
            return taken / (double)count;
        }
    }
}
"""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm.

    Raises:
        MissingError: If CasADi is not installed.
    """
    casadi = module("casadi", extra=CASADI)
    source = kg.generate(kg.load("models/panda_arm.toml"), ("forward_dynamics",), batches=False)
    function = module("kanegen.interop.casadi").function(source)
    rng = np.random.default_rng(1)
    inputs = {name: rng.uniform(-1, 1, 7) for name in ("x", "y", "tau")}
    values, result = list(inputs.values()), np.empty(7)
    buffer, call = function.buffer()
    for place, value in enumerate(values):
        buffer.set_arg(place, memoryview(value))
    buffer.set_res(0, memoryview(result))
    one = [casadi.DM(value) for value in values]
    many, states = function.map(LENGTH), [casadi.repmat(value, 1, LENGTH) for value in one]
    turns = {
        "from C": _through_abi(source, values, result),
        f"map, {LENGTH} states, each": lambda: turn_of(lambda: many(*states)) / LENGTH,
        "buffer in Python": lambda: turn_of(call),
        "DM in Python": lambda: turn_of(lambda: function(*one)),
    }
    alone = in_c(source, "forward_dynamics", inputs)
    return [
        Row(
            "CasADi",
            f"external, {how}, forward_dynamics of panda_arm",
            *in_turns(alone, turn),
            f"casadi {casadi.__version__}",
        )
        for how, turn in turns.items()
    ]


def _through_abi(source: Source, values: list[Floats], result: Floats) -> Callable[[], float]:
    """Return a function that repeats the external function in C and returns nanoseconds of one call."""
    files = {file_name(source): casadi_files(source)[file_name(source)], "timed.c": TIMED}
    path = build(source, facade=Facade("panda_arm_casadi_timed", files))
    timed = ctypes.CDLL(str(path)).nanoseconds
    timed.restype = ctypes.c_double
    work = np.empty(100)
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in (*values, result, work)]
    arguments = (ctypes.c_void_p * len(values))(*pointers[: len(values)])
    results = (ctypes.c_void_p * 1)(pointers[-2])

    def turn() -> float:
        found: float = timed(ctypes.c_double(SECONDS), arguments, results, pointers[-1])
        assert work.size  # which keeps it alive
        return found

    return turn
