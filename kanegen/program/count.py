"""Exact operation counts."""

from __future__ import annotations

from collections import Counter

from kanegen.program.ir import Module, Op, Program

COUNTED = {
    Op.ADD: "add",
    Op.SUBTRACT: "add",
    Op.MULTIPLY: "multiply",
    Op.DIVIDE: "divide",
    Op.SQRT: "sqrt",
    Op.SIN: "sincos",
    Op.COS: "sincos",
}


def count(program: Program) -> dict[str, int]:
    """Operations of one evaluation: "add" holds subtractions too, a sign change is free."""
    found = Counter(COUNTED[i.op] for i in program.instructions if i.op in COUNTED)
    return {kind: found[kind] for kind in ("add", "multiply", "divide", "sqrt", "sincos")}


def operations(module: Module) -> dict[str, int]:
    """What one evaluation of all outputs together costs; "prepare" is the parameter-only step."""
    prepare = sum(count(module.prepare).values()) if module.prepare else 0
    return {**count(module.together), "prepare": prepare}
