"""States of eight classes, ordinary and extreme, with which programs are compared bit for bit."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

import kanegen as kg
from kanegen.model.coordinates import ANGLES
from kanegen.program.precision import Precision
from kanegen.reference.states import random_states
from tests.battery.measurement import Floats

State = tuple[Floats, Floats, Floats]
"""{x}, {y} and {tau} of B states, (B, m), (B, n) and (B, n), in the type of the arrays."""

Change = Callable[[np.random.Generator, kg.System, State], None]
"""Function that turns ordinary states into those of a class, in place."""


def states(system: kg.System, precision: Precision, amount: int, seed: int, classes: Iterable[str]) -> State:
    """Return `amount` states of each class one after the other, in the type of the precision.

    Args:
        system: The tree.
        precision: Precision of the arrays.
        amount: Number of states of each class.
        seed: Seed of the generator.
        classes: Names of `CLASSES`.
    """
    rng = np.random.default_rng(seed)
    found: list[State] = []
    for name in classes:
        ordinary = random_states(system, amount, int(rng.integers(2**32)))
        tau = rng.uniform(-10, 10, ordinary.y.shape)
        with np.errstate(over="ignore", under="ignore"):
            made = tuple(array.astype(precision.dtype) for array in (ordinary.x, ordinary.y, tau))
            CLASSES[name](rng, system, made)
        found.append(made)
    x, y, tau = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
    return x, y, tau


def _ordinary(rng: np.random.Generator, system: kg.System, state: State) -> None:
    del rng, system, state


def _zeros(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """Zeros of both signs in about half of the places, and everywhere in the first state."""
    del system
    for array in state:
        chosen = rng.random(array.shape) < 0.5
        chosen[0] = True
        array[chosen] = np.where(rng.random(array.shape) < 0.5, -0.0, 0.0)[chosen]


def _subnormal(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """Numbers below the least normal one in about half of the places."""
    del system
    for array in state:
        info = np.finfo(array.dtype)
        small = rng.integers(-(2 ** (info.nmant - 2)), 2 ** (info.nmant - 2), array.shape)
        array[...] = np.where(rng.random(array.shape) < 0.5, small * info.smallest_subnormal, array)


def _huge(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """Speeds, efforts and lengths whose squares and products come near the largest number, or beyond."""
    is_length = np.array([coordinate.unit == "m" for coordinate in system.coordinates])
    for array, chosen in zip(state, (is_length, slice(None), slice(None)), strict=True):
        largest = 0.7 * np.log10(np.finfo(array.dtype).max)
        array[:, chosen] *= 10.0 ** rng.uniform(0, largest, array[:, chosen].shape)


def _many_turns(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """Angles of every size up to the largest number, and the numbers next to multiples of pi/2."""
    x = state[0]
    chosen = np.array([coordinate.unit == "rad" for coordinate in system.coordinates])
    largest = np.log10(np.finfo(x.dtype).max)
    x[:, chosen] *= 10.0 ** rng.uniform(0, largest - 1, x[:, chosen].shape)
    near = np.pi / 2 * rng.integers(-(10**6), 10**6, x.shape)
    beside = chosen & (rng.random(x.shape) < 0.5)
    x[beside] = near[beside]


def _near_lock(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """Middle angles 1e-1 to 1e-15 rad from gimbal lock, and at it in the first state."""
    x = state[0]
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.mass_matrix_singularity and body.joint.rotation.coordinates == ANGLES:
            distance = 10.0 ** rng.uniform(-15, -1, len(x))
            distance[0] = 0.0
            middle = 0.0 if body.joint.mass_matrix_singularity == "sin" else np.pi / 2
            x[:, system.coordinate_place(k, 1)] = middle + distance


def _infinite(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """An infinity of either sign in one place of every state."""
    del system
    _one_place(rng, state, np.array([np.inf, -np.inf]))


def _not_a_number(rng: np.random.Generator, system: kg.System, state: State) -> None:
    """A NaN of either sign in one place of every state."""
    del system
    _one_place(rng, state, np.array([np.nan, -np.nan]))


def _one_place(rng: np.random.Generator, state: State, values: Floats) -> None:
    for row in range(len(state[0])):
        array = state[rng.integers(3)]
        array[row, rng.integers(array.shape[1])] = rng.choice(values)


CLASSES: dict[str, Change] = {
    "ordinary": _ordinary,
    "zeros": _zeros,
    "subnormal": _subnormal,
    "huge": _huge,
    "many turns": _many_turns,
    "near gimbal lock": _near_lock,
    "infinite": _infinite,
    "NaN": _not_a_number,
}
"""The classes of states by name."""
