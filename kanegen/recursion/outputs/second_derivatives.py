"""The part of the table of outputs that are second derivatives of other outputs.

All of them stand in straight lines, each symmetric entry computed once. Their number grows with the third
power of that of the freedoms, so that only small systems have them.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.outputs.derivatives import INVERSE_DYNAMICS_PARTS
from kanegen.recursion.outputs.differentiated import SecondDerivative
from kanegen.recursion.outputs.output import Output, Subject

MOST_NUMBERS = 2**13
"""Largest number of second derivatives for which there is code. Those of {ydot} of panda with one finger are
4 608 numbers and 54 000 operations."""

_QUANTITIES = (
    (
        "inverse_dynamics",
        "[A]{ydot} - {f}",
        ("x", "y", "ydot"),
        ("mass_matrix", "inverse_dynamics"),
    ),
    (
        "forward_dynamics",
        "{ydot}",
        ("x", "y", "tau"),
        ("mass_matrix", "inverse_dynamics", "forward_dynamics"),
    ),
)
"""Each output that has second derivatives: what it is, the arrays of its variables, and the outputs whose
programs are differentiated."""


def second_derivatives_of(outputs: Iterable[Output]) -> tuple[Output, ...]:
    """Return the entries of the outputs that are second derivatives of `outputs`."""
    entries = {output.name: output for output in outputs}
    return tuple(
        _second_derivative(entries[base], SecondDerivative(of, needs, by, parts=INVERSE_DYNAMICS_PARTS))
        for base, of, by, needs in _QUANTITIES
    )


def _second_derivative(base: Output, derivation: SecondDerivative) -> Output:
    """Return the entry of second derivatives of the output `base`."""
    name = f"{base.name}_second_derivatives"
    subject = Subject(partial(_few, derivation), partial(_too_many, derivation, base.name))
    return Output(name, partial(_array, base, name, derivation), base.inputs, derivation, subject)


def _few(derivation: SecondDerivative, system: System) -> range:
    """Return a range that is empty for a system with too many second derivatives."""
    return range(_size(derivation, system) <= MOST_NUMBERS)


def _too_many(derivation: SecondDerivative, base: str, system: System) -> str:
    """Return the end of the error message for a system with too many second derivatives."""
    return (
        f"has {_size(derivation, system)} second derivatives, and there is code for {MOST_NUMBERS} at most. "
        f"Ask for {base}_hvp, their product with weights and a direction."
    )


def _size(derivation: SecondDerivative, system: System) -> int:
    """Return the number of second derivatives."""
    return len(system.freedoms) * derivation.width(system) ** 2


def _array(base: Output, name: str, derivation: SecondDerivative, system: System) -> Array:
    """Return the array of second derivatives."""
    return derivation.array(system, name, base.array(system))
