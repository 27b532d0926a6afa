"""The arrays that the generated functions read, and the symbols of their elements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain, product

from sympy import Symbol

from kanegen.model.coordinates import FREEDOMS, CoordinateKind
from kanegen.model.system import System
from kanegen.program.ir import PARAMETERS, Array
from kanegen.symbolic import symbols
from kanegen.symbolic.state_symbols import NOTES

Elements = tuple[tuple[Symbol, str], ...]
"""Symbol of each element of an array, with its name in the generated code."""

LOADS = ("force", "torque", "point_force", "point_moment", "t")
"""Loads on a system beside gravity and {tau}, and the time on which they may depend."""

READ_BY_ALL = ("prescribed",)
"""Arrays that every output may read."""


def input_arrays(system: System) -> dict[Array, Elements]:
    """Return the input arrays of a system with the symbols of their elements, in the order of C arguments."""
    kinds = (_parameters, _state, _accelerations_and_forces, _loads, _point_loads, _time, _prescribed)
    return dict(chain.from_iterable(kind(system) for kind in kinds))


def argument_arrays(system: System) -> tuple[Array, ...]:
    """Return all arrays that C functions of a system may read, in the order of their arguments.

    Beside the inputs of the equations these are the weights and the directions of products with derivatives.
    """
    arrays = [array for array in input_arrays(system)]
    names = [array.name for array in arrays]
    place, n = names.index("ydot") + 1, len(system.freedoms)
    sizes = {array.name: array.size for array in arrays if array.name != "ydot"}
    total = sum(sizes.values())
    further = (
        Array("weights", (n,), "any", "the weight of each element of the quantity that is differentiated"),
        Array("direction", (total,), "those of the variables", "a change of the variables, in their order"),
        Array(
            "state_direction",
            (total - n,),
            "those of the variables",
            "a change of the variables of {f}, in their order",
        ),
    )
    return (*arrays[:place], *further, *arrays[place:])


def coordinate_units(system: System) -> tuple[str, ...]:
    """Return the units that occur in {x}."""
    return (*dict.fromkeys(kind.unit for kind in _orientation_kinds(system)), "rad", "m")


def _orientation_kinds(system: System) -> list[CoordinateKind]:
    """Return the kinds of coordinates of orientations that are no angles, such as elements of quaternions."""
    return [coordinate.kind for coordinate in system.coordinates if coordinate.index >= len(FREEDOMS)]


def _named(elements: Iterable[Symbol]) -> Elements:
    """Return symbols with their own names."""
    return tuple((symbol, symbol.name) for symbol in elements)


def _parameters(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the array of run-time parameters, if there are any."""
    if system.parameters:
        array = Array(PARAMETERS, (len(system.parameters),), "SI", "the run-time parameters")
        yield array, tuple((symbols.parameter(p), f"p_{p.name}") for p in system.parameters)


def _state(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the arrays {x} and {y}."""
    x = NOTES.coordinates(system)
    y = NOTES.speeds(system)
    units = coordinate_units(system)
    orientation = " or ".join([*dict.fromkeys(kind.group for kind in _orientation_kinds(system)), "angles"])
    doc = f"{{x}}, the coordinates: {orientation}, then translations, Eq. (1)"
    yield Array("x", (len(x),), ", ".join(units), doc), _named(x)
    doc = "{y}, the generalized speeds in the same order, Eq. (1)"
    yield Array("y", (len(y),), "rad/s, m/s", doc), _named(y)


def _accelerations_and_forces(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the arrays that only inverse or forward dynamics read."""
    rates = NOTES.accelerations(system)
    doc = "{ydot}, derivatives of the generalized speeds"
    yield Array("ydot", (len(rates),), "rad/s^2, m/s^2", doc), _named(rates)
    forces = [symbols.generalized_force(freedom.body, freedom.index) for freedom in system.freedoms]
    doc = "generalized forces beside loads and gravity"
    yield Array("tau", (len(forces),), "N m, N", doc), _named(forces)


def _loads(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the arrays of forces and torques on bodies, if any body takes loads."""
    if any(body.loads for body in system.bodies):
        count = system.number_of_bodies
        every = list(product(range(1, count + 1), range(3)))
        doc = "acting on each body {}, body components, Eq. (37)"
        force = Array("force", (count, 3), "N", "{F'_K}, the force " + doc.format("at its mass centre"))
        torque = Array("torque", (count, 3), "N m", "{M'_K}, the torque " + doc.format("as a couple"))
        yield force, _named(symbols.force(k, axis) for k, axis in every)
        yield torque, _named(symbols.torque(k, axis) for k, axis in every)


def _point_loads(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the arrays of forces and moments on points, if any point takes loads."""
    if any(point.loads for _, point in system.points):
        count = len(system.points)
        every = list(product(range(1, count + 1), range(3)))
        in_frames = any(point.load_frame for _, point in system.points if point.loads)
        components = (
            "inertial components unless its row names a frame" if in_frames else "inertial components"
        )
        doc = f"on the body of each point, {components}"
        force = Array("point_force", (count, 3), "N", f"the force {doc}, acting there")
        moment = Array("point_moment", (count, 3), "N m", f"the moment {doc}, as a couple")
        yield force, _named(symbols.point_force(number, axis) for number, axis in every)
        yield moment, _named(symbols.point_moment(number, axis) for number, axis in every)


def _time(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the array of the time, if the system depends on it."""
    if system.depends_on_time:
        yield Array("t", (), "s", "the time"), _named([symbols.time()])


def _prescribed(system: System) -> Iterator[tuple[Array, Elements]]:
    """Yield the array of the motion of prescribed freedoms, if there are any."""
    if system.prescribed:
        shape = (3, len(system.prescribed))
        doc = "the prescribed freedoms: a row of values, one of rates, one of second derivatives"
        array = Array("prescribed", shape, "rad, m; rad/s, m/s; rad/s^2, m/s^2", doc)
        yield array, _named(NOTES.prescribed(system))
