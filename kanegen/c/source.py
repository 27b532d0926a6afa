"""The generated files of one model, in memory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from kanegen.c.description import ModelDescription
from kanegen.c.folder import write
from kanegen.c.interface import PREPARE, Footprint, Function
from kanegen.c.source_html import source_html
from kanegen.c.steps import Rollout
from kanegen.c.target import RenderInput
from kanegen.files import path_of
from kanegen.model.system import System
from kanegen.options import STRICT, Variant
from kanegen.program import precision as precisions
from kanegen.program.expand import expanded_module
from kanegen.program.ir import Module


@dataclass(frozen=True)
class Source:
    """Code of one model, and the artifacts beside it.

    Attributes:
        model: Names and sizes of the model.
        outputs: Names of the outputs that the functions fill, such as `("mass_matrix", "forcing")`.
        functions: Every generated function for one state; all but `prepare` have a batch form, too, and with
            `parameters_by_state` that one as well. Code for one state alone has no batch forms.
        rollouts: Every generated function that makes many steps.
        integrators: Names of the functions that follow a motion in steps, such as `("rollout_rk4",)`.
        operations: Operation counts of one evaluation of all outputs: "add", "multiply", "divide", "sqrt",
            "sincos", and "prepare", the operations of the parameter-only step; where they occur, also
            "compare", signs, minima, maxima and conditions, and "function", calls of exp, log, tanh and
            atan2.
        files: Text of every file by its name: header, source, example, build files, README.
        cdef: The declarations of the header, as cffi reads them.
        code_files: Names of the files that hold the code itself; the others are those of artifacts.
        variant: The choices that shaped the code.
        target: Name of the language.
        artifacts: Names of the artifacts that can stand beside this source, see `kanegen.artifacts`.
        beside: Purpose of each artifact that was asked for, with the names of its files.
        next_steps: What users do next with each artifact that was asked for, by its name.
        places: Names, in the folder of the code, of files and folders that artifacts of the model can have,
            beside names that begin with that of the model.
        certificate: The fields of the certificate of a budget, {} without one.
        render_input: The programs that were printed, with the choices for the code; None for a source that
            was not made by `render`.
        footprints: Stack and code of every function for one state, where the target knows them.
        pieces: Number of pieces of each long file, by its name. Such a file may be compiled as a whole, or in
            pieces at the same time: with `-DKANEGEN_PIECE=0`, and with each number up to this one.
        system: The system that the programs compute; None where only the description is known.

    Example:
        >>> source = kg.generate(kg.load("models/double_pendulum.toml"))
        >>> source.operations["sincos"]
        4
        >>> source.write("build/double_pendulum")
    """

    model: ModelDescription
    outputs: tuple[str, ...]
    functions: tuple[Function, ...]
    operations: Mapping[str, int]
    files: Mapping[str, str]
    cdef: str
    code_files: tuple[str, ...] = ()
    variant: Variant = STRICT
    target: str = "c99"
    artifacts: tuple[str, ...] = ()
    beside: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    next_steps: Mapping[str, str] = field(default_factory=dict)
    places: tuple[str, ...] = field(default=(), repr=False, compare=False)
    certificate: Mapping[str, Any] = field(default_factory=dict)
    render_input: RenderInput | None = field(default=None, repr=False, compare=False)
    system: System | None = field(default=None, repr=False, compare=False)
    rollouts: tuple[Rollout, ...] = ()
    integrators: tuple[str, ...] = ()
    footprints: tuple[Footprint, ...] = field(default=(), repr=False, compare=False)
    pieces: Mapping[str, int] = field(default_factory=dict)

    @cached_property
    def module(self) -> Module | None:
        """The programs that were printed, without loops; None for a source that was not made by `render`."""
        return expanded_module(self.render_input.selected) if self.render_input else None

    @property
    def code(self) -> dict[str, str]:
        """The text of every file of the code itself, by its name, without the files of artifacts."""
        return {name: self.files[name] for name in self.code_files}

    @property
    def parameters_by_state(self) -> bool:
        """Whether each state of a batch has its own parameters, so that `prepare` has a batch form."""
        return any(function.name == PREPARE and function.has_batch for function in self.functions)

    @property
    def has_batches(self) -> bool:
        """Whether there are functions for many states at once."""
        return any(function.has_batch for function in self.functions)

    @property
    def mass_matrix_pattern(self) -> tuple[tuple[int, int], ...]:
        """Row and column of each element of [A] that the functions fill; () where they fill the whole."""
        arrays = (array for function in self.functions for array in function.outputs)
        return next((array.pattern for array in arrays if array.pattern), ())

    @property
    def may_not_converge(self) -> bool:
        """Whether functions have an iteration, with a status where it does not converge."""
        steps = (rollout.step for rollout in self.rollouts)
        return any(function.may_not_converge for function in (*self.functions, *steps))

    @property
    def precision(self) -> str:
        """Name of the precision of the arithmetic, in `precision.PRECISIONS`."""
        return self.variant.precision

    @property
    def storage(self) -> str:
        """Name of the precision of states, loads and results, in `precision.PRECISIONS`."""
        return precisions.storage_precision(self.variant.precision, self.variant.storage).name

    def __repr__(self) -> str:
        """Name of the system, language and precision, and the outputs."""
        language = f"{self.target} in {self.precision}"
        return f"<Source of {self.model.shown}: {language}, {', '.join(self.outputs)}>"

    def _repr_html_(self) -> str:
        """The functions, what they cost, and the files, for a notebook."""
        return source_html(self.model.shown, self.functions, self.operations, self.files, self.variant)

    def write(self, folder: str | Path, force: bool = False) -> Path:
        """Write every file into `folder`, which is made where it is missing.

        Files that kanegen wrote there before for this model, unchanged since, are replaced, and those of them
        that this source does not have are removed. Either all files appear, each of them whole, or none.

        Args:
            folder: The folder to write into.
            force: Also write beside files of another origin, and over files of the same names.

        Returns:
            The folder.

        Raises:
            WriteError: If the folder is no path, holds anything else, is a file, or cannot be written.

        Example:
            >>> kg.generate(system).write("build/arm", force=True)
        """
        path = path_of(folder)
        write(self.files, path, force, self.model.name, self.places)
        return path
