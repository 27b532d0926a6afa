"""The classes of entries in the table of outputs, which do not depend on a system."""

from __future__ import annotations

from collections.abc import Callable, Sized
from dataclasses import dataclass

from kanegen.model.arguments import ARGUMENTS, MODEL_DEPENDENT
from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.outputs.differentiated import Derivative, Product, SecondDerivative
from kanegen.recursion.solution import Solution
from kanegen.recursion.tree import Derived, Tree


@dataclass(frozen=True)
class Recursion:
    """Derivation by recursions over the bodies of the tree.

    Attributes:
        method: Name of the algorithm, as documented in the generated C.
        derive: Function that adds the definitions to the tree and returns the entries.
    """

    method: str
    derive: Callable[[Tree], Derived]


@dataclass(frozen=True)
class OfSolution:
    """Derivation from a solver of [A]{ydot} = {f} + {tau}; its method is the name of the solver.

    Attributes:
        derive: Function that returns the entries.
        is_accurate: Whether the entries are promised to be accurate, or a status says that they are not. The
            solver is then chosen for its accuracy.
        is_refined: Whether the entries are those of a solution that is refined where that helps.
    """

    derive: Callable[[Solution], Derived]
    is_accurate: bool = True
    is_refined: bool = False


@dataclass(frozen=True)
class ErrorBound:
    """Derivation of bounds on the error of {ydot} from the programs of inverse and forward dynamics."""

    needs = ("inverse_dynamics", "forward_dynamics")
    """Outputs whose programs, derived anew, become the program of the bounds."""

    method = "running errors"
    """Name of the algorithm, as documented in the generated C."""


@dataclass(frozen=True)
class Subject:
    """A part that a system must have for an output to exist, such as points.

    Attributes:
        found: Function that returns these parts of a system.
        missing: End of the error message for a system without such parts, with the way to add some; or a
            function that returns it.
    """

    found: Callable[[System], Sized]
    missing: str | Callable[[System], str]

    def message(self, system: System) -> str:
        """Return the end of the error message for a system without such parts."""
        return self.missing if isinstance(self.missing, str) else self.missing(system)


@dataclass(frozen=True)
class Output:
    """An output that a user can ask for.

    Attributes:
        name: Name of the output, of its C function and of its method in `Library`.
        array: Function that returns the array which the output fills: name in C, shape, unit, documentation.
        inputs: Names of the arrays that the output may read, beside those of `inputs.READ_BY_ALL`.
        derivation: Algorithm that derives the entries.
        subject: Part that a system must have; None if every system has the output.
    """

    name: str
    array: Callable[[System], Array]
    inputs: tuple[str, ...]
    derivation: Recursion | OfSolution | Derivative | SecondDerivative | Product | ErrorBound
    subject: Subject | None = None

    @property
    def arguments(self) -> tuple[str, ...]:
        """Arguments of the method in `Library`, in order; further inputs are passed by name."""
        return tuple(name for name in ARGUMENTS if name in self.inputs and name not in MODEL_DEPENDENT)

    def is_available(self, system: System) -> bool:
        """Return whether a system has the parts that the output requires."""
        return self.subject is None or len(self.subject.found(system)) > 0
