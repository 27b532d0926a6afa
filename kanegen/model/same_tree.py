"""Systems of one tree that differ in numbers: one system for all, with parameters where they differ.

The numbers of a system are taken from its parts in a fixed order. Another system has the same tree if its
numbers in the parts of the first give exactly its own parts.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from kanegen.errors import KanegenWarning, ModelError, quoted
from kanegen.model.body import Body
from kanegen.model.description import SystemDescription
from kanegen.model.limits import NO_LIMITS
from kanegen.model.numbers import (
    Number,
    Parameter,
    is_fixed,
    map_numbers,
    parameters_of,
    toml_number,
    value_of,
    with_parameters_changed,
)
from kanegen.model.symbolic import free_names
from kanegen.model.system_fields import SystemFields

KINDS: Mapping[str, str] = {
    "bodies": "body",
    "force_elements": "force_element",
    "couplings": "coupling",
    "frames": "frame",
    "rotors": "rotor",
    "contacts": "contact",
}
"""What the parts of a system are called, by the field that holds them."""

GRAVITY = "g"
"""Quantity of the components of gravity."""


def with_parameters_where_different(system: SystemFields, others: Sequence[SystemFields]) -> dict[str, Any]:
    """Return the fields of a system that change where numbers in which others differ become parameters.

    Args:
        system: The system.
        others: Systems of the same tree.

    Raises:
        ModelError: If a system has another tree.
    """
    rows = [_numbers_in_parts_of(system, other) for other in others]
    free, places = free_names(system), _places(system)
    found: dict[str, Number] = {}
    for place, (name, own) in enumerate(places):
        if is_fixed(own) and any(value_of(row[place]) != value_of(own) for row in rows):
            found[name] = Parameter(free(name), value_of(own))
    changed = iter([found.get(name, own) for name, own in places])

    def change(_: Number) -> Number:
        return next(changed)

    gravity = map_numbers(system.gravity, change)
    of_parts = {field: tuple(part.map_numbers(change) for part in getattr(system, field)) for field in KINDS}
    return {"gravity": gravity, **of_parts}


def parameters_for(system: SystemDescription, other: SystemFields) -> dict[str, float]:
    """Return the values by name with which the parameters of a system, in their order, make it another one.

    A value is read where the parameter stands alone, or with the other sign.

    Args:
        system: The system with parameters.
        other: A system of the same tree.

    Raises:
        ModelError: If it has another tree, or a number that no values of the parameters give.
    """
    pairs = list(zip(_places(system), _numbers_in_parts_of(system, other), strict=True))
    found: dict[str, float] = {}
    for (_, own), given in pairs:
        if isinstance(own, Parameter):
            found.setdefault(own.name, value_of(given))
    for (_, own), given in pairs:
        for one in parameters_of(own):
            if own == -one:
                found.setdefault(one.name, -value_of(given))
    for (name, own), given in pairs:
        reached = value_of(with_parameters_changed(own, lambda one: found.get(one.name, one.value)))
        if reached != value_of(given):
            raise ModelError(_cannot_be(system, other, name, own, reached, value_of(given)))
    return {one.name: found.get(one.name, one.value) for one in system.parameters}


def _cannot_be(
    system: SystemFields, other: SystemFields, name: str, own: Number, reached: float, given: float
) -> str:
    """Return the message that a number of another system is out of reach of the parameters of a system."""
    where, text = f"system {quoted(other.name)}: {name} is {quoted(given)}", str(toml_number(own))
    if is_fixed(own):
        return (
            f"{where}, but system {quoted(system.name)} has the number {quoted(reached)} there. Make it a "
            "parameter: with_parameters_for of a list of systems in which it differs does."
        )
    return (
        f"{where}, but system {quoted(system.name)} has {quoted(text)} there, which is {quoted(reached)} "
        "with the numbers at other places. Give each place a parameter of its own."
    )


def _numbers_in_parts_of(system: SystemFields, other: SystemFields) -> list[Number]:
    """Return the numbers of another system, in the order of `_places` of a system.

    Raises:
        ModelError: If it has another tree.
    """
    if not isinstance(other, SystemFields):
        raise ModelError(f"{quoted(other)} is no system. Give systems, such as kg.load(...) returns.")
    found = [*other.gravity]
    for field, kind in KINDS.items():
        own, given = getattr(system, field), getattr(other, field)
        if len(own) != len(given):
            raise _another_tree(system, other, f"it has {len(given)} instead of {len(own)} {field}")
        for k, (one, another) in enumerate(zip(own, given, strict=True), start=1):
            numbers = _numbers(another)
            if not _is_same(one, another, numbers):
                label = f"{kind.replace('_', ' ')} {k}"
                raise _another_tree(system, other, f"{label} differs in more than the values of numbers")
            found += numbers
    for field in ("poses", "reactions"):
        if getattr(system, field) != getattr(other, field):
            raise _another_tree(system, other, f"its {field} differ")
    return found


def _another_tree(system: SystemFields, other: SystemFields, reason: str) -> ModelError:
    return ModelError(
        f"system {quoted(other.name)} is not system {quoted(system.name)} with other numbers: {reason}. It "
        "needs code of its own."
    )


def _is_same(one: Any, another: Any, numbers: Sequence[Number]) -> bool:
    """Return whether a part with the numbers of another one is the other, but for limits."""
    if type(one) is not type(another) or len(_numbers(one)) != len(numbers):
        return False
    given = iter(numbers)
    try:
        filled = _silently(one, lambda _: next(given))
    except ModelError:
        return False  # such as a locked value at a freedom that is prescribed
    return bool(_without_limits(filled) == _without_limits(another))


def _without_limits(part: Any) -> Any:
    """Return a part without limits, which equations do not contain."""
    if isinstance(part, Body) and part.joint.limits != NO_LIMITS:
        return replace(part, joint=replace(part.joint, limits=NO_LIMITS))
    return part


def _numbers(part: Any) -> list[Number]:
    """Return the numbers of a part in the order in which `map_numbers` changes them."""
    found: list[Number] = []

    def record(value: Number) -> Number:
        found.append(value)
        return value

    _silently(part, record)
    return found


def _silently(part: Any, change: Callable[[Number], Number]) -> Any:
    """Return a part with `change` applied to its numbers, without the warnings that it gave before."""
    with warnings.catch_warnings(action="ignore", category=KanegenWarning):
        return part.map_numbers(change)


def _places(system: SystemFields) -> list[tuple[str, Number]]:
    """Return every number of a system, gravity first, with the name of a parameter in its place."""
    found = list(zip(_indexed(GRAVITY, 3), system.gravity, strict=True))
    for field, kind in KINDS.items():
        for k, part in enumerate(getattr(system, field), start=1):
            numbers = _numbers(part)
            names = _of_body(k, part) if isinstance(part, Body) else _indexed(f"{kind}_{k}", len(numbers))
            found += zip(names, numbers, strict=True)
    return found


def _of_body(k: int, body: Body) -> list[str]:
    """Return the names of the numbers of body `k`; those of symmetric entries are the same."""
    pairs = [(i, j) for i in (1, 2, 3) for j in (1, 2, 3)]
    orientation = [f"C_{k}_{i}{j}" for i, j in pairs]
    if not isinstance(body.joint.orientation[0], tuple):
        orientation = _indexed(f"C_{k}", 3)
    return [
        f"m_{k}",
        *(f"I_{k}_{min(pair)}{max(pair)}" for pair in pairs),
        *_indexed(f"r_{k}", 3),
        *_indexed(f"q_{k}", 3),
        *orientation,
        *_indexed(f"locked_{k}", 6),
        *_indexed(f"armature_{k}", 6),
        *(name for n, _ in enumerate(body.points, start=1) for name in _indexed(f"point_{k}_{n}", 3)),
    ]


def _indexed(name: str, count: int) -> list[str]:
    return [f"{name}_{i}" for i in range(1, count + 1)]
