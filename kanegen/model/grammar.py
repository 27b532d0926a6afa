"""The grammar of expressions, and a parser that evaluates nothing.

    expression = number | "pi" | variable | parameter | "(" expression ")"
               | function "(" expression {"," expression} ")"
               | ("+" | "-") expression | expression ("+" | "-" | "*" | "/") expression
               | expression "**" whole number
               | expression "if" condition "else" expression
    condition  = expression {("<" | "<=" | ">" | ">=") expression} | "(" condition ")"
               | "not" condition | condition ("and" | "or") condition
    variable   = "t" | "x." name | "y." name | 'x["' name '"]' | 'y["' name '"]'

A number of a model has no variables: only expressions of force elements depend on the state and the time.
Operators bind as in Python, whose parser makes the tree; everything else that Python allows is refused.
"""

from __future__ import annotations

import ast
import keyword
import re
import warnings
from collections.abc import Iterable, Mapping, Sequence
from functools import reduce
from itertools import pairwise
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.expression import Expression, Parameter, constant, negated, node_of
from kanegen.model.finite import finite, is_plain
from kanegen.model.nodes import (
    FUNCTIONS,
    MAX_DEPTH,
    MAX_EXPONENT,
    MAX_OPERATIONS,
    PI,
    TIME,
    Constant,
    Node,
    Operation,
    Power,
    Variable,
    check_size,
)
from kanegen.model.numbers import Number

MAX_CHARACTERS = 300_000
"""Largest number of characters of an expression: more than any has that was saved with `MAX_OPERATIONS`."""

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


def parse(text: object, parameters: Iterable[Parameter] | Mapping[str, Number] = ()) -> Expression:
    """Return the expression of a text.

    Args:
        text: The text; a number, a `Parameter` or an `Expression` is accepted too.
        parameters: Parameters whose names the text may contain, or numbers of the model by such names.

    Raises:
        ModelError: If the text does not follow the grammar; the message quotes the part that does not.

    Example:
        kg.parse("k*sin(x.arm.theta3)", [kg.Parameter("k", 2.0)])
    """
    if isinstance(text, Expression):
        return text
    if isinstance(text, Parameter):
        return Expression.of(text)
    if not isinstance(text, str):
        return Expression(Constant(finite(text, "expression")))
    if not isinstance(parameters, Mapping):
        known = validation.instances(parameters, Parameter, "parameters")
        parameters = {parameter.name: parameter for parameter in known}
    return Expression(_root(_Reader(text, parameters)))


def parse_number(text: str, known: Mapping[str, Number]) -> Expression:
    """Return the expression of a text in the place of a number, which has no variables.

    Args:
        text: The text.
        known: Parameters, and names of other numbers, by the names that the text may contain.

    Raises:
        ModelError: If the text does not follow the grammar; the message quotes the part that does not.

    Example:
        parse_number("m*l**2/12", {"m": kg.Parameter("m", 2.0), "l": kg.Parameter("l", 0.5)})
    """
    return Expression(_root(_NumberReader(text, known)))


def parse_signal(text: object, parameters: Iterable[Parameter], variables: Sequence[str]) -> Expression:
    """Return the expression of a text whose variables are chosen by the caller.

    Args:
        text: The text; a number is accepted too.
        parameters: Parameters whose names the text may contain.
        variables: Names of the variables, such as "t", "x.pole" and "point_positions.tip.z". One that is not
            made of words stands in brackets, as in y["left drive"].

    Raises:
        ModelError: If the text does not follow the grammar, or contains another name.

    Example:
        parse_signal("point_positions.tip.z - 0.1", [], ["point_positions.tip.z"])
    """
    if not isinstance(text, str):
        return Expression(Constant(finite(text, "expression")))
    known = {parameter.name: parameter for parameter in parameters}
    return Expression(_root(_SignalReader(text, known, variables)))


def _root(reader: _Reader) -> Node:
    """Return the tree of the text of a reader."""
    found = syntax_tree(reader.text)
    try:
        return check_size(reader.node(found))
    except RecursionError:
        raise ModelError(f"{_quoted(reader.text)}: nested too deeply.") from None


_UNFINISHED = re.compile(r"(\*\*|[<>=]=|[-+*/<>(,])\s*$")
"""A sign at the end of a text, after which something is missing."""


def syntax_tree(text: str) -> ast.expr:
    """Return the syntax tree that Python's parser makes of a text, in which the grammar is not yet checked.

    Raises:
        ModelError: If Python has no tree of it, or the text is too long or nested too deeply.

    Example:
        syntax_tree("x.pole > pi/2")
    """
    if len(text) > MAX_CHARACTERS:
        raise ModelError(f"an expression has {len(text)} characters; at most {MAX_CHARACTERS} are read.")
    try:
        with warnings.catch_warnings(action="ignore"):  # Python's warnings are about texts refused below
            return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as error:
        if unfinished := _UNFINISHED.search(text):
            raise ModelError(f"{_quoted(text)}: nothing after {unfinished[1]!r}.") from None
        where = f" near column {error.offset}" if error.offset else ""
        words = [word for word in re.findall(r"\w+", text) if keyword.iskeyword(word) and word not in _WORDS]
        if words:
            raise ModelError(f"{_quoted(text)}: {words[0]!r} cannot be a name in an expression.") from None
        raise ModelError(f"{_quoted(text)}: no expression{where}.") from None
    except (ValueError, MemoryError, RecursionError):
        raise ModelError(f"{_quoted(text)}: no expression, or nested too deeply.") from None


