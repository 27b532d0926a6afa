"""The general form of a model: all freedoms free, every number a run-time parameter, loads on every body.

Freedoms that the model prescribes stay prescribed in its general form.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import Any

from kanegen.model import rotations
from kanegen.model.body import Body
from kanegen.model.frame import Frame
from kanegen.model.joint import Joint
from kanegen.model.numbers import Matrix, Number, Parameter, Vector, is_fixed, map_numbers, value_of
from kanegen.model.system import System
from kanegen.recursion.outputs import chosen

PREFIX = "number"
"""Beginning of the names of the parameters that replace numbers."""


def with_all_freedoms(system: System) -> System:
    """Return the same tree with all six freedoms of every joint free, except for the prescribed ones.

    No freedom is locked or coupled then, so the system has no reaction loads.
    """

    def joint(of: Joint) -> Joint:
        free = tuple(not prescribed for prescribed in of.prescribed)
        return replace(of, free=free, coupled=(False,) * len(free), name="")

    system = replace(system, reactions=None, couplings=())
    return _changed(system, lambda body: replace(body, joint=joint(body.joint)))


def equivalent_outputs(system: System, outputs: Sequence[str]) -> tuple[str, ...]:
    """Return the outputs of a general form that contain the values of `outputs` of the model.

    Where all freedoms are free, reaction loads are among the generalized forces of inverse dynamics.
    """
    if system.reaction_rows:
        return tuple(outputs)
    return chosen("inverse_dynamics" if name == "reaction_loads" else name for name in outputs)


def with_loads(system: System) -> System:
    """Return the same tree with a force and a torque as inputs on every body."""
    return _changed(system, lambda body: replace(body, loads=True))


def with_numbers_as_parameters(system: System) -> System:
    """Return the same system with a run-time parameter for every number, zeros included."""
    taken = {parameter.name for parameter in system.parameters}
    names = (name for k in count(1) if (name := f"{PREFIX}{k}") not in taken)

    def parameter_for(value: Number) -> Number:
        return Parameter(next(names), value_of(value)) if is_fixed(value) else value

    def joint(of: Joint) -> Joint:
        return replace(
            of,
            position=map_numbers(of.position, parameter_for),
            orientation=map_numbers(_angles(of.orientation), parameter_for),
            locked=tuple(
                0.0 if moves else parameter_for(v) for moves, v in zip(of.moving, of.locked, strict=True)
            ),
            armature=tuple(parameter_for(value) if value else value for value in of.armature),
        )

    def body(of: Body) -> Body:
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = of.inertia
        xx, yy, zz, xy, xz, yz = (parameter_for(value) for value in (xx, yy, zz, xy, xz, yz))
        return replace(
            of,
            mass=parameter_for(of.mass),
            inertia=((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)),
            mass_center=map_numbers(of.mass_center, parameter_for),
            joint=joint(of.joint),
            points=tuple(point.map_numbers(parameter_for) for point in of.points),
        )

    def frame(of: Frame) -> Frame:
        return replace(
            of,
            position=map_numbers(of.position, parameter_for),
            orientation=map_numbers(_angles(of.orientation), parameter_for),
        )

    return replace(
        _changed(system, body),
        gravity=map_numbers(system.gravity, parameter_for),
        rotors=tuple(rotor.map_numbers(parameter_for) for rotor in system.rotors),
        force_elements=tuple(element.map_numbers(parameter_for) for element in system.force_elements),
        couplings=tuple(coupling.map_numbers(parameter_for) for coupling in system.couplings),
        frames=tuple(map(frame, system.frames)),
    )


def _angles(orientation: Matrix | Vector) -> Any:
    """Return the three 1-2-3 angles of a constant orientation (rad)."""
    if isinstance(orientation[0], tuple):
        return rotations.angles_123(map_numbers(orientation, value_of))
    return orientation


def steps(system: System) -> Iterator[tuple[str, System]]:
    """Yield the systems from the general form of a model to the model, one choice after the other.

    The first system has the tree of the model and nothing else of it; freedoms that the model locks or
    couples are coordinates there.

    Yields:
        The name of the generality that the system leaves out, and the system.
    """
    loaded = with_loads(system)
    yield "nothing", with_numbers_as_parameters(with_all_freedoms(loaded))
    yield "locked freedoms", with_numbers_as_parameters(loaded)
    yield "loads", with_numbers_as_parameters(system)
    yield "run-time numbers", system


def _changed(system: System, change: Callable[[Body], Body]) -> System:
    """Return the system with `change` applied to every body."""
    return replace(system, bodies=tuple(change(body) for body in system.bodies))
