"""Run-time parameters, and expressions of numbers, parameters and the state of a system.

An expression of numbers and parameters alone is a number of a model, as `numbers.number` checks it. Others
stand in force elements. `grammar` parses them, and Python's operators make them of parameters. The derivation
differentiates and lowers them through SymPy; the reference evaluates them in NumPy, independently.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

from kanegen.errors import ModelError, quoted
from kanegen.model import evaluation
from kanegen.model.arithmetic import Arithmetic
from kanegen.model.expression_text import text_of
from kanegen.model.finite import finite, is_plain
from kanegen.model.names import check_identifier
from kanegen.model.nodes import (
    PI,
    Constant,
    Leaf,
    Node,
    Operation,
    Power,
    Step,
    Variable,
    check_size,
    folded,
    leaves,
    mapped,
    postfix,
    rebuilt,
)
from kanegen.model.sympy_numbers import from_sympy, in_sympy, is_sympy, to_sympy

_UNDEFINED_SOMEWHERE = frozenset(("/", "sqrt", "tan", "log", "exp", "atan2"))
"""Operators and functions that have no finite value, or no finite slope, for some finite operands."""

NO_DEFAULT = math.nan
"""Value of a parameter that has no default value yet."""

_EXACT_INTEGER = 2**53
"""Size up to which every integer is a double."""


class _Operand(Arithmetic["Expression"]):
    """A parameter or an expression: operators make expressions of it."""

    @property
    @abstractmethod
    def node(self) -> Node:
        """The tree of the number."""

    def combined(self, operator: str, *operands: object) -> Expression:
        """Return an operation, one of `nodes.Operation`, on numbers.

        Numbers of SymPy are taken exactly; with another expression of SymPy the result is one of SymPy, in
        which parameters are real symbols. Returns `NotImplemented` where an operand is no number, so that
        Python asks the other operand.

        Raises:
            ModelError: If a number is not finite, or the expression becomes too long.
        """
        if any(is_sympy(operand) and operand.free_symbols for operand in operands):  # type: ignore[attr-defined]
            symbols = [_node(operand) if isinstance(operand, _Operand) else operand for operand in operands]
            return in_sympy(operator, symbols)  # type: ignore[no-any-return]
        nodes = [_node(operand) for operand in operands]
        known = tuple(node for node in nodes if node is not None)
        if len(known) < len(nodes):
            return NotImplemented  # type: ignore[no-any-return]  # as Python's own operators do
        return Expression(check_size(_simplified(Operation(operator, known))))

    def _sympy_(self) -> Any:
        """Return the number as an expression of SymPy, parameters as real symbols of the same names."""
        return to_sympy(self.node)

    _op_priority = 20.0  # so that a number of SymPy leaves its operators to this class

    def __pow__(self, exponent: Any) -> Expression:
        if not is_plain(exponent) or exponent % 1 != 0:
            raise ModelError(f"exponent {quoted(exponent)} is no whole number; for roots there is sqrt.")
        return Expression(check_size(Power(self.node, int(exponent))))

    def __rpow__(self, base: object) -> Expression:
        raise ModelError(
            f"exponent {quoted(text_of(self.node))} is no whole number; b**a is written as exp(a*log(b))."
        )

    def _compared(self, other: object) -> bool:
        """Refuse a comparison, whose result is not known before run time."""
        raise ModelError(
            f"{quoted(text_of(self.node))} cannot be compared before run time. Write max, min and conditions "
            "as a text, such as kg.parse('max(m, l)', [m, l])."
        )

    __lt__ = __le__ = __gt__ = __ge__ = _compared


@dataclass(frozen=True)
class Parameter(_Operand):
    """A number of a model that gets its value at run time.

    With Python's operators and with functions of NumPy such as `numpy.cos`, parameters make expressions,
    which may stand wherever a number may. What depends on parameters alone is computed once, when they are
    set.

    Attributes:
        name: A C identifier, unique within a system.
        value: Default value, in the unit of the quantity that the parameter replaces. Without one, the system
            gives it: by `defaults`, or by a parameter of the same name.

    Raises:
        ModelError: If the name is no C identifier or that of the number pi, or the value is not finite.

    Example:
        m, l = kg.Parameter("m", 1.5), kg.Parameter("l", 0.4)  # kg, m
        rod = kg.Body("rod", 0, m, np.diag([m * l**2 / 12, m * l**2 / 12, 0]), (0, 0, -l / 2))
    """

    name: str
    value: float = NO_DEFAULT

    def __post_init__(self) -> None:
        check_identifier(self.name, "parameter name")
        if self.name == PI:
            raise ModelError(f"parameter name {quoted(self.name)}: this is the number pi. Rename it.")
        if self.value is not NO_DEFAULT:
            object.__setattr__(self, "value", finite(self.value, f"parameter {quoted(self.name)}"))

    @property
    def is_open(self) -> bool:
        """Whether the parameter has no default value, so that a system must give one."""
        return math.isnan(self.value)

    @property
    def node(self) -> Node:
        """The tree of the number: one leaf."""
        return Constant(self)


@dataclass(frozen=True)
class Expression(_Operand):
    """A number that depends on the state, the time and parameters.

    Example:
        kg.parse("k*x.slider.s1 - 2*y.slider.s1", [kg.Parameter("k", 40.0)])
    """

    root: Node

    @property
    def node(self) -> Node:
        """The tree of the number."""
        return self.root

    def __str__(self) -> str:
        """Return the text of the expression as `grammar.parse` reads it, parameters by their names."""
        return text_of(self.root)

    def __repr__(self) -> str:
        """The text of the expression, with the function that reads it."""
        return f"parse({str(self)!r})"

    def __deepcopy__(self, memo: object) -> Expression:
        """Return the expression itself, which never changes."""
        return self

    def __reduce__(self) -> tuple[Callable[[tuple[Step, ...]], Expression], tuple[tuple[Step, ...]]]:
        """Return the tree as a list, because pickle takes trees of limited depth only."""
        return _restored, (postfix(self.root),)

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables, each once, in the order of first use."""
        return tuple(dict.fromkeys(leaf.name for leaf in leaves(self.root) if isinstance(leaf, Variable)))

    @classmethod
    def of(cls, number: Any) -> Expression:
        """Return a number as an expression; also a fraction, or an expression of SymPy.

        Raises:
            ModelError: If `number` is none of these, or SymPy's expression has no counterpart.

        Example:
            kg.Expression.of(Fraction(1, 12))  # 1 / 12
        """
        root = _node(number)
        if root is None:
            raise ModelError(f"{quoted(number)} is no number.")
        return cls(root)

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The parameters, each once, in the order of first use."""
        return tuple(dict.fromkeys(value for value in self.numbers() if isinstance(value, Parameter)))

    @cached_property
    def exact(self) -> evaluation.Exact:
        """The value, parameters at their defaults: a fraction, or a number of 320 bits.

        Raises:
            ModelError: If it depends on variables, divides by zero, or has no finite value.
        """
        return evaluation.exact_value(self.root)

    @cached_property
    def value(self) -> float:
        """The value rounded once, parameters at their defaults; NaN if one has none. Errors as of `exact`."""
        return NO_DEFAULT if self.is_open else float(self.exact)

    @property
    def is_open(self) -> bool:
        """Whether a parameter of the expression has no default value."""
        return any(one.is_open for one in self.parameters)

    @cached_property
    def loss(self) -> float:
        """The relative error of the value if it is computed in doubles, parameters at their defaults."""
        return evaluation.relative_loss(self.root, self.exact)

    @property
    def simplest(self) -> float | Parameter | Expression:
        """The number that the expression is: a double where it is exactly one, a parameter alone, or itself.

        Example:
            kg.parse("2*0.5").simplest  # 1.0
        """
        if isinstance(self.root, Constant):
            return self.root.value if isinstance(self.root.value, Parameter) else float(self.root.value)
        if not depends(self.root) and evaluation.is_double(self.exact):
            return self.value + 0.0
        return self

    def numbers(self) -> Iterator[float | Parameter]:
        """Return the numbers of the expression, from the left.

        Example:
            list(kg.parse("2*x.slider.s1 + 3").numbers())  # [2.0, 3.0]
        """
        values = (leaf.value for leaf in leaves(self.root) if isinstance(leaf, Constant))
        return (value if isinstance(value, Parameter) else float(value) for value in values)

    def operations(self) -> Iterator[Operation]:
        """Return the operations of the expression, operands before the operations on them.

        Example:
            [one.operator for one in kg.parse("2*x.slider.s1 + 3").operations()]  # ["*", "+"]
        """
        found: list[Operation] = []

        def operation(node: Operation | Power, operands: list[None]) -> None:
            if isinstance(node, Operation):
                found.append(node)

        folded(self.root, lambda node: None, operation)
        return iter(found)

    @property
    def may_be_undefined(self) -> bool:
        """Whether the expression, or its slope, is undefined or infinite for some finite variables."""
        steps = postfix(self.root)
        for last, step in pairwise((None, *steps)):
            if isinstance(step, int) and step < 0:
                return True
            if isinstance(step, tuple) and step[0] in _UNDEFINED_SOMEWHERE:
                is_number = isinstance(last, Constant) and last.value != 0 and is_plain(last.value)
                if step[0] != "/" or not is_number:
                    return True
        return False

    def map_numbers(self, change: Callable[[float | Parameter], Any]) -> Expression:
        """Return the same expression with `change` applied to every number.

        Example:
            plain = expression.map_numbers(value_of)  # parameters at their defaults
        """

        def leaf(found: Leaf) -> Node:
            return node_of(change(found.value)) if isinstance(found, Constant) else found

        return Expression(mapped(self.root, leaf))

    def with_variables_renamed(self, rename: Callable[[str], str]) -> Expression:
        """Return the same expression with `rename` applied to the names of its variables.

        Example:
            kg.parse("x.arm.theta3").with_variables_renamed(lambda name: "x.elbow.theta3")
        """

        def leaf(found: Leaf) -> Node:
            return Variable(rename(found.name)) if isinstance(found, Variable) else found

        return Expression(mapped(self.root, leaf))

    def with_constants(self, values: Mapping[str, float | Parameter | Expression]) -> Expression:
        """Return the same expression with numbers in place of some variables.

        Example:
            kg.parse("2*x.arm.s1").with_constants({"x.arm.s1": 0.5})  # 2.0*0.5
        """

        def leaf(found: Leaf) -> Node:
            if isinstance(found, Variable) and found.name in values:
                return node_of(values[found.name])
            return found

        return Expression(mapped(self.root, leaf))


def node_of(number: float | Parameter | Expression) -> Node:
    """Return a number as a tree."""
    return number.node if isinstance(number, _Operand) else Constant(number)


def depends(root: Node) -> bool:
    """Return whether a tree contains a parameter or a variable."""
    return any(isinstance(leaf, Variable) or isinstance(leaf.value, Parameter) for leaf in leaves(root))


def _restored(steps: tuple[Step, ...]) -> Expression:
    """Return the expression whose tree `nodes.postfix` made a list of."""
    return Expression(rebuilt(steps))


def _node(operand: object) -> Node | None:
    """Return an operand of Python's operators as a tree; None if it is no number."""
    match operand:
        case _Operand():
            return operand.node
        case Fraction():
            return _quotient(operand)
        case _ if is_sympy(operand):
            return from_sympy(operand, lambda name: Constant(Parameter(name)))
    return constant(operand) if is_plain(operand) else None


