"""CasADi's C for a system; needs CasADi to be imported at all."""

from __future__ import annotations

import casadi

from kanegen.model.system import System
from kanegen.studies.bench.peers.casadi_dynamics import articulated, factorised
from kanegen.studies.bench.peers.casadi_equations import forcing, mass_matrix
from kanegen.studies.bench.peers.casadi_joints import moved
from kanegen.studies.bench.peers.joints import single_joints


def code(system: System, derives: bool = False) -> dict[str, str]:
    """C of [A] and {f}, of forward dynamics in the cheaper of two ways, and of its Jacobian likewise."""
    gravity, n = system.values().gravity, len(system.freedoms)
    x, y, tau = (casadi.SX.sym(name, n) for name in ("x", "y", "tau"))
    tree = moved(single_joints(system), x)
    matrix, vector = mass_matrix(tree), forcing(tree, gravity, y)
    equations = casadi.Function("equations", [x, y], [casadi.densify(matrix), casadi.densify(vector)])
    ways = [articulated(tree, gravity, y, tau), factorised(tree, matrix, vector + tau)]
    dynamics = [casadi.Function("dynamics", [x, y, tau], [casadi.densify(way)]) for way in ways]
    functions = [equations, _cheapest(dynamics)]
    if derives:
        inputs = casadi.vertcat(x, y, tau)
        # Row-major as everybody's, where CasADi stores columns.
        jacobians = [casadi.densify(casadi.jacobian(way, inputs)).T for way in ways]
        functions.append(
            _cheapest([casadi.Function("derivatives", [x, y, tau], [jacobian]) for jacobian in jacobians])
        )
    return {f"{function.name()}.c": _text(function) for function in functions}


def _cheapest(functions: list[casadi.Function]) -> casadi.Function:
    return min(functions, key=lambda function: function.n_instructions())


def _text(function: casadi.Function) -> str:
    generator = casadi.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    text: str = generator.dump()
    return text
