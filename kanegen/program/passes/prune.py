"""The pass that drops every instruction which no output needs."""

from __future__ import annotations

from kanegen.program.ir import Program
from kanegen.program.selection import dependencies, subprogram


def prune(program: Program) -> Program:
    """Return the same outputs without dead code; the order of the remaining instructions is kept."""
    return subprogram(program, dependencies(program, program.results()))
