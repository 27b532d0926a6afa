"""The reference in 40 digits: the true [A] and {f} of the numbers that a system and a state hold."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from kanegen.model.arrays import SystemArrays
from kanegen.reference import equations as reference
from kanegen.reference.states import States

DIGITS = 40


class Exact(mpmath.mpf):  # type: ignore[misc]  # mpmath has no types
    """A number for object arrays, where NumPy asks the elements for their sine and cosine."""

    def sin(self) -> Any:
        return mpmath.sin(self)

    def cos(self) -> Any:
        return mpmath.cos(self)


def exact(values: NDArray[np.float64] | None) -> Any:
    """The same numbers with unlimited precision to come."""
    return None if values is None else np.vectorize(Exact, otypes=[object])(values)


def exact_system(system: SystemArrays) -> SystemArrays:
    """The same system for high-precision states."""
    arrays = {field.name: getattr(system, field.name) for field in fields(system)}
    floats = {name: v for name, v in arrays.items() if isinstance(v, np.ndarray) and v.dtype == np.float64}
    return replace(system, **{name: exact(values) for name, values in floats.items()})


def true_values(system: SystemArrays, states: States) -> dict[str, NDArray[Any]]:
    """[A] (B, n, n) and {f} (B, n) by the name of the output, entries of 40 digits."""
    numbers = exact_system(system)
    x, y, force, torque = (exact(part) for part in (states.x, states.y, states.force, states.torque))
    with mpmath.workdps(DIGITS):
        return {
            "mass_matrix": reference.mass_matrix(numbers, x),
            "forcing": reference.forcing(numbers, x, y, force, torque),
        }
