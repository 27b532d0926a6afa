"""All numbers of a system: one after the other, changed together, and with default values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.numbers import (
    Number,
    Parameter,
    finite,
    map_numbers,
    parameters_of,
    with_parameters_changed,
)
from kanegen.model.system_fields import SystemFields


def numbers_of(system: SystemFields) -> Iterator[Number]:
    """Yield every number of a system, in the order in which its parameters are counted."""
    yield from _leaves(system.gravity)
    for body in system.bodies:
        joint = body.joint
        yield from _leaves((body.mass, body.inertia, body.mass_center))
        yield from _leaves(tuple(point.position for point in body.points))
        yield from _leaves((joint.position, joint.orientation, joint.locked, joint.armature))
    for coupling in system.couplings:
        yield from coupling.numbers()
    for frame in system.frames:
        yield from _leaves((frame.position, frame.orientation))
    for rotor in system.rotors:
        yield from (rotor.inertia, rotor.ratio)
    for contact in system.contacts:
        yield contact.damping
    for element in system.force_elements:
        yield from element.numbers()


def mapped_numbers(system: SystemFields, change: Callable[[Number], Number]) -> dict[str, Any]:
    """Return the fields of a system that hold numbers, with `change` applied to every number."""
    return {
        "bodies": tuple(body.map_numbers(change) for body in system.bodies),
        "gravity": map_numbers(system.gravity, change),
        "force_elements": tuple(element.map_numbers(change) for element in system.force_elements),
        "couplings": tuple(coupling.map_numbers(change) for coupling in system.couplings),
        "frames": tuple(frame.map_numbers(change) for frame in system.frames),
        "rotors": tuple(rotor.map_numbers(change) for rotor in system.rotors),
        "contacts": tuple(contact.map_numbers(change) for contact in system.contacts),
    }


def with_defaults(system: SystemFields, defaults: Any) -> dict[str, Any]:
    """Return the fields of a system that change where parameters without a default value get one.

    Args:
        system: The fields; every one is a tuple of the right objects.
        defaults: Default values by name; None for none. A parameter that has a default elsewhere in the
            system needs no entry.

    Raises:
        ModelError: If a parameter has no default value, or a name of `defaults` is no such parameter.
    """
    every = {one for value in numbers_of(system) for one in parameters_of(value)}
    known = {one.name: one for one in every if not one.is_open}
    missing = sorted({one.name for one in every if one.is_open} - known.keys())
    given = {} if defaults is None else validation.table(defaults, "defaults", '{"m": 2.0}')
    for name in given:
        if name not in missing:
            problem = "has a default value already" if name in known else "is no parameter of the system"
            raise ModelError(f"defaults: {quoted(name)} {problem}. {did_you_mean(name, missing)}")
    if absent := [name for name in missing if name not in given]:
        names = ", ".join(absent)
        raise ModelError(
            f"system {quoted(system.name)}: no default value of {names}. Pass "
            f"defaults={{{absent[0]!r}: 1.0}}, or write kg.Parameter({absent[0]!r}, 1.0) once instead."
        )
    known |= {name: Parameter(name, finite(given[name], f"default of {quoted(name)}")) for name in missing}
    if not missing and not any(one.is_open for one in every):
        return {}

    def default(one: Parameter) -> Parameter:
        return known[one.name] if one.is_open else one

    return mapped_numbers(system, lambda value: with_parameters_changed(value, default))


def _leaves(value: Any) -> Iterator[Number]:
    """Yield the numbers in nested tuples."""
    if isinstance(value, tuple):
        for item in value:
            yield from _leaves(item)
    else:
        yield value
