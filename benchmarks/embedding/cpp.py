"""C++: calls of the methods of the class, timed in C++."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np

import kanegen as kg
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import SECONDS, Row, in_turns
from kanegen.artifacts.cpp import cpp
from kanegen.c import Source
from kanegen.library.native import compilers
from kanegen.library.native.build import build
from kanegen.library.native.facade import Facade
from kanegen.model.arguments import Floats

TIMED = """\
#include <chrono>

#include "panda_arm.hpp"

using vector = std::array<double, 7>;
static const kanegen::panda_arm::model panda;

/* Time of a call: calls are repeated, twice as many each time, until they take some seconds. */
extern "C" double nanoseconds(
    double seconds, const vector &x, const vector &y, const vector &tau, vector &ydot)
{
    for (std::size_t count = 1;; count *= 2) {
        const auto start = std::chrono::steady_clock::now();
        for (std::size_t i = 0; i < count; i++) {
            %s;
        }
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        if (taken.count() >= seconds) {
            return 1e9 * taken.count() / static_cast<double>(count);
        }
    }
}
"""

FORMS = {
    "method that fills arrays": "static_cast<void>(panda.forward_dynamics(x, y, tau, ydot))",
    "method that returns them": "ydot = panda.forward_dynamics(x, y, tau)",
}


def measure() -> list[Row]:
    """Measure accelerations of panda_arm."""
    source = kg.generate(kg.load("models/panda_arm.toml"), ("forward_dynamics",), batches=False)
    rng = np.random.default_rng(1)
    inputs = {name: rng.uniform(-1, 1, 7) for name in ("x", "y", "tau")}
    alone = in_c(source, "forward_dynamics", inputs)
    arrays = [*inputs.values(), np.empty(7)]
    return [
        Row(
            "C++",
            f"{form}, forward_dynamics of panda_arm",
            *in_turns(alone, _turn(source, call, place, arrays)),
            compilers.find().version,
        )
        for place, (form, call) in enumerate(FORMS.items())
    ]


def _turn(source: Source, call: str, place: int, arrays: list[Floats]) -> Callable[[], float]:
    """Return a function that repeats a call in C++ and returns nanoseconds of one."""
    facade = Facade(f"panda_arm_cpp_timed_{place}", {**cpp(source), "timed.cpp": TIMED % call})
    timed = ctypes.CDLL(str(build(source, facade=facade))).nanoseconds
    timed.restype = ctypes.c_double
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]

    def turn() -> float:
        assert len(arrays) == len(pointers)  # which keeps the arrays alive
        found: float = timed(ctypes.c_double(SECONDS), *pointers)
        return found

    return turn
