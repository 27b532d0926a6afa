"""Expressions and symbols as text, Python and LaTeX.

The printers are SymPy's, with numbers that lose no digit: 0.1 prints as 0.1 and reads back as the same
double.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from sympy import Add, Expr, Float, Symbol
from sympy.printing.latex import LatexPrinter
from sympy.printing.pycode import PythonCodePrinter
from sympy.printing.str import StrPrinter

from kanegen.model.coordinates import COORDINATE_KINDS, FREEDOMS, Freedom
from kanegen.symbolic.equations import Equations
from kanegen.symbolic.functions import python_sign
from kanegen.symbolic.symbols import force, parameter, torque

LINE = 90
"""Width in characters after which a long sum continues in the next line of LaTeX."""

_LETTER = re.compile("[A-Za-z]|alpha|beta|gamma|delta|epsilon|theta|kappa|mu|nu|rho|sigma|tau|phi|psi|omega")
_LETTER_AND_INDEX = re.compile(rf"({_LETTER.pattern})(?:_?(\d+|[xyz]{{1,2}})|_([A-Za-z]{{1,2}}\d*))?")
"""Names that are printed in LaTeX as a letter, perhaps with an index: `g`, `m2`, `theta_1`, `Ixx`, `l_a`."""


class _TextPrinter(StrPrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_Float(self, number: Float) -> str:
        return repr(float(number))


class _LatexPrinter(LatexPrinter):  # type: ignore[misc]  # SymPy has no types
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
        names: LaTeX of symbols; SymPy prints all others.
    """
    settings = {"symbol_names": dict(names), "fold_func_brackets": True}
    return str(_LatexPrinter(settings).doprint(expr))


def latex_lines(expr: Expr, names: Mapping[Symbol, str]) -> list[str]:
    """Return `expr` in LaTeX, a long sum broken into lines of which all but the first begin with a sign.

    Args:
        expr: An expression.
        names: LaTeX of symbols; SymPy prints all others.
    """
    whole = latex(expr, names)
    if not isinstance(expr, Add) or _visible_width(whole) <= LINE:
        return [whole]
    lines = [""]
    for term in expr.as_ordered_terms():
        printed = latex(term, names)
        signed = printed if printed.startswith("-") or lines == [""] else f"+ {printed}"
        if lines[-1] and _visible_width(lines[-1]) + _visible_width(signed) > LINE:
            lines.append(signed)
        else:
            lines[-1] = f"{lines[-1]} {signed}".strip()
    return lines


def _visible_width(printed: str) -> int:
    """Estimate how many characters of LaTeX a reader sees."""
    seen = re.sub(r"\\(left|right|cdot|quad|,| )|[{}_^\\]", "", printed)
    return len(re.sub(r"theta|omega|dot|hat|tilde|sin|cos", "x", seen))


def latex_names(equations: Equations) -> dict[Symbol, str]:
    """Return the LaTeX of coordinates, speeds, accelerations, loads, intermediates and parameters."""
    system, symbols = equations.system, equations.symbols
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
    for body in equations.bodies:
        for axis in range(3):
            names[force(body.number, axis)] = f"{{F'}}_{{{body.number},{axis + 1}}}"
            names[torque(body.number, axis)] = f"{{M'}}_{{{body.number},{axis + 1}}}"
        names |= body.intermediates.latex
    return names


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
