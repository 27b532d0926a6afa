"""Subnormal numbers, exceptions, values that are not finite, and rounding modes: X19 to X21 and X36."""

from __future__ import annotations

import platform
import subprocess
import sys
import warnings
from collections.abc import Iterator, Sequence

import numpy as np

import kanegen as kg
from kanegen.errors import BuildError
from kanegen.library import Library
from kanegen.measure.truth import truth
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.c_programs import efforts_for, printed
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import (
    FLAGS,
    PRECISIONS,
    PROMISE,
    Floats,
    built,
    efforts,
    promise,
    rounded,
    worst,
)
from tests.support.paths import ROOT


@experiment("X19", "Subnormal numbers, and the state of the processor")
def subnormals(size: Size) -> Iterator[Row]:
    """One hinge with inertia 1 and without gravity has {ydot} = {tau}, down to the smallest subnormal
    number."""
    del size
    system = scenes.planar([0.0], inertia=[np.eye(3)], gravity=(0.0, 0.0, 0.0))
    for precision in PRECISIONS:
        library = built(system, precision)
        least = float(np.finfo(precision.dtype).smallest_subnormal)
        tau = np.array([[least * k] for k in (1, 2, 3, 1000, -1, -7, 2**20)])
        still = np.zeros_like(tau)
        found = library.forward_dynamics(still, still, tau).astype(np.float64)
        yield count(f"{precision.name}", found != tau, f"{len(tau)} efforts from {least:.0e}", "same bits")
    for name, options in LIBRARY_FLAGS.items():
        yield count(
            f"the process after loading, {name}",
            [not _keeps_subnormals(options)],
            "a fresh process: half of 1e-310 before and after",
            "subnormals stay",
        )


LIBRARY_FLAGS = {"default flags": "", "flags -O3 -ffast-math": "-O3 -ffast-math"}

_SCRIPT = """
import sys
import numpy as np
from tests.battery import scenes
import kanegen as kg
half = np.array([0.5])
assert (np.array([1e-310]) * half)[0] > 0
library = kg.build(scenes.straight(1), ("forward_dynamics",), flags=sys.argv[1] or None)
library.forward_dynamics([0.1], [0.2])
print((np.array([1e-310]) * half)[0] > 0)
"""


def _keeps_subnormals(options: str) -> bool:
    """Return whether NumPy still computes with subnormal numbers in a process that has loaded a library."""
    root = ROOT
    command = [sys.executable, "-W", "ignore", "-c", _SCRIPT, options]
    printed = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout
    return printed.strip() == "True"


RAISED = ("FE_INVALID", "FE_DIVBYZERO", "FE_OVERFLOW")


