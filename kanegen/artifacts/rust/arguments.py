"""Arguments of generated functions in Rust: what a user passes, and the pointer that the C function takes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from kanegen.artifacts.rust.names import identifier
from kanegen.c.formats import Formats
from kanegen.c.interface import Function
from kanegen.c.steps import LENGTH, Rollout
from kanegen.program.ir import PARAMETERS, PREPARED, Array
from kanegen.program.precision import DOUBLE_DOUBLE

SCALARS = {"double": "f64", "float": "f32"}
"""Types of numbers in Rust by type in C."""

PAIR = "[f64; 2]"
"""Type of a prepared constant that is a sum of two doubles, a struct in C."""

_ROWS = {PARAMETERS: "Parameters", PREPARED: "Prepared"}
"""Types of rows that have names of their own."""


@dataclass(frozen=True)
class Argument:
    """An argument of a method, and what it passes to the C function.

    Attributes:
        name: Its identifier.
        declared: Name and type in the method; "" for what the method takes from the model.
        passed: Expressions that the C function gets.
        foreign: Name and type of these, as the declaration of the C function has them.
        doc: What the argument is, "" if the documentation does not repeat it.
        rows: Kind of the check of the number of its rows: "" for none, "count", "held" or "path".
        label: Its name in C.
    """

    name: str
    declared: str
    passed: tuple[str, ...]
    foreign: tuple[str, ...]
    doc: str = ""
    rows: str = ""
    label: str = ""


@dataclass(frozen=True)
class Types:
    """Types of arrays in Rust.

    Attributes:
        formats: The precisions of the arrays.
    """

    formats: Formats

    def number(self, array: Array) -> str:
        """Return the type of the elements of an array."""
        precision = self.formats.of(array.name)
        return PAIR if precision is DOUBLE_DOUBLE else SCALARS[precision.c_type]

    def of(self, array: Array) -> str:
        """Return the type of an array: a number, or nested arrays whose memory is row-major."""
        return _nested(self.number(array), array.shape)

    def zeros(self, array: Array) -> str:
        """Return the expression of an array of zeros."""
        return _nested("0.0", array.shape)

    def one(self, array: Array, is_output: bool = False) -> Argument:
        """Return the argument of an array for one state."""
        name = identifier(array.name)
        if array.name == PREPARED and not is_output:
            return self._prepared(array)
        borrowed = "&mut " if is_output else "&" if array.shape else ""
        if array.shape:
            passed = f"{name}.{_pointer(is_output)}{'.cast()' if len(array.shape) > 1 else ''}"
        else:
            passed = name if is_output else f"&{name}"
        return Argument(
            name,
            f"{name}: {borrowed}{self.of(array)}",
            (passed,),
            (self._foreign(array, is_output),),
            f"{array.doc} ({array.unit})",
            label=array.name,
        )

    def rows(self, array: Array, is_output: bool = False) -> Argument:
        """Return the argument of an array with a row for each of many states."""
        name, row = identifier(array.name), _ROWS.get(array.name, self.of(array))
        is_nested = array.shape and not (array.name == PREPARED and len(array.shape) == 0)
        return Argument(
            name,
            f"{name}: &{'mut ' * is_output}[{row}]",
            (f"{name}.{_pointer(is_output)}{'.cast()' if is_nested else ''}",),
            (self._foreign(array, is_output),),
            f"{array.doc} ({array.unit})",
            rows="count",
            label=array.name,
        )

    def held(self, array: Array, each: bool) -> Argument:
        """Return the argument of an input that a rollout holds over steps, for one state or for each."""
        found = replace(self.rows(array), rows="held")
        count = f"{found.name}_rows" if each else f"{found.name}.len()"
        foreign = (*found.foreign, f"{found.name}_rows: usize")
        return replace(found, passed=(*found.passed, count), foreign=foreign)

    def _prepared(self, array: Array) -> Argument:
        """Return the prepared constants of the model."""
        return Argument(PREPARED, "", ("self.prepared.as_ptr()",), (self._foreign(array, False),))

    def _foreign(self, array: Array, is_output: bool) -> str:
        kind = "mut" if is_output else "const"
        return f"{identifier(array.name)}: *{kind} {self.number(array)}"


def _nested(kind: str, shape: tuple[int, ...]) -> str:
    for length in reversed(shape):
        kind = f"[{kind}; {length}]"
    return kind


def _pointer(is_output: bool) -> str:
    return "as_mut_ptr()" if is_output else "as_ptr()"


def of_state(function: Function, types: Types) -> list[Argument]:
    """Return the arguments of the form of a function for one state."""
    return [
        *(types.one(array) for array in function.inputs),
        *(types.one(array, is_output=True) for array in function.outputs),
    ]


def of_batch(function: Function, types: Types) -> list[Argument]:
    """Return the arguments of the form of a function for many states, behind their number."""
    return [
        *(
            types.one(array) if array.name in function.shared else types.rows(array)
            for array in function.inputs
        ),
        *(types.rows(array, is_output=True) for array in function.outputs),
    ]


def _value(name: str, kind: str, doc: str, passed: str = "", foreign: str = "") -> Argument:
    """Return an argument that is passed by value."""
    return Argument(name, f"{name}: {kind}", (passed or name,), (f"{name}: {foreign or kind}",), doc)


def of_rollout(rollout: Rollout, types: Types, each: bool) -> list[Argument]:
    """Return the arguments of a function that makes many steps.

    Args:
        rollout: The function.
        types: Types of arrays.
        each: Whether they are for many states, behind their number.
    """
    return [*_followed(rollout, types, each), *_paths(rollout, types, each)]


def _followed(rollout: Rollout, types: Types, each: bool) -> Iterator[Argument]:
    """Yield the inputs of a function that makes many steps."""
    for array in rollout.inputs:
        if array in rollout.held:
            yield types.held(array, each)
        elif array.name in rollout.step.shared or not each:
            yield types.one(array)
        else:
            yield types.rows(array)
    yield types.one(LENGTH)
    yield _value("steps", "usize", "number of steps")
    yield _value("every", "usize", "number of steps, from 1, from one stored state to the next")
    yield _value(
        "compensated",
        "bool",
        "whether to add later what rounding takes from sums (Kahan)",
        "c_int::from(compensated)",
        "c_int",
    )


def _paths(rollout: Rollout, types: Types, each: bool) -> Iterator[Argument]:
    """Yield the results of a function that makes many steps."""
    for array in rollout.inputs:
        if array.name in ("x", "y"):
            path = replace(array, name=f"{array.name}_path", doc=f"{{{array.name}}} of the stored states")
            yield replace(types.rows(path, is_output=True), rows="path")
    doc = "number of steps before that of the status, all of them without one"
    if each:
        kind, passed, rows = "&mut [usize]", "made.as_mut_ptr()", "count"
    else:
        kind, passed, rows = "&mut usize", "made", ""
    yield Argument("made", f"made: {kind}", (passed,), ("made: *mut usize",), doc, rows, "made")
