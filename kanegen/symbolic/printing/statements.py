"""What a document consists of: statements, printed when they are read, and sections of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from sympy import Expr, Symbol

from kanegen.symbolic.printing.printers import latex, latex_lines, text

Names = dict[Symbol, str]
"""LaTeX of symbols."""


@dataclass(frozen=True)
class Written:
    """A statement whose words are there already.

    Attributes:
        text: In plain text, one line or several.
        left: Left side in LaTeX.
        right: Lines of the right side in LaTeX.
    """

    text: str
    left: str
    right: tuple[str, ...]


@dataclass(frozen=True)
class Equation:
    """A statement that is printed when it is read: SymPy is slow, and no format needs both text and LaTeX.

    Attributes:
        name: Left side in plain text.
        left: Left side in LaTeX.
        value: Right side.
        names: LaTeX of its symbols.
    """

    name: str
    left: str
    value: Expr
    names: Names

    @property
    def text(self) -> str:
        """In plain text, one line."""
        return f"{self.name} = {text(self.value)}"

    @cached_property
    def right(self) -> tuple[str, ...]:
        """Lines of the right side in LaTeX."""
        return tuple(latex_lines(self.value, self.names))


Statement = Written | Equation


@dataclass(frozen=True)
class Section:
    """A title, a sentence, equations.

    Attributes:
        title: Heading.
        note: What to know about the equations; may be empty.
        statements: The equations.
        is_list: Whether they are so short that they make a list.
    """

    title: str
    note: str
    statements: tuple[Statement, ...] = ()
    is_list: bool = False


def equation(left: Symbol, right: Expr, names: Names) -> Equation:
    """The definition of a symbol."""
    return Equation(str(left), latex(left, names), right, names)
