"""Matrices and functions of CasADi as plain data: inputs, outputs, and the calls of C between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from kanegen.artifacts.casadi.pattern import Pattern
from kanegen.c.interface import Function
from kanegen.program.ir import PREPARED


@dataclass(frozen=True)
class Matrix:
    """A matrix of CasADi, and the array of C that holds its entries.

    Attributes:
        name: Name of the input or output in CasADi.
        pattern: Shape and entries that are stored.
        array: Name of the array, which may be that of an input; "" for an output whose entries are ones, and
            for an input that is not read.
        places: Place in the array of each entry that is stored.
        size: Number of elements of the array.
        is_known: Whether the source can give it; there may be no derivatives by an input.
    """

    name: str
    pattern: Pattern
    array: str = ""
    places: tuple[int, ...] = ()
    size: int = 0
    is_known: bool = True

    @property
    def is_whole(self) -> bool:
        """Whether the matrix is stored as the array is."""
        return self.places == tuple(range(self.size))


@dataclass(frozen=True)
class CasadiFunction:
    """A function of CasADi.

    Attributes:
        name: Its name, a symbol of the library.
        doc: One sentence.
        inputs: Its arguments. Those of derivatives contain the results of the function that is
            differentiated, which are not read. Several may fill one array together.
        outputs: Its results.
        calls: Functions of C that fill arrays of results.
        added: Further terms of outputs, by their name: each has the pattern of its output.
        passed: For functions of C by name, arguments that get another array than that of their own name.
    """

    name: str
    doc: str
    inputs: tuple[Matrix, ...]
    outputs: tuple[Matrix, ...]
    calls: tuple[Function, ...]
    added: tuple[Matrix, ...] = ()
    passed: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def read(self) -> tuple[Matrix, ...]:
        """The arguments that are read."""
        return tuple(one for one in self.inputs if one.array)

    @property
    def is_derivative(self) -> bool:
        """Whether it is a derivative of another function."""
        return len(self.read) < len(self.inputs)

    @property
    def reads_parameters(self) -> bool:
        """Whether constants are prepared from parameters."""
        return any(array.name == PREPARED for call in self.calls for array in call.inputs)
