"""Drop every instruction that no output needs."""

from __future__ import annotations

from kanegen.program.ir import Program
from kanegen.program.selection import needed, selected


def prune(program: Program) -> Program:
    """The same outputs without dead code; the order of what remains is kept."""
    return selected(program, needed(program, program.results()))
