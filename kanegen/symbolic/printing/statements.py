"""The parts of a document: sections, and the statements in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.symbolic import notation
from kanegen.symbolic.printers import latex, latex_lines, latex_matrix, text

SymbolLatex = Mapping[Symbol, str]
"""LaTeX by symbol."""


@dataclass(frozen=True)
class PrintedStatement:
    """A statement that is printed already.

    Attributes:
        text: The statement in plain text, one line or several.
        left: Left side in LaTeX.
        right: Lines of the right side in LaTeX.
        relation: What stands between the sides.
        number: Numbers of its equations in the notes; "" where the section says them.
    """

    text: str
    left: str
    right: tuple[str, ...]
    relation: str = "="
    number: str = ""


@dataclass(frozen=True)
class Equation:
    """An equation that is printed when it is read: SymPy is slow, and no format needs both text and LaTeX.

    Attributes:
        name: Left side in plain text.
        left: Left side in LaTeX.
        value: Right side.
        names: LaTeX of the symbols in it.
        number: Numbers of its equations in the notes; "" where the section says them.
    """

    name: str
    left: str
    value: Expr
    names: SymbolLatex
    number: str = ""

    @property
    def relation(self) -> str:
        """What stands between the sides."""
        return "="

    @property
    def text(self) -> str:
        """The equation in plain text, one line."""
        return f"{self.name} = {text(self.value)}" + f"  {self.number}" * bool(self.number)

    @cached_property
    def right(self) -> tuple[str, ...]:
        """The lines of the right side in LaTeX."""
        return tuple(latex_lines(self.value, self.names))


@dataclass(frozen=True)
class BlockStatement:
    """A row in the notation of the notes.

    Attributes:
        number: Numbers of its equations in the notes.
        name: Left side in plain text.
        forms: Equal right sides, each in lines of plain text, of which all but the first begin with a sign.
    """

    number: str
    name: str
    forms: tuple[tuple[str, ...], ...]

    @property
    def relation(self) -> str:
        """What stands between the sides."""
        return "="

    @property
    def text(self) -> str:
        """The row in plain text, in several lines if it has several forms or terms of many blocks."""
        lines = [line for form in self.forms for line in (f"= {form[0]}", *form[1:])]
        return "\n    ".join([f"{self.name} {lines[0]}  {self.number}", *lines[1:]])

    @property
    def left(self) -> str:
        """The left side in LaTeX."""
        return notation.latex(self.name)

    @cached_property
    def right(self) -> tuple[str, ...]:
        """The lines of the right side in LaTeX; another form begins with its relation."""
        found: list[str] = []
        for place, form in enumerate(self.forms):
            lines = [notation.latex(part) for line in form for part in notation.lines(line)]
            found += [f"={{}}& {lines[0]}" if place else lines[0], *lines[1:]]
        return tuple(found)


@dataclass(frozen=True)
class MatrixStatement:
    """A small matrix, written out, and perhaps a column that it multiplies.

    Attributes:
        number: Numbers of its equations in the notes.
        name: Left side in plain text, in the notation of the notes.
        value: The matrix.
        names: LaTeX of the symbols in it.
        column: What it multiplies, in the notation of the notes; "" for nothing.
    """

    number: str
    name: str
    value: ImmutableMatrix
    names: SymbolLatex
    column: str = ""

    @property
    def relation(self) -> str:
        """What stands between the sides."""
        return "="

    @cached_property
    def text(self) -> str:
        """The matrix in plain text, a line for each row."""
        rows = [f"[{', '.join(map(text, row))}]" for row in self.value.tolist()]
        ends = [f" {self.column}" if self.column else "", *[""] * (len(rows) - 1)]
        lines = [row + end for row, end in zip(rows, ends, strict=True)]
        return "\n    ".join([f"{self.name} =  {self.number}", *lines])

    @property
    def left(self) -> str:
        """The left side in LaTeX."""
        return notation.latex(self.name)

    @cached_property
    def right(self) -> tuple[str, ...]:
        """The matrix, and what it multiplies, in LaTeX."""
        return (latex_matrix(self.value, self.names) + notation.latex(self.column),)


Statement = PrintedStatement | Equation | BlockStatement | MatrixStatement
"""A line of a section, printed already or when it is read."""


class Part(Enum):
    """What a section of a document belongs to."""

    SYSTEM = "system"
    BLOCKS = "blocks"
    DEFINITIONS = "definitions"
    RESULT = "result"


@dataclass(frozen=True)
class Section:
    """A section of a document.

    Attributes:
        title: Heading.
        note: A sentence about the statements; may be empty.
        statements: The statements in order.
        is_list: Whether the statements are short enough for a list.
        part: What it belongs to.
        body: Number of the body that it is about, 0 for the system.
    """

    title: str
    note: str
    statements: tuple[Statement, ...] = ()
    is_list: bool = False
    part: Part = Part.SYSTEM
    body: int = 0


def equation(left: Symbol, right: Expr, names: SymbolLatex) -> Equation:
    """Return the definition of a symbol as an equation."""
    return Equation(str(left), latex(left, names), right, names)
