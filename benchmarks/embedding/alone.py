"""Calls of a generated function from C, timed in C: what the other programs are compared with."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping

import numpy as np

from benchmarks.embedding.row import SECONDS
from kanegen.c import Source
from kanegen.library.native.build import build
from kanegen.library.native.facade import Facade

TEXT = """\
#define _POSIX_C_SOURCE 199309L
#include <time.h>

#include "{model}.h"

double {model}_nanoseconds(double seconds, {declared});

static double now(void)
{{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e9 + (double)time.tv_nsec;
}}

/* Time of a call: calls are repeated, twice as many each time, until they take some seconds. */
double {model}_nanoseconds(double seconds, {declared})
{{
    for (size_t count = 1;; count *= 2) {{
        const double start = now();
        for (size_t i = 0; i < count; i++) {{
            {model}_{function}({passed});
        }}
        const double taken = now() - start;
        if (taken >= 1e9 * seconds) {{
            return taken / (double)count;
        }}
    }}
}}
"""


def in_c(
    source: Source,
    name: str,
    inputs: Mapping[str, np.ndarray],
    states: int | None = None,
    flags: tuple[str, ...] | None = None,
) -> Callable[[], float]:
    """Return a function that repeats a call in C for a turn and returns nanoseconds of one call.

    Args:
        source: Generated C, in double precision.
        name: Name of the function.
        inputs: Its inputs by name, contiguous, `prepared` among them where the model has parameters.
        states: Number of states of a call of the batch form; None is a call for one state.
        flags: Flags of the compiler; None are those of the variant.

    Example:
        alone = in_c(library.source, "forward_dynamics", {"x": x, "y": y, "tau": tau})
    """
    function = next(one for one in source.functions if one.name == name)
    model = source.model.name
    read, filled = ([array.name for array in arrays] for arrays in (function.inputs, function.outputs))
    text = TEXT.format(
        model=model,
        function=name if states is None else f"{name}_batch",
        declared=", ".join(
            [*(f"const double *{one}" for one in read), *(f"double *{one}" for one in filled)]
        ),
        passed=", ".join([*([] if states is None else [str(states)]), *read, *filled]),
    )
    path = build(source, flags=flags, facade=Facade(f"{model}_{name}_timed", {"timed.c": text}))
    timed = getattr(ctypes.CDLL(str(path)), f"{model}_nanoseconds")
    timed.restype = ctypes.c_double
    arrays = [np.ascontiguousarray(inputs[one], np.float64) for one in read]
    arrays += [np.empty((states or 1, array.size)) for array in function.outputs]
    pointers = [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]

    def turn() -> float:
        assert len(arrays) == len(pointers)  # which keeps the arrays alive
        found: float = timed(ctypes.c_double(SECONDS), *pointers)
        return found

    return turn
