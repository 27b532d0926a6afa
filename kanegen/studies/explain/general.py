"""The general form of a scene: all freedoms, every number a run-time parameter, loads on every body.

What the scene prescribes is prescribed there as well; everything else is free.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import Any

from kanegen.model import rotations
from kanegen.model.body import Body
from kanegen.model.joint import Joint
from kanegen.model.numbers import Number, Parameter, map_numbers, value_of
from kanegen.model.system import System
from kanegen.recursion.outputs import chosen

PREFIX = "number"
"""Of the parameters that stand for a scene's numbers."""


def with_freedoms(system: System) -> System:
    """The same tree with all six freedoms at every joint, free but for those that are prescribed.

    Reaction loads are efforts there.
    """

    def joint(of: Joint) -> Joint:
        return replace(of, free=tuple(not told for told in of.prescribed), name="")

    system = replace(system, reactions=None)
    return _changed(system, lambda body: replace(body, joint=joint(body.joint)))


def answering(system: System, outputs: Sequence[str]) -> tuple[str, ...]:
    """The outputs of a general form that hold what `outputs` of the scene do.

    What the scene locks may be free there: then its reaction loads are among the efforts.
    """
    if system.reacting:
        return tuple(outputs)
    return chosen("inverse_dynamics" if name == "reaction_loads" else name for name in outputs)


def with_loads(system: System) -> System:
    """The same tree with a force and a torque on every body."""
    return _changed(system, lambda body: replace(body, loads=True))


def opened(system: System) -> System:
    """The same system with a run-time parameter for every number, zeros included."""
    taken = {parameter.name for parameter in system.parameters}
    names = (name for k in count(1) if (name := f"{PREFIX}{k}") not in taken)

    def open_(value: Number) -> Number:
        return value if isinstance(value, Parameter) else Parameter(next(names), value)

    def joint(of: Joint) -> Joint:
        angles: Any = of.orientation
        if isinstance(angles[0], tuple):
            angles = rotations.angles_123(map_numbers(angles, value_of))
        return replace(
            of,
            position=map_numbers(of.position, open_),
            orientation=map_numbers(angles, open_),
            locked=tuple(0.0 if moves else open_(v) for moves, v in zip(of.moving, of.locked, strict=True)),
        )

    def body(of: Body) -> Body:
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = of.inertia
        xx, yy, zz, xy, xz, yz = (open_(value) for value in (xx, yy, zz, xy, xz, yz))
        return replace(
            of,
            mass=open_(of.mass),
            inertia=((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)),
            mass_center=map_numbers(of.mass_center, open_),
            joint=joint(of.joint),
            points=tuple(point.changed(open_) for point in of.points),
        )

    elements = tuple(element.changed(open_) for element in system.force_elements)
    return replace(
        _changed(system, body), gravity=map_numbers(system.gravity, open_), force_elements=elements
    )


def steps(system: System) -> Iterator[tuple[str, System]]:
    """From the general form to the scene, one choice after the other.

    The bodies of the first hang together as those of the scene do, and nothing else is known of them: what
    the scene locks are coordinates there.

    Yields:
        What the scene does without, in words, and the system that is left.
    """
    loaded = with_loads(system)
    yield "nothing", opened(with_freedoms(loaded))
    yield "locked freedoms", opened(loaded)
    yield "loads", opened(system)
    yield "run-time numbers", system


def _changed(system: System, change: Callable[[Body], Body]) -> System:
    return replace(system, bodies=tuple(change(body) for body in system.bodies))
