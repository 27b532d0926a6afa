"""The facts of `kanegen info` on a terminal: the tree drawn, then a section for everything else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich import box
from rich.columns import Columns
from rich.console import Console, RenderableType
from rich.markup import escape
from rich.segment import Segments
from rich.table import Table
from rich.tree import Tree

from kanegen.cli import right_angles
from kanegen.cli.facts import TOGETHER, Facts
from kanegen.model.body import Body
from kanegen.model.freedoms import named
from kanegen.model.numbers import Number, Parameter
from kanegen.model.sequences import NOTES
from kanegen.model.system import System
from kanegen.program.passes import savings

WIDEST = 2**16
"""Columns for the tree: what goes beyond them, or beyond the screen's, rich would leave out."""


def show(facts: Facts, console: Console) -> None:
    """Print the facts for people."""
    system = facts.system
    n, bodies = len(system.freedoms), system.number_of_bodies
    gravity = ", ".join(_text(value) for value in system.gravity)
    console.print(f"[bold]{system.name}[/]: {bodies} bodies, {n} freedoms, gravity ({gravity}) m/s^2\n")
    drawing = console.render(_tree(system), console.options.update_width(WIDEST))
    console.print(Segments(drawing), soft_wrap=True)
    for title, remark, content in _sections(facts):
        console.print(f"\n[bold]{title}[/]{remark}")
        console.print(content)
    saved = ", ".join(f"{name} {number}" for name, number in savings(facts.stages).items())
    console.print(f"passes saved: {saved or 'none was run'}")
    console.print(", ".join(f"{name} by {method}" for name, method in facts.methods.items()))
    console.print(escape(f"refinement of forward_dynamics: {facts.refinement}"))
    if facts.right_angles:
        right_angles.show(facts.right_angles, console)


def _sections(facts: Facts) -> Iterator[tuple[str, str, RenderableType]]:
    """Title, remark and content of what a system has."""
    system = facts.system
    quaternions = len(system.coordinates) > len(system.freedoms)
    if quaternions:
        units = [coordinate.unit for coordinate in system.coordinates]
        yield "Coordinates", ", in the order of x", _columns(system.coordinate_names, units)
    yield "Freedoms", f", in the order of {'y' if quaternions else 'x and y'}", _freedoms(system)
    if system.prescribed:
        units = [freedom.unit for freedom in system.prescribed]
        remark = ", in the order of the columns of prescribed"
        yield "Prescribed freedoms", remark, _columns(system.prescribed_names, units)
    if system.parameters:
        yield "Parameters", ", with their defaults", _parameters(system)
    if system.force_elements:
        yield "Force elements", "", escape("\n".join(element.words for element in system.force_elements))
    yield "Operations", " of one evaluation", _costs(facts)


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


def _freedoms(system: System) -> Columns:
    pairs = zip(system.freedom_names, system.speed_names, strict=True)
    speeds = [f", {escape(speed)}" if speed != name else "" for name, speed in pairs]
    return _columns(system.freedom_names, [freedom.unit for freedom in system.freedoms], speeds)


def _columns(names: Sequence[str], units: Sequence[str], remarks: Sequence[str] | None = None) -> Columns:
    """Numbered names with their units and what else is to be said of each."""
    rows = zip(names, units, remarks or [""] * len(names), strict=True)
    cells = [f"{i} {escape(name)} ({unit}){remark}" for i, (name, unit, remark) in enumerate(rows)]
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
