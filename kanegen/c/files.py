"""From the programs of a module to the text of every generated file."""

from __future__ import annotations

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
from kanegen.c.interface import PREPARE, Function, ModelFacts, requested, signatures
from kanegen.c.lanes import LANES
from kanegen.c.pieces import Code, code
from kanegen.c.ranges import require_range
from kanegen.c.source import Source
from kanegen.c.stamp import stamped
from kanegen.c.templates import fill
from kanegen.c.waves import FEW
from kanegen.errors import ModelError
from kanegen.precision import DOUBLE, Precision, named
from kanegen.program.ir import Module, Program
from kanegen.variant import STRICT, Variant
from kanegen.version import __version__

FILES = {
    "{name}.h": "model.h",
    "{name}.c": "model.c",
    "{name}_batch.c": "model_batch.c",
    "kanegen_lanes{f}.h": "kanegen_lanes.h",
    "main.c": "main.c",
    "CMakeLists.txt": "CMakeLists.txt",
    "{name}.pc.in": "model.pc.in",
    "README.md": "README.md",
}
"""Every generated file and its template; {f} is empty, or f in single precision."""

TAKEN_HEADERS = frozenset(
    """
    assert complex ctype errno fenv features float inttypes iso646 kanegen_lanes kanegen_lanesf limits locale
    main malloc math memory pthread sched setjmp signal stdalign stdarg stdatomic stdbit stdbool stdckdint
    stddef stdint stdio stdlib stdnoreturn string strings tgmath threads time uchar unistd wchar wctype
    """.split()
)
"""Model names whose header would hide one of the C library, or whose source the example."""


def render(
    model: ModelFacts, module: Module, operations: Mapping[str, int], variant: Variant = STRICT
) -> Source:
    """C code for the programs of `module`.

    Args:
        model: Names and sizes that the code and its documentation mention.
        module: What to compute.
        operations: Operation counts, for the documentation and `Source.operations`.
        variant: The choices that shape it; the programs follow theirs already.

    Raises:
        ModelError: If the model has the name of a header of the C library, or a number that its
            precision cannot hold.
    """
    if model.name.lower() in TAKEN_HEADERS:
        raise ModelError(
            f"system name {model.name!r}: the file {model.name}.h or {model.name}.c would hide another. "
            "Choose another name."
        )
    precision = named(variant.precision)
    programs = signatures(module)
    require_range(model, programs, precision)
    functions = tuple(programs)
    texts = [_text(model.name, *item, precision) for item in programs.items()]
    outputs = requested(module)
    context = {
        "version": __version__,
        "model": model,
        "prefix": model.name.upper(),
        "outputs": outputs,
        "precision": precision,
        "choices": variant.described(),
        "flags": variant.flags,
        "is_strict": variant.is_strict,
        "lanes": LANES[precision],
        "functions": texts,
        "waves": max(text.code.waves for text in texts),
        "few": FEW,
        "sizes": describe.enumeration(describe.sizes(model, functions)),
        "parameter_indices": describe.enumeration(describe.parameter_indices(model)),
        "spoilt": [f"`{model.name}_{function.name}`" for function in functions if function.spoilt],
        "freedoms": describe.freedoms(model),
        "loads": describe.loads(model),
        "operations": describe.operations(operations),
        "stack": describe.batch_stack(functions, LANES[precision]),
        "inputs": describe.example_inputs(model, functions, precision),
        "results": describe.example_results(functions),
    }
    context["declarations"] = cdef = fill("declarations.h", **context)
    names = {pattern: pattern.format(name=model.name, f=precision.suffix) for pattern in FILES}
    files = {names[p]: stamped(names[p], fill(template, **context)) for p, template in FILES.items()}
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


def _text(model: str, function: Function, pieces: Sequence[Program], precision: Precision) -> FunctionText:
    arithmetic = DOUBLE if function.name == PREPARE else precision
    name = f"{model}_{function.name}"
    return FunctionText(
        name=name,
        signature=function,
        arguments=argument_list(function),
        prototype=prototype(model, function, precision.name),
        code=code(name, function, pieces, scalar(precision, arithmetic)),
        batch_prototype=batch_prototype(model, function, precision.name),
        batch_notes=batch_notes(function),
        lanes_prototype=lanes_prototype(model, function, precision.name),
        lanes_code=code(f"{name}_lanes", function, pieces, lanes(precision))
        if function.in_lanes
        else Code([]),
        lanes_call=lanes_call(model, function),
        row_call=row_call(model, function),
    )
