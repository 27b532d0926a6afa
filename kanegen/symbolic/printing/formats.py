"""The formats in which equations are printed: text, Markdown, LaTeX and a Python module."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from sympy import ImmutableMatrix

from kanegen.choices import require_one
from kanegen.errors import ModelError, OptionError, quoted
from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import MOST_FREEDOMS_WITHOUT_NAMES, Equations, derive
from kanegen.symbolic.printers import escaped
from kanegen.symbolic.printing.document import Extent, document
from kanegen.symbolic.printing.linear_model import render_linear_model
from kanegen.symbolic.printing.prose import prose
from kanegen.symbolic.printing.python_blocks import python_blocks
from kanegen.symbolic.printing.python_module import python_module
from kanegen.symbolic.printing.statements import Part, Section, Statement

ONLY: dict[str, frozenset[Part]] = {
    "blocks": frozenset([Part.BLOCKS]),
    "definitions": frozenset([Part.SYSTEM, Part.DEFINITIONS, Part.RESULT]),
    "closed": frozenset([Part.SYSTEM, Part.RESULT]),
    "linear": frozenset(),
}
"""Parts of a document that are printed alone, by the name of the choice."""

MOST_BODIES_IN_BLOCKS = 16
"""Number of bodies up to which rows of blocks, two for each body, help a reader who does not ask for them."""

NO_FORM = ClosedForm(ImmutableMatrix(0, 0, []), ImmutableMatrix(0, 1, []))
"""No [A] and {f}, where they are not printed."""


def render(
    equations: Equations,
    format: str = "text",
    closed: bool | None = None,
    only: str | None = None,
    body: str | int | None = None,
) -> str:
    """Return equations as text to read, or as a Python module to run.

    Example:
        print(render(kg.derive(kg.load("models/double_pendulum.toml")), "markdown"))

    Args:
        equations: The equations that `derive` returns.
        format: One of `FORMATS`.
        closed: Whether to print the closed form, without intermediates; by default where there are at most
            `MOST_FREEDOMS_WITHOUT_NAMES` freedoms and it is short enough.
        only: One of `ONLY`, to print nothing else: "blocks", the rows of 3 x 3 blocks of the notes;
            "definitions", the named intermediates with [A] and {f} in them; "closed", the closed form;
            "linear", the linear model about rest in the neutral coordinates, in symbols; for other states
            see `Equations.linearize`.
        body: Name of a body or frame, or number of a body from 1, to print its equations alone: its blocks,
            its definitions, and the rows of [A] and {f} of its freedoms.

    Raises:
        OptionError: If a name is unknown, a closed form is asked for that would be too long, or something
            is asked for that is no Python.
        ModelError: If there is no such body.
    """
    require_one("format", format, FORMATS)
    parts = frozenset(Part)
    if only is not None:
        require_one("part", only, ONLY)
        parts = ONLY[only]
        closed = only == "closed"
    if only == "linear":
        if body is not None:
            raise OptionError("body: a linear model is one of the whole system. Leave the body out.")
        return render_linear_model(equations.linearize(), format)
    if format == "python" and body is not None and only != "blocks":
        raise OptionError(
            "format: there is no Python of the rows of [A] and {f} of one body. Print its blocks (only="
            '"blocks"), text, markdown or latex, or all equations.'
        )
    extent = Extent(parts, _number(equations, body))
    if format == "python" and only == "blocks":
        named = equations if equations.intermediates else derive(equations.system, intermediates=True)
        return python_blocks(named, extent.body)
    if only != "blocks" and (form := _closed_form(equations, closed, everywhere=format == "python")):
        return FORMATS[format](derive(equations.system, intermediates=False), form, extent)
    named = equations if equations.intermediates else derive(equations.system, intermediates=True)
    if only is None and len(named.bodies) > MOST_BODIES_IN_BLOCKS:
        extent = replace(extent, parts=parts - {Part.BLOCKS})
    form = ClosedForm(named.A, named.f) if Part.RESULT in parts else NO_FORM
    return FORMATS[format](named, form, extent)


def _number(equations: Equations, body: str | int | None) -> int:
    """Return the number of a body, 0 for none.

    Raises:
        ModelError: If there is no such body.
    """
    if body is None:
        return 0
    system = equations.system
    if isinstance(body, str) and body not in system.frame_names and body.isdecimal():
        body = int(body)
    number = system.frame(body, "body").body
    if number == 0:
        raise ModelError(f"body {quoted(body)} is fixed to the ground and has no equations of its own.")
    return number


def _closed_form(equations: Equations, closed: bool | None, everywhere: bool) -> ClosedForm | None:
    """Return the closed form, or None where it is not wanted or not asked for and too long."""
    small = len(equations.x) <= MOST_FREEDOMS_WITHOUT_NAMES
    if closed is False or (closed is None and not small):
        return None
    try:
        return equations.closed_form(everywhere)
    except OptionError:
        if closed:
            raise
        return None


def _text(equations: Equations, form: ClosedForm, extent: Extent) -> str:
    """Return the document as plain text."""
    described = document(equations, form, extent)
    parts = [f"{described.title}\n{described.note}"]
    for section in described.sections:
        lines = [f"{section.title}. {section.note}".rstrip()]
        lines += [f"  {line}" for statement in section.statements for line in statement.text.split("\n")]
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def _markdown(equations: Equations, form: ClosedForm, extent: Extent) -> str:
    """Return the document in Markdown."""
    described = document(equations, form, extent)
    parts = [f"# {described.title}", prose(described.note, str)]
    for section in described.sections:
        parts += [f"## {prose(section.title, str)}"] + [prose(section.note, str)] * bool(section.note)
        if section.is_list:
            parts.append("\n".join(f"- ${s.left} = {s.right[0]}$" for s in section.statements))
        else:
            parts += [f"$$\n{_markdown_lines(statement)}\n$$" for statement in section.statements]
    return "\n\n".join(parts) + "\n"


def _markdown_lines(statement: Statement) -> str:
    """Return a statement as the content of a formula, aligned if it has several lines."""
    tag = _tag(statement)
    if len(statement.right) == 1:
        return f"{statement.left} {statement.relation} {statement.right[0]}{tag}"
    rows = " \\\\\n".join(_aligned(statement))
    return f"\\begin{{aligned}}\n{rows}\n\\end{{aligned}}{tag}"


def _latex(equations: Equations, form: ClosedForm, extent: Extent) -> str:
    """Return the document in LaTeX."""
    described = document(equations, form, extent)
    parts = [
        r"\documentclass{article}",
        r"\usepackage{amsmath}",
        r"\usepackage[margin=2cm]{geometry}",
        r"\allowdisplaybreaks",
        r"\sloppy",
        r"\begin{document}",
        rf"\section*{{{escaped(described.title)}}}",
        prose(described.note),
    ]
    for section in described.sections:
        parts += [rf"\subsection*{{{prose(section.title)}}}", prose(section.note)]
        if section.statements:
            parts += [r"\begin{align*}", " \\\\\n".join(_rows(section)), r"\end{align*}"]
    return "\n".join([*(part for part in parts if part), r"\end{document}", ""])


def _rows(section: Section) -> Iterator[str]:
    """Yield the lines of an environment of LaTeX with all statements, the first of each with its number."""
    for statement in section.statements:
        first, *others = _aligned(statement)
        yield first + _tag(statement)
        yield from others


def _tag(statement: Statement) -> str:
    """Return the numbers of a statement in LaTeX, "" if it has none."""
    return rf" \tag*{{{statement.number}}}" if statement.number else ""


def _aligned(statement: Statement) -> Iterator[str]:
    """Yield the lines of a statement for an aligned environment of LaTeX."""
    first, *others = statement.right
    yield f"{statement.left} {statement.relation}{{}}& {first}"
    for line in others:
        yield line if line.startswith("={}&") else f"& {line}"


def _python(equations: Equations, form: ClosedForm, _: Extent) -> str:
    """Return [A] and {f} as a Python module."""
    return python_module(equations, form)


FORMATS: dict[str, Callable[[Equations, ClosedForm, Extent], str]] = {
    "text": _text,
    "markdown": _markdown,
    "latex": _latex,
    "python": _python,
}
"""Functions that print equations with their [A] and {f}, by name of format."""
