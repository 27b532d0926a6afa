"""The generated files, in memory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kanegen.c.folder import write
from kanegen.c.interface import Function, ModelFacts
from kanegen.options import STRICT, Variant
from kanegen.program import precision as precisions


@dataclass(frozen=True)
class Source:
    """C code of one model and what goes with it.

    Attributes:
        model: Names and sizes of the model.
        outputs: What was asked for, such as `("mass_matrix", "forcing")`.
        functions: Every C function, without its batch form.
        operations: What one evaluation of all outputs costs: "add", "multiply", "divide", "sqrt", "sincos",
            and "prepare", the operations of the parameter-only step.
        files: Text of every file by its name: header, source, example, build files, README.
        cdef: The declarations of the header, as cffi reads them.
        variant: The choices that shaped it.
    """

    model: ModelFacts
    outputs: tuple[str, ...]
    functions: tuple[Function, ...]
    operations: Mapping[str, int]
    files: Mapping[str, str]
    cdef: str
    variant: Variant = STRICT

    @property
    def precision(self) -> str:
        """The arithmetic, a name of `precision.PRECISIONS`."""
        return self.variant.precision

    @property
    def storage(self) -> str:
        """The precision of states, loads and results, likewise."""
        return precisions.storage_precision(self.variant.precision, self.variant.storage).name

    def write(self, folder: str | Path, force: bool = False) -> Path:
        """Write every file into `folder`, which is made where it is missing.

        Files that kanegen wrote there before, unchanged since, are replaced. Each file appears whole or not
        at all.

        Args:
            folder: Where to write.
            force: Write beside other files too, and over files of the same names.

        Returns:
            The folder.

        Raises:
            WriteError: If the folder holds anything else, is a file, or cannot be written.
        """
        return write(self.files, Path(folder), force)
