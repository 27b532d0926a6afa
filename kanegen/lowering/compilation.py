"""The values that pass from stage to stage of a compilation: request, candidate, compiled functions."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program.count import operations
from kanegen.program.ir import Module
from kanegen.program.passes import Stage
from kanegen.program.triangle import FULL
from kanegen.recursion import Methods
from kanegen.recursion.refinement import Refinement


@dataclass(frozen=True)
class Request:
    """What is to be compiled, checked.

    Attributes:
        system: The tree of bodies.
        outputs: Names of outputs that the system has, in the order of `OUTPUTS`.
        variant: The choices between speed and accuracy.
        integrators: Names of functions of `INTEGRATORS`; what they are composed of is among the outputs.
        mass_matrix: Form in which functions fill [A], one of `triangle.FORMS`.
    """

    system: System
    outputs: tuple[str, ...]
    variant: Variant
    integrators: tuple[str, ...] = ()
    mass_matrix: str = FULL


@dataclass(frozen=True)
class Candidate:
    """A way to derive the outputs, among which the operation count chooses.

    Attributes:
        methods: Method of derivation by output.
        refinement: Iterative refinement of forward dynamics.
        reason: Number of refinement steps and how it was decided, as documented in the generated C.
    """

    methods: Methods
    refinement: Refinement
    reason: str


@dataclass(frozen=True)
class Compiled:
    """The functions of a system, ready to be printed as C.

    Attributes:
        module: A program for each function.
        methods: Method of derivation by output.
        stages: Operation counts of all outputs together, after lowering and after every pass.
        refinement: Number of refinement steps of {ydot} and how it was decided.
    """

    module: Module
    methods: Methods
    stages: tuple[Stage, ...]
    refinement: str

    @property
    def operations(self) -> dict[str, int]:
        """Operations of one evaluation of all outputs together, by kind."""
        return operations(self.module)

    @property
    def cost(self) -> int:
        """Number of operations of one evaluation, without those of `prepare`."""
        return sum(self.operations.values()) - self.operations["prepare"]
