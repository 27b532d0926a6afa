"""Derives the outputs that are asked for, one recursion each, on shared definitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from kanegen.model.system import System
from kanegen.program.constants import DOUBLES, Constants
from kanegen.recursion import factorisation
from kanegen.recursion.coordinate_rates import coordinate_rates
from kanegen.recursion.derived import Derived
from kanegen.recursion.first_moment import mass_center, potential_energy
from kanegen.recursion.forcing import forcing, inverse_dynamics, prescribed_efforts
from kanegen.recursion.forward_dynamics import ArticulatedBodies
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.recursion.momentum import kinetic_energy, momentum
from kanegen.recursion.points import point_accelerations, point_jacobians, point_positions, point_velocities
from kanegen.recursion.poses import body_poses
from kanegen.recursion.reactions import reaction_loads
from kanegen.recursion.refinement import UNREFINED, Refinement, Solution, Solver
from kanegen.recursion.tree import Tree, apart, tree
from kanegen.symbolic.definitions import Definition

Recursion = Callable[[Tree], Derived]

RECURSIONS: dict[str, dict[str, Recursion]] = {
    "mass_matrix": {"composite bodies": mass_matrix},
    "forcing": {"recursion of forces": forcing},
    "inverse_dynamics": {"recursion of forces": inverse_dynamics},
    "reaction_loads": {"recursion of forces": reaction_loads},
    "kinetic_energy": {"velocities of the bodies": kinetic_energy},
    "potential_energy": {"first moments of mass": potential_energy},
    "momentum": {"velocities of the bodies": momentum},
    "mass_center": {"first moments of mass": mass_center},
    "body_poses": {"turns of the joints": body_poses},
    "coordinate_rates": {"turns of the joints": coordinate_rates},
    "point_positions": {"turns of the joints": point_positions},
    "point_velocities": {"velocities of the bodies": point_velocities},
    "point_accelerations": {"accelerations of the bodies": point_accelerations},
    "point_jacobians": {"turns of the joints": point_jacobians},
    "prescribed_efforts": {"recursion of forces": prescribed_efforts},
}
"""The ways to derive each output, by name."""

SOLVERS: dict[str, Callable[[Tree], Solver]] = {
    "articulated bodies": ArticulatedBodies,
    "factorisation": factorisation.Factorisation,
}
"""The ways to solve [A]{ydot} = {b}, by name."""

SOLVED: dict[str, Callable[[Solution], Derived]] = {
    "forward_dynamics": Solution.forward_dynamics,
    "error_estimate": Solution.error_estimate,
    "regularity": Solution.regularity,
}
"""The outputs that come of a solution, all of the same one."""

Methods = Mapping[str, str]
"""For every output the way that is taken."""


@dataclass(frozen=True)
class RecursiveForm:
    """Outputs in terms of definitions.

    Attributes:
        system: What was derived.
        methods: How.
        definitions: In order of evaluation; every expression is small.
        outputs: By name of output.
    """

    system: System
    methods: Methods
    definitions: tuple[Definition, ...]
    outputs: dict[str, Derived]


def methods(system: System, outputs: Sequence[str], solver: str = "cheapest") -> tuple[Methods, ...]:
    """The ways to derive `outputs` among which the operation count may choose.

    Args:
        system: The tree.
        outputs: Names of outputs.
        solver: The way to {ydot}, or "cheapest" for any that loses no accuracy.
    """
    ways = _solvers(system, solver) if SOLVED.keys() & set(outputs) else tuple(SOLVERS)[:1]
    return tuple(
        {name: way if name in SOLVED else next(iter(RECURSIONS[name])) for name in outputs} for way in ways
    )


def _solvers(system: System, solver: str) -> tuple[str, ...]:
    if solver in SOLVERS:
        return (solver,)
    every = tuple(SOLVERS)
    return every if factorisation.worth_trying(system) else every[:1]


def recursive_form(
    system: System, methods: Methods, constants: Constants = DOUBLES, refinement: Refinement = UNREFINED
) -> RecursiveForm:
    """Derive outputs together, sharing every intermediate.

    Args:
        system: The tree.
        methods: The outputs, and how to derive each: keys of `RECURSIONS`, or of `SOLVERS`.
        constants: How exact sines of constant angles are.
        refinement: Of {ydot}.
    """
    prepared = tree(system, constants)
    outputs: dict[str, Derived] = {}
    solution: Solution | None = None
    for name, way in methods.items():
        if name in SOLVED:
            solution = solution or Solution(
                SOLVERS[way](_solved_tree(prepared, methods, refinement)), refinement
            )
            outputs[name] = SOLVED[name](solution)
        else:
            outputs[name] = RECURSIONS[name][way](prepared)
    return RecursiveForm(system, methods, prepared.definitions.listed(), outputs)


def _solved_tree(prepared: Tree, methods: Methods, refinement: Refinement) -> Tree:
    """Corrections need the inertia of every body by itself."""
    return apart(prepared) if refinement.steps or "error_estimate" in methods else prepared


def measuring_form(system: System, solver: str) -> RecursiveForm:
    """The size of a solution and of its first correction, "sizes"; see `Solution.sizes`."""
    prepared = tree(system)
    sizes = Solution(SOLVERS[solver](prepared)).sizes()
    return RecursiveForm(system, {}, prepared.definitions.listed(), {"sizes": sizes})
