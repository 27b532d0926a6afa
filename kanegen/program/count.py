"""Exact counts of the operations of a program."""

from __future__ import annotations

from collections import Counter

from kanegen.program.ir import EVALUATE, Module, Op, Program

COUNTED = {
    Op.ADD: "add",
    Op.SUBTRACT: "add",
    Op.MULTIPLY: "multiply",
    Op.DIVIDE: "divide",
    Op.SQRT: "sqrt",
    Op.SIN: "sincos",
    Op.COS: "sincos",
}
"""The kind under which each operation is counted; all others cost nothing."""


def count(program: Program) -> dict[str, int]:
    """Count the operations of one evaluation by kind; "add" includes subtractions, a sign change is free."""
    found = Counter(COUNTED[i.op] for i in program.instructions if i.op in COUNTED)
    return {kind: found[kind] for kind in ("add", "multiply", "divide", "sqrt", "sincos")}


def operations(module: Module) -> dict[str, int]:
    """Count the operations of one evaluation of all outputs by kind; "prepare" is the total of `prepare`.

    Outputs are evaluated by the function for all of them if there is one, and otherwise by all functions.
    """
    has_all = EVALUATE in module.functions
    programs = [module.functions[EVALUATE]] if has_all else list(module.functions.values())
    counts = [count(program) for program in programs]
    prepare = sum(count(module.prepare).values()) if module.prepare else 0
    return {kind: sum(one[kind] for one in counts) for kind in counts[0]} | {"prepare": prepare}
