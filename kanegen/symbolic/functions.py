"""Functions of expressions that SymPy must neither rewrite nor differentiate by its own rules.

SymPy's own `exp(k*log(x))` becomes a power, its `Max` sorts its arguments and has a Heaviside step as
derivative, and the derivative of its `sign` is a Dirac delta. The functions here stay as they are written. A
derivative is that of the branch taken; jumps have none. Each prints itself as text, LaTeX, Python and NumPy.
"""

from __future__ import annotations

from typing import Any

import sympy
from sympy import Expr, Function, Rational, S


class _Real(Function):  # type: ignore[misc]  # SymPy has no types
    """A function whose values count as real numbers; where it has none, it is NaN in numeric code."""

    def _eval_is_extended_real(self) -> bool:
        return True


class exp(_Real):  # printed under its name
    """The exponential function, e to the power of its argument."""

    nargs = (1,)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative, the function itself."""
        return self


class log(_Real):
    """The natural logarithm of a positive number."""

    nargs = (1,)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative, the reciprocal of the argument."""
        return 1 / self.args[0]


class tanh(_Real):
    """The hyperbolic tangent of a number, from -1 to 1."""

    nargs = (1,)

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return 1 - tanh^2, as (2 e/(1 + e^2))^2 with e = exp(-|a|), without cancellation for large a."""
        e = exp(-sympy.Abs(self.args[0]))
        return 4 * e**2 / (1 + e**2) ** 2


class atan2(_Real):
    """The angle of the point (x, y), from -pi to pi, as atan2(y, x); 0 for x = y = 0 (rad)."""

    nargs = (2,)

    @classmethod
    def eval(cls, y: Expr, x: Expr) -> Expr | None:
        """Return 0 for the angle of the origin, which SymPy leaves undefined."""
        return S.Zero if y.is_zero and x.is_zero else None

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return the derivative by y or by x."""
        y, x = self.args
        return (x if argindex == 1 else -y) / (x**2 + y**2)


class sign(_Real):
    """-1, 0 or 1 by the sign of a number; its derivative is 0 everywhere."""

    nargs = (1,)

    @classmethod
    def eval(cls, argument: Expr) -> Expr | None:
        """Return the sign of a rational number."""
        return sympy.sign(argument) if argument.is_Rational else None

    def fdiff(self, argindex: int = 1) -> Expr:
        """Return 0, also at the jump."""
        return S.Zero

    def _latex(self, printer: Any) -> str:
        return rf"\operatorname{{sgn}}\left({printer.doprint(self.args[0])}\right)"

    def _pythoncode(self, printer: Any) -> str:
        return python_sign(printer.doprint(self.args[0]))


class minimum(_Real):
    """The smaller of two numbers; where they are equal, the first and its derivative."""

    nargs = (2,)

    @classmethod
    def eval(cls, a: Expr, b: Expr) -> Expr | None:
        """Return the smaller of two rational numbers."""
        return min(a, b) if a.is_Rational and b.is_Rational else None

    def _eval_derivative(self, symbol: Expr) -> Expr:
        a, b = self.args
        return choice(a - b, b.diff(symbol), a.diff(symbol))

    def _sympystr(self, printer: Any) -> str:
        return _called("min", self, printer)

    def _latex(self, printer: Any) -> str:
        return rf"\min\left({_arguments(self, printer)}\right)"

    _pythoncode = _sympystr

    def _numpycode(self, printer: Any) -> str:
        return _called(printer._module_format("numpy.minimum"), self, printer)


class maximum(_Real):
    """The larger of two numbers; where they are equal, the first and its derivative."""

    nargs = (2,)

    @classmethod
    def eval(cls, a: Expr, b: Expr) -> Expr | None:
        """Return the larger of two rational numbers."""
        return max(a, b) if a.is_Rational and b.is_Rational else None

    def _eval_derivative(self, symbol: Expr) -> Expr:
        a, b = self.args
        return choice(b - a, b.diff(symbol), a.diff(symbol))

    def _sympystr(self, printer: Any) -> str:
        return _called("max", self, printer)

    def _latex(self, printer: Any) -> str:
        return rf"\max\left({_arguments(self, printer)}\right)"

    _pythoncode = _sympystr

    def _numpycode(self, printer: Any) -> str:
        return _called(printer._module_format("numpy.maximum"), self, printer)


