"""Derivation of several outputs together: one recursion each, on shared definitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.program.constants import DOUBLE_CONSTANTS, Constants
from kanegen.recursion import factorisation
from kanegen.recursion.articulated_bodies import ArticulatedBodies
from kanegen.recursion.outputs.derivatives import PARTS, SOLUTION_BY_STATE, SOLUTION_PARTS
from kanegen.recursion.outputs.output import OfSolution, Recursion
from kanegen.recursion.outputs.table import DERIVED
from kanegen.recursion.pivot_margins import PivotMargins
from kanegen.recursion.refinement import UNREFINED, Refinement
from kanegen.recursion.rotors import articulated_bodies_take
from kanegen.recursion.solution import Solution
from kanegen.recursion.solver import Solver
from kanegen.recursion.tree import Derived, Tree, tree, with_own_inertias
from kanegen.symbolic.definitions import Definition

ARTICULATED = "articulated bodies"
"""Name of the solver that can derive derivatives itself."""

SOLVERS: dict[str, Callable[[Tree], Solver]] = {
    ARTICULATED: ArticulatedBodies,
    "factorisation": factorisation.Factorisation,
}
"""The solvers of [A]{ydot} = {b} by name; the first is the most accurate."""

MOST_FREEDOMS_COMPARED = 10
"""Largest number of freedoms for which derivatives are also derived by tangents alone, if that costs less."""

Methods = Mapping[str, str]
"""The method by which each output is derived: a name of an algorithm or of a solver."""


@dataclass(frozen=True)
class RecursiveForm:
    """Outputs in terms of definitions.

    Attributes:
        system: The system that the outputs were derived for.
        methods: The method by output.
        definitions: Intermediate values in order of evaluation; every expression is small.
        outputs: The derived entries by name of output.
        refinement: Iterative refinement of {ydot}.
    """

    system: System
    methods: Methods
    definitions: tuple[Definition, ...]
    outputs: dict[str, Derived]
    refinement: Refinement = UNREFINED


def methods(system: System, outputs: Sequence[str], solver: str = "cheapest") -> tuple[Methods, ...]:
    """Return the ways to derive `outputs` among which the operation count may choose.

    Args:
        system: The tree.
        outputs: Names of outputs that are no derivatives, and of parts of these; see `outputs.prerequisites`.
        solver: Name of the solver for {ydot}, or "cheapest" for every solver that loses no accuracy.
    """
    derivations = {name: DERIVED[name].derivation for name in outputs}
    solved = any(isinstance(derivation, OfSolution) for derivation in derivations.values())
    solvers = _solvers(system, solver) if solved else tuple(SOLVERS)[:1]
    ways = tuple(
        {
            name: derivation.method if isinstance(derivation, Recursion) else way
            for name, derivation in derivations.items()
        }
        for way in solvers
    )
    by_tangents: tuple[Methods, ...] = ()
    if not PARTS.keys().isdisjoint(outputs) and len(system.freedoms) <= MOST_FREEDOMS_COMPARED:
        by_tangents = tuple({name: way[name] for name in way if name not in PARTS} for way in ways)
    return tuple(one for way in ways for one in _with_one_part(way)) + by_tangents


def _with_one_part(way: Methods) -> tuple[Methods, ...]:
    """Return a way with one of the parts that have derivatives of {ydot} at a time, if it has both."""
    if SOLUTION_BY_STATE not in way:
        return (way,)
    left_out = (SOLUTION_BY_STATE, SOLUTION_PARTS)[: 2 if way[SOLUTION_BY_STATE] == ARTICULATED else 1]
    return tuple({name: way[name] for name in way if name != part} for part in left_out)


def _solvers(system: System, solver: str) -> tuple[str, ...]:
    """Return the names of the solvers to try.

    Raises:
        OptionError: If the solver that is asked for does not take all rotors of the system.
    """
    every = tuple(SOLVERS) if articulated_bodies_take(system) else tuple(SOLVERS)[1:]
    if solver in SOLVERS:
        if solver not in every:
            raise OptionError(
                f"solver {solver!r} takes no rotor whose carrier is apart from the freedom that it drives: "
                "neither its body nor the lower one, or with other turns between; and none of a freedom that "
                f"a coupling names. Take {every[0]!r}."
            )
        return (solver,)
    return every if factorisation.worth_trying(system) else every[:1]


def derive(
    system: System,
    methods: Methods,
    constants: Constants = DOUBLE_CONSTANTS,
    refinement: Refinement = UNREFINED,
) -> RecursiveForm:
    """Derive outputs together, sharing every intermediate.

    Args:
        system: The tree.
        methods: The outputs and the method of each, from `methods`.
        constants: Precision of the sines of constant angles.
        refinement: Iterative refinement of {ydot}.
    """
    prepared = tree(system, constants)
    outputs: dict[str, Derived] = {}
    solution: Solution | None = None
    for name, method in methods.items():
        derivation = DERIVED[name].derivation
        if isinstance(derivation, OfSolution):
            if solution is None:
                solver = SOLVERS[method](_solved_tree(prepared, methods, refinement))
                solution = Solution(solver, refinement)
            outputs[name] = derivation.derive(solution)
        elif isinstance(derivation, Recursion):
            outputs[name] = derivation.derive(prepared)
    return RecursiveForm(system, methods, prepared.definitions.listed(), outputs, refinement)


def _solved_tree(prepared: Tree, methods: Methods, refinement: Refinement) -> Tree:
    """Return the tree for a solver; for corrections every body keeps its own inertia."""
    return with_own_inertias(prepared) if refinement.steps or "error_estimate" in methods else prepared


def derive_losses(system: System, solver: str) -> RecursiveForm:
    """Derive the losses of the pivots of a solver and their bounds, under the names "losses" and "bounds"."""
    prepared = tree(system)
    margins = PivotMargins(SOLVERS[solver](prepared))
    outputs = {"losses": Derived(margins.losses()), "bounds": Derived(margins.largest_losses())}
    return RecursiveForm(system, {}, prepared.definitions.listed(), outputs)
