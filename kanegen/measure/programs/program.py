"""Programs that compute [A], {f} and {ydot}, each as one function from states to its results."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from kanegen.errors import OptionError
from kanegen.measure.compared import ComparedLibrary
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.options import chosen_variant
from kanegen.program.precision import DOUBLE, FLOAT, Precision
from kanegen.reference import equations as reference
from kanegen.reference.states import States
from kanegen.symbolic.equations import derive
from kanegen.symbolic.literal.numeric import NumericEquations, numeric

CLOSED_FORM = "closed form"
DEFINITIONS = "definitions in NumPy"
REFERENCE = "reference"

USUAL_VARIANTS = {
    f"C in {precision.label} precision": chosen_variant(precision=precision.name)
    for precision in (DOUBLE, FLOAT)
}
"""The variants that are measured beside the one of a report, by the name of the program."""

Results = Mapping[str, Floats]


@dataclass(frozen=True)
class Program:
    """A program that computes the equations of one system.

    Attributes:
        name: Its name in tables and pictures.
        results: Function from B states to (B, n, n) "mass_matrix", (B, n) "forcing" and, where the program
            solves with [A] itself, (B, n) "forward_dynamics".
    """

    name: str
    results: Callable[[States], Results]


def of_library(name: str, library: ComparedLibrary, storage: Precision) -> Program:
    """Return compiled C as a program; `storage` is the precision of its arrays."""

    def results(states: States) -> Results:
        x, y = storage.from_doubles(states.x), storage.from_doubles(states.y)
        inputs = {name: storage.from_doubles(values) for name, values in states.inputs.items()}
        loads = {"force": states.force, "torque": states.torque}
        stored = {key: None if load is None else storage.from_doubles(load) for key, load in loads.items()}
        found = {
            "mass_matrix": storage.to_doubles(library.mass_matrix(x, **inputs)),
            "forcing": storage.to_doubles(library.forcing(x, y, **stored, **inputs)),
        }
        if "forward_dynamics" in library.outputs:
            solve = getattr(library, "forward_dynamics")  # noqa: B009 - not every compared library has it
            found["forward_dynamics"] = storage.to_doubles(solve(x, y, **stored, **inputs))
        return found

    return Program(name, results)


def of_reference(system: System) -> Program:
    """Return the reference, Eqs. (1)-(44) of the notes in NumPy, as a program."""
    arrays = system.values()

    def results(states: States) -> Results:
        x, y, force, torque = states.x, states.y, states.force, states.torque
        return {
            "mass_matrix": reference.mass_matrix(arrays, x, states.prescribed),
            "forcing": reference.forcing(arrays, x, y, force, torque, **states.inputs),
        }

    return Program(REFERENCE, results)


def of_definitions(system: System) -> Program:
    """Return the literal equations as a program: every named definition evaluated by NumPy."""
    return _of_equations(DEFINITIONS, derive(system, intermediates=True).lambdify())


def of_closed_form(system: System) -> Program:
    """Return the simplified closed form, evaluated by NumPy, as a program.

    Raises:
        OptionError: If the system has no closed form that can be read.
    """
    equations = derive(system)
    form = equations.closed_form(everywhere=True)
    return _of_equations(CLOSED_FORM, numeric(system, equations.symbols, form.A, form.f, ()))


def symbolic_programs(system: System, notes: list[str]) -> Iterator[Program]:
    """Yield the closed form, if there is one, and the definitions; `notes` gets a line for what is absent."""
    try:
        yield of_closed_form(system)
    except OptionError as error:
        notes.append(f"There is no closed form: {error}")
    yield of_definitions(system)


def with_accelerations(results: Results) -> Results:
    """Return results with {ydot}, which NumPy solves for where the program does not; NaN where it cannot."""
    if "forward_dynamics" in results:
        return results
    solved = np.full_like(results["forcing"], np.nan)
    for k, (matrix, right) in enumerate(zip(results["mass_matrix"], results["forcing"], strict=True)):
        try:
            solved[k] = np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:
            continue
    return {**results, "forward_dynamics": solved}


def _of_equations(name: str, equations: NumericEquations) -> Program:
    """Return functions of single states as a program."""

    def results(states: States) -> Results:
        matrices, forcings = [], []
        for k in range(len(states)):
            one = states.part(k, k + 1)
            prescribed = one.inputs["prescribed"][0] if "prescribed" in one.inputs else None
            given = {key: values[0] for key, values in one.inputs.items()}
            force, torque = (None if load is None else load[0] for load in (one.force, one.torque))
            matrices.append(equations.mass_matrix(one.x[0], prescribed=prescribed))
            forcings.append(equations.forcing(one.x[0], one.y[0], force, torque, **given))
        return {"mass_matrix": np.array(matrices), "forcing": np.array(forcings)}

    return Program(name, results)
