"""`kanegen info`: the tree drawn, its freedoms and parameters, and what its equations cost."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from typing import Any

from rich import box
from rich.columns import Columns
from rich.console import Console
from rich.markup import escape
from rich.segment import Segments
from rich.table import Table
from rich.tree import Tree

from kanegen import compiler
from kanegen import variant as variants
from kanegen.body import FREEDOMS, Body, named
from kanegen.cli import right_angles
from kanegen.cli.right_angles import Angles
from kanegen.derivatives import DERIVATIVES
from kanegen.numbers import Number, Parameter, map_numbers, value_of
from kanegen.program.passes import Stage, savings
from kanegen.sequences import NOTES
from kanegen.signature import EQUATIONS, available
from kanegen.system import System

TOGETHER = " + ".join(EQUATIONS)

WIDEST = 2**16
"""Columns for the tree: what goes beyond them, or beyond the screen's, rich would leave out."""


@dataclass(frozen=True)
class Facts:
    """A system and its operation counts.

    Attributes:
        system: The tree.
        operations: By output, and of [A] and {f} together.
        methods: How each output is derived.
        refinement: Whether {ydot} is refined, and why.
        stages: What all outputs together cost after lowering and after every pass.
        right_angles: What it changes to take them; None where the model misses none.
    """

    system: System
    operations: dict[str, dict[str, int]]
    methods: dict[str, str]
    refinement: str
    stages: tuple[Stage, ...]
    right_angles: Angles | None

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        system = self.system
        return {
            "name": system.name,
            "gravity": map_numbers(system.gravity, value_of),
            "bodies": [
                {
                    "number": k,
                    "name": body.name,
                    "connection": body.lower,
                    "mass": value_of(body.mass),
                    "free": named(body.joint.free),
                    "prescribed": named(body.joint.prescribed),
                    "coordinates": body.joint.coordinates,
                    "sequence": body.joint.sequence,
                    "loads": body.loads,
                }
                for k, body in enumerate(system.bodies, start=1)
            ],
            "coordinates": [
                {"name": name, "body": coordinate.body, "unit": coordinate.unit}
                for name, coordinate in zip(system.coordinate_names, system.coordinates, strict=True)
            ],
            "freedoms": [
                {"name": name, "body": freedom.body, "freedom": FREEDOMS[freedom.index], "unit": freedom.unit}
                for name, freedom in zip(system.freedom_names, system.freedoms, strict=True)
            ],
            "prescribed": [
                {"name": name, "body": freedom.body, "freedom": FREEDOMS[freedom.index], "unit": freedom.unit}
                for name, freedom in zip(system.prescribed_names, system.prescribed, strict=True)
            ],
            "speeds": list(system.speed_names),
            "poses": list(system.pose_names),
            "reactions": [
                {
                    "name": name,
                    "body": freedom.body,
                    "freedom": FREEDOMS[freedom.index],
                    "unit": freedom.effort,
                }
                for name, freedom in zip(system.reaction_names, system.reacting, strict=True)
            ],
            "parameters": {parameter.name: parameter.value for parameter in system.parameters},
            "force_elements": [
                {"kind": element.KEY, **element.as_table()} for element in system.force_elements
            ],
            "operations": self.operations,
            "methods": self.methods,
            "refinement": self.refinement,
            "passes": [asdict(stage) for stage in self.stages],
            "saved": savings(self.stages),
            "right_angles": self.right_angles.as_dict() if self.right_angles else None,
        }


def gather(
    system: System,
    progress: Callable[[str], None],
    without: Iterable[str] | None = None,
    angles: Angles | None = None,
) -> Facts:
    """Count what every output costs alone and all together, without some passes if so wished."""
    variant = variants.chosen(without=without)
    # Derivatives of a large tree take minutes, and nobody has asked for them.
    names = [name for name in available(system) if name not in DERIVATIVES]
    alone = {name: compiler.compile_module(system, (name,), progress, variant) for name in names}
    together = compiler.compile_module(system, EQUATIONS, progress, variant)
    operations = {name: compiled.operations for name, compiled in alone.items()}
    methods = {name: compiled.methods[name] for name, compiled in alone.items()}
    refinement = alone["forward_dynamics"].refinement
    operations[TOGETHER] = together.operations
    return Facts(system, operations, methods, refinement, together.stages, angles)