@experiment("X20", "Floating-point exceptions in ordinary states")
def exceptions(size: Size) -> Iterator[Row]:
    """No invalid operation, division by zero or overflow occurs, not even in values that are not used."""
    amount = size.pick(2_000, 100_000)
    for precision in PRECISIONS:
        for name, system in {
            "8 hinges": scenes.tree(np.random.default_rng(20), [k // 2 for k in range(1, 9)]),
            "a free body and a slide": scenes.mixed(3, free=_free_and_slide()),
        }.items():
            for call, raised in _raised(system, precision, amount).items():
                over = f"{amount} states: {', '.join(RAISED)}"
                yield count(f"{name}, {call}, {precision.name}", raised, over, "0 flags in 0 states")
    if platform.system() == "Linux":
        ended = [_trapped(precision, amount) for precision in PRECISIONS]
        over = f"{amount} states each, feenableexcept: {', '.join(RAISED)}"
        yield count("8 hinges, every flag a trap", ended, over, "no trap")


def _trapped(precision: Precision, amount: int) -> bool:
    """Return whether a program in which these exceptions are signals is ended by one."""
    system = scenes.tree(np.random.default_rng(20), [k // 2 for k in range(1, 9)])
    states = random_states(system, amount, 20).rounded(precision)
    try:
        printed("flags.c", system, precision, states, efforts_for(states, 20), (*FLAGS, "-DTRAP"))
    except BuildError:
        return True
    return False


def _free_and_slide() -> np.ndarray:
    free = scenes.flags(3, "s2")
    free[0] = True
    return free


def _raised(system: kg.System, precision: Precision, amount: int) -> dict[str, Sequence[int]]:
    """Return the number of calls that raise each exception, state by state and as a batch."""
    states = random_states(system, amount, 20).rounded(precision)
    lines = printed("flags.c", system, precision, states, efforts_for(states, 20), FLAGS)
    one, many = ([int(word) for word in line.split()] for line in lines.splitlines())
    return {"state by state": one, "batch": many}


@experiment("X21", "NaN and infinity in one number of the input")
def not_a_number(size: Size) -> Iterator[Row]:
    """Outputs that depend on the number must not be finite, and all other outputs must not change."""
    system = scenes.tree(np.random.default_rng(21), [0, 1, 0, 3, 4])
    for precision in PRECISIONS:
        library = built(system, precision)
        states = random_states(system, size.pick(2, 20), 21)
        tau = efforts(system, states, np.random.default_rng(21))
        for name, value in {"NaN": np.nan, "infinity": np.inf, "-infinity": -np.inf}.items():
            wrong = [
                _spreads_wrongly(library, [x, y, t], argument, place, value)
                for x, y, t in zip(states.x, states.y, tau, strict=True)
                for argument in range(3)
                for place in range(len(x))
            ]
            over = f"every number of x, y and tau in {len(states)} states; two trees on one ground"
            yield count(f"{name}, {precision.name}", wrong, over, "spreads to what depends on it alone")


def _spreads_wrongly(
    library: Library, state: Sequence[Floats], argument: int, place: int, value: float
) -> bool:
    """Return whether an output that depends on the input is finite, or another output has changed."""
    changed, invalid = ([array.copy() for array in state] for _ in range(2))
    changed[argument][place] += 0.25
    invalid[argument][place] = value
    batch = [np.stack(rows) for rows in zip(state, changed, invalid, strict=True)]
    with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
        right, other, found = library.forward_dynamics(*batch)
    depends = right != other
    refused = (
        argument == 0 and np.isnan(found).all()
    )  # NaN in x makes a pivot of [A] NaN, and with it all accelerations
    return bool(np.isfinite(found[depends]).any() or not (refused or (found == right)[~depends].all()))


MODES = ("nearest", "upward", "downward", "toward zero")
ROUNDING_FLAGS = ("-O0", "-ffp-contract=off", "-frounding-math")


@experiment("X36", "Other rounding modes")
def rounding_modes(size: Size) -> Iterator[Row]:
    """Results in all four rounding modes must lie within 3 T(u) of each other.

    A directed rounding errs by up to 2 u, twice as much as rounding to nearest, and the errors of the modes
    differ, so the results of an unstable computation would spread further. Sine and cosine are those of the C
    library, since kanegen's own require rounding to nearest.
    """
    # In single precision there is no bound for chains that are much longer.
    chains = {DOUBLE: scenes.straight(size.pick(8, 64)), FLOAT: scenes.straight(8)}
    trees = {
        "tree of hinges": scenes.tree(np.random.default_rng(36), [k // 2 for k in range(1, 9)]),
        "heavier outward": scenes.planar([10.0**i for i in range(4)]),
    }
    for precision in PRECISIONS:
        for name, system in {"straight chain": chains[precision], **trees}.items():
            found = _spread(system, precision, size.pick(4, 64))
            over = f"{len(found)} states; {', '.join(MODES)}"
            yield worst(f"{name}, {precision.name}", found, f"3 {PROMISE}", over)


def _spread(system: kg.System, precision: Precision, amount: int) -> list[Point]:
    """Return, for each state, the largest difference between rounding to nearest and the other modes."""
    states = random_states(system, amount, 36).rounded(precision)
    tau = rounded(efforts(system, states, np.random.default_rng(36)), precision)
    lines = printed("rounding.c", system, precision, states, tau, ROUNDING_FLAGS, "libm").splitlines()
    modes = np.array([[float.fromhex(word) for word in line.split()] for line in lines])
    found: Floats = modes.reshape(len(MODES), amount, -1)
    result = []
    for b, (x, y, t) in enumerate(zip(states.x, states.y, tau, strict=True)):
        exact = truth(system, x, y, t, unit_roundoff=precision.roundoff)
        scale = exact.units.of("forward_dynamics")
        whole = np.linalg.norm(exact["forward_dynamics"].value * scale)
        spread = max(np.linalg.norm((found[0, b] - found[m, b]) * scale) for m in range(1, len(MODES)))
        result.append(Point(0.0, float(spread / whole), 3 * promise(exact, precision)))
    return result
