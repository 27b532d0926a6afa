"""CasADi's C for a system: [A] and {f} as CasADi expressions, and the functions made of them.

[A] comes from composite bodies, {f} from inverse dynamics without acceleration, as in R. Featherstone, Rigid
Body Dynamics Algorithms (2008), chapters 5 and 6. Importing this module needs CasADi.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi
from casadi import SX

from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.studies.bench.peers.casadi_dynamics import articulated, factorised
from kanegen.studies.bench.peers.casadi_joints import Motion, Moved, Tree, moved
from kanegen.studies.bench.peers.joints import single_joints


def functions(system: System) -> dict[str, str]:
    """Generate the C of [A] and {f} and of forward dynamics, by the method with fewer instructions.

    Returns:
        Texts by name of the file.
    """
    problem = _Symbols.of(system)
    matrix, vector = mass_matrix(problem.tree), forcing(problem.tree, problem.gravity, problem.y)
    equations = casadi.Function(
        "equations", [problem.x, problem.y], [casadi.densify(matrix), casadi.densify(vector)]
    )
    methods = [casadi.Function("dynamics", problem.all, [casadi.densify(one)]) for one in problem.methods]
    return _texts([equations, _cheapest(methods)])


def derivatives(system: System) -> dict[str, str]:
    """Generate the C of the derivatives of forward and inverse dynamics.

    Returns:
        Texts by name of the file.
    """
    problem = _Symbols.of(system)
    forward = [_jacobian("derivatives", method, problem.all) for method in problem.methods]
    loads = inverse_dynamics(problem.tree, problem.gravity, problem.y, problem.tau)
    return _texts([_cheapest(forward), _jacobian("inverse_derivatives", loads, problem.all)])


@dataclass(frozen=True)
class _Symbols:
    """The symbols of a system: coordinates, speeds, generalized forces or accelerations, moved joints."""

    x: SX
    y: SX
    tau: SX
    tree: Tree
    gravity: Floats

    @classmethod
    def of(cls, system: System) -> _Symbols:
        """Return new symbols for a system."""
        x, y, tau = (casadi.SX.sym(name, len(system.freedoms)) for name in ("x", "y", "tau"))
        return cls(x, y, tau, moved(single_joints(system), x), system.values().gravity)

    @property
    def all(self) -> list[SX]:
        """Coordinates, speeds and generalized forces."""
        return [self.x, self.y, self.tau]

    @property
    def methods(self) -> list[SX]:
        """The accelerations {ydot} by every method."""
        right = forcing(self.tree, self.gravity, self.y) + self.tau
        return [
            articulated(self.tree, self.gravity, self.y, self.tau),
            factorised(self.tree, mass_matrix(self.tree), right),
        ]


def _texts(found: list[casadi.Function]) -> dict[str, str]:
    """Return the C of functions by name of the file."""
    return {f"{function.name()}.c": _text(function) for function in found}


def _jacobian(name: str, values: SX, inputs: list[SX]) -> casadi.Function:
    """Return the function of the derivatives of values, row by row; CasADi stores columns."""
    jacobian = casadi.jacobian(values, casadi.vertcat(*inputs))
    return casadi.Function(name, inputs, [casadi.densify(jacobian).T])


def _cheapest(functions: list[casadi.Function]) -> casadi.Function:
    """Return the function with the fewest instructions."""
    return min(functions, key=lambda function: function.n_instructions())


def _text(function: casadi.Function) -> str:
    """Return the C code of a CasADi function."""
    generator = casadi.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    text: str = generator.dump()
    return text


Composite = tuple[SX, SX, SX]
"""The mass (kg), first moment (kg m) and inertia about the origin (kg m^2) of a composite body."""


def forcing(tree: Tree, gravity: Floats, y: SX) -> SX:
    """Return {f}, minus the generalized forces of inverse dynamics without acceleration."""
    return -inverse_dynamics(tree, gravity, y, SX(len(tree), 1))


def inverse_dynamics(tree: Tree, gravity: Floats, y: SX, ydot: SX) -> SX:
    """Return the generalized forces that accelerations require, by the recursion of Newton and Euler."""
    ground = Motion(SX(3, 1), SX(3, 1), SX(-gravity))
    motions: list[Motion] = []
    for at in tree:
        moved = at.outward(motions[at.parent - 1] if at.parent else ground, y[at.column])
        motions.append(at.accelerated(moved, ydot[at.column]))
    loads = [_load(at, motion) for at, motion in zip(tree, motions, strict=True)]
    result = SX(len(tree), 1)
    for i in reversed(range(len(tree))):
        at, (moment, force) = tree[i], loads[i]
        result[at.column] = at.own(moment, force) + at.armature * ydot[at.column]
        if at.parent:
            lower, carried = loads[at.parent - 1], at.inward(moment, force)
            loads[at.parent - 1] = (lower[0] + carried[0], lower[1] + carried[1])
    return result


def mass_matrix(tree: Tree) -> SX:
    """Return [A] by the algorithm of composite bodies."""
    bodies: list[Composite] = [(at.mass, at.moment, at.inertia) for at in tree]
    result = SX(len(tree), len(tree))
    for i in reversed(range(len(tree))):
        at, (mass, first, inertia) = tree[i], bodies[i]
        if at.angle:
            moment, force = inertia @ at.axis, casadi.cross(at.axis, first)
        else:
            moment, force = casadi.cross(first, at.axis), mass * at.axis
        result[at.column, at.column] = at.own(moment, force) + at.armature
        step = at
        while step.parent:
            moment, force = step.inward(moment, force)
            step = tree[step.parent - 1]
            result[step.column, at.column] = result[at.column, step.column] = step.own(moment, force)
        if at.parent:
            lower, carried = bodies[at.parent - 1], _carried(at, mass, first, inertia)
            bodies[at.parent - 1] = (lower[0] + carried[0], lower[1] + carried[1], lower[2] + carried[2])
    return result


def _load(at: Moved, motion: Motion) -> tuple[SX, SX]:
    """Return the moment about the origin and the force that a motion of the body beyond a joint requires."""
    velocity, first = motion.velocity, at.moment
    force = at.mass * motion.acceleration + casadi.cross(motion.rate, first)
    force += casadi.cross(velocity, casadi.cross(velocity, first))
    moment = at.inertia @ motion.rate + casadi.cross(velocity, at.inertia @ velocity)
    return moment + casadi.cross(first, motion.acceleration), force


def _carried(at: Moved, mass: SX, first: SX, inertia: SX) -> Composite:
    """Return a composite body in the frame before its joint."""
    arm, first = casadi.skew(at.position), at.rotation @ first
    cross = arm @ casadi.skew(first)
    inertia = at.rotation @ inertia @ at.rotation.T - cross - cross.T - mass * arm @ arm
    return mass, first + mass * at.position, inertia
