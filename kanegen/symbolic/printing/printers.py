"""SymPy's printers, with numbers that lose no digit: 0.1 prints as 0.1 and reads back as the same double."""

from __future__ import annotations

import re
from collections.abc import Mapping

from sympy import Add, Expr, Float, Symbol
from sympy.printing.latex import LatexPrinter
from sympy.printing.pycode import PythonCodePrinter
from sympy.printing.str import StrPrinter

LINE = 90
"""Width in characters after which a long sum goes on in the next line of LaTeX."""


class _Text(StrPrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_Float(self, number: Float) -> str:
        return repr(float(number))


class _Latex(LatexPrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_Float(self, number: Float) -> str:
        mantissa, _, exponent = repr(float(number)).partition("e")
        return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if exponent else mantissa


class _Python(PythonCodePrinter):  # type: ignore[misc]  # SymPy has no types
    def _print_Float(self, number: Float) -> str:
        return repr(float(number))


def text(expr: Expr) -> str:
    """`expr` in SymPy's plain notation."""
    return str(_Text().doprint(expr))


def python(expr: Expr) -> str:
    """`expr` in Python, with `sin` and `cos` as bare names."""
    return str(_Python({"fully_qualified_modules": False}).doprint(expr))


def latex(expr: Expr, names: Mapping[Symbol, str]) -> str:
    """`expr` in LaTeX, its symbols as `names` says, others as SymPy likes."""
    settings = {"symbol_names": dict(names), "fold_func_brackets": True}
    return str(_Latex(settings).doprint(expr))


def latex_lines(expr: Expr, names: Mapping[Symbol, str]) -> list[str]:
    """The same, a long sum broken between its terms; every line but the first begins with its sign."""
    whole = latex(expr, names)
    if not isinstance(expr, Add) or _width(whole) <= LINE:
        return [whole]
    lines = [""]
    for term in expr.as_ordered_terms():
        printed = latex(term, names)
        signed = printed if printed.startswith("-") or lines == [""] else f"+ {printed}"
        if lines[-1] and _width(lines[-1]) + _width(signed) > LINE:
            lines.append(signed)
        else:
            lines[-1] = f"{lines[-1]} {signed}".strip()
    return lines


def _width(printed: str) -> int:
    """About how many characters a reader sees."""
    seen = re.sub(r"\\(left|right|cdot|quad|,| )|[{}_^\\]", "", printed)
    return len(re.sub(r"theta|omega|dot|hat|tilde|sin|cos", "x", seen))
