"""Locking: freedoms that stay at constant values, and leave {x}, {y}, [A] and {f}.

The equations of the system with locked freedoms are those of the whole system at these values, with speeds
and accelerations of zero there. Force elements on a locked freedom stay, and see its constant value.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from kanegen.errors import ModelError, quoted, warn
from kanegen.model import validation
from kanegen.model.body import Body
from kanegen.model.coordinates import (
    ANGLES,
    COORDINATE_KINDS,
    FREEDOMS,
    ORIENTATIONS,
    SPEED_KINDS,
    SPEEDS,
    Freedom,
)
from kanegen.model.coupling import Coupling
from kanegen.model.description import SystemDescription
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import Drive, JointFriction
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, is_fixed, number, numbers, value_of

LOCKED = "locked"
"""Beginning of error messages."""


Values = dict[Freedom, Number]
"""Values at which freedoms are locked (rad, m)."""


def with_locked(system: SystemDescription, values: Any) -> dict[str, Any]:
    """Return the fields of a system that change where some freedoms are locked; see `System.with_locked`.

    Raises:
        ModelError: If there is no such freedom or it is coupled, a value is no number, or a part of an
            orientation is locked whose coordinates or speeds need all of it free.

    Warns:
        KanegenWarning: If a value is outside the limits of its freedom, or a drive acts on nothing any more.
    """
    example = '{"elbow": 0.3}'
    orientations: dict[int, tuple[Number, ...]] = {}
    locked = _values(system, validation.table(values, LOCKED, example), orientations)
    couplings, locked = _couplings(system, locked)
    bodies = list(system.bodies)
    for k in dict.fromkeys(freedom.body for freedom in locked):
        own = {freedom.index: value for freedom, value in locked.items() if freedom.body == k}
        bodies[k - 1] = replace(bodies[k - 1], joint=_locked(bodies[k - 1], own))
    elements = _force_elements(system, bodies, orientations)
    return {"bodies": tuple(bodies), "couplings": couplings, "force_elements": elements}


def _values(
    system: SystemDescription,
    values: Mapping[str, Any],
    orientations: dict[int, tuple[Number, ...]],
) -> Values:
    """Return the values of the freedoms to lock.

    Args:
        system: The system.
        values: Values by name of the freedom, of the joint or of the body.
        orientations: Receives the coordinates of every orientation that is locked, by number of the body.
    """
    names = _orientation_names(system)
    coupled = {one.freedom for one in system.coupled}
    found: Values = {}
    for name, value in values.items():
        if name in names:
            joint = system.bodies[names[name] - 1].joint
            orientations[names[name]] = given = _orientation(joint, name, value)
            found |= {Freedom(names[name], i): angle for i, angle in _angles(joint, name, given)}
            continue
        freedom = system.freedom(name, LOCKED)
        if freedom in coupled:
            raise ModelError(
                f"{LOCKED}: {quoted(name)} is coupled. Lock the freedoms that it follows, or leave the "
                "coupling out."
            )
        if freedom.index not in system.bodies[freedom.body - 1].joint.coordinate_kinds:
            whole = next(key for key, k in names.items() if k == freedom.body)
            raise ModelError(
                f"{LOCKED}: {quoted(name)} has no coordinate of its own. Lock the whole orientation, such as "
                f"{{{whole!r}: (1, 0, 0, 0)}}."
            )
        found[freedom] = number(value, f"{LOCKED}: {quoted(name)}")
    return found


def _orientation_names(system: SystemDescription) -> dict[str, int]:
    """Return the numbers of bodies whose orientation is free, by the names of their joints or their own."""
    return {
        body.joint.name or body.name: k
        for k, body in enumerate(system.bodies, start=1)
        if body.joint.has_free_orientation
    }


def _orientation(joint: Joint, name: str, value: Any) -> tuple[Number, ...]:
    """Return the coordinates of an orientation, as many numbers as the joint has.

    Raises:
        ModelError: If they are other than that.
    """
    given: tuple[Number, ...] = numbers(
        value, (len(joint.rotation.coordinates),), f"{LOCKED}: {quoted(name)}"
    )
    return given


def _angles(joint: Joint, name: str, given: tuple[Number, ...]) -> Iterator[tuple[int, Number]]:
    """Yield index and value of the three angles of a joint for an orientation by its coordinates.

    Raises:
        ModelError: If four coordinates are zero, or one of them is a parameter.
    """
    if len(given) == len(ANGLES):
        yield from zip(ANGLES, given, strict=True)
        return
    label = f"{LOCKED}: {quoted(name)}"
    plain = [value_of(entry) for entry in given]
    if not all(map(is_fixed, given)):
        raise ModelError(f"{label}: an orientation by {len(plain)} numbers takes no parameters.")
    if not any(plain):
        raise ModelError(f"{label}: {len(plain)} zeros are no orientation.")
    yield from zip(ANGLES, joint.rotation.angles(plain), strict=True)


def _couplings(system: SystemDescription, locked: Values) -> tuple[tuple[Coupling, ...], Values]:
    """Return the couplings that remain, and the values together with those of coupled freedoms now constant.

    Raises:
        ModelError: If the value of a coupled freedom is not finite.
    """
    values, left = dict(locked), []
    by_name = {coupling.freedom: coupling for coupling in system.couplings}
    for one in system.coupled:
        name = f"{system.bodies[one.freedom.body - 1].name}.{FREEDOMS[one.freedom.index]}"
        coupling, offset, terms = by_name[name], one.offset, []
        for (freedom, factor), term in zip(one.terms, coupling.pairs, strict=True):
            if freedom not in values:
                terms.append(term)
                continue
            value = values[freedom]
            offset = number(offset + factor * value, f"{LOCKED}: {quoted(name)}")
        if terms:
            left.append(Coupling(name, tuple(terms), offset))
        else:
            values[one.freedom] = offset
    return tuple(left), values


def _force_elements(
    system: SystemDescription, bodies: Sequence[Body], orientations: Mapping[int, tuple[Number, ...]]
) -> tuple[ForceElement, ...]:
    """Return the force elements, with the values of those coordinates and speeds that exist no more.

    A locked angle or translation keeps its name. The elements of a locked quaternion and the components of a
    locked angular velocity lose theirs.

    Warns:
        KanegenWarning: If a drive or friction acts on a component of a locked angular velocity; it is left
            out.
    """
    constants: dict[str, Number] = {}
    for k, given in orientations.items():
        body, joint = system.bodies[k - 1], bodies[k - 1].joint
        kinds = zip(body.joint.rotation.coordinates, given, strict=True)
        constants |= {
            f"x.{body.name}.{COORDINATE_KINDS[kind].name}": value
            for kind, value in kinds
            if kind not in joint.coordinate_kinds
        }
        constants |= {
            f"y.{body.name}.{SPEED_KINDS[kind].name}": 0.0
            for kind in body.joint.speed_kinds
            if kind not in joint.speed_kinds
        }
    idle = [
        element
        for element in system.force_elements
        if isinstance(element, Drive | JointFriction) and f"y.{element.freedom}" in constants
    ]
    if idle:
        names = ", ".join(element.freedom for element in idle if isinstance(element, Drive | JointFriction))
        warn(
            f"{LOCKED}: drives and friction on locked components of an angular velocity are left out: "
            f"{names}."
        )
    return tuple(e.with_constants(constants) for e in system.force_elements if e not in idle)


def _locked(body: Body, values: Mapping[int, Number]) -> Joint:
    """Return the joint of a body with some of its freedoms locked, by their indices.

    Raises:
        ModelError: If some but not all angles are locked whose speeds are no rates.
    """
    joint = body.joint
    _warn_of_limits(body, values)
    changed: dict[str, Any] = {
        kind: tuple(flag and i not in values for i, flag in enumerate(getattr(joint, kind)))
        for kind in ("free", "prescribed", "coupled")
    }
    free = changed["free"]
    changed["limits"] = joint.limits.without(*values)
    changed["locked"] = tuple(values.get(i, value) for i, value in enumerate(joint.locked))
    if joint.has_free_orientation and not joint.speeds_are_rates and not all(free[:3]):
        if any(free[:3]):
            raise ModelError(
                f"{LOCKED}: the speeds of body {quoted(body.name)} are its angular velocity, which needs "
                "three free angles. Lock theta1, theta2 and theta3 together, or take angle rates first."
            )
        changed |= {"speeds": SPEEDS[0], "coordinates": ORIENTATIONS[0]}
    return replace(joint, **changed)


def _warn_of_limits(body: Body, values: Mapping[int, Number]) -> None:
    """Warn of values outside the limits of their freedoms."""
    limits = body.joint.limits
    for index, value in values.items():
        lower, upper = limits.lower[index], limits.upper[index]
        if not lower <= value_of(value) <= upper:
            name = body.joint.freedom_name(index) or f"{body.name}.{FREEDOMS[index]}"
            warn(f"{LOCKED}: {name} at {value_of(value):g} is outside its limits, {lower:g} to {upper:g}.")
