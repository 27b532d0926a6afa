"""Outputs that are about where bodies and points are and how they move."""

from __future__ import annotations

from kanegen.model.system import System
from kanegen.program.ir import Array, Condition
from kanegen.recursion.outputs.inputs import coordinate_units
from kanegen.recursion.outputs.kind import OutputKind, Subject

POINTS = Subject(
    lambda system: system.points,
    "has no points. Give a body points in the model file, such as points = {tool = [0, 0, 0.1]}, or use "
    "System.with_points.",
)


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
    units = ", ".join({"1": "1/s"}.get(unit, f"{unit}/s") for unit in coordinate_units(system))
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


KINEMATICS = {
    "body_poses": OutputKind(_body_poses, ("x",)),
    "coordinate_rates": OutputKind(_coordinate_rates, ("x", "y")),
    "point_positions": OutputKind(_point_positions, ("x",), POINTS),
    "point_velocities": OutputKind(_point_velocities, ("x", "y"), POINTS),
    "point_accelerations": OutputKind(_point_accelerations, ("x", "y", "ydot"), POINTS),
    "point_jacobians": OutputKind(_point_jacobians, ("x",), POINTS),
}
