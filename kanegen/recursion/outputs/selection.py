"""The outputs that a user selects for a system: checked names, arrays, and the C functions that fill them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from kanegen.choices import several
from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.program.ir import EVALUATE, Array
from kanegen.program.split import Signature
from kanegen.recursion.derivative_costs import may_cost_less
from kanegen.recursion.outputs.contacts import OF_CONTACTS
from kanegen.recursion.outputs.derivatives import SOLUTION_PARTS
from kanegen.recursion.outputs.differentiated import (
    Derivative,
    Product,
    SecondDerivative,
)
from kanegen.recursion.outputs.inputs import READ_BY_ALL, argument_arrays
from kanegen.recursion.outputs.operational import OPERATIONAL_NAMES
from kanegen.recursion.outputs.output import ErrorBound, OfSolution
from kanegen.recursion.outputs.table import DERIVED, OUTPUTS
from kanegen.recursion.solution_derivatives import has_parts_of_derivatives

FROM_PROGRAMS = Derivative | SecondDerivative | Product
"""Derivations from the programs of other outputs, which are differentiated."""


def chosen(outputs: Iterable[str] | str, further: Iterable[str] = ()) -> tuple[str, ...]:
    """Return the names `outputs`, checked, in the order of `OUTPUTS`, each once.

    Args:
        outputs: Names that a user chose, or a single one.
        further: Names that there are beside those of `OUTPUTS`, such as `INTEGRATORS`.

    Raises:
        OptionError: If `outputs` is empty or contains an unknown name.
    """
    known = (*OUTPUTS, *further)
    asked = several("outputs", "output", outputs, known)
    if not asked:
        raise OptionError(f"no output is asked for. There are {', '.join(known)}.")
    return asked


def available(system: System) -> tuple[str, ...]:
    """Return the names of the outputs that a system has."""
    return tuple(name for name, output in OUTPUTS.items() if output.is_available(system))


def require_available(system: System, outputs: Iterable[str]) -> None:
    """Make sure that a system has the parts that the outputs require.

    Raises:
        OptionError: If such a part, for example a point, is missing.
    """
    for name in outputs:
        output = OUTPUTS[name]
        if output.subject and not output.is_available(system):
            raise OptionError(f"output {name!r}: system {system.name!r} {output.subject.message(system)}")


def solving(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return those of the outputs that need a solution of [A]{ydot} = {b}, which a singular [A] has not."""
    return tuple(name for name in outputs if _solves(name))


def holding(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return those of the outputs that need loads of contacts, which dependent contacts have not."""
    return tuple(name for name in outputs if name in OF_CONTACTS)


def _solves(name: str) -> bool:
    """Return whether an output is a solution of [A]{ydot} = {b} or is made from one."""
    derivation = OUTPUTS[name].derivation
    if isinstance(derivation, FROM_PROGRAMS | ErrorBound):
        return bool(solving(derivation.needs))
    return isinstance(derivation, OfSolution)


def accurately_solved(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return those of the outputs of a solver that are accurate, or have a status where they are not."""
    return tuple(name for name in outputs if _is_accurate(DERIVED[name].derivation))


def _is_accurate(derivation: object) -> bool:
    """Return whether a derivation is from a solver that must be accurate."""
    return isinstance(derivation, OfSolution) and derivation.is_accurate


def refined_solutions(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return those of the outputs that are solutions of [A]{ydot} = {b}, refined where that helps."""
    found = ((name, DERIVED[name].derivation) for name in outputs)
    return tuple(name for name, one in found if isinstance(one, OfSolution) and one.is_refined)


def prerequisites(outputs: Sequence[str], system: System | None = None) -> tuple[str, ...]:
    """Return what to derive for `outputs`: derivatives are replaced by the outputs differentiated.

    Bounds on errors have a program of their own and need none.

    Args:
        outputs: Names of outputs.
        system: The tree, for which the names of parts of derivatives are added where it has them, with those
            of alternatives that are worth counting.
    """
    found: list[str] = []
    for name in outputs:
        derivation = OUTPUTS[name].derivation
        if isinstance(derivation, FROM_PROGRAMS):
            found += derivation.needs
            if system is not None and not isinstance(derivation, Product):
                found += derivation.parts if _takes_parts(derivation, system) else ()
        elif not isinstance(derivation, ErrorBound):
            found.append(name)
    if system is not None:
        found += _alternatives(outputs, system)
    return tuple(dict.fromkeys(found))


def _alternatives(outputs: Sequence[str], system: System) -> tuple[str, ...]:
    """Return the part that can take the place of `SOLUTION_PARTS`, if all that need these can take it."""
    derivations = (OUTPUTS[name].derivation for name in outputs)
    needing = [one for one in derivations if isinstance(one, Derivative) and SOLUTION_PARTS in one.parts]
    found = {one.alternative for one in needing}
    return tuple(found) if found and "" not in found and may_cost_less(system) else ()


def _takes_parts(derivation: Derivative | SecondDerivative, system: System) -> bool:
    """Return whether derivatives come from parts, not from the tangents of other outputs."""
    return SOLUTION_PARTS not in derivation.parts or has_parts_of_derivatives(system)


def takes_long(system: System, name: str) -> bool:
    """Return whether deriving an output of a large tree takes long, some seconds or minutes.

    So it is for outputs that are made from programs, and for operational inertias where they are those of all
    bodies, because a user usually chooses one or two frames.
    """
    return bool(method_of_program(name)) or (system.poses is None and name in OPERATIONAL_NAMES)


def method_of_program(name: str) -> str:
    """Return the method of an output that is derived from programs of other outputs, "" of any other one."""
    derivation = OUTPUTS[name].derivation
    return derivation.method if isinstance(derivation, FROM_PROGRAMS | ErrorBound) else ""


def output_array(system: System, name: str, methods: Mapping[str, str]) -> Array:
    """Return the array of an output, with the method of its derivation added to its documentation."""
    array = DERIVED[name].array(system)
    return replace(array, doc=f"{array.doc}; by {methods[name]}")


def function_signatures(
    system: System, outputs: Sequence[str], together: Mapping[str, tuple[str, ...]] = MappingProxyType({})
) -> dict[str, Signature]:
    """Return the arrays of each C function: one function per output, and `EVALUATE` for several together.

    Args:
        system: The tree.
        outputs: Names of the outputs.
        together: Outputs that are also computed together by a function of their own, by its name, unless they
            are all or just one.
    """
    arrays = [array.name for array in argument_arrays(system)]
    read = {name: {*OUTPUTS[name].inputs, *READ_BY_ALL} for name in outputs}
    groups: dict[str, tuple[str, ...]] = {name: (name,) for name in outputs}
    groups |= {name: group for name, group in together.items() if 1 < len(group) < len(outputs)}
    if len(outputs) > 1:
        groups[EVALUATE] = tuple(outputs)
    return {
        function: Signature(
            inputs=tuple(array for array in arrays if any(array in read[name] for name in group)),
            outputs=tuple(OUTPUTS[name].array(system).name for name in group),
        )
        for function, group in groups.items()
    }
