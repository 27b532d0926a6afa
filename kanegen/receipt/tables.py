"""The rows of a receipt, in words."""

from __future__ import annotations

from kanegen.receipt.receipt import Receipt, Step

HEADS = ("without", "operations", "once", "freedoms", "parameters", "inputs", "C, KiB", "compiling, s")


def heads(receipt: Receipt) -> list[str]:
    """Of the columns."""
    return list(HEADS if receipt.steps[0].seconds is not None else HEADS[:-1])


def rows(receipt: Receipt) -> list[list[str]]:
    """A row for each step, the general program first."""
    return [_row(step, len(heads(receipt))) for step in receipt.steps]


def _row(step: Step, width: int) -> list[str]:
    numbers = (step.total, step.operations["prepare"], step.freedoms, step.parameters, step.inputs)
    size = f"{step.bytes / 1024:.1f}"
    time = "" if step.seconds is None else f"{step.seconds:.2f}"
    return [step.without, *map(str, numbers), size, time][:width]
