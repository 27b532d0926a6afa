"""The part of the table of outputs about motion alone: poses, velocities, accelerations and Jacobians."""

from __future__ import annotations

from kanegen.model.system import System
from kanegen.program.ir import Array, Condition
from kanegen.recursion.coordinate_rates import coordinate_rates
from kanegen.recursion.frame_motion import (
    frame_accelerations,
    frame_bias_accelerations,
    frame_jacobians,
    frame_velocities,
)
from kanegen.recursion.kinematics import body_poses
from kanegen.recursion.outputs.inputs import coordinate_units
from kanegen.recursion.outputs.output import Output, Recursion, Subject
from kanegen.recursion.points import point_accelerations, point_jacobians, point_positions, point_velocities

POINTS = Subject(
    lambda system: system.points,
    "has no points. Give a body points in the model file, such as points = {tool = [0, 0, 0.1]}, or use "
    "System.with_points, on the command line --points.",
)


def _chosen(system: System) -> str:
    """Return what has the rows of outputs about frames: every body, or what the system selects."""
    if system.poses is None:
        return "body"
    bodies = {body.name for body in system.bodies}
    return "chosen body" if bodies.issuperset(system.poses) else "chosen frame"


def _poses_doc(system: System) -> str:
    """Return the documentation of `body_poses`."""
    which = _chosen(system)
    if which == "chosen frame":
        return (
            "for each chosen frame the rows of its [R], which takes inertial components to its own, Eq. (3), "
            "then its origin, Eq. (22), inertial components"
        )
    return (
        f"for each {which} the rows of [R_K], Eq. (3), which takes inertial to body components, "
        "then its origin {p_O_K}, Eq. (22), inertial components"
    )


def _six_rows(system: System, name: str, unit: str, what: str) -> Array:
    """Return the array of an output with six components for each frame."""
    doc = f"for each {_chosen(system)} {what}, inertial components"
    return Array(name, (len(system.pose_names), 6), unit, doc)


def _rate_units(system: System) -> str:
    """Return the units of {xdot}, those of {x} per second."""
    return ", ".join({"1": "1/s"}.get(unit, f"{unit}/s") for unit in coordinate_units(system))


KINEMATICS = (
    Output(
        "body_poses",
        lambda system: Array("body_poses", (len(system.pose_names), 4, 3), "1, m", _poses_doc(system)),
        ("x",),
        Recursion("turns of the joints", body_poses),
    ),
    Output(
        "frame_velocities",
        lambda system: _six_rows(
            system,
            "frame_velocities",
            "rad/s, m/s",
            "its angular velocity, Eq. (11), then the velocity of its origin, Eq. (27)",
        ),
        ("x", "y"),
        Recursion("velocities of the bodies", frame_velocities),
    ),
    Output(
        "frame_accelerations",
        lambda system: _six_rows(
            system,
            "frame_accelerations",
            "rad/s^2, m/s^2",
            "its angular acceleration, Eq. (20), then that of its origin, Eq. (33), without gravity",
        ),
        ("x", "y", "ydot"),
        Recursion("accelerations of the bodies", frame_accelerations),
    ),
    Output(
        "frame_bias_accelerations",
        lambda system: _six_rows(
            system,
            "frame_bias_accelerations",
            "rad/s^2, m/s^2",
            "its accelerations for {ydot} = 0, angular, then of its origin: d/dt of its Jacobian times {y}",
        ),
        ("x", "y"),
        Recursion("accelerations of the bodies", frame_bias_accelerations),
    ),
    Output(
        "frame_jacobians",
        lambda system: Array(
            "frame_jacobians",
            (len(system.pose_names), 6, len(system.freedoms)),
            "1, m",
            f"for each {_chosen(system)} the partial velocities by {{y}}: of its angular velocity, Eq. (15), "
            "then of its origin, Eq. (32), inertial components: jacr, then jacp of MuJoCo's mj_jac; with the "
            "linear rows first Pinocchio's LOCAL_WORLD_ALIGNED, and LOCAL after [R] times either half",
        ),
        ("x",),
        Recursion("turns of the joints", frame_jacobians),
    ),
    Output(
        "coordinate_rates",
        lambda system: Array(
            "xdot",
            (len(system.coordinates),),
            _rate_units(system),
            "{xdot}, the rates of the coordinates, Eqs. (9), (45)",
            Condition("squared divisor of Eq. (9)", "the angles have no rates"),
        ),
        ("x", "y"),
        Recursion("turns of the joints", coordinate_rates),
    ),
    Output(
        "point_positions",
        lambda system: Array(
            "point_positions",
            (len(system.points), 3),
            "m",
            "{p_P} of each point from the inertial origin, Eq. (22), inertial components",
        ),
        ("x",),
        Recursion("turns of the joints", point_positions),
        POINTS,
    ),
    Output(
        "point_velocities",
        lambda system: Array(
            "point_velocities",
            (len(system.points), 3),
            "m/s",
            "{v_P} of each point, Eq. (27), inertial components",
        ),
        ("x", "y"),
        Recursion("velocities of the bodies", point_velocities),
        POINTS,
    ),
    Output(
        "point_accelerations",
        lambda system: Array(
            "point_accelerations",
            (len(system.points), 3),
            "m/s^2",
            "{a_P} of each point, Eq. (33), without gravity, inertial components",
        ),
        ("x", "y", "ydot"),
        Recursion("accelerations of the bodies", point_accelerations),
        POINTS,
    ),
    Output(
        "point_jacobians",
        lambda system: Array(
            "point_jacobians",
            (len(system.points), 3, len(system.freedoms)),
            "m, 1",
            "[v_P,y] of each point, its partial velocities, Eq. (32), inertial components",
        ),
        ("x",),
        Recursion("turns of the joints", point_jacobians),
        POINTS,
    ),
)
"""The entries of frames, coordinates and points, in the order of the generated C."""

MOTIONS_OF_FRAMES = (
    "body_poses",
    "frame_velocities",
    "frame_accelerations",
    "frame_bias_accelerations",
    "frame_jacobians",
)
"""The outputs about motion with rows for each frame that the system selects."""
