"""Models whose numbers leave the range of doubles, found before any code is written.

The lengths of the paths along the tree bound the velocities in every state, and so the diagonal of [A] and
the weight in {f}. The bounds are computed in exponents of two, so that nothing here can overflow.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from kanegen.errors import ModelError, quoted
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.model.system import System

LARGEST = 969.0
"""Largest magnitude of an exponent of two in a model, in [A] and in the weight. Rounding errors of numbers
down to 2^-969 are normal numbers, and sums and products of larger ones with numbers near 1 are finite."""

ADVICE = (
    "for the range of double precision. Choose units in which masses, lengths and gravity are nearer to 1."
)

Exponents = Mapping[str, list[float]]
"""Exponents of the terms that a freedom moves, by the quantity that they add to."""


def require_range(system: System) -> None:
    """Make sure that the numbers of a model, [A] and the weight are in range; parameters stand at defaults.

    Raises:
        ModelError: If one of them is too large or too small; the message names the body, and the freedom.
    """
    arrays = system.values()
    for place, values in _numbers(system, arrays):
        if too := _out_of_range([_exponent(values)]):
            raise ModelError(f"{place} is too {too} {ADVICE}")
    moved = _moved(arrays)
    for name, freedom in zip(system.speed_names, system.freedoms, strict=True):
        body = quoted(system.bodies[freedom.body - 1].name)
        for quantity, exponents in moved[freedom.body, freedom.is_angle].items():
            if too := _out_of_range(exponents):
                mover = f"body {body}: the {quantity} that freedom {quoted(name)} moves"
                raise ModelError(f"{mover} is too {too} {ADVICE}")


def _numbers(system: System, arrays: SystemArrays) -> Iterator[tuple[str, Floats]]:
    """Yield the quantities of a model, each with its name for a message."""
    for k, body in enumerate(system.bodies):
        for label, values in (
            ("mass", arrays.mass[k]),
            ("inertia", arrays.inertia[k]),
            ("mass centre", arrays.mass_center[k]),
            ("joint position", arrays.joint_position[k]),
            ("locked translation", arrays.locked[k, 3:]),
            ("armature", arrays.armature[k]),
        ):
            yield f"body {quoted(body.name)}: the {label}", np.asarray(values)
    yield "gravity", arrays.gravity


def _moved(arrays: SystemArrays) -> dict[tuple[int, bool], Exponents]:
    """Return what angles and translations of each body move, by the body and whether it is an angle.

    What coupled freedoms move counts for the freedoms that they follow.
    """
    count, gravity = len(arrays.mass), _exponent(arrays.gravity)
    found: dict[tuple[int, bool], Exponents] = {
        (k, is_angle): {"inertia": [], "weight": []}
        for k in range(1, count + 1)
        for is_angle in (True, False)
    }
    for outer in range(1, count + 1):
        found[outer, True]["inertia"] += [_exponent(arrays.armature[outer - 1, :3])]
        found[outer, False]["inertia"] += [_exponent(arrays.armature[outer - 1, 3:])]
        mass, moments = _exponent(arrays.mass[outer - 1]), _exponent(arrays.inertia[outer - 1])
        distance, k = _length(arrays.mass_center[outer - 1]), outer
        while k:
            arm = _exponent(np.array(distance))
            found[k, True]["inertia"] += [mass + 2 * arm, moments]
            found[k, True]["weight"] += [mass + arm + gravity]
            found[k, False]["inertia"] += [mass]
            found[k, False]["weight"] += [mass + gravity]
            distance += _length(arrays.joint_position[k - 1]) + _length(arrays.locked[k - 1, 3:])
            k = int(arrays.connection[k - 1])
    for one in reversed(arrays.coupled):
        own = found[one.freedom.body, one.freedom.is_angle]
        for other, factor in one.terms:
            share, moved = _exponent(np.array(factor)), found[other.body, other.is_angle]
            moved["inertia"] += [exponent + 2 * share for exponent in own["inertia"]]
            moved["weight"] += [exponent + share for exponent in own["weight"]]
    return found


def _length(vector: Floats) -> float:
    """Return the length of a vector of numbers of any size."""
    return math.hypot(*vector.tolist())


def _exponent(values: Floats) -> float:
    """Return the exponent of two of the largest of some numbers, minus infinity where all are zero."""
    largest = float(np.abs(values).max())
    return math.log2(largest) if largest else -math.inf


def _out_of_range(exponents: list[float]) -> str:
    """Return "large" or "small" where a sum of terms that are not all zero is out of range, else ""."""
    largest = max(exponents)
    if largest + math.log2(len(exponents)) > LARGEST:
        return "large"
    return "small" if -math.inf < largest < -LARGEST else ""
