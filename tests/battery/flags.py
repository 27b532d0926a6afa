"""What the processor is told to remember, and what is not a number: X20 and X21."""

from __future__ import annotations

import platform
import warnings
from collections.abc import Iterator, Sequence

import numpy as np

import kanegen as kg
from kanegen.errors import BuildError
from kanegen.library import Library
from kanegen.program.precision import Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.drivers import efforts_for, printed
from tests.battery.measuring import FLAGS, PRECISIONS, Floats, built, efforts
from tests.battery.rows import Row, Size, count, subject

RAISED = ("FE_INVALID", "FE_DIVBYZERO", "FE_OVERFLOW")


@subject("X20", "Floating-point exceptions in ordinary states")
def exceptions(size: Size) -> Iterator[Row]:
    """No invalid operation, division by zero or overflow, not even in what is thrown away."""
    amount = size.pick(2_000, 100_000)
    for precision in PRECISIONS:
        for name, system in {
            "8 hinges": scenes.tree(np.random.default_rng(20), [k // 2 for k in range(1, 9)]),
            "a free body and a slide": scenes.mixed(3, free=_free_and_slide()),
        }.items():
            for way, raised in _raised(system, precision, amount).items():
                over = f"{amount} states: {', '.join(RAISED)}"
                yield count(f"{name}, {way}, {precision.name}", raised, over, "0 flags in 0 states")
    if platform.system() == "Linux":
        ended = [_trapped(precision, amount) for precision in PRECISIONS]
        over = f"{amount} states each, feenableexcept: {', '.join(RAISED)}"
        yield count("8 hinges, every flag a trap", ended, over, "no trap")


def _trapped(precision: Precision, amount: int) -> bool:
    """Whether a program ends in which these flags are signals."""
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
    """How often each flag was up, by way of calling: one after the other, or as a batch."""
    states = random_states(system, amount, 20).rounded(precision)
    lines = printed("flags.c", system, precision, states, efforts_for(states, 20), FLAGS)
    one, many = ([int(word) for word in line.split()] for line in lines.splitlines())
    return {"state by state": one, "batch": many}


@subject("X21", "NaN and infinity in one number of the input")
def not_a_number(size: Size) -> Iterator[Row]:
    """Whatever depends on it is not finite, and whatever does not is untouched."""
    system = scenes.tree(np.random.default_rng(21), [0, 1, 0, 3, 4])
    for precision in PRECISIONS:
        library = built(system, precision)
        states = random_states(system, size.pick(2, 20), 21)
        tau = efforts(system, states, np.random.default_rng(21))
        for name, value in {"NaN": np.nan, "infinity": np.inf, "-infinity": -np.inf}.items():
            wrong = [
                _spoilt_wrongly(library, [x, y, t], argument, place, value)
                for x, y, t in zip(states.x, states.y, tau, strict=True)
                for argument in range(3)
                for place in range(len(x))
            ]
            over = f"every number of x, y and tau in {len(states)} states; two trees on one ground"
            yield count(f"{name}, {precision.name}", wrong, over, "spreads to what depends on it alone")


def _spoilt_wrongly(
    library: Library, state: Sequence[Floats], argument: int, place: int, value: float
) -> bool:
    """Whether an output is finite that depends on the input, or lost that does not."""
    changed, spoilt = ([array.copy() for array in state] for _ in range(2))
    changed[argument][place] += 0.25
    spoilt[argument][place] = value
    batch = [np.stack(rows) for rows in zip(state, changed, spoilt, strict=True)]
    with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
        right, other, found = library.forward_dynamics(*batch)
    depends = right != other
    refused = argument == 0 and np.isnan(found).all()  # a pivot of [A] that is not a number spoils the state
    return bool(np.isfinite(found[depends]).any() or not (refused or (found == right)[~depends].all()))