class choice(_Real):
    """The second argument where the first is positive, and the third where it is 0 or negative."""

    nargs = (3,)

    @classmethod
    def eval(cls, condition: Expr, a: Expr, b: Expr) -> Expr | None:
        """Return the argument that is chosen in every state; a choice between -1 and 1 is resolved."""
        if isinstance(condition, choice) and condition.args[1:] == (S.NegativeOne, S.One):
            return choice(condition.args[0], b, a)
        if condition.is_number:
            value = condition.evalf()
            if value.is_comparable:
                return a if value > 0 else b
        return None

    def _eval_derivative(self, symbol: Expr) -> Expr:
        condition, a, b = self.args
        return choice(condition, a.diff(symbol), b.diff(symbol))

    def _latex(self, printer: Any) -> str:
        condition, a, b = (printer.doprint(argument) for argument in self.args)
        rows = rf"{a} & \text{{for}}\: {condition} > 0 \\ {b} & \text{{otherwise}}"
        return rf"\begin{{cases}} {rows} \end{{cases}}"

    def _sympystr(self, printer: Any) -> str:
        condition, a, b = (printer.doprint(argument) for argument in self.args)
        return f"({a} if {condition} > 0 else {b})"

    _pythoncode = _sympystr

    def _numpycode(self, printer: Any) -> str:
        where = printer._module_format("numpy.where")
        condition, a, b = (printer.doprint(argument) for argument in self.args)
        return f"{where}({condition} > 0, {a}, {where}({condition} <= 0, {b}, {condition}))"


class root(_Real):
    """A power with an exponent below 1 of what may be 0, where its derivative is 0 if that of the base is.

    Elsewhere the derivative is not chosen by that of the base, so that it can be differentiated again.
    It stands in the place of SymPy's power during a differentiation, see `with_roots`.
    """

    nargs = (2,)

    def _eval_derivative(self, symbol: Expr) -> Expr:
        base, exponent = self.args
        slope = base.diff(symbol)
        not_at_minimum = sympy.Abs(base) + sympy.Abs(slope)
        return choice(not_at_minimum, exponent * slope * base ** (exponent - 1), S.Zero)


def with_roots(value: Expr) -> Expr:
    """Return a value with `root` in the place of roots that may be 0."""
    return value.replace(_may_vanish, lambda power: root(power.base, power.exp))


def without_roots(value: Expr) -> Expr:
    """Return a value with SymPy's powers in the place of `root`."""
    return value.replace(root, sympy.Pow)


def _may_vanish(value: Expr) -> bool:
    """Return whether a value is a square root, or a root of roots, that may be 0."""
    if not value.is_Pow or not value.exp.is_Rational:
        return False
    return bool(0 < value.exp < 1 and not value.base.is_positive)


def has_branches(value: Expr) -> bool:
    """Return whether a derivative of a value must not be multiplied where it does not count."""
    return bool(value.has(*_BRANCHING)) or any(map(_may_vanish, value.atoms(sympy.Pow)))


_BRANCHING = (minimum, maximum, choice)
"""Functions of which only one argument counts in a state, so that the others may be undefined there."""

_NO = Rational(-1)
_YES = Rational(1)


def greater(a: Expr, b: Expr) -> Expr:
    """Return a number that is positive where a > b."""
    return a - b


def not_less(a: Expr, b: Expr) -> Expr:
    """Return a number that is positive where a >= b."""
    return negated(b - a)


def both(p: Expr, q: Expr) -> Expr:
    """Return a number that is positive where p and q are; q does not count where p is not positive."""
    return choice(p, q, _NO)


def either(p: Expr, q: Expr) -> Expr:
    """Return a number that is positive where p or q is; q does not count where p is positive."""
    return choice(p, _YES, q)


def negated(p: Expr) -> Expr:
    """Return a number that is positive where p is not."""
    return choice(p, _NO, _YES)


def python_sign(text: str) -> str:
    """Return the sign of a number as Python writes it; a module's `copysign` has no 0."""
    return f"(({text} > 0) - ({text} < 0))"


def _called(name: str, function: Function, printer: Any) -> str:
    """Return the call of a function of this name."""
    return f"{name}({_arguments(function, printer)})"


def _arguments(function: Function, printer: Any) -> str:
    """Return the arguments of a function, with commas between them."""
    return ", ".join(printer.doprint(argument) for argument in function.args)
