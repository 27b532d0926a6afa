"""The rows of a receipt, in words."""

from __future__ import annotations

from kanegen.studies.explain.costs import SYSTEM
from kanegen.studies.explain.receipt import Receipt, Step

HEADS = ("without", "operations", "once", "freedoms", "parameters", "inputs", "C, KiB", "compiling, s")


def heads(receipt: Receipt) -> list[str]:
    """Of the columns."""
    return list(HEADS if receipt.steps[0].seconds is not None else HEADS[:-1])


def rows(receipt: Receipt) -> list[list[str]]:
    """A row for each step, the general program first."""
    return [_row(step, len(heads(receipt))) for step in receipt.steps]


def bodies(receipt: Receipt) -> list[tuple[str, str]]:
    """What each body costs, the dearest first: its number and name, and operations."""
    names = {SYSTEM: "all bodies"}
    names |= {k: f"{k} {body.name}" for k, body in enumerate(receipt.system.bodies, start=1)}
    costs = sorted(receipt.bodies.items(), key=lambda item: -item[1])
    return [(names[k], str(operations)) for k, operations in costs if operations]


def outputs(receipt: Receipt) -> list[tuple[str, str]]:
    """What each output costs by itself, where there are several."""
    alone = receipt.alone if len(receipt.alone) > 1 else {}
    return [(name, str(operations)) for name, operations in alone.items()]


def _row(step: Step, width: int) -> list[str]:
    numbers = (step.total, step.operations["prepare"], step.freedoms, step.parameters, step.inputs)
    size = f"{step.bytes / 1024:.1f}"
    time = "" if step.seconds is None else f"{step.seconds:.2f}"
    return [step.without, *map(str, numbers), size, time][:width]
