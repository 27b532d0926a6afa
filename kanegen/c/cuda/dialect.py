"""The notation of statements in device functions: C, in which an array may lie element by element."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.c.dialect import Dialect
from kanegen.c.layout import BREAK
from kanegen.c.usage import Run

ALL_FINITE = "kanegen_all_finite"
"""Name of the function that tests a run of an array, in `kanegen_device.cuh`."""


@dataclass(frozen=True)
class CudaDialect(Dialect):
    """Functions for one state, whose arrays are pointers or views with the operator [].

    Attributes:
        barriers: Instructions before which a warp waits for the others of its block.
    """

    barriers: tuple[int, ...] = ()

    @property
    def reserved(self) -> frozenset[str]:
        """Names that no local may take."""
        return super().reserved | {ALL_FINITE, "kanegen_state", "stride", "threadIdx", "blockIdx"}

    def before(self, first: int, last: int) -> list[str]:
        """Return a barrier for each of `barriers` among some instructions."""
        return ["    kanegen_barrier();" for place in self.barriers if first <= place <= last]

    def all_finite(self, run: Run) -> str:
        """Return the condition that every number in a run of an output array is finite."""
        return f"{ALL_FINITE}({run.array.name}, {run.start}, {run.stop})"

    def argument(self, array: str, is_common: bool, is_read: bool) -> str:
        """Return the declaration of an array that a part of a function takes, a pointer or a view."""
        return f"{array}_type {array}"

    def part(self, name: str, may_fail: bool, arrays: Sequence[str]) -> str:
        """Return the beginning of the definition of a part, up to its arguments.

        A compiler that joined the parts would need too long for the whole.
        """
        kind = self.status if may_fail else "void"
        return f"{template(arrays)}{BREAK}static __device__ __noinline__ {kind} {name}"


def template(arrays: Sequence[str]) -> str:
    """Return the list of template parameters of a function: the types of the arrays of these names."""
    return f"template <{f',{BREAK}'.join(f'typename {array}_type' for array in arrays)}>"
