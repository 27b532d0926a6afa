"""The variables of the templates: whatever has to be computed is here before a template is filled."""

from __future__ import annotations

import textwrap
from typing import Any

from kanegen import __version__
from kanegen.c.describe import example, sizes, tables, words
from kanegen.c.double_double import PAIRS
from kanegen.c.function_text import texts
from kanegen.c.layout import WIDTH
from kanegen.c.render_input import Draft
from kanegen.c.vector_sincos import FEW
from kanegen.program.precision import DOUBLE_DOUBLE

Context = dict[str, Any]
"""Variables by name: text, numbers and what has more to say."""


def context(draft: Draft) -> Context:
    """All variables but `declarations`, which is a template of its own."""
    return {
        "version": __version__,
        "model": draft.model,
        "prefix": draft.model.name.upper(),
        "outputs": draft.outputs,
        **_choices(draft),
        **_functions(draft),
        **_sizes(draft),
        **_tables(draft),
        **_words(draft),
        **_example(draft),
    }


def _choices(draft: Draft) -> Context:
    variant = draft.variant
    return {
        "precision": draft.precision,
        "formats": draft.formats,
        "pairs": PAIRS if draft.precision is DOUBLE_DOUBLE else None,
        "lanes": draft.lanes,
        "sincos": draft.sincos,
        "choices": variant.described(draft.decided),
        "flags": variant.flags,
        "flushes": variant.flushes,
        "is_strict": variant.is_strict,
    }


def _functions(draft: Draft) -> Context:
    written = texts(draft)
    functions, name = draft.functions, draft.model.name
    return {
        "functions": written,
        "waves": max(text.code.waves for text in written),
        "has_sines": any(text.code.has_sines for text in written),
        "few": FEW,
        "spoilt": [f"`{name}_{function.name}`" for function in functions if function.spoilt],
        "judged": [f"`{name}_{function.name}`" for function in functions if function.judged],
        "conditions": list(dict.fromkeys(c for function in functions for c in function.conditions)),
    }


def _sizes(draft: Draft) -> Context:
    model, functions, lanes = draft.model, draft.functions, draft.lanes
    return {
        "sizes": sizes.enumeration(sizes.sizes(model, functions)),
        "parameter_indices": sizes.enumeration(sizes.parameter_indices(model)),
        "stack": sizes.batch_stack(functions, lanes, draft.formats) if lanes else 0,
    }


def _tables(draft: Draft) -> Context:
    model, outputs = draft.model, draft.outputs
    return {
        "freedoms": tables.freedoms(model),
        "coordinates": tables.coordinates(model),
        "poses": tables.poses(model, outputs),
        "reactions": tables.reactions(model, outputs),
        "loads": tables.loads(model),
        "point_loads": tables.point_loads(model),
    }


def _words(draft: Draft) -> Context:
    model = draft.model
    return {
        "operations": words.operations(draft.operations),
        "force_elements": words.force_elements(model),
        "sines": _lines(words.sines(draft.sincos, draft.precision)),
        "arithmetic": _lines(words.arithmetic(draft.formats, bool(model.parameters))),
    }


def _example(draft: Draft) -> Context:
    model, functions, held = draft.model, draft.functions, draft.formats
    return {
        "inputs": example.inputs(model, functions, held),
        "results": example.results(functions, held),
        "printers": example.printers(functions, held),
    }


def _lines(text: str) -> list[str]:
    """Of a comment."""
    return textwrap.wrap(text, WIDTH - len(" * "))