def _quoted(text: str) -> str:
    """Return the text of an expression in quotes for an error message, shortened if it is long."""
    return f"expression {text if len(text) <= 80 else f'{text[:77]}...'!r}"


def _joined(operator: str, operands: Sequence[Node]) -> Node:
    """Return an operation on two operands applied to one or more, from the left."""
    return reduce(lambda a, b: Operation(operator, (a, b)), operands)


class _Reader:
    """Converts Python's syntax tree to an expression and refuses everything outside the grammar."""

    def __init__(self, text: str, known: Mapping[str, Number]) -> None:
        self.text = text
        self._known = known
        self._operations = 0

    def node(self, found: ast.expr, depth: int = 0, power: int = 1) -> Node:
        """Return the tree of `found`, at depth `depth`, inside exponents that multiply to `power`."""
        self._count(found, depth)
        match found:
            case ast.Constant(value=bool() | complex() | str() | bytes() | None):
                raise self._refused(found, "no number.")
            case ast.Constant(value=value):
                return self._number(value)
            case ast.Name(id=name):
                return self._named(found, name)
            case ast.Attribute() | ast.Subscript():
                return Variable(self._element(found))
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.node(operand, depth + 1, power)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self._negative(self.node(operand, depth + 1, power))
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
            raise ModelError(f"{_quoted(self.text)}: more than {MAX_OPERATIONS} operations.")
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

    def _negative(self, node: Node) -> Node:
        """Return a tree after a minus; a number becomes the negative number, as by Python's operators."""
        is_number = isinstance(node, Constant) and is_plain(node.value)
        return negated(node) if is_number else Operation("negate", (node,))

    def _number(self, value: Any) -> Node:
        """Return a number that the text contains."""
        return Constant(finite(value, _quoted(self.text)))

    def _named(self, found: ast.expr, name: str) -> Node:
        """Return pi, a variable or the parameter of a name, which must have one meaning."""
        known = self._known.get(name)
        if known is not None and name == PI:
            raise self._refused(found, "this is the number pi, but a parameter has the same name. Rename it.")
        if name == PI:
            return Operation(PI, ())
        return self._variable_or(known, found, name)

    def _known_number(self, known: Number) -> Node:
        """Return the tree of a number that has a name; its operations count as those of the text."""
        if isinstance(known, Expression):
            self._operations += sum(1 for _ in known.operations())
        return node_of(known)

    def _variable_or(self, known: Number | None, found: ast.expr, name: str) -> Node:
        """Return the time or the number of a name."""
        if name in VECTORS:
            hint = "" if known is None else " A parameter in an expression needs another name."
            raise self._refused(found, f"one element is needed, such as {name}.arm.theta1.{hint}")
        if known is not None and name == TIME:
            raise self._refused(found, "this is the time, but a parameter has the same name. Rename it.")
        if known is not None:
            return self._known_number(known)
        if name == TIME:
            return Variable(name)
        hint = f" {did_you_mean(name, self._known)}" if self._known else ""
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
        if isinstance(digits, ast.BinOp):
            one = f"one whole number, at most {MAX_EXPONENT}"
            raise self._refused(found, f"an exponent is written as {one}; for roots there is sqrt.")
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
        part = ast.get_source_segment(self.text.strip(), found) or ""
        where = f" in {_quoted(self.text)}" if part != self.text.strip() else ""
        return ModelError(f"{_quoted(part)}{where}: {why}")


class _NumberReader(_Reader):
    """Reads the expression of a number, where nothing but parameters has a name."""

    def _number(self, value: Any) -> Node:
        return constant(value, _quoted(self.text))

    def _negative(self, node: Node) -> Node:
        return negated(node)

    def _variable_or(self, known: Number | None, found: ast.expr, name: str) -> Node:
        if known is not None:
            return self._known_number(known)
        if name in (TIME, *VECTORS):
            raise self._refused(found, _NO_VARIABLES)
        raise self._refused(found, f"there is no parameter of this name. {did_you_mean(name, self._known)}")

    def _element(self, found: ast.expr) -> str:
        raise self._refused(found, _NO_VARIABLES)


class _SignalReader(_Reader):
    """Reads an expression whose variables are given by their full names."""

    def __init__(self, text: str, known: Mapping[str, Number], variables: Sequence[str]) -> None:
        super().__init__(text, known)
        self._variables = variables

    def _variable_or(self, known: Number | None, found: ast.expr, name: str) -> Node:
        if name in self._variables and known is None:
            return Variable(name)
        if known is not None and name not in self._variables:
            return self._known_number(known)
        if known is not None:
            raise self._refused(found, "a parameter and a variable have this name. Rename the parameter.")
        elements = [one for one in self._variables if one.startswith(f"{name}.")]
        if elements:
            raise self._refused(found, f"one element is needed, such as {elements[0]}.")
        raise self._refused(
            found, f"the name is not known. {did_you_mean(name, (*self._variables, *self._known))}"
        )

    def _element(self, found: ast.expr) -> str:
        match found:
            case ast.Subscript(value=value, slice=ast.Constant(value=str(rest))):
                name = f"{ast.unparse(value)}.{rest}"
            case _:
                name = ast.unparse(found)
        if name not in self._variables:
            group = name.partition(".")[0]
            alike = [one for one in self._variables if one.startswith(f"{group}.")] or self._variables
            raise self._refused(found, f"there is no such variable. {did_you_mean(name, alike)}")
        return name


_NO_VARIABLES = "a number of a model depends on parameters, not on coordinates, speeds or the time."
