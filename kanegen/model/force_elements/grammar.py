"""The grammar of expressions, and a parser that evaluates nothing.

    expression = number | "pi" | variable | parameter | "(" expression ")"
               | function "(" expression {"," expression} ")"
               | ("+" | "-") expression | expression ("+" | "-" | "*" | "/") expression
               | expression "**" whole number
               | expression "if" condition "else" expression
    condition  = expression {("<" | "<=" | ">" | ">=") expression} | "(" condition ")"
               | "not" condition | condition ("and" | "or") condition
    variable   = "t" | "x." name | "y." name | 'x["' name '"]' | 'y["' name '"]'

Operators bind as in Python, whose parser makes the tree; everything else that Python allows is refused.
"""

from __future__ import annotations

import ast
import keyword
import re
import warnings
from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import pairwise

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.force_elements.expression import (
    FUNCTIONS,
    PI,
    TIME,
    Constant,
    Expression,
    Node,
    Operation,
    Power,
    Variable,
)
from kanegen.model.numbers import Parameter, finite

MAX_OPERATIONS = 2000
"""Largest number of operations of an expression."""

MAX_CHARACTERS = 300_000
"""Largest number of characters of an expression: more than any has that was saved with `MAX_OPERATIONS`."""

MAX_DEPTH = 200
"""Largest depth of nested operations."""

MAX_EXPONENT = 64
"""Largest exponent, and largest product of the exponents of nested powers."""

VECTORS = ("x", "y")
"""Names of the vectors whose elements are variables: coordinates and speeds."""

_SIGNS: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}

_WORDS = ("if", "else", "and", "or", "not")
"""Words of Python that the grammar has."""

_COMPARISONS: dict[type[ast.cmpop], str] = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}

_SEVERAL = ("max", "min")
"""Functions that take two numbers or more."""

_NUMBERS = {1: "one number", 2: "two numbers"}
"""Numbers of operands in words."""


def parse(text: object, parameters: Iterable[Parameter] = ()) -> Expression:
    """Return the expression of a text.

    Args:
        text: The text; a number or an `Expression` is accepted too.
        parameters: Parameters whose names the text may contain.

    Raises:
        ModelError: If the text does not follow the grammar; the message quotes the part that does not.

    Example:
        kg.parse("k*sin(x.arm.theta3)", [kg.Parameter("k", 2.0)])
    """
    if isinstance(text, Expression):
        return text
    if not isinstance(text, str):
        return Expression(Constant(finite(text, "expression")))
    if len(text) > MAX_CHARACTERS:
        raise ModelError(f"an expression has {len(text)} characters; at most {MAX_CHARACTERS} are read.")
    known = validation.instances(parameters, Parameter, "parameters")
    reader = _Reader(text, {parameter.name: parameter for parameter in known})
    try:
        return Expression(reader.node(_tree(text)))
    except RecursionError:
        raise ModelError(f"{_quoted(text)}: nested too deeply.") from None


def _tree(text: str) -> ast.expr:
    """Return the syntax tree that Python's parser makes of a text."""
    try:
        with warnings.catch_warnings(action="ignore"):  # Python's warnings are about texts refused below
            return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        where = f" near column {error.offset}" if error.offset else ""
        words = [word for word in re.findall(r"\w+", text) if keyword.iskeyword(word) and word not in _WORDS]
        if words:
            raise ModelError(f"{_quoted(text)}: {words[0]!r} cannot be a name in an expression.") from None
        raise ModelError(f"{_quoted(text)}: no expression{where}.") from None
    except (ValueError, MemoryError):
        raise ModelError(f"{_quoted(text)}: no expression, or nested too deeply.") from None


def _quoted(text: str) -> str:
    """Return the text of an expression in quotes for an error message, shortened if it is long."""
    return f"expression {text if len(text) <= 80 else f'{text[:77]}...'!r}"


def _joined(operator: str, operands: Sequence[Node]) -> Node:
    """Return an operation on two operands applied to one or more, from the left."""
    return reduce(lambda a, b: Operation(operator, (a, b)), operands)


