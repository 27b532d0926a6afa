"""Expressions and symbols as text, Python and LaTeX.

The printers are SymPy's, with numbers that lose no digit: 0.1 prints as 0.1 and reads back as the same
double.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from sympy import Expr, Float, ImmutableMatrix, Symbol
from sympy.printing.latex import LatexPrinter
from sympy.printing.pycode import PythonCodePrinter
from sympy.printing.str import StrPrinter

from kanegen.model.coordinates import COORDINATE_KINDS, FREEDOMS, Freedom
from kanegen.model.symbolic import Place, places
from kanegen.model.system import System
from kanegen.symbolic.functions import python_sign
from kanegen.symbolic.literal.dynamics import BodyEquations
from kanegen.symbolic.state_symbols import StateSymbols
from kanegen.symbolic.symbols import force, parameter, point_force, point_moment, torque

LINE = 90
"""Width in characters after which a long sum continues in the next line of LaTeX."""

_LETTER = re.compile("[A-Za-z]|alpha|beta|gamma|delta|epsilon|theta|kappa|mu|nu|rho|sigma|tau|phi|psi|omega")
_LETTER_AND_INDEX = re.compile(rf"({_LETTER.pattern})(?:_?(\d+|[xyz]{{1,2}})|_([A-Za-z]{{1,2}}\d*))?")
"""Names that are printed in LaTeX as a letter, perhaps with an index: `g`, `m2`, `theta_1`, `Ixx`, `l_a`."""


_SIZED = re.compile(r"\\(left|right)(\\[{}|]|[()\[\]|])")
"""Brackets that are as large as what they hold."""

_DEPTH = re.compile(r"\\[{}]|(?P<open>\\begin\{\w+\}|\{)|(?P<close>\\end\{\w+\}|\})|(?P<sign> (?=[+-] ))")
"""Where LaTeX goes deeper, comes back, or has the sign of a term."""

_INVISIBLE = re.compile(
    r"\\(left|right|bigl|bigr|cdot|quad|mathit|text|mathrm|,)|\\(hat|dot|ddot|tilde)(?=\{)|[{}_^ ]"
)
_ESCAPED = re.compile(r"\\[{}_|&%$# ]")
_FUNCTION = re.compile(r"\\(sin|cos|tan|tanh|exp|log|min|max)(?![a-z])")
_COMMAND = re.compile(r"\\[A-Za-z]+")
"""Parts of LaTeX that show nothing, one character, three, and again one."""


class _TextPrinter(StrPrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_Float(self, number: Float) -> str:
        return repr(float(number))


class _LatexPrinter(LatexPrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_Symbol(self, symbol: Symbol, *_: object) -> str:
        return self._settings["symbol_names"].get(symbol) or _of_name(symbol.name)

    def _print_Float(self, number: Float) -> str:
        mantissa, _, exponent = repr(float(number)).partition("e")
        return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else mantissa


class _PythonPrinter(PythonCodePrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_sign(self, function: Expr) -> str:
        return python_sign(self.doprint(function.args[0]))

    def _print_Float(self, number: Float) -> str:
        return repr(float(number))


def text(expr: Expr) -> str:
    """Return `expr` in SymPy's plain notation."""
    return str(_TextPrinter().doprint(expr))


def python(expr: Expr) -> str:
    """Return `expr` in Python, with the functions of the module `math` as bare names."""
    return str(_PythonPrinter({"fully_qualified_modules": False}).doprint(expr))


def latex(expr: Expr, names: Mapping[Symbol, str]) -> str:
    """Return `expr` in LaTeX.

    Args:
        expr: An expression or a matrix.
        names: LaTeX of symbols; all others are printed by their names.
    """
    settings = {"symbol_names": dict(names), "fold_func_brackets": True}
    return str(_LatexPrinter(settings).doprint(expr))


def latex_matrix(value: ImmutableMatrix, names: Mapping[Symbol, str]) -> str:
    """Return a matrix in LaTeX, in square brackets.

    Args:
        value: The matrix.
        names: LaTeX of symbols; all others are printed by their names.
    """
    rows = [" & ".join(latex(entry, names) for entry in row) for row in value.tolist()]
    return r"\begin{bmatrix}" + r" \\ ".join(rows) + r"\end{bmatrix}"


def matrix_width(value: ImmutableMatrix, names: Mapping[Symbol, str]) -> int:
    """Estimate how many characters of a matrix in LaTeX a reader sees in a line."""
    columns = value.T.tolist()
    widest = (max(_visible_width(latex(entry, names)) for entry in column) for column in columns)
    return sum(width + 2 for width in widest)


def latex_lines(expr: Expr, names: Mapping[Symbol, str], width: int = LINE) -> list[str]:
    """Return `expr` in LaTeX, a long one broken before the signs of its sums, also of those in parentheses.

    Args:
        expr: An expression.
        names: LaTeX of symbols; all others are printed by their names.
        width: Width of a line in characters.
    """
    whole = latex(expr, names)
    if _visible_width(whole) <= width:
        return [whole]
    lines: list[str] = []
    for part in _between_signs(_SIZED.sub(_fixed_size, whole)):
        if lines and _visible_width(lines[-1] + part) <= width:
            lines[-1] += part
        else:
            lines.append(part.lstrip())
    return lines


