"""The arrays of the generated functions: what can be asked for, and what each output reads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence, Sized
from dataclasses import dataclass, replace
from functools import partial

from sympy import Symbol

from kanegen import derivatives
from kanegen.choices import several
from kanegen.errors import OptionError
from kanegen.program.ir import EVALUATE, Array, Condition
from kanegen.program.selection import PARAMETERS
from kanegen.program.split import Signature
from kanegen.symbolic import symbols
from kanegen.system import System

Elements = tuple[tuple[Symbol, str], ...]


@dataclass(frozen=True)
class Subject:
    """What an output is about that not every system has.

    Attributes:
        found: What a system has of it.
        missing: What to say of a system that has none, and how to mend it.
    """

    found: Callable[[System], Sized]
    missing: str


POINTS = Subject(
    lambda system: system.points,
    "has no points. Give a body points in the model file, such as points = {tool = [0, 0, 0.1]}, or use "
    "System.with_points.",
)

REACTIONS = Subject(
    lambda system: system.reacting,
    "has no locked directions, all joints move freely. Lock some, or ask for inverse_dynamics.",
)


PRESCRIBED = Subject(
    lambda system: system.prescribed,
    'has no prescribed freedoms. Prescribe some in the model file, such as prescribed = ["theta1"] in a '
    "joint, or use System.with_prescribed.",
)


@dataclass(frozen=True)
class OutputKind:
    """An output that can be asked for.

    Attributes:
        array: The array that it fills.
        inputs: Names of the arrays that it may read, beside those of `EVERYWHERE`.
        subject: What it is about, so that only systems with it have the output; None where all do.
    """

    array: Callable[[System], Array]
    inputs: tuple[str, ...]
    subject: Subject | None = None


def _mass_matrix(system: System) -> Array:
    n = len(system.freedoms)
    return Array("A", (n, n), "kg m^2, kg m, kg", "[A], the generalized mass matrix, Eq. (43)")


def _forcing(system: System) -> Array:
    return Array("f", (len(system.freedoms),), "N m, N", "{f}, the right side of [A]{ydot} = {f}, Eq. (44)")


def _generalized_force(system: System) -> Array:
    doc = "[A]{ydot} - {f}, the generalized forces that {ydot} needs beside loads and gravity"
    return Array("generalized_force", (len(system.freedoms),), "N m, N", doc)


def _acceleration(system: System) -> Array:
    doc = "{ydot} of [A]{ydot} = {f} + {tau}, Eq. (42)"
    return Array("acceleration", (len(system.freedoms),), "rad/s^2, m/s^2", doc)


def _reaction_loads(system: System) -> Array:
    doc = (
        "what holds locked directions, beside loads and gravity: for an angle the moment about O_K and its "
        "axis, for a translation the force along it"
    )
    return Array("reaction_loads", (len(system.reacting),), "N m, N", doc)


def _kinetic_energy(system: System) -> Array:
    return Array(
        "kinetic_energy", (), "J", "the sum of m v_G^2 / 2 + {omega}^T [I_G] {omega} / 2, Eqs. (18), (31)"
    )


def _potential_energy(system: System) -> Array:
    doc = "of gravity, minus the sum of m g . p_G, zero where all mass centres are at the inertial origin"
    return Array("potential_energy", (), "J", doc)


def _momentum(system: System) -> Array:
    doc = (
        "the sum of m {v_G}, then the sum of [I_G] {omega} + ({p_G} - {p_C}) x m {v_G} about the mass centre "
        "C of all bodies, inertial components"
    )
    return Array("momentum", (6,), "kg m/s, kg m^2/s", doc)


def _mass_center(system: System) -> Array:
    doc = "{p_C}, the sum of m {p_G}, Eq. (23), over the sum of m, inertial components"
    return Array("mass_center", (3,), "m", doc)


def _body_poses(system: System) -> Array:
    which = "body" if system.poses is None else "chosen body"
    doc = (
        f"for each {which} the rows of [R_K], Eq. (3), which takes inertial to body components, "
        "then its origin {p_O_K}, Eq. (22), inertial components"
    )
    return Array("body_poses", (len(system.posed), 4, 3), "1, m", doc)


def _coordinate_rates(system: System) -> Array:
    doc = "{xdot}, the rates of the coordinates, Eqs. (9), (45)"
    condition = Condition("squared divisor of Eq. (9)", "the angles have no rates")
    units = ", ".join({"1": "1/s"}.get(unit, f"{unit}/s") for unit in _units(system))
    return Array("xdot", (len(system.coordinates),), units, doc, condition)


def _point_positions(system: System) -> Array:
    doc = "{p_P} of each point from the inertial origin, Eq. (22), inertial components"
    return Array("point_positions", (len(system.points), 3), "m", doc)


def _point_velocities(system: System) -> Array:
    doc = "{v_P} of each point, Eq. (27), inertial components"
    return Array("point_velocities", (len(system.points), 3), "m/s", doc)


def _point_accelerations(system: System) -> Array:
    doc = "{a_P} of each point, Eq. (33), without gravity, inertial components"
    return Array("point_accelerations", (len(system.points), 3), "m/s^2", doc)


def _point_jacobians(system: System) -> Array:
    doc = "[v_P,y] of each point, its partial velocities, Eq. (32), inertial components"
    return Array("point_jacobians", (len(system.points), 3, len(system.freedoms)), "m, 1", doc)


def _error_estimate(system: System) -> Array:
    doc = "about the error of each entry of {ydot} before refinement: how much a first step changes it"
    return Array("error_estimate", (len(system.freedoms),), "rad/s^2, m/s^2", doc)


def _regularity(system: System) -> Array:
    doc = (
        "for each freedom what is left of its inertia where freedoms that are eliminated before it may move; "
        "1 is all, 0 singular"
    )
    return Array("regularity", (len(system.freedoms),), "1", doc)


def _prescribed_efforts(system: System) -> Array:
    doc = "generalized forces that act at the prescribed freedoms, beside loads and gravity"
    return Array("prescribed_efforts", (len(system.prescribed),), "N m, N", doc)


LOADS = ("force", "torque", "point_force", "point_moment", "t")
"""What may act on a system beside gravity and {tau}, or decide about it."""

EVERYWHERE = ("prescribed",)
"""Arrays that every output may read."""


def _derivatives(name: str) -> Callable[[System], Array]:
    return partial(derivatives.array, name=name)


OUTPUTS: dict[str, OutputKind] = {
    "mass_matrix": OutputKind(_mass_matrix, ("x",)),
    "forcing": OutputKind(_forcing, ("x", "y", *LOADS)),
    "inverse_dynamics": OutputKind(_generalized_force, ("x", "y", "ydot", *LOADS)),
    "reaction_loads": OutputKind(_reaction_loads, ("x", "y", "ydot", *LOADS), REACTIONS),
    "forward_dynamics": OutputKind(_acceleration, ("x", "y", "tau", *LOADS)),
    "error_estimate": OutputKind(_error_estimate, ("x", "y", "tau", *LOADS)),
    "regularity": OutputKind(_regularity, ("x",)),
    "kinetic_energy": OutputKind(_kinetic_energy, ("x", "y")),
    "potential_energy": OutputKind(_potential_energy, ("x",)),
    "momentum": OutputKind(_momentum, ("x", "y")),
    "mass_center": OutputKind(_mass_center, ("x",)),
    "body_poses": OutputKind(_body_poses, ("x",)),
    "coordinate_rates": OutputKind(_coordinate_rates, ("x", "y")),
    "point_positions": OutputKind(_point_positions, ("x",), POINTS),
    "point_velocities": OutputKind(_point_velocities, ("x", "y"), POINTS),
    "point_accelerations": OutputKind(_point_accelerations, ("x", "y", "ydot"), POINTS),
    "point_jacobians": OutputKind(_point_jacobians, ("x",), POINTS),
    "prescribed_efforts": OutputKind(_prescribed_efforts, ("x", "y", "ydot", *LOADS), PRESCRIBED),
    "forcing_derivatives": OutputKind(_derivatives("forcing_derivatives"), ("x", "y", *LOADS)),
    "inverse_dynamics_derivatives": OutputKind(
        _derivatives("inverse_dynamics_derivatives"), ("x", "y", "ydot", *LOADS)
    ),
    "forward_dynamics_derivatives": OutputKind(
        _derivatives("forward_dynamics_derivatives"), ("x", "y", "tau", *LOADS)
    ),
}

EQUATIONS = ("mass_matrix", "forcing")
"""What is computed unless something else is asked for: [A] and {f} of Eq. (42)."""


def chosen(outputs: Iterable[str] | str) -> tuple[str, ...]:
    """`outputs` checked, in the order of `OUTPUTS`, each once.

    Raises:
        OptionError: If there is none, or one is unknown.
    """
    asked = several("outputs", "output", outputs, OUTPUTS)
    if not asked:
        raise OptionError(f"no output is asked for. There are {', '.join(OUTPUTS)}.")
    return asked


def available(system: System) -> tuple[str, ...]:
    """The outputs that a system has."""
    return tuple(name for name, kind in OUTPUTS.items() if not kind.subject or kind.subject.found(system))


def require_available(system: System, outputs: Iterable[str]) -> None:
    """Make sure that a system has what outputs are about.

    Raises:
        OptionError: If they are about something that there is not.
    """
    for name in outputs:
        subject = OUTPUTS[name].subject
        if subject and not subject.found(system):
            raise OptionError(f"output {name!r}: system {system.name!r} {subject.missing}")


def input_arrays(system: System) -> dict[Array, Elements]:
    """Every input array of a system and the symbols of its elements, in the order of the C arguments."""
    n, bodies = len(system.freedoms), system.number_of_bodies
    x = symbols.coordinates(system)
    units = ", ".join(_units(system))
    turning = "quaternions or angles" if "1" in units else "angles"
    doc = f"{{x}}, the coordinates: {turning}, then translations, Eq. (1)"
    arrays = {
        Array("x", (len(x),), units, doc): _named(x),
        Array("y", (n,), "rad/s, m/s", "{y}, the generalized speeds in the same order, Eq. (1)"): _named(
            symbols.speeds(system)
        ),
    }
    given = symbols.accelerations(system)
    forces = [symbols.generalized_force(freedom.body, freedom.index) for freedom in system.freedoms]
    arrays |= {
        Array("ydot", (n,), "rad/s^2, m/s^2", "{ydot}, derivatives of the generalized speeds"): _named(given),
        Array("tau", (n,), "N m, N", "generalized forces beside loads and gravity"): _named(forces),
    }
    if system.parameters:
        array = Array(PARAMETERS, (len(system.parameters),), "SI", "the run-time parameters")
        elements = tuple((symbols.parameter(p), f"p_{p.name}") for p in system.parameters)
        arrays = {array: elements, **arrays}
    if any(body.loads for body in system.bodies):
        every = [(k, axis) for k in range(1, bodies + 1) for axis in range(3)]
        doc = "acting on each body {}, body components, Eq. (37)"
        force = Array("force", (bodies, 3), "N", "{F'_K}, the force " + doc.format("at its mass centre"))
        torque = Array("torque", (bodies, 3), "N m", "{M'_K}, the torque " + doc.format("as a couple"))
        arrays[force] = _named([symbols.force(k, axis) for k, axis in every])
        arrays[torque] = _named([symbols.torque(k, axis) for k, axis in every])
    if any(point.loads for _, point in system.points):
        places = [(number, axis) for number in range(1, len(system.points) + 1) for axis in range(3)]
        doc = "on the body of each point, inertial components"
        acting = Array("point_force", (len(system.points), 3), "N", f"the force {doc}, acting there")
        couple = Array("point_moment", (len(system.points), 3), "N m", f"the moment {doc}, as a couple")
        arrays[acting] = _named([symbols.point_force(number, axis) for number, axis in places])
        arrays[couple] = _named([symbols.point_moment(number, axis) for number, axis in places])
    if system.depends_on_time:
        arrays[Array("t", (), "s", "the time")] = _named([symbols.time()])
    if system.prescribed:
        doc = "the prescribed freedoms: a row of values, one of rates, one of second derivatives"
        array = Array("prescribed", (3, len(system.prescribed)), "rad, m; rad/s, m/s; rad/s^2, m/s^2", doc)
        arrays[array] = _named(symbols.prescribed(system))
    return arrays


def _units(system: System) -> tuple[str, ...]:
    """Of the elements of {x}."""
    quaternions = any(coordinate.unit == "1" for coordinate in system.coordinates)
    return ("1", "rad", "m") if quaternions else ("rad", "m")


def output_array(system: System, name: str, methods: Mapping[str, str]) -> Array:
    """The array of an output, its documentation saying how it is derived."""
    array = OUTPUTS[name].array(system)
    return replace(array, doc=f"{array.doc}; by {methods[name]}")


def _named(elements: Sequence[Symbol]) -> Elements:
    return tuple((symbol, symbol.name) for symbol in elements)


def functions(system: System, outputs: Sequence[str]) -> dict[str, Signature]:
    """One function for every output, and `EVALUATE` for all of them where there are several."""
    available = [array.name for array in input_arrays(system)]
    read = {name: {*OUTPUTS[name].inputs, *EVERYWHERE} for name in outputs}
    groups: dict[str, tuple[str, ...]] = {name: (name,) for name in outputs}
    if len(outputs) > 1:
        groups[EVALUATE] = tuple(outputs)
    return {
        function: Signature(
            inputs=tuple(a for a in available if any(a in read[name] for name in group)),
            outputs=tuple(OUTPUTS[name].array(system).name for name in group),
        )
        for function, group in groups.items()
    }
