"""C that CasADi generates for the same quantities of the same joints."""

from __future__ import annotations

from pathlib import Path

import kanegen as kg
from benchmarks.peers.building import MissingError, Setting, compiled, driver
from benchmarks.peers.joints import single_joints

try:
    import casadi

    from benchmarks.peers.casadi_dynamics import articulated, factorised
    from benchmarks.peers.casadi_equations import forcing, mass_matrix
    from benchmarks.peers.casadi_joints import moved
except ImportError:
    casadi = None


def version() -> str:
    """CasADi's version.

    Raises:
        MissingError: If it is not installed.
    """
    if casadi is None:
        raise MissingError("the Python package casadi is not installed")
    return casadi.__version__


def code(system: kg.System) -> dict[str, str]:
    """CasADi's C, forward dynamics in the cheaper of two ways.

    Raises:
        MissingError: If CasADi is not installed.
    """
    version()
    gravity, n = system.values().gravity, len(system.freedoms)
    x, y, tau = (casadi.SX.sym(name, n) for name in ("x", "y", "tau"))
    tree = moved(single_joints(system), x)
    matrix, vector = mass_matrix(tree), forcing(tree, gravity, y)
    equations = casadi.Function("equations", [x, y], [casadi.densify(matrix), casadi.densify(vector)])
    ways = [
        articulated(tree, gravity, y, tau),
        factorised(tree, matrix, vector + tau),
    ]
    dynamics = [casadi.Function("dynamics", [x, y, tau], [casadi.densify(way)]) for way in ways]
    cheapest = min(dynamics, key=lambda function: function.n_instructions())
    return {f"{function.name()}.c": _text(function) for function in (equations, cheapest)}


def program(system: kg.System, files: dict[str, str], setting: Setting) -> Path:
    """The driver with `files` in it."""
    return compiled(f"casadi_{system.name}", {"casadi.c": driver("casadi.c"), **files}, setting.flags)


def _text(function: casadi.Function) -> str:
    generator = casadi.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    text: str = generator.dump()
    return text
