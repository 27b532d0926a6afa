"""States that random ones miss: at rest, at the origin, and where an expression has a kink or a jump.

A kink is where the operand of a magnitude or a sign is 0, or where two numbers are equal of which the smaller
or the larger is taken, or which a condition compares. It is approached from random states by one variable
after the other, between two neighbouring numbers where the sign changes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kanegen.model.arrays import Flags, Floats, SystemArrays
from kanegen.model.coordinates import Coordinate, Freedom
from kanegen.model.expression import Expression
from kanegen.model.force_elements.elements import JointSpring
from kanegen.model.force_elements.names import variable_places
from kanegen.model.nodes import COMPARISONS, TIME, Operation
from kanegen.model.numbers import value_of
from kanegen.model.system import System
from kanegen.reference import equations, expressions
from kanegen.reference.force_elements import variables
from kanegen.reference.freedoms import full_order
from kanegen.reference.states import States, joined, ranges

STARTS = 3
"""Number of random states from which every kink is approached, and of those that are brought to rest."""

MOST_OPERATIONS = 400
"""Largest number of operations of the expressions of all kinks that are approached."""

HALVINGS = 80
"""Number of halvings of an interval; the numbers at its ends are then neighbours."""


@dataclass(frozen=True)
class SpecialStates:
    """Further states, and how they were chosen.

    Attributes:
        states: The states, all of them defined.
        at_rest: Number of states with zero speeds.
        at_kinks: Number of states next to or at kinks of expressions.
        undefined: Number of states that were left out because {f} is undefined there.
    """

    states: States
    at_rest: int
    at_kinks: int
    undefined: int

    @property
    def words(self) -> str:
        """How the states were chosen, in words; "" where there are none."""
        parts = [(self.at_rest, "at rest or at the origin"), (self.at_kinks, "at kinks of expressions")]
        named = [f"{count} {where}" for count, where in parts if count]
        text = " and ".join(named)
        return f"{text}; {{f}} is undefined in {self.undefined} more" if self.undefined else text


def special_states(system: System, sample: States) -> SpecialStates:
    """Return states at rest, at the origin, and at kinks of expressions, parameters at their defaults.

    Args:
        system: The tree.
        sample: Random states, of which the first are changed; loads stay as they are.
    """
    starts = sample.part(0, min(STARTS, len(sample)))
    arrays = system.values()
    still = joined([*_still(system, starts)])
    kinked = [*_at_kinks(system, arrays, starts)]
    every = joined([still, *kinked])
    kept = defined(arrays, every)
    left = every.chosen(kept)
    return SpecialStates(
        states=left,
        at_rest=int(kept[: len(still)].sum()),
        at_kinks=int(kept[len(still) :].sum()),
        undefined=int((~kept).sum()),
    )


def kinks(expression: Expression) -> list[Expression]:
    """Return expressions that are 0 where an expression has a kink or a jump, each once."""
    found: list[Expression] = []
    for operation in expression.operations():
        if operation.operator in ("abs", "sign"):
            found.append(Expression(operation.operands[0]))
        elif operation.operator in ("min", "max", *COMPARISONS):
            found.append(Expression(Operation("-", operation.operands)))
    return list(dict.fromkeys(found))


def _still(system: System, starts: States) -> Iterator[States]:
    """Yield the origin at rest, random states at rest, the origin in motion, and springs at their rest."""
    origin = np.zeros_like(starts.x[:1])
    for coordinate, free in system.coordinate_places.items():
        if coordinate.kind.name == "e0":
            origin[:, free] = 1.0
    origin = np.clip(origin, system.limits.lower, system.limits.upper)
    one = starts.part(0, 1)
    yield replace(one, x=origin, y=np.zeros_like(one.y))
    yield replace(starts, y=np.zeros_like(starts.y))
    yield replace(one, x=origin)
    places, relaxed = variable_places(system.bodies), origin.copy()
    for element in system.force_elements:
        if isinstance(element, JointSpring):
            place = system.coordinate_places.get(Coordinate(*places[f"x.{element.freedom}"]))
            if place is not None:
                relaxed[:, place] = value_of(element.rest)
    if (relaxed != origin).any():
        yield replace(one, x=relaxed, y=np.zeros_like(one.y))


def _at_kinks(system: System, arrays: SystemArrays, starts: States) -> Iterator[States]:
    """Yield states on both sides of every kink, each reached by one variable."""
    elements = arrays.forces.elements
    found = dict.fromkeys(
        kink for element in elements for expression in element.expressions() for kink in kinks(expression)
    )
    done = 0
    for kink in found:
        done += sum(1 for _ in kink.operations())
        if done > MOST_OPERATIONS:
            return
        for name in kink.variables:
            yield from _reached(system, arrays, starts, kink, name)


def _reached(
    system: System, arrays: SystemArrays, starts: States, kink: Expression, name: str
) -> Iterator[States]:
    """Yield states at a kink that one variable reaches from some of the starting states."""
    place = place_of_variable(system, name)
    if place is None:
        return
    vector, index = place
    speeds = full_order(arrays, starts.y, starts.prescribed[:, 1])
    time = starts.inputs.get(TIME, np.zeros(len(starts)))
    values = variables(arrays, (starts.x, starts.prescribed[:, 0]), speeds, time)
    size = {"x": ranges(arrays).x, "y": ranges(arrays).y}[vector][index]
    low, high = np.full(len(starts), -size), np.full(len(starts), size)

    def sign(at: Floats) -> Floats:
        with np.errstate(all="ignore"):
            found = expressions.evaluate(kink, values | {name: at}, np.float64)
        return np.broadcast_to(np.sign(found), at.shape)

    below, above = sign(low), sign(high)
    reached = below * above < 0
    for _ in range(HALVINGS):
        middle = low + (high - low) / 2
        there = sign(middle)
        low = np.where((there == below) | (there == 0), middle, low)
        high = np.where((there == above) | (there == 0), middle, high)
    for end in (low, high):
        moved = {"x": starts.x.copy(), "y": starts.y.copy()}
        moved[vector][:, index] = end
        yield replace(starts, x=moved["x"], y=moved["y"]).chosen(reached)


def place_of_variable(system: System, name: str) -> tuple[str, int] | None:
    """Return the vector, x or y, and the place in it of a variable that is free; None for any other."""
    if name == TIME:
        return None
    k, index = variable_places(system.bodies)[name]
    place = (
        system.coordinate_places.get(Coordinate(k, index))
        if name.startswith("x.")
        else system.places.get(Freedom(k, index))
    )
    return None if place is None else (name[0], place)


def defined(arrays: SystemArrays, states: States) -> Flags:
    """Return in which states the reference's {f} is finite."""
    with np.errstate(all="ignore"):
        found = equations.forcing(arrays, states.x, states.y, states.force, states.torque, **states.inputs)
    finite: Flags = np.all(np.isfinite(found), axis=1)
    return finite
