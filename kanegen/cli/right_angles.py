"""`kanegen info`: right angles that a model misses, and what it changes to take them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kanegen.studies.explain import Exactness
from kanegen.studies.explain.exactness import STATES

SYMBOLS = {"mass_matrix": "[A]", "forcing": "{f}", "ydot": "{ydot}"}


@dataclass(frozen=True)
class Angles:
    """What a tolerance changes, or would.

    Attributes:
        tolerance: It (rad).
        taken: Whether the system that is shown has exact right angles.
        found: The difference.
    """

    tolerance: float
    taken: bool
    found: Exactness

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return {"tolerance": self.tolerance, "taken": self.taken, **self.found.as_dict()}


def show(angles: Angles, console: Console) -> None:
    """Print the bodies that differ, by how much results do, and what that saves."""
    found, limit = angles.found, f"{angles.tolerance:g}"
    miss = f"[bold]Right angles[/] missed by no more than {limit} rad"
    hint = "are exact here" if angles.taken else f"are as written; --right-angles {limit} makes them exact"
    console.print(f"\n{miss} {hint}", soft_wrap=True)
    table = Table("body", "turned, rad", "shifted, m", "inertia, relative", box=box.SIMPLE_HEAD)
    for column in table.columns[1:]:
        column.justify = "right"
    for body in found.bodies:
        table.add_row(escape(body.body), *(f"{x:.1e}" for x in (body.turned, body.shifted, body.inertia)))
    console.print(table)
    changes = ", ".join(f"{SYMBOLS[name]} {change:.1e}" for name, change in found.results.items())
    verb = "changes" if angles.taken else "would change"
    words = f"relative to the model as written this {verb}: {changes}, at most in {STATES} random states"
    console.print(escape(words), soft_wrap=True)
    costs = ", ".join(f"{name} {old} to {new}" for name, (old, new) in found.operations.items())
    console.print(f"operations: {costs}", soft_wrap=True)
