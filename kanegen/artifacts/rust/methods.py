"""Methods of a model in Rust as text: documentation, signatures, checks, and calls of the C functions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from kanegen.artifacts.rust.arguments import Argument, Types, of_batch, of_rollout, of_state
from kanegen.artifacts.rust.names import WIDTH, camel_case, doc, identifier, listed, plain, sentence
from kanegen.c.interface import PREPARE, Function
from kanegen.c.steps import Rollout
from kanegen.program.ir import PREPARED

_IN, _BODY = " " * 4, " " * 8

_SAFETY = {
    "one": "every array has the length that C needs, and results are borrowed mutably.",
    "count": "as above, and every array has `count` rows.",
    "steps": "as above, and every array has the rows that the steps need.",
}
"""Reasons why calls of C functions are sound."""


@dataclass(frozen=True)
class Method:
    """A method of `Model`, or a function beside it.

    Attributes:
        name: Its name.
        doc: Lines of its documentation.
        signature: Lines up to the opening brace.
        body: Lines between the braces.
    """

    name: str
    doc: tuple[str, ...]
    signature: tuple[str, ...]
    body: tuple[str, ...]


@dataclass(frozen=True)
class Outputs:
    """The struct of the results of a function that has several.

    Attributes:
        name: Its name.
        function: Name of the function.
        fields: Name, type, zeros and documentation of each result.
    """

    name: str
    function: str
    fields: tuple[tuple[str, str, str, tuple[str, ...]], ...]


def outputs_of(function: Function, types: Types) -> Outputs | None:
    """Return the struct of the results of a function, None where it has one result only."""
    if len(function.outputs) == 1:
        return None
    fields = [
        (
            identifier(one.name),
            types.of(one),
            types.zeros(one),
            tuple(sentence(f"{one.doc} ({one.unit}).", _IN)),
        )
        for one in function.outputs
    ]
    return Outputs(f"{camel_case(function.name)}Outputs", function.name, tuple(fields))


def methods_of(model: str, function: Function, types: Types) -> list[Method]:
    """Return the methods for one state and for many of a function that is not `prepare`.

    Args:
        model: Name of the model.
        function: The function.
        types: Types of arrays.
    """
    single = [_returning(function, types), _filling(model, function, types)]
    return [*single, *([batch(model, function, types)] if function.has_batch else [])]


def _returning(function: Function, types: Types) -> Method:
    """Return the method that returns the results for one state."""
    inputs = [one for one in of_state(function, types)[: len(function.inputs)] if one.declared]
    name, struct, (first, *_) = identifier(function.name), outputs_of(function, types), function.outputs
    kind, zero, result = (
        (struct.name, f"{struct.name}::ZERO", "outputs")
        if struct
        else (types.of(first), types.zeros(first), identifier(first.name))
    )
    unit = doc(f"The result is in {first.unit}.", _IN) if struct is None else []
    call = listed(f"self.{name}_into(", [*(one.name for one in inputs), f"&mut {result}"], ")?;", _BODY, 60)
    return Method(
        name,
        _paragraphs(sentence(function.doc, _IN), _listed(inputs), unit, _errors(_statuses(function))),
        _signature(name, inputs, kind, "Status"),
        (f"{_BODY}let mut {result} = {zero};", *call, f"{_BODY}Ok({result})"),
    )


def _filling(model: str, function: Function, types: Types) -> Method:
    """Return the method that fills the caller's arrays with the results for one state."""
    arguments, name = of_state(function, types), identifier(function.name)
    inputs, results = arguments[: len(function.inputs)], arguments[len(function.inputs) :]
    struct = outputs_of(function, types)
    declared = [one.declared for one in (*inputs, *(() if struct else results)) if one.declared]
    passed = [text for one in inputs for text in one.passed]
    if struct:
        declared.append(f"outputs: &mut {struct.name}")
    for array, one in zip(function.outputs, results, strict=True):
        (text,) = one.passed
        passed.append(f"{'&mut ' * (not array.shape)}outputs.{text}" if struct else text)
    about = f"[`{name}`](Self::{name}) into memory of the caller, which is filled where it is an error, too."
    return Method(
        f"{name}_into",
        _paragraphs([f"{_IN}/// {about}"], _errors(f"As [`{name}`](Self::{name}).")),
        tuple(listed(f"pub fn {name}_into(", ["&self", *declared], ") -> Result<(), Status> {", _IN)),
        (
            *_call("code", f"{model}_{function.name}", passed, "one"),
            f'{_BODY}Status::check("{function.name}", code)',
        ),
    )