def _quotient(fraction: Fraction) -> Node:
    """Return a fraction as a tree.

    Raises:
        ModelError: If its numerator or denominator is no double.
    """
    parts = fraction.numerator, fraction.denominator
    if evaluation.is_double(fraction):
        return constant(float(fraction))
    if not all(evaluation.is_double(Fraction(part)) for part in parts):
        raise ModelError(f"{quoted(fraction)}: its parts have more digits than a double. Pass a float.")
    return Operation("/", (constant(parts[0]), constant(parts[1])))


def constant(value: Any, label: str = "a number in an expression") -> Constant:
    """Return a number as a leaf; an integer that a double holds stays one, so that texts show it as one.

    Raises:
        ModelError: If `value` is no finite number; the message calls it `label`.
    """
    known = finite(value, label)
    return Constant(int(known) if known.is_integer() and abs(known) <= _EXACT_INTEGER else known)


def _simplified(operation: Operation) -> Node:
    """Return an operation, or what it equals where an operand is 0, 1 or -1, as in products of matrices."""
    operator, operands = operation.operator, operation.operands
    if operator == "negate":
        return negated(operands[0])
    if operator not in ("+", "-", "*", "/"):
        return operation
    first, second = operands
    neutral = Constant(0) if operator in ("+", "-") else Constant(1)
    if second == neutral:
        return first
    if first == neutral and operator in ("+", "*"):
        return second
    if operator == "*" and Constant(0) in operands:
        return Constant(0)
    if operator == "*" and Constant(-1) in operands:
        return negated(second if first == Constant(-1) else first)
    return operation


def negated(node: Node) -> Node:
    """Return a tree with the other sign."""
    match node:
        case Operation("negate", (operand,)):
            return operand
        case Constant(int() | float() as value):
            return Constant(0 - value)  # no negative zero
    return Operation("negate", (node,))
