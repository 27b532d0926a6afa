"""The parts of a document: sections, and the statements in them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, Symbol

from kanegen.symbolic.printing.printers import latex, latex_lines, text

SymbolLatex = dict[Symbol, str]
"""LaTeX by symbol."""


@dataclass(frozen=True)
class PrintedStatement:
    """A statement that is printed already.

    Attributes:
        text: The statement in plain text, one line or several.
        left: Left side in LaTeX.
        right: Lines of the right side in LaTeX.
        relation: What stands between the sides.
    """

    text: str
    left: str
    right: tuple[str, ...]
    relation: str = "="


@dataclass(frozen=True)
class Equation:
    """An equation that is printed when it is read: SymPy is slow, and no format needs both text and LaTeX.

    Attributes:
        name: Left side in plain text.
        left: Left side in LaTeX.
        value: Right side.
        names: LaTeX of the symbols in it.
    """

    name: str
    left: str
    value: Expr
    names: SymbolLatex

    @property
    def relation(self) -> str:
        """What stands between the sides."""
        return "="

    @property
    def text(self) -> str:
        """The equation in plain text, one line."""
        return f"{self.name} = {text(self.value)}"

    @cached_property
    def right(self) -> tuple[str, ...]:
        """The lines of the right side in LaTeX."""
        return tuple(latex_lines(self.value, self.names))


Statement = PrintedStatement | Equation
"""A line of a section, printed already or when it is read."""


@dataclass(frozen=True)
class Section:
    """A section of a document.

    Attributes:
        title: Heading.
        note: A sentence about the statements; may be empty.
        statements: The statements in order.
        is_list: Whether the statements are short enough for a list.
    """

    title: str
    note: str
    statements: tuple[Statement, ...] = ()
    is_list: bool = False


def equation(left: Symbol, right: Expr, names: SymbolLatex) -> Equation:
    """Return the definition of a symbol as an equation."""
    return Equation(str(left), latex(left, names), right, names)