class _Reader:
    """Converts Python's syntax tree to an expression and refuses everything outside the grammar."""

    def __init__(self, text: str, parameters: dict[str, Parameter]) -> None:
        self._text = text
        self._parameters = parameters
        self._operations = 0

    def node(self, found: ast.expr, depth: int = 0, power: int = 1) -> Node:
        """Return the tree of `found`, at depth `depth`, inside exponents that multiply to `power`."""
        self._count(found, depth)
        match found:
            case ast.Constant(value=bool() | complex() | str() | bytes() | None):
                raise self._refused(found, "no number.")
            case ast.Constant(value=value):
                return Constant(finite(value, _quoted(self._text)))
            case ast.Name(id=name):
                return self._named(found, name)
            case ast.Attribute() | ast.Subscript():
                return Variable(self._element(found))
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.node(operand, depth + 1, power)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return Operation("negate", (self.node(operand, depth + 1, power),))
            case ast.BinOp(op=ast.BitXor()):
                raise self._refused(found, "a power is written with **, as in x.arm.theta1**2.")
            case ast.BinOp(left=base, op=ast.Pow(), right=exponent):
                whole = self._exponent(exponent, power)
                base_node = self.node(base, depth + 1, power * max(abs(whole), 1))
                return Power(base_node, whole)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _SIGNS:
                pair = self.node(left, depth + 1, power), self.node(right, depth + 1, power)
                return Operation(_SIGNS[type(op)], pair)
            case ast.Call():
                return self._call(found, depth, power)
            case ast.IfExp(test=test, body=then, orelse=otherwise):
                branches = (self.node(branch, depth + 1, power) for branch in (then, otherwise))
                return Operation("if", (self._condition(test, depth + 1), *branches))
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                raise self._refused(
                    found, "a condition is no number. Write <number> if <condition> else <number>."
                )
        raise self._refused(
            found, "only numbers, names, + - * / **, brackets, functions, and if with else are possible."
        )

    def _count(self, found: ast.expr, depth: int) -> None:
        """Count an operation, and refuse an expression that is too deep or too long."""
        if depth > MAX_DEPTH:
            raise self._refused(found, f"more than {MAX_DEPTH} operations inside each other.")
        if self._operations > MAX_OPERATIONS:
            raise ModelError(f"{_quoted(self._text)}: more than {MAX_OPERATIONS} operations.")
        kinds = ast.UnaryOp | ast.BinOp | ast.Call | ast.IfExp | ast.Compare | ast.BoolOp
        self._operations += isinstance(found, kinds)

    def _condition(self, found: ast.expr, depth: int) -> Node:
        """Return the tree of a condition; each comparison of a chain must hold."""
        self._count(found, depth)
        match found:
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return Operation("not", (self._condition(operand, depth + 1),))
            case ast.BoolOp(op=op, values=values):
                parts = [self._condition(value, depth + 1) for value in values]
                return _joined("and" if isinstance(op, ast.And) else "or", parts)
            case ast.Compare(left=left, ops=ops, comparators=others) if all(
                type(op) in _COMPARISONS for op in ops
            ):
                # A number in the middle of a chain counts twice, as it stands in two comparisons.
                pairs = zip(ops, pairwise((left, *others)), strict=True)
                return _joined("and", [self._comparison(op, pair, depth) for op, pair in pairs])
        raise self._refused(found, "a condition compares numbers by < <= > >=, and may have and, or, not.")

    def _comparison(self, op: ast.cmpop, pair: tuple[ast.expr, ast.expr], depth: int) -> Node:
        """Return the comparison of two numbers."""
        a, b = (self.node(number, depth + 1) for number in pair)
        return Operation(_COMPARISONS[type(op)], (a, b))

    def _named(self, found: ast.expr, name: str) -> Node:
        """Return pi, the time or the parameter of a name, which must have one meaning."""
        parameter = self._parameters.get(name)
        if parameter and name == PI:
            raise self._refused(found, "this is the number pi, but a parameter has the same name. Rename it.")
        if name == PI:
            return Operation(PI, ())
        if name in VECTORS:
            hint = " A parameter in an expression needs another name." if parameter else ""
            raise self._refused(found, f"one element is needed, such as {name}.arm.theta1.{hint}")
        if parameter and name == TIME:
            raise self._refused(found, "this is the time, but a parameter has the same name. Rename it.")
        if parameter:
            return Constant(parameter)
        if name == TIME:
            return Variable(name)
        hint = f" {did_you_mean(name, self._parameters)}" if self._parameters else ""
        raise self._refused(
            found, f"the name is not known. Write x.<coordinate>, y.<speed>, t or a parameter.{hint}"
        )

    def _element(self, found: ast.expr) -> str:
        """Return `x.arm.theta1` from names with dots between them, or from a text in brackets."""
        match found:
            case ast.Subscript(value=ast.Name(id=vector), slice=ast.Constant(value=str(name))) if (
                vector in VECTORS
            ):
                return f"{vector}.{name}"
            case ast.Attribute(value=ast.Name(id=vector), attr=name) if vector in VECTORS:
                return f"{vector}.{name}"
            case ast.Attribute(value=ast.Attribute() as inner, attr=name):
                return f"{self._element(inner)}.{name}"
        raise self._refused(found, "only x and y have elements: x.<coordinate>, y.<speed>.")

    def _exponent(self, found: ast.expr, power: int) -> int:
        """Return an exponent, an integer; `power` is the product of the exponents around it."""
        sign, digits = 1, found
        match found:
            case ast.UnaryOp(op=ast.UAdd(), operand=digits):
                pass
            case ast.UnaryOp(op=ast.USub(), operand=digits):
                sign = -1
        value = digits.value if isinstance(digits, ast.Constant) else None
        if not isinstance(value, int | float) or isinstance(value, bool) or value % 1 != 0:
            raise self._refused(found, "an exponent is a whole number; for roots there is sqrt.")
        if value * power > MAX_EXPONENT:
            raise self._refused(found, f"a huge power; together exponents reach at most {MAX_EXPONENT}.")
        return sign * int(value)

    def _call(self, found: ast.Call, depth: int, power: int) -> Node:
        """Return the operation of a call of one of `FUNCTIONS`."""
        if not isinstance(found.func, ast.Name) or found.func.id not in FUNCTIONS:
            name = ast.unparse(found.func)
            known = f"There are {', '.join(FUNCTIONS)}."
            raise self._refused(found, f"there is no function {quoted(name)}. {known}")
        name, count = found.func.id, FUNCTIONS[found.func.id]
        more = name in _SEVERAL
        if found.keywords or len(found.args) < count or (len(found.args) > count and not more):
            raise self._refused(found, f"{name} takes {_NUMBERS[count]}{' or more' * more}.")
        operands = [self.node(operand, depth + 1, power) for operand in found.args]
        return _joined(name, operands) if more else Operation(name, tuple(operands))

    def _refused(self, found: ast.expr, why: str) -> ModelError:
        """Return the error that refuses a part of the expression, with the reason."""
        part = ast.get_source_segment(self._text.strip(), found) or ""
        where = f" in {_quoted(self._text)}" if part != self._text.strip() else ""
        return ModelError(f"{_quoted(part)}{where}: {why}")
