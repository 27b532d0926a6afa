"""The part of the table of outputs that are derivatives of other outputs.

Those by state, {tau} and run-time parameters are `<output>_derivatives`, those by loads, time and prescribed
motion `<output>_input_derivatives`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.articulated_rows import ArticulatedRows
from kanegen.recursion.inverse_dynamics_derivatives import (
    forcing_by_state,
    forcing_of_elements,
    inverse_dynamics_by_state,
    inverse_dynamics_of_elements,
)
from kanegen.recursion.outputs.differentiated import Derivative
from kanegen.recursion.outputs.inputs import LOADS, READ_BY_ALL, input_arrays
from kanegen.recursion.outputs.output import OfSolution, Output, Recursion, Subject
from kanegen.recursion.solution import Solution
from kanegen.recursion.solution_derivatives import SolutionRows
from kanegen.recursion.tree import Derived, Tree

_DIFFERENTIATED = (
    ("forcing", "{f}, Eq. (44),", ("x", "y")),
    ("gravity_forces", "the part of {f} that gravity causes", ("x",)),
    ("inverse_dynamics", "[A]{ydot} - {f} for given {ydot}", ("x", "y")),
    ("forward_dynamics", "{ydot} of [A]{ydot} = {f} + {tau}", ("x", "y", "tau")),
    ("contact_dynamics", "{ydot} where all contacts hold", ("x", "y", "tau")),
    ("coordinate_rates", "{xdot}, Eqs. (9), (45),", ("x", "y")),
    ("point_positions", "{p_P} of each point, Eq. (22),", ("x",)),
    ("point_velocities", "{v_P} of each point, Eq. (27),", ("x", "y")),
    ("point_accelerations", "{a_P} of each point for given {ydot}, Eq. (33),", ("x", "y")),
    ("kinetic_energy", "the kinetic energy", ("x", "y")),
    ("potential_energy", "the potential energy", ("x",)),
    ("momentum", "linear momentum, then angular momentum about the mass centre,", ("x", "y")),
    ("centroidal_momentum_bias", "the rate of the momentum for {ydot} = 0", ("x", "y")),
    ("mass_center", "{p_C}", ("x",)),
)
"""Each output that has derivatives, what it is in a sentence, and the arrays of its variables."""

_INPUTS = (*LOADS, *READ_BY_ALL)
"""The inputs from outside that only some systems have."""

_OF_INPUTS = ("forcing", "inverse_dynamics", "forward_dynamics")
"""Outputs that have derivatives by inputs from outside."""

SOLUTION_PARTS = "forward_dynamics_parts"
"""Name of the part from which all derivatives of {ydot} are made, where the system has it."""

SOLUTION_BY_STATE = "forward_dynamics_by_state"
"""Name of the part with the derivatives of {ydot} by articulated bodies, an alternative to the other."""

INVERSE_DYNAMICS_PARTS = ("inverse_dynamics_by_state", "inverse_dynamics_of_elements")
"""Names of the parts of derivatives of inverse dynamics."""

_PARTS = {
    "forcing": ("forcing_by_state", "forcing_of_elements"),
    "inverse_dynamics": INVERSE_DYNAMICS_PARTS,
    "forward_dynamics": (SOLUTION_PARTS,),
}
"""Names of the parts that give the derivatives of an output, where the system has them."""

_ALTERNATIVES = {"forward_dynamics": SOLUTION_BY_STATE}
"""Names of the parts that can take the place of these where that costs less."""

_PARTS_BY_INPUTS = {"forward_dynamics": _PARTS["forward_dynamics"]}
"""The same for derivatives by inputs from outside."""


def _by_state(name: str, derive: Callable[[Tree], Derived]) -> Output:
    """Return the part that holds derivatives by {x} and {y}."""

    def array(system: System) -> Array:
        n, coordinates = len(system.freedoms), len(system.coordinates)
        return Array(name, (n, coordinates + n), "N m, N", "derivatives by {x} and {y}")

    return Output(name, array, ("x", "y", "ydot", *LOADS), Recursion("composite bodies", derive))


def _of_elements(name: str, derive: Callable[[Tree], Derived]) -> Output:
    """Return the part that holds a term whose derivatives the other part leaves out."""

    def array(system: System) -> Array:
        return Array(name, (len(system.freedoms),), "N m, N", "the part of force elements")

    return Output(name, array, ("x", "y", "ydot", *LOADS), Recursion("recursion of forces", derive))


def _of_solution() -> Output:
    """Return the part with the rows from which derivatives of {ydot} are made."""

    def array(system: System) -> Array:
        rows = SolutionRows(len(system.coordinates), len(system.freedoms))
        shape = rows.count, rows.freedoms
        return Array(SOLUTION_PARTS, shape, "SI", "rows of derivatives", of_freedoms=True)

    return Output(
        SOLUTION_PARTS,
        array,
        ("x", "y", "ydot", "tau", *LOADS),
        OfSolution(Solution.parts_of_derivatives, is_accurate=False),
    )


def _of_solution_by_state() -> Output:
    """Return the part with the derivatives of {ydot} by articulated bodies."""

    def array(system: System) -> Array:
        rows = ArticulatedRows(len(system.freedoms))
        shape = rows.count, rows.freedoms
        return Array(SOLUTION_BY_STATE, shape, "SI", "rows of derivatives", of_freedoms=True)

    derivation = OfSolution(Solution.derivatives_by_state, is_accurate=False)
    return Output(SOLUTION_BY_STATE, array, ("x", "y", "tau", *LOADS), derivation)


PARTS = {
    part.name: part
    for part in (
        _by_state("forcing_by_state", forcing_by_state),
        _of_elements("forcing_of_elements", forcing_of_elements),
        _by_state("inverse_dynamics_by_state", inverse_dynamics_by_state),
        _of_elements("inverse_dynamics_of_elements", inverse_dynamics_of_elements),
        _of_solution(),
        _of_solution_by_state(),
    )
}
"""Parts of derivatives that are derived by recursions, by name. They are no outputs for users."""


def derivatives_of(outputs: Iterable[Output]) -> tuple[Output, ...]:
    """Return the entries of the outputs that are derivatives of `outputs`.

    The array of one has the axes of the output that is differentiated, and behind them one for the variables.
    """
    entries = {output.name: output for output in outputs}
    by_state = (
        _derivative(
            entries,
            name,
            f"{name}_derivatives",
            Derivative(of, (name,), by, parts=_PARTS.get(name, ()), alternative=_ALTERNATIVES.get(name, "")),
            entries[name].subject,
        )
        for name, of, by in _DIFFERENTIATED
    )
    by_inputs = (
        _derivative(
            entries,
            name,
            f"{name}_input_derivatives",
            Derivative(of, (name,), _INPUTS, by_parameters=False, parts=_PARTS_BY_INPUTS.get(name, ())),
            EXTERNAL,
        )
        for name, of, _ in _DIFFERENTIATED
        if name in _OF_INPUTS
    )
    return (*by_state, *by_inputs)


def _external(system: System) -> list[str]:
    """Return the names of the inputs from outside that a system has."""
    return [array.name for array in input_arrays(system) if array.name in _INPUTS]


EXTERNAL = Subject(
    _external,
    "has neither loads nor prescribed freedoms and does not depend on the time. Ask for derivatives by its "
    "state.",
)


def _derivative(
    entries: Mapping[str, Output], base: str, name: str, derivation: Derivative, subject: Subject | None
) -> Output:
    """Return the entry `name` of derivatives of the output `base`."""
    entry = entries[base]
    return Output(
        name,
        lambda system: derivation.array(system, name, entry.array(system)),
        entry.inputs,
        derivation,
        subject,
    )
