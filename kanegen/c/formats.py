"""Which array has which precision.

States, loads and results have the precision that was chosen for storage. What stands for numbers of the model
does not: parameters have the own type of the arithmetic, and what is prepared from them, or left by one piece
of a function for the next, is not rounded at all.
"""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.options import Variant
from kanegen.program import precision as precisions
from kanegen.program.ir import PARAMETERS, PREPARED, WORKSPACE
from kanegen.program.precision import DOUBLE, Precision


@dataclass(frozen=True)
class Formats:
    """The precisions of one model.

    Attributes:
        arithmetic: Of everything that is computed from a state.
        storage: Of states, loads and results.
    """

    arithmetic: Precision = DOUBLE
    storage: Precision = DOUBLE

    @property
    def parameters(self) -> Precision:
        """Of run-time parameters."""
        return precisions.storage_precision(self.arithmetic.name)

    @property
    def preparing(self) -> Precision:
        """Of what is computed from parameters alone: at least double."""
        return max(DOUBLE, self.arithmetic, key=lambda precision: precision.significand_bits)

    @property
    def is_mixed(self) -> bool:
        """Whether states and results are converted."""
        return self.arithmetic is not self.storage

    @property
    def every(self) -> tuple[Precision, ...]:
        """All of them, each once."""
        return tuple(dict.fromkeys((self.storage, self.parameters, self.arithmetic)))

    def of(self, array: str) -> Precision:
        """That of the array of this name."""
        if array == PARAMETERS:
            return self.parameters
        return self.arithmetic if array in (PREPARED, WORKSPACE) else self.storage


def formats(variant: Variant) -> Formats:
    """What a variant asks for."""
    return Formats(
        precisions.precision_named(variant.precision),
        precisions.storage_precision(variant.precision, variant.storage),
    )


def uniform(precision: Precision) -> Formats:
    """One precision for all."""
    return Formats(precision, precision)