def _fixed_size(match: re.Match[str]) -> str:
    """Return a bracket that may stand in another line than the one that closes it."""
    return rf"\bigl{match[2]}" if match[1] == "left" else rf"\bigr{match[2]}"


def _between_signs(printed: str) -> Iterator[str]:
    """Yield the parts of LaTeX that begin with the signs of sums, but for those in braces or environments."""
    depth = start = 0
    for match in _DEPTH.finditer(printed):
        if match["sign"]:
            if depth == 0 and match.start() > start:
                yield printed[start : match.start()]
                start = match.start()
        else:
            depth += 1 if match["open"] else -1
    yield printed[start:]


def _visible_width(printed: str) -> int:
    """Estimate how many characters of LaTeX a reader sees."""
    seen = _INVISIBLE.sub("", _FUNCTION.sub("xxx", _ESCAPED.sub("x", printed)))
    return len(_COMMAND.sub("x", seen))


def latex_names(
    system: System, symbols: StateSymbols, bodies: Iterable[BodyEquations] = ()
) -> dict[Symbol, str]:
    """Return the LaTeX of coordinates, speeds, accelerations, loads, intermediates and parameters.

    Args:
        system: The system.
        symbols: The symbols of its coordinates and speeds.
        bodies: The equations of its bodies, which have symbols for loads and intermediates.
    """
    names = {parameter(given): _of_name(given.name) for given in system.parameters}
    moving = {(f.body, f.index) for f in system.freedoms + system.prescribed}
    for k, kind in sorted(moving | {(c.body, c.index) for c in system.coordinates}):
        given = symbols.names.get(Freedom(k, kind))
        letter, place = _letter_and_index(given) if given else _of_the_notes(k, kind)
        names[symbols.coordinate(k, kind)] = letter + place
        names[symbols.coordinate_rate(k, kind)] = rf"\dot{{{letter}}}" + place
        if kind < len(FREEDOMS):
            names[symbols.acceleration(k, kind)] = rf"\ddot{{{letter}}}" + place
    for each in system.speeds:
        if not each.kind.is_rate:
            place = f"_{{{each.body},{each.kind.number}}}"
            names[symbols.speed(each.body, each.index)] = rf"{{\hat{{\omega}}'}}{place}"
            names[symbols.acceleration(each.body, each.index)] = rf"{{\dot{{\hat{{\omega}}}}'}}{place}"
    for body in bodies:
        for axis in range(3):
            names[force(body.number, axis)] = f"{{F'}}_{{{body.number},{axis + 1}}}"
            names[torque(body.number, axis)] = f"{{M'}}_{{{body.number},{axis + 1}}}"
        names |= body.intermediates.latex
    for point in range(1, len(system.points) + 1):
        for axis in range(3):
            names[point_force(point, axis)] = f"F_{{P_{{{point}}},{axis + 1}}}"
            names[point_moment(point, axis)] = f"M_{{P_{{{point}}},{axis + 1}}}"
    names |= {parameter(given): _of_place(place) for given, place in places(system)}
    return names


def _of_place(place: Place) -> str:
    """Return the LaTeX of a symbol that stands for a number of a body, as the notes write it."""
    if place.quantity == "m":
        return f"m_{{{place.body}}}"
    where = f"G_{{{place.body}}}" if place.quantity == "I" else str(place.body)
    return f"{{{place.quantity}'}}_{{{where},{''.join(map(str, place.index))}}}"


def _of_the_notes(body: int, kind: int) -> tuple[str, str]:
    """Return the letter and the index of a coordinate in LaTeX as the notes write it."""
    entry = COORDINATE_KINDS[kind]
    return _letter(entry.symbol), f"_{{{body},{entry.number}}}"


def _of_name(name: str) -> str:
    """Return a name in LaTeX."""
    return "".join(_letter_and_index(name))


def _letter_and_index(name: str) -> tuple[str, str]:
    """Return a name in LaTeX as a letter and an index, such as q and 1; a longer name has no index."""
    match = _LETTER_AND_INDEX.fullmatch(name)
    if not match:
        return rf"\mathit{{{escaped(name)}}}", ""
    index = match[2] or match[3]
    return _letter(match[1]), f"_{{{index}}}" if index else ""


def _letter(symbol: str) -> str:
    """Return a letter in LaTeX: a command for a Greek one, itself otherwise."""
    return symbol if len(symbol) == 1 else rf"\{symbol}"


def escaped(plain: str) -> str:
    """Return plain text for LaTeX, with characters that would be commands escaped."""
    return "".join(_LATEX_CHARACTERS.get(character, character) for character in plain)


_LATEX_CHARACTERS = {
    **{character: f"\\{character}" for character in "{}_&%$#"},
    "\\": r"\textbackslash{}",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
}
"""LaTeX of characters that would be commands."""
