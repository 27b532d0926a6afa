"""Arrays of a system: reading what a user passes, and handing the model out as NumPy arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.errors import ModelError
from kanegen.model import validation
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.names import Place
from kanegen.model.numbers import listed, numbers
from kanegen.model.rotations import rotation_123

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class ForceArrays:
    """What acts beside gravity and loads on bodies.

    Attributes:
        elements: Parameters at their defaults.
        variables: Of expressions, by name.
        points: By name the body, from 1, and the (3,) position from its origin, in its components (m).
        loaded: (P,) which points take a force and a moment.
    """

    elements: tuple[ForceElement, ...]
    variables: Mapping[str, Place]
    points: Mapping[str, tuple[int, Floats]]
    loaded: Flags


@dataclass(frozen=True)
class SystemArrays:
    """The numbers of a system of N bodies; row K - 1 belongs to body K. Units as `System.from_arrays`."""

    connection: NDArray[np.int64]  # (N,)
    mass: Floats  # (N,)
    inertia: Floats  # (N, 3, 3)
    mass_center: Floats  # (N, 3)
    joint_position: Floats  # (N, 3)
    joint_orientation: Floats  # (N, 3, 3)
    free: Flags  # (N, 6)
    locked: Floats  # (N, 6)
    gravity: Floats  # (3,)
    loads: Flags  # (N,)
    sequence: tuple[str, ...]  # (N,)
    speeds: tuple[str, ...]  # (N,)
    coordinates: tuple[str, ...]  # (N,)
    forces: ForceArrays
    prescribed: Flags  # (N, 6)

    def rows(self) -> dict[str, Any]:
        """The arguments of `System.from_arrays` that give these numbers again: all but `forces`."""
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name != "forces"}


def system_arrays(
    *,
    connection: Sequence[int],
    joint_orientation: Sequence[Any],
    free: Any,
    loads: Any,
    sequence: tuple[str, ...],
    speeds: tuple[str, ...],
    coordinates: tuple[str, ...],
    forces: ForceArrays,
    prescribed: Any,
    **floats: Any,
) -> SystemArrays:
    """`SystemArrays` from nested tuples; orientations given as 1-2-3 angles become matrices."""
    return SystemArrays(
        connection=np.array(connection, dtype=np.int64),
        joint_orientation=np.array([_matrix(value) for value in joint_orientation]),
        free=np.array(free, dtype=np.bool_),
        loads=np.array(loads, dtype=np.bool_),
        sequence=sequence,
        speeds=speeds,
        coordinates=coordinates,
        forces=forces,
        prescribed=np.array(prescribed, dtype=np.bool_),
        **{name: np.array(value, dtype=np.float64) for name, value in floats.items()},
    )


def _matrix(orientation: Any) -> Floats:
    value = np.array(orientation, dtype=np.float64)
    return value if value.shape == (3, 3) else np.array(rotation_123(orientation))


def integers(value: Any, what: str) -> tuple[int, ...]:
    """`value` as a tuple of ints."""
    items = listed(value)
    if items is None:
        raise ModelError(f"{what}: expected a sequence of integers, got {value!r}.")
    return tuple(validation.integer(item, f"{what}[{i}]") for i, item in enumerate(items))


@dataclass(frozen=True)
class Rows:
    """Reads optional arrays with one row a body."""

    count: int

    def numbers(self, value: Any, shape: tuple[int, ...], default: Any, what: str) -> Any:
        """(count, *shape) numbers, or `default` in every row where `value` is None."""
        return (default,) * self.count if value is None else numbers(value, (self.count, *shape), what)

    def flags(self, value: Any, length: int, default: bool, what: str) -> tuple[tuple[bool, ...], ...]:
        """(count, length) bools, or `default` everywhere where `value` is None."""
        if value is None:
            return ((default,) * length,) * self.count
        rows = validation.sequence(value, self.count, what)
        return tuple(validation.flags(row, length, f"{what}[{k}]") for k, row in enumerate(rows))

    def names(self, value: Any, what: str) -> Sequence[Any]:
        """(count,) names from one name for all or one a body."""
        if isinstance(value, str):
            return (value,) * self.count
        return validation.sequence(value, self.count, what)

    def loads(self, value: Any) -> tuple[bool, ...]:
        """(count,) bools from None, one bool or one a body."""
        if value is None or isinstance(value, bool | np.bool_):
            return (bool(value),) * self.count
        return validation.flags(value, self.count, "loads")
