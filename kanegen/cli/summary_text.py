"""The summary of `kanegen info` on a terminal: the tree, then a section for everything else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich import box
from rich.columns import Columns
from rich.console import Console, RenderableType
from rich.markup import escape
from rich.segment import Segments
from rich.table import Table
from rich.tree import Tree

from kanegen.cli.model_facts import ModelFacts
from kanegen.cli.summary import RightAngleChanges, Summary
from kanegen.errors import counted
from kanegen.model.body import Body
from kanegen.model.coordinates import NOTES, ORIENTATIONS, selected_freedoms
from kanegen.model.identification.base_parameters import BaseParameters
from kanegen.model.numbers import Number, toml_number, value_of
from kanegen.model.system import System
from kanegen.model.system_numbers import expression_summaries
from kanegen.program.count import PREPARE, kinds
from kanegen.program.passes import savings
from kanegen.studies.explain.exactness import STATES

WIDEST = 2**16
"""Characters of a line of a tree or a table; rich would cut off lines wider than the screen."""

SYMBOLS = {"mass_matrix": "[A]", "forcing": "{f}", "ydot": "{ydot}"}
"""The letters of the notes by the names of the results that exact right angles change."""


def show(summary: Summary, console: Console, verbose: bool = False, sums: bool = False) -> None:
    """Print a summary: the tree, its sections, and the changes of exact right angles.

    Args:
        summary: The summary.
        console: Where to print.
        verbose: Whether to name all frames, limits and bodies that a line counts.
        sums: Whether to print the base parameters as sums of inertial parameters.
    """
    system = summary.system
    bodies = counted(system.number_of_bodies, "body", "bodies")
    freedoms = counted(len(system.freedoms), "freedom")
    gravity = ", ".join(_text(value) for value in system.gravity)
    console.print(f"[bold]{escape(system.name)}[/]: {bodies}, {freedoms}, gravity ({gravity}) m/s^2\n")
    _print_whole(_tree(system), console)
    _show_facts(summary.facts, console, verbose)
    for title, remark, content in _sections(summary):
        console.print(f"\n[bold]{title}[/]{remark}")
        if isinstance(content, Table):
            _print_whole(content, console)
        else:
            console.print(content)
    if summary.uncounted:
        text = f"further outputs, counted with --all: {', '.join(summary.uncounted)}"
        console.print(escape(text), soft_wrap=True)
    if summary.steps:
        console.print(f"steps and rollouts in C: {', '.join(summary.steps)}", soft_wrap=True)
    saved = ", ".join(f"{name} {number}" for name, number in savings(summary.stages).items())
    console.print(f"passes saved: {saved or 'none was run'}")
    console.print(", ".join(f"{name} by {method}" for name, method in summary.methods.items()))
    if summary.massless:
        names = ", ".join(summary.massless)
        text = (
            f"[A] is singular in every state, because these freedoms move neither mass nor inertia: {names}"
        )
        console.print(escape(text), soft_wrap=True)
    else:
        console.print(escape(f"refinement of forward_dynamics: {summary.refinement}"))
    _show_base_parameters(summary.base, console, sums)
    if summary.dependent:
        text = (
            "these directions cannot be held, because others hold them in every state or nothing moves them"
        )
        console.print(escape(f"{text}: {', '.join(summary.dependent)}"), soft_wrap=True)
    if summary.right_angles:
        _show_right_angles(summary.right_angles, console)


def _print_whole(content: Tree | Table, console: Console) -> None:
    """Print a tree or a table with whole lines, which the terminal wraps where they are wider than it is."""
    drawing = console.render(content, console.options.update_width(WIDEST))
    console.print(Segments(drawing), soft_wrap=True)


def _show_facts(facts: ModelFacts, console: Console, verbose: bool) -> None:
    """Print facts on the model beside its equations, and what its reader left out."""
    lines = list(facts.lines(verbose))
    if lines:
        console.print("\n[bold]Frames, limits and masses[/]")
    for line in lines:
        console.print(escape(line), soft_wrap=True)
    if facts.left_out:
        console.print("\n[bold]Left out, changed or inaccurate[/] in reading")
    for line in facts.left_out:
        console.print(escape(line), soft_wrap=True)


def _sections(summary: Summary) -> Iterator[tuple[str, str, RenderableType]]:
    """Yield title, remark and content of each section; empty sections are left out."""
    system = summary.system
    has_other_coordinates = system.coordinate_names != system.freedom_names
    if has_other_coordinates:
        units = [coordinate.unit for coordinate in system.coordinates]
        yield "Coordinates", ", in the order of x", _columns(system.coordinate_names, units)
    yield "Freedoms", f", in the order of {'y' if has_other_coordinates else 'x and y'}", _freedoms(system)
    if system.prescribed:
        units = [freedom.unit for freedom in system.prescribed]
        remark = ", in the order of the columns of prescribed"
        yield "Prescribed freedoms", remark, _columns(system.prescribed_names, units)
    if system.couplings:
        equations = escape("\n".join(system.coupling_equations))
        yield "Couplings", ", which take freedoms out of x and y", equations
    if system.motor_summaries:
        yield "Motors", ", with inertia of their own", escape("\n".join(system.motor_summaries))
    if system.contacts:
        lines = escape("\n".join(contact.summary for contact in system.contacts))
        yield "Contacts", ", which contact_dynamics and contact_forces hold", lines
    if system.parameters:
        yield "Parameters", ", with their defaults", _parameters(system)
    if expressions := expression_summaries(system):
        remark = " of parameters, checked for the defaults: masses and inertias must not become negative"
        yield "Expressions", remark, escape("\n".join(expressions))
    if system.force_elements:
        yield (
            "Force elements",
            "",
            escape("\n".join(element.summary for element in system.named_force_elements)),
        )
    yield "Operations", " of one evaluation", _costs(summary)


def _tree(system: System) -> Tree:
    """Return the tree of bodies, each with its freedoms and its mass."""
    tree = Tree("ground")
    branches = [tree]
    for k, body in enumerate(system.bodies, start=1):
        free = escape(_moving(body) or "welded")
        if body.joint.coordinates != ORIENTATIONS[0]:
            free = f"{free} ({body.joint.coordinates})"
        if body.joint.sequence != NOTES:
            free = f"{free} ({body.joint.sequence})"
        loads = ", takes loads" if body.loads else ""
        label = f"{k} [bold]{escape(body.name)}[/]  {free}  [dim]{_text(body.mass)} kg{loads}[/]"
        branches.append(branches[body.lower].add(label))
    return tree


def _freedoms(system: System) -> Columns:
    """Return the freedoms in columns, with their units and speeds."""
    pairs = zip(system.freedom_names, system.speed_names, strict=True)
    speeds = [f", {escape(speed)}" if speed != name else "" for name, speed in pairs]
    per_second = "/s" if system.coordinate_names != system.freedom_names else ""
    units = [f"{freedom.unit}{per_second}" for freedom in system.freedoms]
    return _columns(system.freedom_names, units, speeds)


def _columns(names: Sequence[str], units: Sequence[str], remarks: Sequence[str] | None = None) -> Columns:
    """Arrange numbered names in columns, each with its unit and a remark."""
    rows = zip(names, units, remarks or [""] * len(names), strict=True)
    cells = [f"{i} {escape(name)} ({unit}){remark}" for i, (name, unit, remark) in enumerate(rows)]
    return Columns(cells, column_first=True, padding=(0, 3))


def _parameters(system: System) -> Table:
    """Return the table of run-time parameters."""
    table = Table("name", "default", box=box.SIMPLE_HEAD)
    for parameter in system.parameters:
        table.add_row(parameter.name, repr(parameter.value))
    return table


def _costs(summary: Summary) -> Table:
    """Return the table of operation counts."""
    columns = kinds((*summary.operations.values(), *(stage.operations for stage in summary.stages)))
    table = Table("", *columns, box=box.SIMPLE_HEAD)
    for column in table.columns[1:]:
        column.justify = "right"
    for name, counts in summary.operations.items():
        table.add_row(name, *(str(counts.get(kind, 0)) for kind in columns))
    for stage in summary.stages:
        cells = ("" if kind == PREPARE else str(stage.operations.get(kind, 0)) for kind in columns)
        table.add_row(f"[dim]this after {stage.name}[/]", *cells)
    return table


def _show_base_parameters(base: BaseParameters, console: Console, sums: bool) -> None:
    """Print the number of base parameters, and the sums that they are."""
    certainty = "" if base.is_proven else ", as random positions show"
    hint = ":" if sums else " (--base-parameters names them)"
    count = counted(len(base), "combination is a base parameter", "combinations are base parameters")
    text = f"of {len(base.parameters)} inertial parameters {count}{certainty}{hint}"
    console.print(text, soft_wrap=True)
    if sums and base.at_defaults:
        console.print(f"  at the default values of {', '.join(base.at_defaults)}", soft_wrap=True)
    for name in base.names if sums else ():
        console.print(f"  {name}", soft_wrap=True)


def _show_right_angles(changes: RightAngleChanges, console: Console) -> None:
    """Print the changes by exact right angles: bodies, results and operations."""
    found, limit = changes.exactness, f"{changes.tolerance:g}"
    hint = "are exact here" if changes.applied else f"are as written; --right-angles {limit} makes them exact"
    console.print(f"\n[bold]Right angles[/] missed by no more than {limit} rad {hint}", soft_wrap=True)
    table = Table("body", "turned, rad", "shifted, m", "inertia, relative", box=box.SIMPLE_HEAD)
    for column in table.columns[1:]:
        column.justify = "right"
    for body in found.bodies:
        table.add_row(escape(body.body), *(f"{x:.1e}" for x in (body.turned, body.shifted, body.inertia)))
    _print_whole(table, console)
    results = ", ".join(f"{SYMBOLS[name]} {change:.1e}" for name, change in found.results.items())
    verb = "changes" if changes.applied else "would change"
    text = f"relative to the model as written this {verb}: {results}, at most in {STATES} random states"
    console.print(escape(text), soft_wrap=True)
    costs = ", ".join(f"{name} {old} to {new}" for name, (old, new) in found.operations.items())
    console.print(f"operations: {costs}", soft_wrap=True)


def _moving(body: Body) -> str:
    """Return the free, prescribed and coupled freedoms of a body in words."""
    joint = body.joint
    kinds = (("", joint.free), ("prescribed ", joint.prescribed), ("coupled ", joint.coupled))
    return ", ".join(word + " ".join(selected_freedoms(flags)) for word, flags in kinds if any(flags))


def _text(value: Number) -> str:
    """Return a number; after the name of a parameter, or the text of an expression, it is at the defaults."""
    shown = f"{value_of(value):g}"
    return shown if isinstance(value, float) else f"{toml_number(value)} = {shown}"
