"""The C functions as text: prototypes, comments and bodies, ready for the templates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.c.declarations import (
    argument_list,
    batch_notes,
    batch_prototype,
    lanes_call,
    lanes_prototype,
    prototype,
    row_call,
)
from kanegen.c.dialect import lanes, scalar
from kanegen.c.function_parts import Code, code
from kanegen.c.interface import PREPARE, Function
from kanegen.c.render_input import Draft
from kanegen.c.simd import LANES
from kanegen.program.ir import Program


@dataclass(frozen=True)
class FunctionText:
    """One C function as lines for the templates."""

    name: str
    signature: Function
    arguments: list[str]
    prototype: list[str]
    code: Code
    batch_prototype: list[str]
    batch_notes: list[str]
    lanes_prototype: list[str]
    lanes_code: Code
    lanes_call: list[str]
    row_call: list[str]
    in_lanes: bool


def texts(draft: Draft) -> list[FunctionText]:
    """Every function of a model."""
    return [_text(draft, function, pieces) for function, pieces in draft.programs.items()]


def _text(draft: Draft, function: Function, pieces: Sequence[Program]) -> FunctionText:
    model, held = draft.model.name, draft.formats
    name = f"{model}_{function.name}"
    in_lanes = function.in_lanes and held.arithmetic in LANES
    return FunctionText(
        name=name,
        signature=function,
        arguments=argument_list(function),
        prototype=prototype(model, function, held),
        code=_code(draft, name, function, pieces),
        batch_prototype=batch_prototype(model, function, held),
        batch_notes=batch_notes(function),
        lanes_prototype=lanes_prototype(model, function, held),
        lanes_code=_lanes_code(draft, name, function, pieces) if in_lanes else Code([]),
        lanes_call=lanes_call(model, function),
        row_call=row_call(model, function),
        in_lanes=in_lanes,
    )


def _code(draft: Draft, name: str, function: Function, pieces: Sequence[Program]) -> Code:
    """For one state, or for parameters alone."""
    held, prepares = draft.formats, function.name == PREPARE
    arithmetic = held.preparing if prepares else held.arithmetic
    has_own_sines = draft.sincos is not None and arithmetic is held.arithmetic
    dialect = scalar(held, arithmetic, has_own_sines)
    return code(name, function, pieces, dialect, draft.variant.flushes and not prepares)


def _lanes_code(draft: Draft, name: str, function: Function, pieces: Sequence[Program]) -> Code:
    """For several states side by side."""
    dialect = lanes(draft.formats.arithmetic, draft.sincos is not None)
    return code(f"{name}_lanes", function, pieces, dialect, draft.variant.flushes)
