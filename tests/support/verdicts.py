"""What becomes of a mutant: one clear error, or a system whose code agrees with the reference."""

from __future__ import annotations

import contextlib
import signal
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.errors import LONGEST_MESSAGE
from kanegen.measure.comparison import rounding_bound
from kanegen.model.numbers import value_of
from kanegen.program.evaluate import evaluate
from kanegen.program.precision import DOUBLE
from kanegen.reference import equations
from kanegen.reference.freedoms import largest_coupled_angle
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import (
    element_magnitude,
    forcing_magnitude,
    mass_matrix_magnitude,
    path_maxima,
)
from kanegen.reference.states import random_states

SECONDS = 20
"""Limit of the processor time of one mutant, from reading to comparison (s)."""

WAITING = 300
"""Limit of its time by the clock (s), long because machines are busy."""

LARGEST = 1e150
"""Magnitude up to which values are compared."""

MODERATE = 1e40
"""Largest constant in an expression whose values are compared."""

STATES = 4
MOST_BODIES = 12
"""Number of bodies up to which code is derived and compared."""


class Fault(AssertionError):
    """A mutant that neither raised one clear error nor became code that agrees with the reference."""


def verdict(make: Callable[[], kg.System], folder: Path | None = None) -> str:
    """Return "refused" or "compared" for a mutant.

    Args:
        make: Function that makes the system of the mutant.
        folder: Folder in which the system is saved and the code compiled; None to leave both out.

    Raises:
        Fault: If a message is too long or has several lines, the time limit is exceeded, or a value differs
            from the reference. Every exception that is no `KanegenError` passes through.
    """
    try:
        with _time_limit(), warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", kg.KanegenWarning)
            system = make()
            if folder is not None:
                _require_saved(system, folder)
            if system.number_of_bodies <= MOST_BODIES:
                _require_agreement(system)
                if folder is not None:
                    _require_agreement_of_c(system)
    except kg.KanegenError as error:
        message = str(error)
        if not message.isprintable() or not 10 < len(message) <= LONGEST_MESSAGE:
            raise Fault(f"message: {message!r}") from None
        return "refused"
    return "compared"


@contextlib.contextmanager
def _time_limit() -> Iterator[None]:
    """Raise a `Fault` inside a block that takes longer than `SECONDS`."""

    def stop(*_: object) -> None:
        raise Fault(f"took more than {SECONDS} s of processor time, or {WAITING} s")

    clocks = {signal.SIGPROF: (signal.ITIMER_PROF, SECONDS), signal.SIGALRM: (signal.ITIMER_REAL, WAITING)}
    before = {number: signal.signal(number, stop) for number in clocks}
    for timer, seconds in clocks.values():
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for number, (timer, _) in clocks.items():
            signal.setitimer(timer, 0)
            signal.signal(number, before[number])


def _require_saved(system: kg.System, folder: Path) -> None:
    """Raise a `Fault` unless a saved system loads as an equal one."""
    file = folder / "saved.toml"
    system.save(file)
    if kg.load(file).as_table() != system.as_table():
        raise Fault("the saved model differs")


def _require_agreement(system: kg.System) -> None:
    """Raise a `Fault` where the program that becomes C differs from the reference by more than rounding."""
    module = compile_module(system, ("mass_matrix", "forcing")).module
    arrays = system.values()
    states = random_states(arrays, STATES)
    x, y, force, torque = states.x, states.y, states.force, states.torque
    named = {"x": x, "y": y, "force": force, "torque": torque, **states.inputs}
    inputs = {name: [*np.reshape(v, (STATES, -1)).T] for name, v in named.items() if v is not None}
    with np.errstate(all="ignore"):
        if module.prepare is not None:
            values = {"parameters": [np.float64(parameter.value) for parameter in system.parameters]}
            inputs |= evaluate(module.prepare, values, np)
        found = evaluate(module.functions["evaluate"], inputs, np)
        bodies = kinematics(arrays, x, y, states.prescribed)
        maxima = path_maxima(arrays, bodies, y, states.prescribed)
        expected = {
            "A": (
                equations.mass_matrix(arrays, x, states.prescribed),
                mass_matrix_magnitude(arrays, maxima),
            ),
            "f": (
                equations.forcing(arrays, x, y, force, torque, **states.inputs),
                forcing_magnitude(arrays, maxima, force, torque)
                + element_magnitude(arrays, bodies, x, y, **states.inputs),
            ),
        }
    if not _is_moderate(system):
        return
    angle = largest_coupled_angle(arrays, x, states.prescribed[:, 0])
    for name, (truth, size) in expected.items():
        value = np.stack([np.broadcast_to(entry, (STATES,)) for entry in found[name]], axis=-1)
        bound = rounding_bound(len(arrays.mass), DOUBLE, angle=angle)
        _require_equal(name, value.reshape(truth.shape), truth, size, bound)


def _is_moderate(system: kg.System) -> bool:
    """Return whether products of the constants in expressions stay in range, in whatever order they are made.

    The reference is undefined, or 0, where its own intermediates leave the range; the code may not be.
    """
    numbers = [
        abs(value_of(number))
        for element in system.force_elements
        for expression in element.expressions()
        for number in expression.numbers()
    ]
    return all(number == 0 or 1 / MODERATE < number < MODERATE for number in numbers)


def _require_equal(name: str, value: Any, truth: Any, size: Any, limit: float) -> None:
    """Raise a `Fault` where the reference is defined, and a value differs from it by more than rounding.

    Where a bound on rounding errors is as large as the terms themselves, no digit is left to compare. Beyond
    `LARGEST`, products that are ordered in another way than in the reference overflow.
    """
    with np.errstate(all="ignore"):
        defined = np.isfinite(truth) & (size < LARGEST) & (size * limit < np.abs(truth) + 1.0)
        wrong = defined & ~(np.abs(value - truth) <= limit * size)
    if wrong.any():
        at = tuple(np.argwhere(wrong)[0])
        raise Fault(f"{name}{at}: {value[at]!r} instead of {truth[at]!r}, rounding {limit * size[at]:.1e}")


def _require_agreement_of_c(system: kg.System) -> None:
    """Raise a `Fault` where compiled C has other bits than the program, or cannot be compiled or called."""
    library = kg.build(system, ("mass_matrix", "forcing"))
    states = random_states(system.values(), STATES)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        batch = library.mass_matrix(states.x, **states.inputs)
        single = np.stack(
            [
                library.mass_matrix(states.x[i], **{n: v[i] for n, v in states.inputs.items()})
                for i in range(STATES)
            ]
        )
    if not np.array_equal(batch, single, equal_nan=True):
        raise Fault("a batch has other bits than its states")
