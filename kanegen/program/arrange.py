"""Choose the order in which the instructions of a program stand, by what a processor executes for it.

A derivation goes body by body and carries every column of [A] along. With many columns, more values are alive
than a processor has registers, and each of them waits in memory. Programs with divisions, for which others
wait, leave a processor idle unless the longest chain of operations goes on. No order changes a bit.
"""

from __future__ import annotations

from kanegen.program.cut import cut
from kanegen.program.ir import Op, Program
from kanegen.program.machine import instructions
from kanegen.program.orders import by_rows, depth_first, longest_chain_first

SEEN = 400
"""Instructions of a program that a processor sees at once, so that their order does not matter."""

GAIN = 0.95
"""Largest share of the instructions of the derived order that another order has where it is taken."""

COUNTED = 20000
"""Number of instructions up to which orders are compared; for longer programs counting takes too long, and
computing each result in turn has always gained."""


def arrange(program: Program) -> Program:
    """Return the program in the order that is likely to take least time, which is its own if it is short."""
    length = len(program.instructions)
    if length <= SEEN:
        return program
    if length > COUNTED:
        return depth_first(program)
    parts = cut(program)
    if len(parts) == 1:
        waits = any(x.op in (Op.DIVIDE, Op.SQRT) for x in program.instructions)
        return longest_chain_first(program) if waits else program
    others = [by_rows(program), depth_first(program)]
    counts = [instructions(cut(other)) for other in others]
    least = min(counts)
    return others[counts.index(least)] if least <= GAIN * instructions(parts) else program
