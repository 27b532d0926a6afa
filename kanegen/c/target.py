"""The interface of target languages: the input of a target, and the members that a target must have.

A target prints the programs of a module. Programs, names and documentation are the same for all targets; a
target defines the notation of statements (its dialects), the declarations, the longest part of a function,
and the files. `c99` is the first target; its variants are the precisions and SIMD batches.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol, runtime_checkable

from kanegen.c.description import ModelDescription
from kanegen.c.dialect import Dialect
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import (
    Footprint,
    Function,
    fit_simd,
    prepared_names,
    requested,
    signatures,
)
from kanegen.c.pieces import number_of_pieces
from kanegen.c.simd import SIMD, Simd
from kanegen.c.sincos import Sincos, sincos_named
from kanegen.c.steps import Rollout, composed, step_function
from kanegen.options import Variant
from kanegen.program.cut import LONGEST_PART
from kanegen.program.distinct import distinct_values
from kanegen.program.expand import LONGEST_STRAIGHT, expanded_module, has_loops
from kanegen.program.ir import EVALUATE, PARAMETERS, PREPARED, Module, Program
from kanegen.program.precision import Precision
from kanegen.program.split import select_functions


@dataclass(frozen=True)
class BatchFunction:
    """A function as the SIMD lanes of a batch compute it.

    Attributes:
        function: The function; its matrices may hold every value once.
        parts: Its programs in order.
        places: For the name of each matrix that holds every value once, place of the value of each element.
        copied: Numbers of a state that are copied on their way, because arrays have another precision.
    """

    function: Function
    parts: tuple[Program, ...]
    places: Mapping[str, tuple[int, ...]]
    copied: int = 0

    @property
    def numbers(self) -> int:
        """Number of numbers on the stack for one state."""
        return self.function.numbers + self.copied

    @property
    def fits_simd(self) -> bool:
        """Whether these are few enough to compute several states side by side."""
        return fit_simd(self.numbers)


@dataclass(frozen=True)
class RenderInput:
    """The input of a target: a model, its programs and the choices for the code.

    Attributes:
        model: Names and sizes that the code and its documentation mention.
        module: The programs.
        operations: Operation counts of one evaluation of all outputs that the printed functions fill.
        variant: The choices that shape the code; the programs follow theirs already.
        decided: Values and reasons of choices that were left to kanegen, as text by name of the choice.
        longest_part: Instructions of a function from which it is cut into parts.
        chosen: Names of the functions to print besides `prepare`, None for all.
        parameters_by_state: Whether each state of a batch has its own parameters.
        batches: Whether there are functions for many states at once beside those for one.
    """

    model: ModelDescription
    module: Module
    operations: Mapping[str, int]
    variant: Variant
    decided: Mapping[str, str]
    longest_part: int = LONGEST_PART
    chosen: tuple[str, ...] | None = None
    parameters_by_state: bool = False
    batches: bool = True

    @cached_property
    def selected(self) -> Module:
        """The programs that are printed."""
        return self.module if self.chosen is None else select_functions(self.module, self.chosen)

    @cached_property
    def programs(self) -> dict[Function, tuple[Program, ...]]:
        """Every function that is printed, with its parts."""
        return signatures(self.selected, self.longest_part, self.parameters_by_state, self.batches)

    @cached_property
    def batch_programs(self) -> dict[str, BatchFunction]:
        """Every function as the SIMD lanes of a batch compute it, by name.

        Where the code for one state solves for columns in loops, that for several states is straight-line
        code with the same operations, unless that would be too long. Values that a matrix holds several times
        are stored once, unless functions that follow a motion read the matrix.
        """
        module = self.selected
        if has_loops(module):
            module = expanded_module(module, LONGEST_STRAIGHT)
        of_steps = self._of_steps
        found = {
            name: distinct_values(program)
            for name, program in module.functions.items()
            if name not in of_steps
        }
        if any(one.places for one in found.values()):
            programs = {name: one.program for name, one in found.items()}
            module = replace(module, functions={**module.functions, **programs})
        printed = self.programs
        if module is not self.selected:
            printed = signatures(module, self.longest_part, self.parameters_by_state, self.batches)
        places = {name: one.places for name, one in found.items()}
        is_mixed = self.formats.is_mixed
        return {
            function.name: BatchFunction(
                function, parts, places.get(function.name, {}), self._copied(whole) if is_mixed else 0
            )
            for whole, (function, parts) in zip(self.programs, printed.items(), strict=True)
        }

    @staticmethod
    def _copied(function: Function) -> int:
        """Return the number of numbers of a state in the rows of arrays that a function reads or fills."""
        arrays = (*function.inputs, *function.outputs)
        return sum(array.size for array in arrays if array.name not in function.shared)

    @property
    def _of_steps(self) -> set[str]:
        """Names of the functions that those which follow a motion call."""
        are_rates = self.model.speeds_are_rates
        called = (composed(name, self.programs, are_rates) for name in self.selected.integrators)
        return {function.name for functions in called for function in functions}

    @cached_property
    def steps(self) -> dict[str, Function]:
        """The function of one step, by the name of every printed function that follows a motion."""
        are_rates = self.model.speeds_are_rates
        made = {name: step_function(name, self.programs, are_rates) for name in self.selected.integrators}
        return {name: replace(step, has_batch=self.batches) for name, step in made.items()}

    @property
    def rollouts(self) -> tuple[Rollout, ...]:
        """Every function that makes many steps."""
        return tuple(Rollout(name, step) for name, step in self.steps.items() if step.name != name)

    @property
    def functions(self) -> tuple[Function, ...]:
        """Every function for one state that is printed, in the order of the generated code."""
        steps = (step for name, step in self.steps.items() if step.name == name)
        return (*self.programs, *steps)

    @cached_property
    def prepared(self) -> tuple[str, ...]:
        """Name of every prepared constant, in the order of the array; () without parameters."""
        return prepared_names(self.programs)

    @property
    def places(self) -> dict[str, tuple[str, ...]]:
        """Enumerators of the places of parameters and of prepared constants, by name of the array."""
        prefix = self.model.prefix
        parameters = tuple(f"{prefix}_P_{name}" for name, _ in self.model.parameters)
        prepared = tuple(f"{prefix}_C_{name}" for name in self.prepared)
        return {PARAMETERS: parameters, PREPARED: prepared}

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs that the printed functions fill."""
        if self.chosen is None or EVALUATE in self.chosen:
            return requested(self.module)
        return self.chosen

    @cached_property
    def pieces(self) -> int:
        """Number of pieces of each file of C, 0 where the longer one is too short to be divided."""
        of_batches = [one.parts for one in self.batch_programs.values()] if self.batches else []
        return max(map(number_of_pieces, (self.programs.values(), of_batches)))

    @property
    def formats(self) -> Formats:
        """Precisions of arrays and arithmetic."""
        return formats(self.variant)

    @property
    def batch_stack(self) -> int:
        """The most KiB that a batch function keeps on the stack, with the widest vectors."""
        simd = self.simd
        if simd is None:
            return 0
        batches = [one for one in self.batch_programs.values() if one.function.has_batch and one.fits_simd]
        steps = (
            []
            if self.formats.is_mixed
            else [one for one in self.steps.values() if one.has_batch and one.fits_simd]
        )
        numbers = max([*(one.numbers for one in batches), *(one.numbers for one in steps)], default=0)
        return -(-numbers * simd.widths[-1] * simd.precision.bytes // 1024)

    @property
    def precision(self) -> Precision:
        """Precision of the arithmetic."""
        return self.formats.arithmetic

    @property
    def simd(self) -> Simd | None:
        """SIMD vectors of the arithmetic, None where the precision has none."""
        return SIMD.get(self.precision)

    @property
    def sincos(self) -> Sincos | None:
        """kanegen's sine and cosine, None for those of the C library or of double-double."""
        return sincos_named(self.variant.sincos, self.precision)


@dataclass(frozen=True)
class Printed:
    """The code of a model in a target.

    Attributes:
        files: Text of every file of code by its name, without the line of provenance.
        declarations: Enumerations and prototypes for callers in plain C, as cffi reads them.
        footprints: Memory of every function for one state, where the target knows it.
        pieces: Number of pieces with parts of functions, by the name of each file that has several.
    """

    files: Mapping[str, str]
    declarations: str
    footprints: tuple[Footprint, ...] = ()
    pieces: Mapping[str, int] = field(default_factory=dict)


@runtime_checkable
class Target(Protocol):
    """A language, or a way to use one, in which the functions of a model are printed."""

    @property
    def name(self) -> str:
        """Name of the target, as users write it."""
        ...

    @property
    def longest_part(self) -> int:
        """Instructions of a function from which it is cut into parts."""
        ...

    @property
    def has_loops(self) -> bool:
        """Whether it prints solutions in loops over columns; without, it gets straight-line code for them."""
        ...

    def require_name(self, name: str) -> None:
        """Refuse a model whose name the files or identifiers of this target cannot have.

        Raises:
            ModelError: If there is such a conflict.
        """
        ...

    def dialect(self, render_input: RenderInput, function: Function) -> Dialect:
        """Return the notation of the statements of a function for one state, or of `prepare`."""
        ...

    def printed(self, render_input: RenderInput) -> Printed:
        """Return the code of a model."""
        ...
