"""The document on the equations of a system, section by section, before it is written in a format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby

from sympy import ImmutableMatrix, Symbol

from kanegen.errors import counted
from kanegen.model.system import System
from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.printers import (
    LINE,
    escaped,
    latex,
    latex_matrix,
    matrix_width,
    text,
)
from kanegen.symbolic.printing.block_rows import BodyRows, system_rows
from kanegen.symbolic.printing.statements import (
    Equation,
    Part,
    PrintedStatement,
    Section,
    Statement,
    SymbolLatex,
    equation,
)
from kanegen.symbolic.symbols import expression, parameter

MOST_ENTRIES = 36
"""Number of entries up to which a matrix may be printed whole; a longer one is printed by entries."""


@dataclass(frozen=True)
class Document:
    """The content of a printed document.

    Attributes:
        title: Name and size of the system.
        note: A sentence about all equations.
        sections: The sections in order.
    """

    title: str
    note: str
    sections: tuple[Section, ...]


@dataclass(frozen=True)
class Extent:
    """What of a document is wanted.

    Attributes:
        parts: Parts of the document.
        body: Number of the body that it is about, from 1; 0 for all bodies and the system.
    """

    parts: frozenset[Part] = frozenset(Part)
    body: int = 0

    def has(self, section: Section) -> bool:
        """Return whether a section is wanted."""
        return section.part in self.parts and self.body in (0, section.body)


def document(equations: Equations, form: ClosedForm, extent: Extent) -> Document:
    """Return a document of [A] and {f}, and of the definitions that they need.

    Args:
        equations: The equations to which [A] and {f} belong.
        form: [A] and {f}, with or without intermediates.
        extent: What of it is wanted.
    """
    system = equations.system
    n, count = len(equations.y), system.number_of_bodies
    bodies, freedoms = counted(count, "body", "bodies"), counted(n, "freedom")
    return Document(
        f"{system.name}: {bodies}, {freedoms}",
        f"Equations of motion [A]{{ydot}} = {{f}}, with {kinematic_relation(system)}. SI units.",
        tuple(section for section in _sections(equations, form, extent) if extent.has(section)),
    )


def kinematic_relation(system: System) -> str:
    """Return how the rates of the coordinates follow from the speeds."""
    return "{xdot} = {y}" if system.speeds_are_rates else "{xdot} from {y} by Eqs. (9), (45)"


def _sections(equations: Equations, form: ClosedForm, extent: Extent) -> Iterator[Section]:
    """Yield the sections of the document on [A] and {f}; those that take time only if they are wanted."""
    names = equations.latex_names
    if extent.body == 0:
        yield from _about(equations, names)
    if Part.BLOCKS in extent.parts and equations.intermediates:
        yield from _blocks(equations, names)
    if Part.DEFINITIONS in extent.parts:
        yield from _definitions(equations, names)
    if Part.RESULT in extent.parts:
        yield from _result(equations, form, extent.body, names)


def _about(equations: Equations, names: SymbolLatex) -> Iterator[Section]:
    """Yield the sections on the system: what its symbols mean, and what acts on it."""
    system = equations.system
    yield _state(equations, names)
    yield from _prescribed(equations, names)
    yield from _coordinate_rates(equations, names)
    yield from _parameters(equations, names)
    yield from _loads(system)
    yield from _couplings(system)
    yield from _motors(system)
    yield from _force_elements(system)


def _blocks(equations: Equations, names: SymbolLatex) -> Iterator[Section]:
    """Yield a section of blocks for each body, and one for the system."""
    system = equations.system
    for k, body in enumerate(system.bodies, start=1):
        rows = tuple(BodyRows(equations, k, names).rows())
        title = f"Body {k} ({body.name}) in blocks"
        note = "Blocks are 3 x 3."
        if equations.bodies[k - 1].sines:
            note += " S_K_i and C_K_i are sine and cosine of angle i of body K."
        if equations.bodies[k - 1].rotation_factor:
            note += " h_K_1 is 2 over the squared length of the quaternion of body K."
        yield Section(title, note, rows, part=Part.BLOCKS, body=k)
    note = (
        "{y_1} are the speeds of all angles, {y_2} those of all translations; columns of locked freedoms "
        "drop out. {F'_K} and {M'_K} are the load on body K, m_K[R_K]{g} is its weight."
    )
    if system.couplings:
        note += " Columns of coupled freedoms, times their factors, add to those of the freedoms they follow."
    if system.prescribed:
        note += " {ω'_t,K} and {v'_t,GK} are the velocities that prescribed freedoms cause."
    if system.force_elements or any(point.loads for _, point in system.points):
        note += " {F_y,e} comes from force elements and loads on points."
    if system.motor_summaries:
        note += " [A_m] and {f_m} come from motors."
    yield Section("All bodies in blocks", note, tuple(system_rows(equations)), part=Part.BLOCKS)


def _definitions(equations: Equations, names: SymbolLatex) -> Iterator[Section]:
    """Yield the sections on named intermediates, those of each body in order of evaluation."""
    of_bodies = [(body.number, body.definitions) for body in equations.bodies]
    count = sum(len(definitions) for _, definitions in of_bodies)
    for number, definitions in (*of_bodies, (0, equations.definitions[count:])):
        for note, group in groupby(definitions, key=lambda definition: definition.note):
            statements = tuple(equation(each.symbol, each.value, names) for each in group)
            yield Section(note, "", statements, part=Part.DEFINITIONS, body=number)


def _result(equations: Equations, form: ClosedForm, body: int, names: SymbolLatex) -> Iterator[Section]:
    """Yield the sections on [A] and {f}; of one body the rows that belong to its freedoms."""
    freedoms = equations.system.freedoms
    rows = [place for place, freedom in enumerate(freedoms) if body in (0, freedom.body)]
    if body and not rows:
        yield Section("Mass matrix", f"Body {body} has no free freedom.", part=Part.RESULT, body=body)
        return
    yield from (replace(each, body=body) for each in _conditions(form, names))
    symmetric = "[A] of Eq. (43); it is symmetric."
    of_body = f"Rows of [A], Eq. (43), and of {{f}}, Eq. (44), for the freedoms of body {body}."
    entries = tuple(_entries("A", form.A, names, rows, symmetric=not body))
    statements = entries if body else _matrix("A", form.A, names, entries)
    yield Section("Mass matrix", of_body if body else symmetric, statements, part=Part.RESULT, body=body)
    entries = tuple(_entries("f", form.f, names, rows))
    statements = entries if body else _matrix("f", form.f, names, entries)
    yield Section("Forcing", "{f} of Eq. (44).", statements, part=Part.RESULT, body=body)


def _state(equations: Equations, names: SymbolLatex) -> Section:
    """Return the section on {x} and {y}: side by side if each coordinate has its speed, else one by one."""
    side_by_side = len(equations.x) == len(equations.y)
    statements = _state_pairs(equations, names) if side_by_side else _state_elements(equations, names)
    return Section("Coordinates and speeds", "Eq. (1).", tuple(statements), is_list=True)


def _state_pairs(equations: Equations, names: SymbolLatex) -> Iterator[PrintedStatement]:
    """Yield a statement for each coordinate and its speed."""
    for i, (x, y) in enumerate(zip(equations.x, equations.y, strict=True)):
        name, unit = _pair_label(equations.system, i)
        yield PrintedStatement(
            f"x[{i + 1}] = {x}, y[{i + 1}] = {y}: {name} ({unit})",
            f"x_{{{i + 1}}}",
            (rf"{names[x]}, \quad y_{{{i + 1}}} = {names[y]} \quad {_latex_label(name, unit)}",),
        )


def _pair_label(system: System, place: int) -> tuple[str, str]:
    """Return name and unit of an element of {x}, and those of {y} where the speed has a name of its own."""
    name, unit = system.freedom_names[place], system.freedoms[place].unit
    speed_name = system.speed_names[place]
    return (name, unit) if name == speed_name else (f"{name}, {speed_name}", f"{unit}, {unit}/s")


def _state_elements(equations: Equations, names: SymbolLatex) -> Iterator[PrintedStatement]:
    """Yield a statement for each coordinate, then one for each speed."""
    system = equations.system
    units = [coordinate.unit for coordinate in system.coordinates]
    rates = [f"{freedom.unit}/s" for freedom in system.freedoms]
    yield from _elements("x", equations.x, zip(system.coordinate_names, units, strict=True), names)
    yield from _elements("y", equations.y, zip(system.speed_names, rates, strict=True), names)


def _elements(
    array: str, symbols: Iterable[Symbol], labels: Iterable[tuple[str, str]], names: SymbolLatex
) -> Iterator[PrintedStatement]:
    """Yield a statement for each element of {x} or {y}.

    Args:
        array: Name of the array, "x" or "y".
        symbols: Elements of the array.
        labels: Names and units of the elements.
        names: LaTeX of symbols.
    """
    for i, (symbol, (name, unit)) in enumerate(zip(symbols, labels, strict=True), start=1):
        plain = f"{array}[{i}] = {symbol}: {name} ({unit})"
        yield PrintedStatement(
            plain, f"{array}_{{{i}}}", (rf"{names[symbol]} \quad {_latex_label(name, unit)}",)
        )


def _prescribed(equations: Equations, names: SymbolLatex) -> Iterator[Section]:
    """Yield the section on prescribed freedoms, if there are any."""
    system, statements = equations.system, []
    for i, (name, freedom) in enumerate(zip(system.prescribed_names, system.prescribed, strict=True)):
        symbols = list(equations.prescribed[:, i])
        plain = f"prescribed[{i + 1}] = {', '.join(map(str, symbols))}: {name} ({freedom.unit})"
        formula = r", \quad ".join(names[symbol] for symbol in symbols)
        right = rf"{formula} \quad {_latex_label(name, freedom.unit)}"
        statements.append(PrintedStatement(plain, rf"\text{{prescribed}}_{{{i + 1}}}", (right,)))
    if statements:
        note = "Their values, rates and second derivatives are given; they are no coordinates."
        yield Section("Prescribed freedoms", note, tuple(statements), is_list=True)


def _coordinate_rates(equations: Equations, names: SymbolLatex) -> Iterator[Section]:
    """Yield the section on {xdot}, if some coordinates have rates that are not speeds."""
    rates = equations.symbols.coordinate_rates(equations.system)
    every = zip(rates, equations.xdot, strict=True)
    statements = tuple(equation(symbol, rate, names) for symbol, rate in every if rate != symbol)
    if statements:
        note = (
            "Eq. (9), where the speeds are components of a relative angular velocity; {xdot} = {y} elsewhere."
        )
        yield Section("Rates of the coordinates", note, statements)


def _parameters(equations: Equations, names: SymbolLatex) -> Iterator[Section]:
    """Yield the section on default values of parameters, if there are any."""
    values = [(parameter(each), expression(each.value)) for each in equations.system.parameters]
    if values:
        statements = tuple(equation(symbol, value, names) for symbol, value in values)
        yield Section("Parameters", "Default values.", statements, is_list=True)


def _loads(system: System) -> Iterator[Section]:
    """Yield the sections on loads on bodies and on points, if there are any."""
    if loaded := [(k, body.name) for k, body in enumerate(system.bodies, start=1) if body.loads]:
        turned = {frame.name for frame in system.frames}
        where = "body K" if turned.isdisjoint(body.name for body in system.bodies) else "the frame of body K"
        note = (
            f"F_K_i and M_K_i, Eq. (37), are components in {where} of a force at its mass centre (N) and of "
            f"a torque (N m). Loaded: {_numbered(loaded)}."
        )
        yield Section("Loads", note)
    points = [(p, point) for p, (_, point) in enumerate(system.points, start=1) if point.loads]
    if points:
        in_frames = any(point.load_frame for _, point in points)
        components = "components, inertial unless a frame is named," if in_frames else "inertial components"
        loaded = [(p, ", in ".join(filter(None, (point.name, point.load_frame)))) for p, point in points]
        note = (
            f"FP_P_i and MP_P_i are {components} of a force at point P (N) and of a moment on its body "
            f"(N m). Loaded: {_numbered(loaded)}."
        )
        yield Section("Loads on points", note)


def _numbered(names: Iterable[tuple[int, str]]) -> str:
    """Return names with their numbers, separated by commas."""
    return ", ".join(f"{number} ({name})" for number, name in names)


def _couplings(system: System) -> Iterator[Section]:
    """Yield the section on freedoms that follow others, if there are any."""
    if system.couplings:
        note = (
            f"Freedoms that follow others are not in {{x}} and {{y}}: {'; '.join(system.coupling_equations)}."
        )
        yield Section("Couplings", note)


def _motors(system: System) -> Iterator[Section]:
    """Yield the section on the inertia of motors, if there is any."""
    if system.motor_summaries:
        yield Section("Motors", f"Their inertia is part of [A]: {'; '.join(system.motor_summaries)}.")


def _force_elements(system: System) -> Iterator[Section]:
    """Yield the section on force elements, if there are any."""
    if system.force_elements:
        words = "; ".join(element.summary for element in system.force_elements)
        yield Section("Force elements", f"{words}.")


def _conditions(form: ClosedForm, names: SymbolLatex) -> Iterator[Section]:
    """Yield the section on the conditions under which a closed form holds, if there are any."""
    statements = tuple(
        PrintedStatement(f"{text(one)} > 0", latex(one, names), ("0",), relation=">")
        for one in form.conditions
    )
    if statements:
        note = "{f} holds where the ends of each spring do not pass through each other, that is where"
        yield Section("Directions of springs", note, statements, part=Part.RESULT)


def _matrix(
    name: str, value: ImmutableMatrix, names: SymbolLatex, entries: tuple[Equation, ...]
) -> tuple[Statement, ...]:
    """Return the statements about [A] or {f}: one where it fits a line of LaTeX, else one an entry."""
    if len(value) > MOST_ENTRIES or matrix_width(value, names) > LINE:
        return entries
    plain = "\n".join(entry.text for entry in entries) or f"{name} = 0"
    return (PrintedStatement(plain, name, (latex_matrix(value, names),)),)


def _entries(
    name: str, value: ImmutableMatrix, names: SymbolLatex, wanted: Iterable[int], symmetric: bool = False
) -> Iterator[Equation]:
    """Yield the entries in some rows that are not zero, of a symmetric matrix those from the diagonal on."""
    columns = value.shape[1]
    for i in wanted:
        for j in range(i if symmetric else 0, columns):
            if value[i, j]:
                index = f"{i + 1}" if columns == 1 and name == "f" else f"{i + 1},{j + 1}"
                yield Equation(f"{name}[{index}]", f"{name}_{{{index}}}", value[i, j], names)


def _latex_label(name: str, unit: str) -> str:
    """Return name and unit as text in LaTeX."""
    return rf"\text{{{escaped(name)} ({unit})}}"
