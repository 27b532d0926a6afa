"""The outputs that can be asked for, and which of them a system has."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial

from kanegen.choices import several
from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.outputs import derivatives
from kanegen.recursion.outputs.dynamics import DYNAMICS, EFFORTS
from kanegen.recursion.outputs.inputs import LOADS
from kanegen.recursion.outputs.kind import OutputKind
from kanegen.recursion.outputs.kinematics import KINEMATICS
from kanegen.recursion.outputs.totals import TOTALS


def _derivatives(name: str, *inputs: str) -> dict[str, OutputKind]:
    return {name: OutputKind(partial(derivatives.array, name=name), inputs)}


OUTPUTS: dict[str, OutputKind] = {
    **DYNAMICS,
    **TOTALS,
    **KINEMATICS,
    **EFFORTS,
    **_derivatives("forcing_derivatives", "x", "y", *LOADS),
    **_derivatives("inverse_dynamics_derivatives", "x", "y", "ydot", *LOADS),
    **_derivatives("forward_dynamics_derivatives", "x", "y", "tau", *LOADS),
}
"""By name, in the order in which the C has them."""

EQUATIONS = ("mass_matrix", "forcing")
"""What is computed unless something else is asked for: [A] and {f} of Eq. (42)."""


def chosen(outputs: Iterable[str] | str) -> tuple[str, ...]:
    """`outputs` checked, in the order of `OUTPUTS`, each once.

    Raises:
        OptionError: If there is none, or one is unknown.
    """
    asked = several("outputs", "output", outputs, OUTPUTS)
    if not asked:
        raise OptionError(f"no output is asked for. There are {', '.join(OUTPUTS)}.")
    return asked


def available(system: System) -> tuple[str, ...]:
    """The outputs that a system has."""
    return tuple(name for name, kind in OUTPUTS.items() if not kind.subject or kind.subject.found(system))


def require_available(system: System, outputs: Iterable[str]) -> None:
    """Make sure that a system has what outputs are about.

    Raises:
        OptionError: If they are about something that there is not.
    """
    for name in outputs:
        subject = OUTPUTS[name].subject
        if subject and not subject.found(system):
            raise OptionError(f"output {name!r}: system {system.name!r} {subject.missing}")


def output_array(system: System, name: str, methods: Mapping[str, str]) -> Array:
    """The array of an output, its documentation saying how it is derived."""
    array = OUTPUTS[name].array(system)
    return replace(array, doc=f"{array.doc}; by {methods[name]}")
