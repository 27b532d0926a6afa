"""From the programs of a module to the text of every generated file."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kanegen.c import describe
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
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function, ModelFacts, requested, signatures
from kanegen.c.lanes import LANES
from kanegen.c.layout import WIDTH
from kanegen.c.pairs import PAIRS
from kanegen.c.pieces import Code, code
from kanegen.c.ranges import require_range
from kanegen.c.sincos import own
from kanegen.c.source import Source
from kanegen.c.stamp import stamped
from kanegen.c.templates import fill
from kanegen.c.waves import FEW
from kanegen.errors import ModelError
from kanegen.precision import DOUBLE_DOUBLE
from kanegen.program.ir import Module, Program
from kanegen.variant import NOTHING, STRICT, Variant
from kanegen.version import __version__

FILES = {
    "{name}.h": "model.h",
    "{name}.c": "model.c",
    "{name}_batch.c": "model_batch.c",
    "kanegen_lanes{f}.h": "kanegen_lanes.h",
    "kanegen_sincos{f}.h": "kanegen_sincos.h",
    "kanegen_pairs.h": "kanegen_pairs.h",
    "main.c": "main.c",
    "CMakeLists.txt": "CMakeLists.txt",
    "{name}.pc.in": "model.pc.in",
    "README.md": "README.md",
}
"""Every generated file and its template; {f} is empty, or f in single precision."""

NEEDED = {"kanegen_lanes.h": "lanes", "kanegen_sincos.h": "sincos", "kanegen_pairs.h": "pairs"}
"""Templates that are only for models that have what is named here."""

TAKEN_HEADERS = frozenset(
    """
    assert complex ctype errno fenv features float inttypes iso646 kanegen_lanes kanegen_lanesf kanegen_pairs
    kanegen_sincos kanegen_sincosf limits locale main malloc math memory pthread sched setjmp signal stdalign
    stdarg stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string strings tgmath
    threads time uchar unistd wchar wctype
    """.split()
)
"""Model names whose header would hide one of the C library, or whose source the example."""


def render(
    model: ModelFacts,
    module: Module,
    operations: Mapping[str, int],
    variant: Variant = STRICT,
    decided: Mapping[str, str] = NOTHING,
) -> Source:
    """C code for the programs of `module`.

    Args:
        model: Names and sizes that the code and its documentation mention.
        module: What to compute.
        operations: Operation counts, for the documentation and `Source.operations`.
        variant: The choices that shape it; the programs follow theirs already.
        decided: What became of some choices, by name, in words.

    Raises:
        ModelError: If the model has the name of a header of the C library, or a number that its
            precision cannot hold.
    """
    if model.name.lower() in TAKEN_HEADERS:
        raise ModelError(
            f"system name {model.name!r}: the file {model.name}.h or {model.name}.c would hide another. "
            "Choose another name."
        )
    held = formats(variant)
    precision = held.arithmetic
    programs = signatures(module)
    require_range(model, programs, held)
    functions = tuple(programs)
    sincos = own(variant.sincos, precision)
    lanes_ = LANES.get(precision)
    texts = [_text(model.name, *item, held, sincos is not None, variant.flushes) for item in programs.items()]
    outputs = requested(module)
    context = {
        "version": __version__,
        "model": model,
        "prefix": model.name.upper(),
        "outputs": outputs,
        "precision": precision,
        "formats": held,
        "pairs": PAIRS if precision is DOUBLE_DOUBLE else None,
        "choices": variant.described(decided),
        "flags": variant.flags,
        "flushes": variant.flushes,
        "is_strict": variant.is_strict,
        "lanes": lanes_,
        "sincos": sincos,
        "functions": texts,
        "waves": max(text.code.waves for text in texts),
        "has_sines": any(text.code.has_sines for text in texts),
        "few": FEW,
        "sizes": describe.enumeration(describe.sizes(model, functions)),
        "parameter_indices": describe.enumeration(describe.parameter_indices(model)),
        "spoilt": [f"`{model.name}_{function.name}`" for function in functions if function.spoilt],
        "conditions": list(dict.fromkeys(c for function in functions for c in function.conditions)),
        "judged": [f"`{model.name}_{function.name}`" for function in functions if function.judged],
        "freedoms": describe.freedoms(model),
        "coordinates": describe.coordinates(model),
        "poses": describe.poses(model, outputs),
        "reactions": describe.reactions(model, outputs),
        "loads": describe.loads(model),
        "point_loads": describe.point_loads(model),
        "force_elements": describe.force_elements(model),
        "operations": describe.operations(operations),
        "sines": textwrap.wrap(describe.sines(sincos, precision), WIDTH - len(" * ")),
        "stack": describe.batch_stack(functions, lanes_, held) if lanes_ else 0,
        "inputs": describe.example_inputs(model, functions, held),
        "results": describe.example_results(functions, held),
        "printers": describe.printers(functions, held),
        "arithmetic": textwrap.wrap(describe.arithmetic(held, bool(model.parameters)), WIDTH - len(" * ")),
    }
    context["declarations"] = cdef = fill("declarations.h", **context)
    if DOUBLE_DOUBLE in held.every:
        cdef = PAIRS.declared + cdef
    names = {pattern: pattern.format(name=model.name, f=precision.suffix) for pattern in FILES}
    wanted = {p: t for p, t in FILES.items() if t not in NEEDED or context[NEEDED[t]] is not None}
    files = {names[p]: stamped(names[p], fill(template, **context)) for p, template in wanted.items()}
    return Source(model, outputs, functions, dict(operations), files, cdef, variant)


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


def _text(
    model: str, function: Function, pieces: Sequence[Program], held: Formats, own: bool, flushes: bool
) -> FunctionText:
    arithmetic = held.preparing if function.name == PREPARE else held.arithmetic
    in_lanes = function.in_lanes and held.arithmetic in LANES
    name = f"{model}_{function.name}"
    one = scalar(held, arithmetic, own and arithmetic is held.arithmetic)
    return FunctionText(
        name=name,
        signature=function,
        arguments=argument_list(function),
        prototype=prototype(model, function, held),
        code=code(name, function, pieces, one, flushes and function.name != PREPARE),
        batch_prototype=batch_prototype(model, function, held),
        batch_notes=batch_notes(function),
        lanes_prototype=lanes_prototype(model, function, held),
        lanes_code=code(f"{name}_lanes", function, pieces, lanes(held.arithmetic, own), flushes)
        if in_lanes
        else Code([]),
        lanes_call=lanes_call(model, function),
        row_call=row_call(model, function),
        in_lanes=in_lanes,
    )
