"""A system as plain numbers, from which any program can build the same tree.

Doubles are hexadecimal, so that they are exact in every language that reads C99. A joint orientation that is
given as doubles means the rotation nearest to them, and its entries are decimals with all digits of `DIGITS`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from kanegen.measure.truth.balls import arb, ctx
from kanegen.measure.truth.tree import constant_orientation
from kanegen.model.coordinates import FREEDOMS, Freedom, QuaternionRotation
from kanegen.model.numbers import value_of
from kanegen.model.system import System

DIGITS = 32
"""Significant digits of decimals."""

BITS = 256
"""Working precision of constant orientations."""

Entry = dict[str, Any]
"""A JSON object whose numbers are texts, but for indices and axes."""


def tree_numbers(system: System) -> Entry:
    """Return gravity, names and bodies of a system.

    Raises:
        ValueError: If the system has something that the format has no words for.
    """
    foreign = [name for name in ("force_elements", "rotors") if getattr(system, name)]
    if foreign:
        raise ValueError(f"the format has no {' and no '.join(foreign)}.")
    return {
        "gravity": hexadecimal(value_of(number) for number in system.gravity),
        "coordinates": list(system.coordinate_names),
        "speeds": list(system.speed_names),
        "bodies": [_body(system, k) for k in range(1, system.number_of_bodies + 1)],
    }


def hexadecimal(values: Iterable[float]) -> list[str]:
    """Return doubles as hexadecimal texts."""
    return [float(value).hex() for value in values]


def decimal(ball: arb) -> str:
    """Return a number with its certified digits, at most `DIGITS`; "0" if its ball contains 0."""
    if ball.contains(0):
        return "0"
    if ball.is_exact() and ball.is_integer():
        return str(int(ball.unique_fmpz()))
    return str(ball.str(DIGITS, radius=False))


def _body(system: System, k: int) -> Entry:
    """Return body K: where its joint is, how it moves, and its mass."""
    body = system.bodies[k - 1]
    with ctx.workprec(BITS):
        orientation = [decimal(entry) for entry in constant_orientation(body.joint.orientation).entries()]
    return {
        "name": body.name,
        "lower": body.lower,
        "position": hexadecimal(value_of(number) for number in body.joint.position),
        "orientation": orientation,
        "joint": [*_slides(system, k), *_turns(system, k)],
        "mass": float(value_of(body.mass)).hex(),
        "mass_center": hexadecimal(value_of(number) for number in body.mass_center),
        "inertia": hexadecimal(value_of(number) for row in body.inertia for number in row),
    }


def _slides(system: System, k: int) -> Iterator[Entry]:
    """Yield the translations along the axes of the joint frame that move."""
    for axis in (1, 2, 3):
        yield from _movement(system, Freedom(k, FREEDOMS.index(f"s{axis}")), "slide", axis)


def _turns(system: System, k: int) -> Iterator[Entry]:
    """Yield the turns that move, or a quaternion."""
    joint = system.bodies[k - 1].joint
    if isinstance(joint.rotation, QuaternionRotation):
        x = [system.coordinate_place(k, kind) for kind in joint.rotation.coordinates]
        yield {"quaternion": x, "y": [system.places[Freedom(k, index)] for index in range(3)]}
        return
    if joint.speeds_are_rates is False:
        raise ValueError(
            f"body {system.bodies[k - 1].name!r}: the format has no angles with angular velocities."
        )
    for index, axis in enumerate(joint.axes):
        yield from _movement(system, Freedom(k, index), "turn", axis + 1)


def _movement(system: System, freedom: Freedom, kind: str, axis: int) -> Iterator[Entry]:
    """Yield how one freedom moves: by its own coordinate, or by a factor of another one."""
    body = system.bodies[freedom.body - 1]
    if body.joint.free[freedom.index]:
        place = system.coordinate_place(freedom.body, freedom.index)
        yield {kind: axis, "x": place, "y": system.places[freedom]}
    elif body.joint.coupled[freedom.index]:
        yield {kind: axis, **_followed(system, freedom)}
    elif value_of(body.joint.locked[freedom.index]) != 0 or body.joint.prescribed[freedom.index]:
        raise ValueError(f"body {body.name!r}: the format has no locked and no prescribed freedoms.")


def _followed(system: System, freedom: Freedom) -> Entry:
    """Return which coordinate a coupled freedom follows, by which factor, from where."""
    (one,) = (one for one in system.coupled if one.freedom == freedom)
    ((other, factor),) = one.terms
    place = system.coordinate_place(other.body, other.index)
    numbers = {"factor": factor, "offset": one.offset}
    texts = {name: float(value_of(number)).hex() for name, number in numbers.items()}
    return {"x": place, "y": system.places[other], **texts}
