"""What there is to say about a system's equations, before it is put into a format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, groupby

from sympy import Expr, ImmutableMatrix, Symbol

from kanegen.printing.block_terms import Sum, Term
from kanegen.printing.blocks import Blocks
from kanegen.printing.latex_names import escaped, latex_names
from kanegen.printing.printers import latex, latex_lines, text
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.symbols import coordinate_rates, expression, parameter
from kanegen.system import System

Names = dict[Symbol, str]
"""LaTeX of symbols."""

MOST_BODIES_IN_BLOCKS = 16
"""Rows of more 3 x 3 blocks than two for each of these bodies are no help to a reader."""

SHORT_MATRIX = 600
"""A matrix whose LaTeX is shorter is printed whole, a longer one by entries."""


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
    statements: tuple[Statement, ...]
    is_list: bool = False


@dataclass(frozen=True)
class Document:
    """Everything that a format prints."""

    title: str
    note: str
    sections: tuple[Section, ...]


def document(equations: Equations, A: ImmutableMatrix, f: ImmutableMatrix) -> Document:
    """A document of [A] and {f}, and of the definitions that they need.

    Args:
        equations: Where they come from.
        A: (n, n) [A], with or without intermediates.
        f: (n, 1) {f}.
    """
    system = equations.system
    n, count = len(equations.y), system.number_of_bodies
    bodies = "1 body" if count == 1 else f"{count} bodies"
    freedoms = "1 freedom" if n == 1 else f"{n} freedoms"
    return Document(
        f"{system.name}: {bodies}, {freedoms}",
        f"Equations of motion [A]{{ydot}} = {{f}}, with {kinematics(system)}. SI units.",
        tuple(_sections(equations, A, f)),
    )


def _sections(equations: Equations, A: ImmutableMatrix, f: ImmutableMatrix) -> Iterator[Section]:
    definitions = equations.definitions
    names = latex_names(equations)
    yield _freedoms(equations, names)
    yield from _prescribed(equations, names)
    yield from _coordinate_rates(equations, names)
    yield from _parameters(equations, names)
    yield from _loads(equations)
    if definitions:
        yield from _blocks(equations)
    for note, group in groupby(definitions, key=lambda definition: definition.note):
        yield Section(note, "", tuple(_equation(each.symbol, each.value, names) for each in group))
    yield Section("Mass matrix", "[A] of Eq. (43); it is symmetric.", _matrix("A", A, names))
    yield Section("Forcing", "{f} of Eq. (44).", _matrix("f", f, names))


def _freedoms(equations: Equations, names: Names) -> Section:
    system = equations.system
    if len(equations.x) > len(equations.y):
        units = [coordinate.unit for coordinate in system.coordinates]
        rates = [f"{freedom.unit}/s" for freedom in system.freedoms]
        x = _elements("x", equations.x, zip(system.coordinate_names, units, strict=True), names)
        y = _elements("y", equations.y, zip(system.speed_names, rates, strict=True), names)
        return Section("Coordinates and speeds", "Eq. (1).", (*x, *y), is_list=True)
    statements = []
    for i, (x, y) in enumerate(zip(equations.x, equations.y, strict=True)):
        name, unit = _meaning(system, i)
        label = rf"\text{{{escaped(name)} ({unit})}}"
        statements.append(
            Written(
                f"x[{i + 1}] = {x}, y[{i + 1}] = {y}: {name} ({unit})",
                f"x_{{{i + 1}}}",
                (rf"{names[x]}, \quad y_{{{i + 1}}} = {names[y]} \quad {label}",),
            )
        )
    return Section("Coordinates and speeds", "Eq. (1).", tuple(statements), is_list=True)


def _elements(
    array: str, symbols: Iterable[Symbol], meanings: Iterable[tuple[str, str]], names: Names
) -> Iterator[Written]:
    """What stands in {x}, or in {y}."""
    for i, (symbol, (name, unit)) in enumerate(zip(symbols, meanings, strict=True), start=1):
        label = rf"\text{{{escaped(name)} ({unit})}}"
        plain = f"{array}[{i}] = {symbol}: {name} ({unit})"
        yield Written(plain, f"{array}_{{{i}}}", (rf"{names[symbol]} \quad {label}",))


def kinematics(system: System) -> str:
    """What the coordinates have to do with the speeds."""
    return "{xdot} = {y}" if system.speeds_are_rates else "{xdot} from {y} by Eqs. (9), (45)"


def _meaning(system: System, place: int) -> tuple[str, str]:
    """Name and unit at a place of {x}, and those in {y} where it is not the rate."""
    name, unit = system.freedom_names[place], system.freedoms[place].unit
    speed_name = system.speed_names[place]
    return (name, unit) if name == speed_name else (f"{name}, {speed_name}", f"{unit}, {unit}/s")


def _prescribed(equations: Equations, names: Names) -> Iterator[Section]:
    system, statements = equations.system, []
    for i, (name, freedom) in enumerate(zip(system.prescribed_names, system.prescribed, strict=True)):
        symbols = list(equations.prescribed[:, i])
        plain = f"prescribed[{i + 1}] = {', '.join(map(str, symbols))}: {name} ({freedom.unit})"
        formula = r", \quad ".join(names[symbol] for symbol in symbols)
        label = rf"\text{{{escaped(name)} ({freedom.unit})}}"
        statements.append(Written(plain, rf"\text{{prescribed}}_{{{i + 1}}}", (rf"{formula} \quad {label}",)))
    if statements:
        note = "Their values, rates and second derivatives are given; they are no coordinates."
        yield Section("Prescribed freedoms", note, tuple(statements), is_list=True)


def _coordinate_rates(equations: Equations, names: Names) -> Iterator[Section]:
    """Eq. (9), where coordinates have other rates than the speeds."""
    rates = zip(coordinate_rates(equations.system), equations.xdot, strict=True)
    statements = tuple(_equation(symbol, rate, names) for symbol, rate in rates if rate != symbol)
    if statements:
        note = (
            "Eq. (9), where the speeds are components of a relative angular velocity; {xdot} = {y} elsewhere."
        )
        yield Section("Rates of the coordinates", note, statements)


def _parameters(equations: Equations, names: Names) -> Iterator[Section]:
    values = [(parameter(given), expression(given.value)) for given in equations.system.parameters]
    if values:
        statements = tuple(_equation(symbol, value, names) for symbol, value in values)
        yield Section("Parameters", "Default values.", statements, is_list=True)


def _loads(equations: Equations) -> Iterator[Section]:
    loaded = [body for body in equations.bodies if body.body.loads]
    if loaded:
        bodies = ", ".join(f"{body.number} ({body.body.name})" for body in loaded)
        note = (
            "F_K_i and M_K_i, Eq. (37), are components in body K of a force at its mass centre (N) and of a "
            f"torque (N m). Loaded: {bodies}."
        )
        yield Section("Loads", note, ())
    points = [(number, p) for number, (_, p) in enumerate(equations.system.points, start=1) if p.loads]
    if points:
        named = ", ".join(f"{number} ({point.name})" for number, point in points)
        note = (
            "FP_P_i and MP_P_i are inertial components of a force at point P (N) and of a moment on its body "
            f"(N m). Loaded: {named}."
        )
        yield Section("Loads on points", note, ())
    if equations.system.force_elements:
        words = "; ".join(element.words for element in equations.system.force_elements)
        yield Section("Force elements", f"{words}.", ())


def _equation(left: Symbol, right: Expr, names: Names) -> Equation:
    return Equation(str(left), latex(left, names), right, names)


def _matrix(name: str, matrix: ImmutableMatrix, names: Names) -> tuple[Statement, ...]:
    """The matrix, whole where it is short in LaTeX; in text by entries that are not zero or below others."""
    rows, columns = matrix.shape
    entries = []
    for i in range(rows):
        for j in range(i if columns > 1 else 0, columns):
            if matrix[i, j]:
                index = f"{i + 1}" if columns == 1 else f"{i + 1},{j + 1}"
                entries.append(Equation(f"{name}[{index}]", f"{name}_{{{index}}}", matrix[i, j], names))
    lengths = accumulate(len(line) for entry in entries for line in entry.right)
    if any(length > SHORT_MATRIX for length in lengths):  # without printing the rest of a long one
        return tuple(entries)
    plain = "\n".join(entry.text for entry in entries) or f"{name} = 0"
    return (Written(plain, name, (latex(matrix, names),)),)


def _blocks(equations: Equations) -> Iterator[Section]:
    if equations.system.number_of_bodies > MOST_BODIES_IN_BLOCKS:
        return
    blocks = Blocks(equations.system)
    for k, body in enumerate(equations.system.bodies, start=1):
        statements = tuple(_block_statements(blocks, k))
        yield Section(f"Body {k} ({body.name}) in blocks", "Blocks are 3 x 3.", statements)


def _block_statements(blocks: Blocks, k: int) -> Iterator[Statement]:
    columns: list[tuple[str, str, Term]] = [
        ("{p'_G%d}", r"\lbrace p'_{G_{%d}} \rbrace", blocks.position_of_center(k)),
        ("{v'_O%d}", r"\lbrace v'_{O_{%d}} \rbrace", blocks.velocity_of_origin(k)),
        ("{v'_G%d}", r"\lbrace v'_{G_{%d}} \rbrace", blocks.velocity_of_center(k)),
        ("[ω'_%d,y1]", r"[\omega'_{%d,y_1}]", blocks.partial_angular_velocity(k)),
    ]
    rows: list[tuple[str, str, Sum]] = [
        ("[ω̇'_%d,y1]", r"[\dot{\omega}'_{%d,y_1}]", blocks.partial_angular_velocity_rate(k)),
        ("[v'_O%d,y]", r"[v'_{O_{%d},y}]", blocks.partial_velocity_of_origin(k)),
        ("[v̇'_O%d,y]", r"[\dot{v}'_{O_{%d},y}]", blocks.partial_velocity_of_origin_rate(k)),
        ("[v'_G%d,y]", r"[v'_{G_{%d},y}]", blocks.partial_velocity_of_center(k)),
        ("[v̇'_G%d,y]", r"[\dot{v}'_{G_{%d},y}]", blocks.partial_velocity_of_center_rate(k)),
    ]
    for plain, formula, value in columns:
        yield Written(f"{plain % k} = {value.text()}", formula % k, (value.latex(),))
    for plain, formula, terms in rows:
        text_lines = "\n    ".join([f"{plain % k} =", *terms.lines()])
        yield Written(text_lines, formula % k, tuple(terms.lines("latex")))
