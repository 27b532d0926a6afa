"""Functions in C that solve [A]{z} + {b} = {0} for many columns in loops, printed from their plan.

Tables of rows stand where straight-line code has statements. The form for one state computes as many columns
at once as a few SIMD vectors have lanes; the form for several states has these in its lanes, and computes a
few columns at once.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.c.dialect import Dialect
from kanegen.c.expression import Expression, apply, literal
from kanegen.c.interface import Loops
from kanegen.c.layout import BREAK, HINGE, WIDTH, wrap
from kanegen.c.templates import fill
from kanegen.program.columns import VECTORS, ColumnSolution
from kanegen.program.ir import WORKSPACE, Op


@dataclass(frozen=True)
class Sweeps:
    """The elimination and the substitution of a few vectors of columns, which all solutions of a file share.

    Attributes:
        dialect: Notation of the statements.
    """

    dialect: Dialect

    @property
    def name(self) -> str:
        """Name of the functions, without the number of vectors; both forms may stand in one file."""
        return "solve_columns" if self.dialect.is_scalar else "simd_solve_columns"

    @property
    def copy(self) -> str:
        """Name of the function that copies elements of neighbouring columns."""
        return "copy_columns" if self.dialect.is_scalar else "simd_copy_columns"

    @property
    def most(self) -> int:
        """Most vectors of columns that are computed at once."""
        return VECTORS

    @property
    def counts(self) -> range:
        """The numbers of vectors for which there is a function."""
        return range(1, self.most + 1)

    @property
    def in_lanes(self) -> bool:
        """Whether a vector has several columns of one state in its lanes."""
        return self.dialect.has_columns_in_lanes

    @property
    def number(self) -> str:
        """Type in C of a factor of [A]."""
        return self.dialect.number

    @property
    def vector(self) -> str:
        """Type in C of a vector of columns."""
        return "simd" if self.in_lanes else self.number

    @property
    def stored(self) -> str:
        """Type of an element of an output."""
        dialect = self.dialect
        return dialect.formats.storage.c_type if dialect.is_scalar else dialect.number

    @property
    def copied(self) -> str:
        """Element `from[k]` of a solution as an output holds it."""
        return str(self.dialect.written("", Expression("from[k]")))

    def cells(self, vectors: str) -> str:
        """Return an array of vectors of columns as an array of numbers."""
        return f"({self.number} *){vectors}" if self.in_lanes else vectors

    @property
    def zero(self) -> str:
        """The number 0 with the type of a factor."""
        return self.constant(0.0)

    def constant(self, number: float) -> str:
        """Return a number as a factor."""
        dialect = self.dialect
        return dialect.everywhere(dialect.notation.text(literal(number, dialect.arithmetic)))

    def every(self, factor: str) -> str:
        """Return a factor as a vector of columns."""
        return f"simd_of({factor})" if self.in_lanes else factor

    def less(self, value: str, other: str) -> str:
        """Return a value less `factor` times another."""
        change = apply(Op.MULTIPLY, (Expression("factor"), Expression(other)), written=self.dialect.notation)
        return self._text(apply(Op.SUBTRACT, (Expression(value), change), written=self.dialect.notation))

    def product(self, value: str, other: str) -> str:
        """Return the product of two values."""
        operands = (Expression(value), Expression(other))
        return self._text(apply(Op.MULTIPLY, operands, written=self.dialect.notation))

    def _text(self, expression: Expression) -> str:
        return self.dialect.notation.text(expression).replace(BREAK, " ").replace(HINGE, "")


@dataclass(frozen=True)
class PrintedColumns:
    """A function that solves for the columns of one output.

    Attributes:
        prototype: Lines of the prototype.
        body: Lines between its braces.
        call: Lines of the call.
    """

    prototype: list[str]
    body: list[str]
    call: list[str]


def printed_columns(name: str, loops: Loops, sweeps: Sweeps) -> PrintedColumns:
    """Return the function that computes an output in loops.

    Args:
        name: Name of the function.
        loops: The output and how it is solved for.
        sweeps: The functions that it calls.
    """
    array, dialect = loops.array.name, sweeps.dialect
    arguments = f"const {dialect.number} *values,{BREAK}{sweeps.stored} *{array}"
    values = f"{WORKSPACE} + {loops.start}" if loops.start else WORKSPACE
    return PrintedColumns(
        prototype=wrap(f"static NOINLINE void {name}({arguments})", indent="", hanging="    "),
        body=_body(loops, sweeps),
        call=wrap(f"{name}({values},{BREAK}{array});"),
    )


def _body(loops: Loops, sweeps: Sweeps) -> list[str]:
    """Return the lines between the braces of the function."""
    array, dialect = loops.array, sweeps.dialect
    text = fill(
        "c99/columns.c",
        **_tables(loops.solution),
        sweeps=sweeps,
        array=array.name,
        size=array.size,
        columns=sum(len(group.columns) for group in loops.solution.groups),
        operations=sum(loops.solution.operations.values()),
        row=array.size // loops.solution.stored,
        block=f"{sweeps.most}*KANEGEN_LANES" if sweeps.in_lanes else sweeps.most,
        zero=sweeps.every(sweeps.zero),
        minus_one=sweeps.constant(-1.0),
        stored_zero=dialect.number_in(array.name, 0.0),
        has_zeros=_has_zeros(loops),
    )
    return text.splitlines()


def _tables(solution: ColumnSolution) -> dict[str, object]:
    """Return the variables of the template that say which rows and columns there are."""
    first = [0]
    for carriers in solution.carriers:
        first.append(first[-1] + len(carriers))
    lists = [
        place
        for group in solution.groups
        for place in (*group.columns, *group.given, *group.reduced, *group.solved)
    ]
    counts = [(len(g.columns), len(g.given), len(g.reduced), len(g.solved)) for g in solution.groups]
    has_inverse = any(group.is_of_inverse for group in solution.groups)
    copied = dict.fromkeys(solution.outward, 0)
    for i, _ in solution.mirrored:
        copied[i] += 1
    return {
        "first": _lines(first),
        "carriers": _lines(row for carriers in solution.carriers for row in carriers),
        "counts": _lines(f"{{{a}, {b}, {c}, {d}}}" for a, b, c, d in counts),
        "lists": _lines(lists),
        "order": _lines(solution.outward) if has_inverse else "",
        "units": len(solution.outward),
        "copied": _lines(copied.values()),
        "partners": _lines(j for i in copied for one, j in solution.mirrored if one == i),
        "first_unit": solution.first_unit,
        "factors": solution.number_of_factors,
        "rows": solution.rows,
        "stored": solution.stored,
        "groups": len(solution.groups),
    }


def _lines(entries: Iterable[object]) -> str:
    """Return the entries of a table in lines of C."""
    text = ", ".join(map(str, entries)) or "0"
    indent = " " * 8
    return "\n".join(textwrap.wrap(text, WIDTH, initial_indent=indent, subsequent_indent=indent))


def _has_zeros(loops: Loops) -> bool:
    """Return whether there are elements that no loop computes."""
    solution = loops.solution
    filled = sum(
        len(group.columns) * sum(row < solution.stored for row in group.solved) for group in solution.groups
    )
    return filled + len(solution.mirrored) < loops.array.size