def batch(model: str, function: Function, types: Types) -> Method:
    """Return the method of a function for many states."""
    arguments, name = of_batch(function, types), identifier(function.name)
    is_of_model = not any(one.name == PREPARED and one.declared for one in arguments)
    first = next(one for one in arguments if one.rows)
    rows = [one for one in arguments if one.rows and one is not first]
    about = "Prepared constants" if function.name == PREPARE else f"[`{name}`](Self::{name})"
    errors = (
        f"[`Error::Rows`] where an array has another number of rows than `{first.name}`; [`Error::States`] "
        "where states have a status other than 0, but all rows are filled."
    )
    return Method(
        f"{name}_batch",
        _paragraphs([f"{_IN}/// {about} for many states; each has a row of every array."], _errors(errors)),
        _signature(f"{name}_batch", arguments, "()", "Error", is_of_model),
        (
            f"{_BODY}let count = {first.name}.len();",
            *_checks(rows, "require_rows", "count"),
            *_call("failed", f"{model}_{function.name}_batch", ["count", *_passed(arguments)], "count"),
            f'{_BODY}Error::check("{function.name}", failed, count)',
        ),
    )


_HELD = (
    "`steps / every + 1` states are stored, the start first. An input has no rows where it is zero, one "
    "where it is constant, `steps` where it is constant over each step, `steps + 1` where it follows "
    "straight lines between the ends of the steps, or `2 * steps + 1`: its values at "
    "the start, the middle and the end of each step."
)
"""What the rows of an input of a rollout mean."""


def rollout(model: str, function: Rollout, types: Types) -> Method:
    """Return the method that makes many steps from one state."""
    arguments, name = of_rollout(function, types, each=False), identifier(function.name)
    errors = (
        "[`Error::Rows`] and [`Error::Every`] where an argument does not fit; [`Error::Status`] with the "
        "status of the first step after which the state is missing, not finite or not accurate."
    )
    return Method(
        name,
        _paragraphs(
            sentence(function.doc, _IN),
            [f"{_IN}/// {line}" for line in plain(_HELD)],
            _listed(arguments),
            _errors(errors),
        ),
        _signature(name, arguments, "()", "Error"),
        (
            f"{_BODY}let kept = kept(steps, every)?;",
            *_checks(_of(arguments, "held"), "require_held", "steps"),
            *_checks(_of(arguments, "path"), "require_rows", "kept"),
            *_call("code", f"{model}_{function.name}", _passed(arguments), "steps"),
            f'{_BODY}Ok(Status::check("{function.name}", code)?)',
        ),
    )


def rollout_batch(model: str, function: Rollout, types: Types) -> Method:
    """Return the method that makes many steps from many states."""
    arguments, name = of_rollout(function, types, each=True), identifier(function.name)
    counted = [one for one in _of(arguments, "count") if one.name != "x"]
    is_of_model = not any(one.name == PREPARED and one.declared for one in arguments)
    errors = f"As [`{name}`](Self::{name}), but [`Error::States`] for statuses."
    about = (
        f"[`{name}`](Self::{name}) for many states: the rows of the first state, then those of the second, "
        "and so on."
    )
    return Method(
        f"{name}_batch",
        _paragraphs([f"{_IN}/// {line}" for line in plain(about)], _errors(errors)),
        _signature(f"{name}_batch", arguments, "()", "Error", is_of_model),
        (
            f"{_BODY}let count = x.len();",
            f"{_BODY}let kept = kept(steps, every)?.saturating_mul(count);",
            *_checks(counted, "require_rows", "count"),
            *(
                f'{_BODY}let {one.name}_rows = held_rows("{one.label}", {one.name}.len(), steps, count)?;'
                for one in _of(arguments, "held")
            ),
            *_checks(_of(arguments, "path"), "require_rows", "kept"),
            *_call("failed", f"{model}_{function.name}_batch", ["count", *_passed(arguments)], "steps"),
            f'{_BODY}Error::check("{function.name}", failed, count)',
        ),
    )


