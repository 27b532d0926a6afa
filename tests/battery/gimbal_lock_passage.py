"""Motions that pass gimbal lock, and joint frames that are turned on the way: X9 and X10."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

import kanegen as kg
from kanegen.measure.truth import truth
from kanegen.program.precision import DOUBLE
from kanegen.reference.states import random_states
from kanegen.simulation import Trajectory, simulate
from tests.battery import scenes
from tests.battery.experiments import Point, Row, Size, count, experiment
from tests.battery.measurement import FLAGS, Floats, built, promise, worst

MOTION = ("coordinate_rates", "forward_dynamics", "body_poses")
SPIN = np.array([0.8, 0.0, 1.0])
"""Angular velocity in body components at 1 s (rad/s)."""

ZERO = (0.0, 0.0, 0.0)

FINE = 1e-13
"""Tolerance of the integrator where the equations are not stiff."""


def top(description: str) -> kg.System:
    """Return a symmetric body with moments 1, 1 and 2 on its mass centre, whose joint frame can be turned."""
    one, two, three = (kg.Parameter(f"turn{axis}", 0.0) for axis in (1, 2, 3))
    joint = kg.Joint(ZERO, (one, two, three), (True, True, True, False, False, False))
    inertia = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0))
    system = kg.System("top", (kg.Body("body", 0, 1.0, inertia, ZERO, joint),), ZERO)
    if description == "quaternion":
        return system.with_coordinates(description)
    return system.with_speeds(description)


@functools.cache
def library(description: str) -> kg.Library:
    """Return the compiled library, which serves all joint frames."""
    return kg.build(top(description), MOTION, flags=FLAGS)


def cross(a: Floats) -> Floats:
    """Return the (3, 3) matrix [a~] of the vector product a x."""
    one, two, three = a
    return np.array([[0.0, -three, two], [three, 0.0, -one], [-two, one, 0.0]])


def turned(angles: Floats) -> Floats:
    """Return the (3, 3) matrix from inertial to body components for 1-2-3 angles, from matrix
    exponentials."""
    frame: Floats = functools.reduce(
        lambda before, k: expm(-cross(np.eye(3)[k] * angles[k])) @ before, range(3), np.eye(3)
    )
    return frame


def orientation(time: float, distance: float) -> Floats:
    """Return the exact (3, 3) orientation of the body; at 1 s theta2 has its maximum, pi/2 - distance.

    In axes that turn about axis 3 at 1 rad/s, the angular velocity of the body is constant, and so is that of
    these axes.
    """
    late = time - 1.0
    frame = expm(-cross(np.add(SPIN, [0.0, 0.0, 1.0])) * late) @ turned(
        np.array([0.3, math.pi / 2 - distance, 0.0])
    )
    about: Floats = expm(cross(np.array([0.0, 0.0, late]))) @ frame
    return about


def start(distance: float, description: str) -> tuple[Floats, Floats]:
    """Return coordinates and speeds at 0 s."""
    c = orientation(0.0, distance)
    if description == "quaternion":
        return np.roll(Rotation.from_matrix(c.T).as_quat(), 1), _spin()
    x = np.array([math.atan2(-c[2, 1], c[2, 2]), math.asin(c[2, 0]), math.atan2(-c[1, 0], c[0, 0])])
    omega = _spin()
    (s2, c2), (s3, c3) = ((math.sin(angle), math.cos(angle)) for angle in x[1:])
    rates = np.linalg.solve([[c2 * c3, s3, 0.0], [-c2 * s3, c3, 0.0], [s2, 0.0, 1.0]], omega)
    return x, rates if description == "angle_rates" else omega


def _spin() -> Floats:
    """Return the angular velocity in body components at 0 s (rad/s)."""
    omega: Floats = expm(cross(np.array([0.0, 0.0, -1.0]))) @ SPIN
    return omega


@experiment("X9", "Passage next to gimbal lock")
def passage(size: Size) -> Iterator[Row]:
    """A body without efforts passes theta2 = pi/2 - delta; 2 s of DOP853 are compared with a closed form.

    The tolerance is 1e-11, or 1e-13 where the equations are not stiff. With angle rates as speeds the
    equations become stiff: 1e-6 rad from gimbal lock they take millions of evaluations, so they are compared
    at larger distances only. With angular velocities as speeds only the angles change fast. With a joint
    frame that is turned in time, or with a quaternion, nothing does.
    """
    near = size.pick([1e-1, 1e-6], [10.0**-k for k in range(1, 7)])
    far = [distance for distance in near if distance >= 1e-4]
    methods: dict[str, tuple[Callable[[float], tuple[int, float]], list[float], float, float]] = {
        "angle rates": (lambda distance: _straight(distance, "angle_rates", 1e-11), far, 1e5, 1e-6),
        "angular velocity": (
            lambda distance: _straight(distance, "angular_velocity", 1e-11),
            near,
            3e3,
            1e-11,
        ),
        "joint frame turned": (_with_reanchoring, near, 3e3, 1e-12),
        "quaternion": (lambda distance: _straight(distance, "quaternion", FINE), near, 3e3, 1e-12),
    }
    for name, (integrate, distances, most, limit) in methods.items():
        found = [(distance, *integrate(distance)) for distance in distances]
        over = f"delta = {distances[0]:g} to {distances[-1]:g} rad"
        calls = [Point(distance, float(evaluations), most) for distance, evaluations, _ in found]
        errors = [Point(distance, error, limit) for distance, _, error in found]
        yield worst(f"evaluations, {name}", calls, f"{most:g}", over)
        yield worst(f"orientation, {name}", errors, f"{limit:g}", over)


def _straight(distance: float, description: str, tolerance: float) -> tuple[int, float]:
    """Integrate without turning joint frames; return the number of evaluations and the error of
    orientation."""
    path = _over(library(description), *start(distance, description), 0.0, 2.0, tolerance)
    return path.evaluations, _error(path, distance)


def _with_reanchoring(distance: float) -> tuple[int, float]:
    """Do the same, but turn the joint frame after every quarter of a second in which theta2 exceeds 1 rad."""
    speeds, evaluations = "angular_velocity", 0
    system = top(speeds)
    x, y = start(distance, speeds)
    for quarter in range(8):
        system, x, y = kg.reanchored(system, x, y, margin=math.cos(1.0))
        turned_so = {parameter.name: parameter.value for parameter in system.parameters}
        path = _over(library(speeds).with_parameters(turned_so), x, y, quarter / 4, (quarter + 1) / 4, FINE)
        x, y, evaluations = path.x[-1], path.y[-1], evaluations + path.evaluations
    return evaluations, _error(path, distance)


def _over(
    compiled: kg.Library, x: Floats, y: Floats, begin: float, end: float, tolerance: float
) -> Trajectory:
    return simulate(compiled, x, y, [begin, end], "DOP853", tolerance=tolerance)


def _error(path: Trajectory, distance: float) -> float:
    found = path.library.body_poses(path.x[-1])[0, :3]
    return float(np.linalg.norm(found - orientation(path.times[-1], distance)) / math.sqrt(2))


@experiment("X10", "A joint frame turned on the way")
def anchoring(size: Size) -> Iterator[Row]:
    """Turning a joint frame changes the description only: poses, speeds, energy and accelerations must not
    change."""
    free = scenes.flags(3, "theta1", "theta2", "theta3")
    free[0] = True
    system = scenes.tree(np.random.default_rng(10), [0, 1, 2], free).with_speeds("angular_velocity")
    outputs = ("forward_dynamics", "kinetic_energy", "potential_energy", "body_poses")
    states = random_states(system, size.pick(2, 12), 10)
    poses: list[Point] = []
    energies: list[Point] = []
    accelerations: list[Point] = []
    changed: list[bool] = []
    places = [i for i, freedom in enumerate(system.freedoms) if freedom.is_angle]
    u = DOUBLE.roundoff
    for x, y in zip(states.x, states.y, strict=True):
        after = kg.reanchored(system, x, y, bodies=[1, 2, 3])
        old, new = built(system, outputs=outputs), built(after.system, outputs=outputs)
        moved = np.abs(old.body_poses(x) - new.body_poses(after.x))
        poses.append(Point(0.0, float(moved[:, :3].max()), 4 * 3 * u))
        jump = _energy(new, after.x, after.y) - _energy(old, x, y)
        size_of_parts = abs(old.kinetic_energy(x, y)) + abs(old.potential_energy(x))
        energies.append(Point(0.0, float(abs(jump) / size_of_parts), 8 * 3 * u))
        changed.append(bool((after.y[places] != y[places]).any()))
        exact = truth(system, x, y)
        right = exact["forward_dynamics"].value[places]
        apart = new.forward_dynamics(after.x, after.y)[places] - old.forward_dynamics(x, y)[places]
        limit = 2 * promise(exact, DOUBLE)
        accelerations.append(Point(0.0, float(np.linalg.norm(apart) / np.linalg.norm(right)), limit))
    over = f"{len(poses)} states, 3 bodies with three angles each, the root with translations"
    yield worst("rotations", poses, "4 N u", over)
    yield worst("energy", energies, "8 N u of its parts", over)
    yield worst("rates of angular velocities", accelerations, "2 T(u)", over)
    yield count("angular velocities", changed, over, "same bits")


def _energy(library: kg.Library, x: Floats, y: Floats) -> float:
    return float(library.kinetic_energy(x, y) + library.potential_energy(x))
