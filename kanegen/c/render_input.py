"""What the files of a model are made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from kanegen.c.formats import Formats, formats
from kanegen.c.interface import Function, ModelFacts, requested, signatures
from kanegen.c.simd import LANES, Lanes
from kanegen.c.sincos import Sincos, own
from kanegen.options import Variant
from kanegen.program.ir import Module, Program
from kanegen.program.precision import Precision


@dataclass(frozen=True)
class Draft:
    """A model that is about to be written.

    Attributes:
        model: Names and sizes that the code and its documentation mention.
        module: What to compute.
        operations: Operation counts, for the documentation.
        variant: The choices that shape it.
        decided: What became of some choices, by name, in words.
    """

    model: ModelFacts
    module: Module
    operations: Mapping[str, int]
    variant: Variant
    decided: Mapping[str, str]

    @cached_property
    def programs(self) -> dict[Function, tuple[Program, ...]]:
        """Every function with its pieces."""
        return signatures(self.module)

    @property
    def functions(self) -> tuple[Function, ...]:
        """Every function."""
        return tuple(self.programs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """What was asked for."""
        return requested(self.module)

    @property
    def formats(self) -> Formats:
        """The precisions of arrays and arithmetic."""
        return formats(self.variant)

    @property
    def precision(self) -> Precision:
        """Of the arithmetic."""
        return self.formats.arithmetic

    @property
    def lanes(self) -> Lanes | None:
        """Several states side by side, where the precision has that."""
        return LANES.get(self.precision)

    @property
    def sincos(self) -> Sincos | None:
        """kanegen's sine and cosine; None for those of the C library, or of pairs."""
        return own(self.variant.sincos, self.precision)
