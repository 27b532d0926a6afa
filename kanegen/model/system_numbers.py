"""All numbers of a system: one after the other, changed together, and with default values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.expression import Expression
from kanegen.model.numbers import (
    Number,
    Parameter,
    finite,
    map_numbers,
    parameters_of,
    toml_number,
    with_parameters_changed,
)
from kanegen.model.system_fields import SystemFields


def numbers_of(system: SystemFields) -> Iterator[Number]:
    """Yield every number of a system, in the order in which its parameters are counted."""
    for _, value in _of_bodies(system):
        yield from _leaves(value)
    for coupling in system.couplings:
        yield from coupling.numbers()
    for _, value in _of_frames(system):
        yield from _leaves(value)
    for rotor in system.rotors:
        yield from (rotor.inertia, rotor.ratio)
    for contact in system.contacts:
        yield contact.damping
    for element in system.force_elements:
        yield from element.numbers()


def expression_summaries(system: SystemFields) -> tuple[str, ...]:
    """Return one line for each quantity of bodies, joints and frames that is an expression of parameters.

    Those of couplings, rotors, contacts and force elements stand in the summaries of these.

    Example:
        expression_summaries(kg.load("models/cart_pole.toml"))[0]  # "gravity = (0.0, 0.0, -g)"
    """
    lines = []
    for label, value in (*_of_bodies(system), *_of_frames(system)):
        if any(isinstance(one, Expression) and one.parameters for one in _leaves(value)):
            lines.append(f"{label} = {_shown(value)}")
    return tuple(lines)


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


def _of_bodies(system: SystemFields) -> Iterator[tuple[str, Any]]:
    """Yield gravity and the quantities of bodies and joints, each with a label."""
    yield "gravity", system.gravity
    for body in system.bodies:
        joint = body.joint
        yield f"{body.name}: mass", body.mass
        yield f"{body.name}: inertia", body.inertia
        yield f"{body.name}: mass_center", body.mass_center
        yield from ((f"{point.name}: position", point.position) for point in body.points)
        for name in ("position", "orientation", "locked", "armature"):
            yield f"{body.name}: joint.{name}", getattr(joint, name)


def _of_frames(system: SystemFields) -> Iterator[tuple[str, Any]]:
    """Yield the quantities of frames, each with a label."""
    for frame in system.frames:
        yield f"{frame.name}: position", frame.position
        yield f"{frame.name}: orientation", frame.orientation


def _shown(value: Any) -> str:
    """Return nested tuples of numbers as text."""
    return f"({', '.join(map(_shown, value))})" if isinstance(value, tuple) else str(toml_number(value))


def _leaves(value: Any) -> Iterator[Number]:
    """Yield the numbers in nested tuples."""
    if isinstance(value, tuple):
        for item in value:
            yield from _leaves(item)
    else:
        yield value