def show(facts: Facts, console: Console) -> None:
    """Print the facts for people."""
    system = facts.system
    n, bodies = len(system.freedoms), system.number_of_bodies
    gravity = ", ".join(_text(value) for value in system.gravity)
    console.print(f"[bold]{system.name}[/]: {bodies} bodies, {n} freedoms, gravity ({gravity}) m/s^2\n")
    drawing = console.render(_tree(system), console.options.update_width(WIDEST))
    console.print(Segments(drawing), soft_wrap=True)
    if len(system.coordinates) > n:
        console.print("\n[bold]Coordinates[/], in the order of x")
        console.print(_coordinates(system))
        console.print("\n[bold]Freedoms[/], in the order of y")
    else:
        console.print("\n[bold]Freedoms[/], in the order of x and y")
    console.print(_freedoms(system))
    if system.prescribed:
        console.print("\n[bold]Prescribed freedoms[/], in the order of the columns of prescribed")
        console.print(_prescribed(system))
    if system.parameters:
        console.print("\n[bold]Parameters[/], with their defaults")
        console.print(_parameters(system))
    if system.force_elements:
        console.print("\n[bold]Force elements[/]")
        console.print(escape("\n".join(element.words for element in system.force_elements)))
    console.print("\n[bold]Operations[/] of one evaluation")
    console.print(_costs(facts))
    saved = ", ".join(f"{name} {number}" for name, number in savings(facts.stages).items())
    console.print(f"passes saved: {saved or 'none was run'}")
    console.print(", ".join(f"{name} by {method}" for name, method in facts.methods.items()))
    console.print(escape(f"refinement of forward_dynamics: {facts.refinement}"))
    if facts.right_angles:
        right_angles.show(facts.right_angles, console)


def _tree(system: System) -> Tree:
    tree = Tree("ground")
    branches = [tree]
    for k, body in enumerate(system.bodies, start=1):
        free = escape(_moving(body) or "welded")
        if body.joint.is_quaternion:
            free = f"{free} (quaternion)"
        if body.joint.sequence != NOTES:
            free = f"{free} ({body.joint.sequence})"
        loads = ", takes loads" if body.loads else ""
        label = f"{k} [bold]{escape(body.name)}[/]  {free}  [dim]{_text(body.mass)} kg{loads}[/]"
        branches.append(branches[body.lower].add(label))
    return tree


def _coordinates(system: System) -> Columns:
    rows = zip(system.coordinate_names, system.coordinates, strict=True)
    cells = [f"{i} {escape(name)} ({coordinate.unit})" for i, (name, coordinate) in enumerate(rows)]
    return Columns(cells, column_first=True, padding=(0, 3))


def _freedoms(system: System) -> Columns:
    rows = zip(system.freedom_names, system.speed_names, system.freedoms, strict=True)
    cells = [
        f"{i} {escape(name)} ({freedom.unit})" + (f", {escape(speed)}" if speed != name else "")
        for i, (name, speed, freedom) in enumerate(rows)
    ]
    return Columns(cells, column_first=True, padding=(0, 3))


def _prescribed(system: System) -> Columns:
    rows = zip(system.prescribed_names, system.prescribed, strict=True)
    cells = [f"{i} {escape(name)} ({freedom.unit})" for i, (name, freedom) in enumerate(rows)]
    return Columns(cells, column_first=True, padding=(0, 3))


def _parameters(system: System) -> Table:
    table = Table("name", "default", box=box.SIMPLE_HEAD)
    for parameter in system.parameters:
        table.add_row(parameter.name, repr(parameter.value))
    return table


def _costs(facts: Facts) -> Table:
    kinds = list(facts.operations[TOGETHER])
    table = Table("", *kinds, box=box.SIMPLE_HEAD)
    for column in table.columns[1:]:
        column.justify = "right"
    for name, counts in facts.operations.items():
        table.add_row(name, *(str(counts[kind]) for kind in kinds))
    for stage in facts.stages:
        cells = (str(stage.operations.get(kind, "")) for kind in kinds)
        table.add_row(f"[dim]this after {stage.name}[/]", *cells)
    return table


def _moving(body: Body) -> str:
    kinds = (("", body.joint.free), ("prescribed ", body.joint.prescribed))
    return ", ".join(word + " ".join(named(flags)) for word, flags in kinds if any(flags))


def _text(value: Number) -> str:
    return f"{value.name} = {value.value:g}" if isinstance(value, Parameter) else f"{value:g}"
