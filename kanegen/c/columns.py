"""Functions in C that solve [A]{z} + {b} = {0} for many columns in loops, printed from their plan.

Every group of columns has a function with a loop over its columns, in which each pair of related rows is one
statement; every tree of rows has one for its part of [A]^-1, with a loop for each row. The form for one state
computes as many columns at once as a SIMD vector has lanes; the form for several states has these in its
lanes, and computes one column at a time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from kanegen.c.dialect import Dialect
from kanegen.c.expression import Expression, apply
from kanegen.c.interface import Loops
from kanegen.c.layout import BREAK, comment, wrap
from kanegen.c.simd import SIMD as VECTORS
from kanegen.program.columns import ColumnGroup
from kanegen.program.ir import WORKSPACE, Op


@dataclass(frozen=True)
class PrintedColumns:
    """A function that computes columns of one output.

    Attributes:
        prototype: Lines of the prototype.
        body: Lines between its braces.
        call: Lines of the call.
        numbers: How many numbers its locals hold.
    """

    prototype: list[str]
    body: list[str]
    call: list[str]
    numbers: int


def printed_columns(name: str, loops: Loops, dialect: Dialect) -> list[PrintedColumns]:
    """Return the functions that compute the columns of an output in loops.

    Args:
        name: Name of the functions, without their number.
        loops: The output and how it is solved for.
        dialect: Notation of the statements.
    """
    writer = _Writer(loops, dialect)
    bodies = []
    right = loops.start + loops.solution.number_of_factors + loops.solution.rows
    for group in loops.solution.groups:
        bodies.append(_group(writer, group, right))
        right += len(group.given) * len(group.columns)
    bodies += [_inverse(writer, tree) for tree in loops.solution.inverses]
    return [writer.function(f"{name}_{k}", *body) for k, body in enumerate(bodies, start=1)]


@dataclass(frozen=True)
class _Writer:
    """The notation of columns: vectors of neighbouring columns of one state, or numbers.

    Attributes:
        loops: The output and how it is solved for.
        dialect: Notation of the statements.
    """

    loops: Loops
    dialect: Dialect

    def function(self, name: str, lines: list[str], numbers: int) -> PrintedColumns:
        """Return a function with these lines, whose locals hold so many numbers."""
        dialect, array = self.dialect, self.loops.array.name
        filled = dialect.argument(array, is_common=False, is_read=False)
        arguments = f"const {dialect.number} *{WORKSPACE},{BREAK}{filled}"
        head = dialect.part(name, False, [WORKSPACE, array])
        return PrintedColumns(
            prototype=wrap(f"{head}({arguments})", indent="", hanging="    "),
            body=lines,
            call=wrap(f"{name}({WORKSPACE},{BREAK}{array});"),
            numbers=numbers,
        )

    @property
    def is_in_lanes(self) -> bool:
        """Whether a vector has several columns of one state in its lanes."""
        return self.dialect.has_columns_in_lanes

    @property
    def vector(self) -> str:
        """Type in C of neighbouring columns."""
        return "simd" if self.is_in_lanes else self.dialect.number

    @property
    def lanes(self) -> int:
        """The most columns that a vector holds, 1 where it is a number."""
        return VECTORS[self.dialect.arithmetic].widths[-1] if self.is_in_lanes else 1

    def stride(self, width: int) -> int:
        """Return the numbers from one row of columns to the next, so that its last vector ends in it."""
        return -(-width // self.lanes) * self.lanes

    def loop(self, width: int, statements: Iterator[str]) -> list[str]:
        """Return the lines of a loop over columns."""
        advance = "c += KANEGEN_LANES" if self.is_in_lanes else "++c"
        lines = [f"    for (int c = 0; c < {width}; {advance}) {{"]
        for statement in statements:
            lines += wrap(statement, indent=" " * 8, hanging=" " * 12)
        return [*lines, "    }"]

    def read(self, name: str, array: str, place: int) -> str:
        """Return the statements that define a local as the columns from element `place + c` on."""
        offset = _sum(place, "c")
        if self.is_in_lanes:
            return f"{self.vector} {name};{BREAK}memcpy(&{name}, {array} + {offset}, sizeof {name});"
        return f"{self.vector} {name} = {array}[{offset}];"

    def write(self, name: str, array: str, place: int) -> str:
        """Return the statement that stores a local in the columns from element `place + c` on."""
        offset = _sum(place, "c")
        if self.is_in_lanes:
            return f"memcpy({array} + {offset}, &{name}, sizeof {name});"
        return f"{array}[{offset}] = {name};"

    def scaled(self, name: str, factor: int) -> str:
        """Return the statement that multiplies a local by a value of the workspace."""
        return f"{name} = {self._text(self._product(name, factor))};"

    def less(self, name: str, factor: int, other: str, *, is_known: bool, kind: str = "") -> str:
        """Return the statement that subtracts a value of the workspace times another local from a local.

        Args:
            name: The local, or an element of an array.
            factor: Place of the value.
            other: The other local.
            is_known: Whether the local has a value; else it is zero, and is defined.
            kind: Type of the local; by default that of neighbouring columns.
        """
        product = self._product(other, factor)
        if not is_known:
            negative = apply(Op.NEGATE, (product,), written=self.dialect.notation)
            return f"{kind or self.vector} {name} = {self._text(negative)};"
        less = apply(Op.SUBTRACT, (Expression(name), product), written=self.dialect.notation)
        return f"{name} = {self._text(less)};"

    def _product(self, name: str, factor: int) -> Expression:
        operands = (Expression(f"{WORKSPACE}[{factor}]"), Expression(name))
        return apply(Op.MULTIPLY, operands, written=self.dialect.notation)

    def _text(self, expression: Expression) -> str:
        return self.dialect.notation.text(expression)

    def copies(
        self, rows: Sequence[int], row_places: Mapping[int, int], columns: Mapping[int, int], stride: int
    ) -> list[str]:
        """Return the lines that copy elements of the array `z` into the output.

        Args:
            rows: Rows of the output, in increasing order.
            row_places: Row of the array of each of them.
            columns: Column of the array for each column of the output.
            stride: Numbers from one row of the array to the next.
        """
        lines: list[str] = []
        for run in _runs(rows, row_places):
            lines.append(f"    for (int i = 0; i < {len(run)}; ++i) {{")
            for part in _runs(sorted(columns), columns):
                source = _sum(stride * row_places[run[0]] + columns[part[0]], f"{stride}*i")
                target = _sum(self.loops.array.row * run[0] + part[0], f"{self.loops.array.row}*i")
                lines += wrap(self._copy(source, target, len(part)), indent=" " * 8, hanging=" " * 12)
            lines.append("    }")
        return lines

    def _copy(self, source: str, target: str, count: int) -> str:
        """Return the statement that copies neighbouring numbers of the array `z`."""
        array = self.loops.array.name
        if self.is_in_lanes:
            return f"memcpy({array} + {target}, z + {source}, {count}*sizeof *z);"
        if count == 1:
            return f"{array}[{target}] = {self.dialect.written(array, Expression(f'z[{source}]'))};"
        element = self.dialect.written(array, Expression(f"z[{source} + j]"))
        return f"for (int j = 0; j < {count}; ++j) {{ {array}[{target} + j] = {element}; }}"


def _group(writer: _Writer, group: ColumnGroup, right: int) -> tuple[list[str], int]:
    """Return the lines of the function of a group of columns, and how many numbers its locals hold.

    Args:
        writer: The notation.
        group: The group.
        right: Place in the workspace of its first element of {b}.
    """
    width = len(group.columns)
    stride = writer.stride(width)
    rows = sorted(row for row in group.solved if row < writer.loops.solution.stored)
    places = {row: place for place, row in enumerate(rows)}
    number = f"{width} columns" if width > 1 else "a column"
    lines = comment(
        f"Solve [A]{{z}} + {{b}} = {{0}} for {number} {{z}} of {writer.loops.array.name}. {WORKSPACE} holds "
        "the factors of [A] = [L]^T [D] [L], -1 over each pivot, and {b}."
    )
    if not writer.is_in_lanes:
        table = ", ".join(map(str, group.columns))
        lines += [
            *wrap(f"static const unsigned short columns[{width}] ={BREAK}{{{table}}};"),
            *writer.loop(width, _solution(writer, group, right, places)),
        ]
        return lines, writer.loops.solution.rows
    size = len(rows) * stride
    lines += [
        f"    {writer.dialect.number} z[{size}];",
        *writer.loop(width, _solution(writer, group, right, places)),
        *writer.copies(rows, places, {column: k for k, column in enumerate(group.columns)}, stride),
    ]
    return lines, size + writer.lanes * writer.loops.solution.rows


def _solution(writer: _Writer, group: ColumnGroup, right: int, places: Mapping[int, int]) -> Iterator[str]:
    """Yield the statements that solve for neighbouring columns of a group.

    Args:
        writer: The notation.
        group: The group.
        right: Place in the workspace of its first element of {b}.
        places: Row of the array `z` of each row of the result.
    """
    loops, width = writer.loops, len(group.columns)
    solution, start = loops.solution, loops.start
    for k, row in enumerate(group.given):
        yield writer.read(f"z{row}", WORKSPACE, right + k * width)
    known = set(group.given)
    for row in group.reduced:
        for k, other in enumerate(solution.carriers[row], start=start + solution.first_factors[row]):
            yield writer.less(f"z{other}", k, f"z{row}", is_known=other in known)
            known.add(other)
        yield writer.scaled(f"z{row}", start + solution.number_of_factors + row)
    for row, number in zip(group.solved, group.sums, strict=True):
        for k, other in enumerate(solution.sums[number], start=start + solution.first_factors[number]):
            if other in known:
                yield writer.less(f"z{row}", k, f"z{other}", is_known=row in known)
                known.add(row)
        if row in places and writer.is_in_lanes:
            yield writer.write(f"z{row}", "z", places[row] * writer.stride(width))
        elif row in places:
            array = loops.array.name
            value = writer.dialect.written(array, Expression(f"z{row}"))
            yield f"{array}[{loops.array.row * row} + columns[c]] = {value};"


def _inverse(writer: _Writer, tree: Sequence[int]) -> tuple[list[str], int]:
    """Return the lines of the function for [A]^-1 in the rows of a tree, and how many numbers it holds.

    The array `z` holds the elements of all rows of the tree, outward.
    """
    solution, stride = writer.loops.solution, writer.stride(len(tree))
    places = {row: place for place, row in enumerate(tree)}
    zero = "{0}"
    lines = [
        *comment(
            f"{len(tree)} related rows of [A]^-1, outward, for columns of {writer.loops.array.name}: sums of "
            "products of factors with rows before, and by symmetry."
        ),
        f"    {writer.dialect.number} z[{len(tree) * stride}] = {zero};",
    ]
    for place, row in enumerate(tree):
        if place:
            lines += writer.loop(place, _row_of_inverse(writer, row, places))
        for statement in _diagonal(writer, row, places):
            lines += wrap(statement)
        if place:
            lines += [
                f"    for (int c = 0; c < {place}; ++c) {{",
                f"        z[{stride}*c + {place}] = z[{place * stride} + c];",
                "    }",
            ]
    rows = sorted(row for row in tree if row < solution.stored)
    columns = {solution.first_unit + row: places[row] for row in rows}
    return [*lines, *writer.copies(rows, places, columns, stride)], len(tree) * stride + 2 * writer.lanes


def _row_of_inverse(writer: _Writer, row: int, places: Mapping[int, int]) -> Iterator[str]:
    """Yield the statements for neighbouring elements of a row of [A]^-1 left of the diagonal."""
    solution, stride = writer.loops.solution, writer.stride(len(places))
    first = writer.loops.start + solution.first_factors[row]
    for k, other in enumerate(solution.carriers[row]):
        yield writer.read(f"z{other}", "z", places[other] * stride)
        yield writer.less(f"z{row}", first + k, f"z{other}", is_known=k > 0)
    yield writer.write(f"z{row}", "z", places[row] * stride)


def _diagonal(writer: _Writer, row: int, places: Mapping[int, int]) -> Iterator[str]:
    """Yield the statements for the element of a row of [A]^-1 on the diagonal."""
    solution, stride = writer.loops.solution, writer.stride(len(places))
    first, place = writer.loops.start + solution.first_factors[row], places[row] * stride
    number, name = writer.dialect.number, f"d{row}"
    is_known = row not in solution.mapped
    if is_known:
        inverse = Expression(f"{WORKSPACE}[{writer.loops.start + solution.number_of_factors + row}]")
        positive = apply(Op.NEGATE, (inverse,), written=writer.dialect.notation)
        yield f"{number} {name} = {writer.dialect.notation.text(positive)};"
    for k, other in enumerate(solution.carriers[row]):
        element = f"z[{place + places[other]}]"
        yield writer.less(name, first + k, element, is_known=is_known, kind=number)
        is_known = True
    yield f"z[{place + places[row]}] = {name};"


def _sum(number: int, term: str) -> str:
    """Return the sum of a number and a term in C, without the number 0."""
    return f"{number} + {term}" if number else term


def _runs(numbers: Sequence[int], places: Mapping[int, int]) -> list[list[int]]:
    """Return runs of numbers that follow each other without a gap, as do their places."""
    runs = [[numbers[0]]]
    for before, number in pairwise(numbers):
        if number == before + 1 and places[number] == places[before] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return runs
