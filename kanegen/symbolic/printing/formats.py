"""The formats in which equations are printed: text, Markdown, LaTeX and a Python module."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from kanegen.choices import require_one
from kanegen.errors import OptionError
from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import MOST_FREEDOMS_WITHOUT_NAMES, Equations, derive
from kanegen.symbolic.printing.document import document
from kanegen.symbolic.printing.printers import escaped
from kanegen.symbolic.printing.python_module import python_module
from kanegen.symbolic.printing.statements import Statement


def render(equations: Equations, format: str = "text", closed: bool | None = None) -> str:
    """Return equations as text to read, or as a Python module to run.

    Example:
        print(render(kg.derive(kg.load("models/double_pendulum.toml")), "markdown"))

    Args:
        equations: The equations that `derive` returns.
        format: One of `FORMATS`.
        closed: Whether to print the closed form, without intermediates; by default where there are at most
            `MOST_FREEDOMS_WITHOUT_NAMES` freedoms and it is short enough.

    Raises:
        OptionError: If the format is unknown, or a closed form is asked for that would be too long.
    """
    require_one("format", format, FORMATS)
    printed = FORMATS[format]
    form = _closed_form(equations, closed, everywhere=format == "python")
    if form is not None:
        return printed(derive(equations.system, intermediates=False), form)
    named = equations if equations.intermediates else derive(equations.system, intermediates=True)
    return printed(named, ClosedForm(named.A, named.f))


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


def _text(equations: Equations, form: ClosedForm) -> str:
    """Return the document as plain text."""
    described = document(equations, form)
    parts = [f"{described.title}\n{described.note}"]
    for section in described.sections:
        lines = [f"{section.title}. {section.note}".rstrip()]
        lines += [f"  {line}" for statement in section.statements for line in statement.text.split("\n")]
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def _markdown(equations: Equations, form: ClosedForm) -> str:
    """Return the document in Markdown."""
    described = document(equations, form)
    parts = [f"# {described.title}", described.note]
    for section in described.sections:
        parts += [f"## {section.title}"] + [section.note] * bool(section.note)
        if section.is_list:
            parts.append("\n".join(f"- ${s.left} = {s.right[0]}$" for s in section.statements))
        else:
            parts += [f"$$\n{_markdown_lines(statement)}\n$$" for statement in section.statements]
    return "\n\n".join(parts) + "\n"


def _markdown_lines(statement: Statement) -> str:
    """Return a statement as the content of a formula, aligned if it has several lines."""
    if len(statement.right) == 1:
        return f"{statement.left} {statement.relation} {statement.right[0]}"
    rows = " \\\\\n".join(_aligned(statement))
    return f"\\begin{{aligned}}\n{rows}\n\\end{{aligned}}"


def _latex(equations: Equations, form: ClosedForm) -> str:
    """Return the document in LaTeX."""
    described = document(equations, form)
    parts = [
        r"\documentclass{article}",
        r"\usepackage{amsmath}",
        r"\usepackage[margin=2cm]{geometry}",
        r"\allowdisplaybreaks",
        r"\begin{document}",
        rf"\section*{{{escaped(described.title)}}}",
        escaped(described.note),
    ]
    for section in described.sections:
        parts += [rf"\subsection*{{{escaped(section.title)}}}", escaped(section.note)]
        if section.statements:
            rows = [row for statement in section.statements for row in _aligned(statement)]
            parts += [r"\begin{align*}", " \\\\\n".join(rows), r"\end{align*}"]
    return "\n".join([*(part for part in parts if part), r"\end{document}", ""])


def _aligned(statement: Statement) -> Iterator[str]:
    """Yield the lines of a statement for an aligned environment of LaTeX."""
    first, *others = statement.right
    yield f"{statement.left} {statement.relation}{{}}& {first}"
    for line in others:
        yield f"& {line}"


FORMATS: dict[str, Callable[[Equations, ClosedForm], str]] = {
    "text": _text,
    "markdown": _markdown,
    "latex": _latex,
    "python": python_module,
}
"""Functions that print equations with their [A] and {f}, by name of format."""
