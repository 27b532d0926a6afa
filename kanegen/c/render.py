"""From the programs of a module to the text of every generated file."""

from __future__ import annotations

from collections.abc import Mapping

from kanegen.c.context import Context, context
from kanegen.c.double_double import PAIRS
from kanegen.c.interface import ModelFacts
from kanegen.c.provenance import stamped
from kanegen.c.ranges import require_range
from kanegen.c.render_input import Draft
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.errors import ModelError
from kanegen.options import NOTHING, STRICT, Variant
from kanegen.program.ir import Module
from kanegen.program.precision import DOUBLE_DOUBLE

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
    _require_free(model.name)
    draft = Draft(model, module, operations, variant, decided)
    require_range(model, draft.programs, draft.formats)
    variables = context(draft)
    variables["declarations"] = declarations = fill("declarations.h", **variables)
    pairs = PAIRS.declared if DOUBLE_DOUBLE in draft.formats.every else ""
    return Source(
        model=model,
        outputs=draft.outputs,
        functions=draft.functions,
        operations=dict(operations),
        files=_files(draft, variables),
        cdef=pairs + declarations,
        variant=variant,
    )


def _require_free(name: str) -> None:
    if name.lower() in TAKEN_HEADERS:
        raise ModelError(
            f"system name {name!r}: the file {name}.h or {name}.c would hide another. Choose another name."
        )


def _files(draft: Draft, variables: Context) -> dict[str, str]:
    """By name the text of every file that the model has."""
    files = {}
    for pattern, template in FILES.items():
        if template not in NEEDED or variables[NEEDED[template]] is not None:
            name = pattern.format(name=draft.model.name, f=draft.precision.libm_suffix)
            files[name] = stamped(name, fill(template, **variables))
    return files
