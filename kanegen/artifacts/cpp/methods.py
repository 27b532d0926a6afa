"""Generated functions as methods in C++: prototypes and bodies, ready for the template."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.c.declarations import argument_row
from kanegen.c.formats import Formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import BREAK, HINGE, WIDTH, columns, wrap
from kanegen.c.source import Source
from kanegen.c.steps import Rollout
from kanegen.program.ir import PREPARED, Array

_INDENT = 4
"""Columns by which a method is indented in its class."""

_PREPARED = "prepared_.data()"
"""The constants that depend on parameters alone, as the C functions take them."""


@dataclass(frozen=True)
class Method:
    """A generated function as two methods, and a third one for many states.

    Attributes:
        name: Name of the function.
        doc: One sentence on it.
        arguments: Lines on its arguments.
        prototype: Lines of the form that fills arrays of the caller.
        call: Lines of its body.
        results: Lines of the members of its structure of results, [] for a single result.
        returned: What the other form returns, in a sentence.
        value_prototype: Lines of the form that returns its results.
        value_body: Lines of its body.
        batch_prototype: Lines of the form for many states, [] without one.
        batch_body: Lines of its body.
    """

    name: str
    doc: str
    arguments: list[str]
    prototype: list[str]
    call: list[str]
    results: list[str]
    returned: str
    value_prototype: list[str]
    value_body: list[str]
    batch_prototype: list[str]
    batch_body: list[str]

    @classmethod
    def of(cls, function: Function, source: Source, kinds: Formats) -> Method:
        """Return the methods of a function of a source."""
        inputs = [array for array in function.inputs if array.name != PREPARED]
        outputs = list(function.outputs)
        taken = [_input(array, kinds) for array in inputs]
        filled = [_output(array, kinds) for array in outputs]
        rows = [argument_row("[in]", array) for array in inputs]
        rows += [argument_row("[out]", array) for array in outputs]
        symbol = f"::{source.model.name}_{function.name}"
        has_parameters = len(inputs) < len(function.inputs)
        fixed = [_PREPARED] if has_parameters else []
        passed = [*fixed, *(_address(array) for array in (*inputs, *outputs))]
        result = f"{function.name}_results" if len(outputs) > 1 else _held(outputs[0], kinds)
        batch = Batch(function, source.model.name, kinds) if function.has_batch else None
        return cls(
            name=function.name,
            doc=function.doc,
            arguments=columns(rows, width=WIDTH - _INDENT - len(" * ")),
            prototype=_prototype("status", function.name, [*taken, *filled]),
            call=_statement(f"return status({symbol}({f',{BREAK}'.join(passed)}));"),
            results=[f"{_held(a, kinds)} {a.name};" for a in outputs] if len(outputs) > 1 else [],
            returned=", ".join(array.name for array in outputs),
            value_prototype=_prototype(f"[[nodiscard]] {result}", function.name, taken),
            value_body=_value_body(function.name, inputs, outputs, result),
            batch_prototype=batch.prototype if batch else [],
            batch_body=batch.body if batch else [],
        )


@dataclass(frozen=True)
class Batch:
    """The form of a function for many states."""

    function: Function
    model: str
    kinds: Formats

    @property
    def own(self) -> list[Array]:
        """The inputs of which each state has a row."""
        return [array for array in self.function.inputs if array.name not in self.function.shared]

    @property
    def prototype(self) -> list[str]:
        """The lines of the prototype."""
        kinds = self.kinds
        arguments = [f"rows<const {kinds.of(a.name).c_type}, {a.size}> {a.name}" for a in self.own]
        arguments += [f"rows<{kinds.of(a.name).c_type}, {a.size}> {a.name}" for a in self.function.outputs]
        is_static = self.function.name == PREPARE  # which reads nothing of the object
        kind = "[[nodiscard]] static ::std::size_t" if is_static else "[[nodiscard]] ::std::size_t"
        return _prototype(kind, f"{self.function.name}_batch", arguments, "" if is_static else " const")

    @property
    def body(self) -> list[str]:
        """The lines of the body."""
        arrays = [*self.own, *self.function.outputs]
        counts = [f"{array.name}.count()" for array in arrays]
        different = f" ||{BREAK}".join(f"{count} != {counts[0]}" for count in counts[1:])
        passed = [
            _PREPARED if a.name in self.function.shared else f"{a.name}.data()" for a in self.function.inputs
        ]
        passed += [f"{array.name}.data()" for array in self.function.outputs]
        arguments = f",{BREAK}".join([counts[0], *passed])
        call = f"return ::{self.model}_{self.function.name}_batch({arguments});"
        refused = _refusal(different, f"{self.function.name}_batch: arrays have different numbers of rows")
        return [*refused, *_statement(call)]


def _input(array: Array, kinds: Formats) -> str:
    """Return the declaration of an argument that is read; a scalar is taken by its value."""
    kind = kinds.of(array.name).c_type
    return f"{_view(f'const {kind}', array)} {array.name}" if array.shape else f"{kind} {array.name}"


def _output(array: Array, kinds: Formats) -> str:
    """Return the declaration of an argument that is filled."""
    kind = kinds.of(array.name).c_type
    return f"{_view(kind, array)} {array.name}" if array.shape else f"{kind} &{array.name}"


def _view(kind: str, array: Array) -> str:
    """Return the type of a view of an array; the columns are the elements of its last axis."""
    if len(array.shape) == 1:
        return f"view<{kind}, {array.size}>"
    return f"view<{kind}, {array.size // array.row}, {array.row}>"


def _held(array: Array, kinds: Formats) -> str:
    """Return the type that holds a result."""
    kind = kinds.of(array.name).c_type
    return f"::std::array<{kind}, {array.size}>" if array.shape else kind


def _address(array: Array) -> str:
    return f"{array.name}.data()" if array.shape else f"&{array.name}"


def _prototype(kind: str, name: str, arguments: Sequence[str], ends: str = " const") -> list[str]:
    text = f"{kind} {name}({f',{BREAK}'.join(arguments)}){ends}"
    return [line[_INDENT:] for line in wrap(text, indent=" " * _INDENT, hanging=" " * 2 * _INDENT)]


def _statement(text: str) -> list[str]:
    indent = 2 * _INDENT
    return [line[indent:] for line in wrap(text, indent=" " * indent, hanging=" " * (indent + _INDENT))]


def _value_body(name: str, inputs: Sequence[Array], outputs: Sequence[Array], result: str) -> list[str]:
    """Return the lines of the form that returns its results."""
    filled = ["result"] if len(outputs) == 1 else [f"result.{array.name}" for array in outputs]
    arguments = f",{BREAK}".join([*(array.name for array in inputs), *filled])
    return [
        f"{result} result;",
        *_statement(f"const status found = {name}({arguments});"),
        "if (!found.ok()) {",
        f'    throw error("{name}", found);',
        "}",
        "return result;",
    ]


def _refusal(condition: str, message: str) -> list[str]:
    """Return the lines of a check that throws with a message where a condition holds."""
    thrown = wrap(
        f'::kanegen_views::refuse({HINGE}"{message}.");', indent=" " * 3 * _INDENT, hanging=" " * 4 * _INDENT
    )
    return [*_statement(f"if ({condition}) {{"), *(line[2 * _INDENT :] for line in thrown), "}"]


@dataclass(frozen=True)
class RolloutMethod:
    """A generated function of many steps as a method.

    Attributes:
        name: Name of the function.
        doc: One sentence on it.
        prototype: Lines of its prototype.
        body: Lines of its body.
    """

    name: str
    doc: str
    prototype: list[str]
    body: list[str]

    @classmethod
    def of(cls, rollout: Rollout, source: Source, kinds: Formats) -> RolloutMethod:
        """Return the method of a function of a source."""
        number = kinds.storage.c_type
        inputs = [array for array in rollout.inputs if array.name != PREPARED]
        sizes = {array.name: array.size for array in inputs}
        taken = [
            f"rows<const {number}, {array.size}> {array.name}"
            if array in rollout.held
            else _input(array, kinds)
            for array in inputs
        ]
        taken += [f"{number} step", "::std::size_t steps", "::std::size_t every", "bool compensated"]
        taken += [f"rows<{number}, {sizes[name]}> {name}_path" for name in "xy"]
        taken += ["::std::size_t &made"]
        passed = [_PREPARED] * (len(inputs) < len(rollout.inputs))
        for array in inputs:
            passed += [
                f"{array.name}.data(), {array.name}.count()" if array in rollout.held else _address(array)
            ]
        passed += [
            "&step",
            "steps",
            "every",
            "compensated ? 1 : 0",
            "x_path.data()",
            "y_path.data()",
            "&made",
        ]
        call = f"return status(::{source.model.name}_{rollout.name}({f',{BREAK}'.join(passed)}));"
        kept = (
            f"every == 0 ||{BREAK}x_path.count() != steps/every + 1 ||{BREAK}y_path.count() != x_path.count()"
        )
        body = _refusal(kept, f"{rollout.name}: x_path and y_path need steps/every + 1 rows")
        for array in rollout.held:
            body += _refusal(
                _wrong_rows(array.name), f"{rollout.name}: {array.name} has a wrong number of rows"
            )
        return cls(
            rollout.name,
            rollout.doc,
            _prototype("status", rollout.name, taken),
            [*body, *_statement(call)],
        )


def _wrong_rows(name: str) -> str:
    """Return the condition that an input which is held over steps has a number of rows without a meaning."""
    allowed = ("1", "steps", "steps + 1", "2*steps + 1")
    return f" &&{BREAK}".join([f"{name}.count() > 0", *(f"{name}.count() != {one}" for one in allowed)])
