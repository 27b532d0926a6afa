"""Exact counts of the operations of a program."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from kanegen.program.ir import CHOICES, EVALUATE, TRANSCENDENTAL, Module, Op, Program

COUNTED = {
    Op.ADD: "add",
    Op.SUBTRACT: "add",
    Op.MULTIPLY: "multiply",
    Op.DIVIDE: "divide",
    Op.SQRT: "sqrt",
    Op.SIN: "sincos",
    Op.COS: "sincos",
    **dict.fromkeys(CHOICES, "compare"),
    **dict.fromkeys(TRANSCENDENTAL, "function"),
}
"""The kind under which each operation is counted; all others cost nothing."""

ALWAYS_LISTED = ("add", "multiply", "divide", "sqrt", "sincos")
"""Kinds that stand in every count; the others stand in it where they occur."""

PREPARE = "prepare"
"""The kind of all operations that depend on parameters alone."""


def count(program: Program) -> dict[str, int]:
    """Count the operations of one evaluation by kind; sign changes and magnitudes are free.

    Loops count with every pass that they make for a column.

    "add" includes subtractions. "compare" counts signs, minima, maxima and conditions, and "function" calls
    of exp, log, tanh and atan2; these two are left out where there are none.
    """
    found = Counter(COUNTED[i.op] for i in program.instructions if i.op in COUNTED)
    for output in program.outputs:
        found.update(output.solution.operations if output.solution else {})
    return {
        kind: found[kind] for kind in dict.fromkeys(COUNTED.values()) if kind in ALWAYS_LISTED or found[kind]
    }


def kinds(counts: Iterable[Mapping[str, int]]) -> tuple[str, ...]:
    """Return the kinds that occur in some of several counts, in the order of a count."""
    found = set().union(*counts)
    return tuple(kind for kind in dict.fromkeys((*COUNTED.values(), PREPARE)) if kind in found)


def operations(module: Module) -> dict[str, int]:
    """Count the operations of one evaluation of all outputs by kind; "prepare" is the total of `prepare`.

    Outputs are evaluated by the function for all of them if there is one, and otherwise by all functions.
    """
    has_all = EVALUATE in module.functions
    programs = [module.functions[EVALUATE]] if has_all else list(module.functions.values())
    counts = [count(program) for program in programs]
    prepare = sum(count(module.prepare).values()) if module.prepare else 0
    return {kind: sum(one.get(kind, 0) for one in counts) for kind in kinds(counts)} | {PREPARE: prepare}
