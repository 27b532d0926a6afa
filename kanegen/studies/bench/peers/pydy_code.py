"""The C of [A] and {f} of a model, derived as a user of SymPy and PyDy derives it, and printed.

python -m kanegen.studies.bench.peers.pydy_code MODEL.toml
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import sympy
from pydy.codegen.c_code import CMatrixGenerator
from sympy.physics import mechanics

from kanegen.model.arrays import Floats
from kanegen.readers import load
from kanegen.studies.bench.peers.joints import KINDS, Joint, Mass, single_joints


def main() -> None:
    """Read a model file and print the C."""
    system = load(sys.argv[1])
    print(code(single_joints(system), system.values().gravity))


def code(joints: Sequence[Joint], gravity: Floats) -> str:
    """Return the C function `evaluate(double x[], double y[], double A[], double f[])`."""
    n = len(joints)
    x, y = (list(mechanics.dynamicsymbols(f"{letter}:{n}")) for letter in "xy")
    ground = mechanics.ReferenceFrame("N")
    origin = mechanics.Point("O")
    origin.set_vel(ground, 0)
    carriers = [(ground, origin)]
    bodies, loads = [], []
    for number, joint in enumerate(joints, start=1):
        column = joint.columns[0]
        carriers.append(_beyond(joint, carriers[joint.parent], x[column], y[column], number, ground))
        if joint.body.mass:
            body = _body(joint.body, *carriers[-1], number, ground)
            bodies.append(body)
            loads.append((body.masscenter, body.mass * _vector(gravity, ground)))
    rates = [speed - coordinate.diff() for coordinate, speed in zip(x, y, strict=True)]
    method = mechanics.KanesMethod(ground, q_ind=x, u_ind=y, kd_eqs=rates)
    method.kanes_equations(bodies, loads)
    motors = {joint.columns[0]: _number(joint.armature[0]) for joint in joints}
    matrix = method.mass_matrix + sympy.diag(*(motors[i] for i in range(n)))
    _, source = CMatrixGenerator((x, y), (matrix, method.forcing)).doprint()
    return str(source)


Carrier = tuple[mechanics.ReferenceFrame, mechanics.Point]


def _beyond(
    joint: Joint,
    carrier: Carrier,
    coordinate: sympy.Expr,
    speed: sympy.Expr,
    number: int,
    ground: mechanics.ReferenceFrame,
) -> Carrier:
    """Return the frame and the origin beyond a joint."""
    lower, base = carrier
    index = KINDS.index(joint.kind)
    before = mechanics.ReferenceFrame(f"B{number}")
    before.orient_explicit(lower, _matrix(joint.placement.rotation))
    before.set_ang_vel(lower, 0)
    axis = (before.x, before.y, before.z)[index % 3]
    point = base.locatenew(f"P{number}", _vector(joint.placement.position, lower))
    point.v2pt_theory(base, ground, lower)
    if index < 3:
        frame = mechanics.ReferenceFrame(f"F{number}")
        frame.orient_axis(before, axis, coordinate)
        frame.set_ang_vel(before, speed * axis)
        return frame, point
    origin = point.locatenew(f"O{number}", coordinate * axis)
    arm = origin.pos_from(base)
    origin.set_vel(ground, base.vel(ground) + lower.ang_vel_in(ground).cross(arm) + speed * axis)
    return before, origin


def _body(
    mass: Mass,
    frame: mechanics.ReferenceFrame,
    origin: mechanics.Point,
    number: int,
    ground: mechanics.ReferenceFrame,
) -> mechanics.RigidBody:
    """Return the rigid body beyond a joint."""
    center = origin.locatenew(f"G{number}", _vector(mass.center, frame))
    center.v2pt_theory(origin, ground, frame)
    entries = _matrix(mass.central_inertia)
    order = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
    inertia = mechanics.inertia(frame, *(entries[pair] for pair in order))
    return mechanics.RigidBody(f"body{number}", center, frame, _number(mass.mass), (inertia, center))


def _vector(values: Floats, frame: mechanics.ReferenceFrame) -> mechanics.Vector:
    """Return a vector with components in `frame`."""
    x, y, z = (_number(value) for value in values)
    return x * frame.x + y * frame.y + z * frame.z


def _matrix(values: Floats) -> sympy.Matrix:
    """Return a matrix of SymPy numbers."""
    return sympy.Matrix(3, 3, [_number(value) for value in values.ravel()])


def _number(value: float) -> sympy.Expr:
    """Return a whole number as an Integer, so that SymPy removes zeros and ones, and any other as a Float."""
    return sympy.Integer(int(value)) if float(value).is_integer() else sympy.Float(float(value))


if __name__ == "__main__":
    main()
