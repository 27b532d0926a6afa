"""Outputs that are the equations of motion, or what their solution gives."""

from __future__ import annotations

from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.outputs.inputs import LOADS
from kanegen.recursion.outputs.kind import OutputKind, Subject

REACTIONS = Subject(
    lambda system: system.reacting,
    "has no locked directions, all joints move freely. Lock some, or ask for inverse_dynamics.",
)

PRESCRIBED = Subject(
    lambda system: system.prescribed,
    'has no prescribed freedoms. Prescribe some in the model file, such as prescribed = ["theta1"] in a '
    "joint, or use System.with_prescribed.",
)


def _mass_matrix(system: System) -> Array:
    n = len(system.freedoms)
    return Array("A", (n, n), "kg m^2, kg m, kg", "[A], the generalized mass matrix, Eq. (43)")


def _forcing(system: System) -> Array:
    return Array("f", (len(system.freedoms),), "N m, N", "{f}, the right side of [A]{ydot} = {f}, Eq. (44)")


def _generalized_force(system: System) -> Array:
    doc = "[A]{ydot} - {f}, the generalized forces that {ydot} needs beside loads and gravity"
    return Array("generalized_force", (len(system.freedoms),), "N m, N", doc)


def _reaction_loads(system: System) -> Array:
    doc = (
        "what holds locked directions, beside loads and gravity: for an angle the moment about O_K and its "
        "axis, for a translation the force along it"
    )
    return Array("reaction_loads", (len(system.reacting),), "N m, N", doc)


def _acceleration(system: System) -> Array:
    doc = "{ydot} of [A]{ydot} = {f} + {tau}, Eq. (42)"
    return Array("acceleration", (len(system.freedoms),), "rad/s^2, m/s^2", doc)


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


DYNAMICS = {
    "mass_matrix": OutputKind(_mass_matrix, ("x",)),
    "forcing": OutputKind(_forcing, ("x", "y", *LOADS)),
    "inverse_dynamics": OutputKind(_generalized_force, ("x", "y", "ydot", *LOADS)),
    "reaction_loads": OutputKind(_reaction_loads, ("x", "y", "ydot", *LOADS), REACTIONS),
    "forward_dynamics": OutputKind(_acceleration, ("x", "y", "tau", *LOADS)),
    "error_estimate": OutputKind(_error_estimate, ("x", "y", "tau", *LOADS)),
    "regularity": OutputKind(_regularity, ("x",)),
}

EFFORTS = {
    "prescribed_efforts": OutputKind(_prescribed_efforts, ("x", "y", "ydot", *LOADS), PRESCRIBED),
}
