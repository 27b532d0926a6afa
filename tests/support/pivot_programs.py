"""Programs with pivots that some states make singular, and such states."""

import numpy as np

from kanegen.artifacts import with_artifacts
from kanegen.c import render
from kanegen.program.check import check
from kanegen.program.ir import Module, Op, Output, Program
from tests.support.handmade import Listing, X, Y, array, description

TAU, YDOT = array("tau", 2), array("ydot", 2)
ACCELERATION, GENERALIZED = array("acceleration", 2), array("generalized_force", 2)


def forward():
    """Return a program with pivots (x_1, x_0 - 1/x_1) and accelerations (y + tau)/pivot."""
    k = Listing()
    x, y, tau = ([k.read(name, i) for i in range(2)] for name in ("x", "y", "tau"))
    outer = k(Op.MULTIPLY, x[1], k.number(1.0), name="D_2")
    inner = k(Op.SUBTRACT, x[0], k(Op.DIVIDE, k.number(1.0), outer))
    ydot = [k(Op.DIVIDE, k(Op.ADD, a, b), d) for a, b, d in zip(y, tau, (inner, outer), strict=True)]
    output = Output(ACCELERATION, tuple(ydot), (inner, outer))
    return check(Program((X, Y, TAU), tuple(k.instructions), (output,)))


def inverse():
    """Return a program without pivots: generalized forces x ydot, plus y_0 in the first."""
    k = Listing()
    values = [k(Op.MULTIPLY, k.read("x", i), k.read("ydot", i)) for i in range(2)]
    values[0] = k(Op.ADD, values[0], k.read("y", 0))
    return check(k.program([X, Y, YDOT], {GENERALIZED: values}))


def source_with_pivots():
    """Return the C of both programs."""
    functions = {"inverse_dynamics": inverse(), "forward_dynamics": forward()}
    return with_artifacts(render(description(parameters=False, loads=False), Module(None, functions), {}))


GOOD = np.array([[2.0, 3.0], [1.0, 4.0], [0.5, 2.5], [1001.0, 1e-3], [5.0, 5.0]])
"""States x whose pivots are all positive."""


BAD = [
    ("elbow", [1.0, 0.0]),
    ("elbow", [1.0, -0.0]),
    ("elbow", [-1.0, -1.0]),
    ("elbow", [1.0, np.nan]),
    ("elbow", [0.0, -np.inf]),
    ("arm.theta1", [0.5, 2.0]),
    ("arm.theta1", [-1.0, 1.0]),
    ("arm.theta1", [np.nan, 1.0]),
]
"""The freedom whose pivot is the first to be computed that is not positive, and x."""