def _checks(arguments: Iterable[Argument], check: str, rows: str) -> list[str]:
    """Return the statements that check the number of rows of arguments."""
    return [
        line
        for one in arguments
        for line in listed(f"{check}(", [f'"{one.label}"', f"{one.name}.len()", rows], ")?;", _BODY, 60)
    ]


def _of(arguments: Iterable[Argument], rows: str) -> list[Argument]:
    return [one for one in arguments if one.rows == rows]


def _passed(arguments: Iterable[Argument]) -> list[str]:
    return [text for one in arguments for text in one.passed]


def _signature(
    name: str, arguments: Iterable[Argument], result: str, error: str, is_of_model: bool = True
) -> tuple[str, ...]:
    """Return the lines of a function up to its opening brace."""
    declared = [*["&self"] * is_of_model, *(one.declared for one in arguments if one.declared)]
    return tuple(listed(f"pub fn {name}(", declared, f") -> Result<{result}, {error}> {{", _IN))


def _call(result: str, function: str, arguments: list[str], safety: str) -> list[str]:
    """Return the statement that calls a C function, and why it is sound."""
    reason = f"{_BODY}// SAFETY: {_SAFETY[safety]}"
    call = f"unsafe {{ sys::{function}({', '.join(arguments)}) }};"
    if len(", ".join(arguments)) <= 60:
        if len(line := f"{_BODY}let {result} = {call}") <= WIDTH:
            return [reason, line]
        if len(line := f"{_BODY}    {call}") <= WIDTH:
            return [reason, f"{_BODY}let {result} =", line]
    chains = [_chain(text, f"{_BODY}{_BODY}    ") for text in arguments]
    inner = listed(f"sys::{function}(", chains, ")", f"{_BODY}    ", 60)
    return [reason, f"{_BODY}let {result} = unsafe {{", *inner, f"{_BODY}}};"]


def _chain(text: str, indent: str) -> str:
    """Return a chain of calls on a line for each, where it is too long for one."""
    return text if len(text) <= 60 else text.replace(".", f"\n{indent}.")


def _listed(arguments: Iterable[Argument]) -> list[str]:
    """Return the list of the documentation of arguments."""
    lines = []
    for one in arguments:
        if one.declared:
            lines += doc(f"{one.doc}.", _IN, bullet=f"- `{one.name}`: ")
    return lines


def _statuses(function: Function) -> str:
    """Return the sentence on the statuses of a function."""
    quantity = function.quantity.replace("[A]", "`[A]`")
    kinds = [f"[`Status::Missing`] where a {quantity} is not positive"] * bool(function.may_fail)
    kinds.append("[`Status::NotFinite`] where a number in a result is infinite or NaN")
    kinds += ["[`Status::Inaccurate`] where most digits are lost"] * bool(function.may_be_inaccurate)
    return f"{', '.join(kinds)}."


def _errors(text: str) -> list[str]:
    return [f"{_IN}/// # Errors", f"{_IN}///", *(f"{_IN}/// {line}" for line in plain(text))]


def _paragraphs(*paragraphs: Sequence[str]) -> tuple[str, ...]:
    """Return documentation with an empty line between paragraphs."""
    found: list[str] = []
    for lines in filter(None, paragraphs):
        found += [*([f"{_IN}///"] if found else []), *lines]
    return tuple(found)
