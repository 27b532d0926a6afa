"""What there is to say about a system's equations, before it is put into a format."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

from sympy import ImmutableMatrix

from kanegen.symbolic.equations import Equations
from kanegen.symbolic.printing.block_sections import bodies_in_blocks
from kanegen.symbolic.printing.given_sections import force_elements, loads, parameters
from kanegen.symbolic.printing.latex_names import latex_names
from kanegen.symbolic.printing.matrices import matrix
from kanegen.symbolic.printing.state_sections import kinematics, prescribed, rates, state
from kanegen.symbolic.printing.statements import Section, equation


@dataclass(frozen=True)
class Document:
    """Everything that a format prints."""

    title: str
    note: str
    sections: tuple[Section, ...]


def document(equations: Equations, A: ImmutableMatrix, f: ImmutableMatrix) -> Document:
    """A document of [A] and {f}, and of the definitions that they need.

    Args:
        equations: Where they come from.
        A: (n, n) [A], with or without intermediates.
        f: (n, 1) {f}.
    """
    system = equations.system
    n, count = len(equations.y), system.number_of_bodies
    bodies = "1 body" if count == 1 else f"{count} bodies"
    freedoms = "1 freedom" if n == 1 else f"{n} freedoms"
    return Document(
        f"{system.name}: {bodies}, {freedoms}",
        f"Equations of motion [A]{{ydot}} = {{f}}, with {kinematics(system)}. SI units.",
        tuple(_sections(equations, A, f)),
    )


def _sections(equations: Equations, A: ImmutableMatrix, f: ImmutableMatrix) -> Iterator[Section]:
    system, definitions = equations.system, equations.definitions
    names = latex_names(equations)
    yield state(equations, names)
    yield from prescribed(equations, names)
    yield from rates(equations, names)
    yield from parameters(equations, names)
    yield from loads(system)
    yield from force_elements(system)
    if definitions:
        yield from bodies_in_blocks(system)
    for note, group in groupby(definitions, key=lambda definition: definition.note):
        yield Section(note, "", tuple(equation(each.symbol, each.value, names) for each in group))
    yield Section("Mass matrix", "[A] of Eq. (43); it is symmetric.", matrix("A", A, names))
    yield Section("Forcing", "{f} of Eq. (44).", matrix("f", f, names))
