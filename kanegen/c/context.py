"""The variables that the templates of headers, sources and documentation share.

Templates hold C and prose. Tables, numbers and sentences that depend on the model are computed here.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from kanegen import __version__
from kanegen.c import declarations
from kanegen.c.description import ModelDescription
from kanegen.c.double_double import DOUBLE_DOUBLE_HEADER
from kanegen.c.formats import Formats, formats, uniform
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import WIDTH
from kanegen.c.simd import SIMD
from kanegen.c.sincos import Sincos, sincos_named
from kanegen.errors import counted
from kanegen.model.quoting import c_comment
from kanegen.options import Variant
from kanegen.program.precision import DOUBLE, DOUBLE_DOUBLE, FLOAT, LONG_DOUBLE, Precision
from kanegen.program.semantics import FINITE

Context = dict[str, Any]
"""Variables of a template by name."""

OPERATIONS = {
    "add": ("addition or subtraction", "additions and subtractions"),
    "multiply": ("multiplication", "multiplications"),
    "divide": ("division", "divisions"),
    "sqrt": ("square root", "square roots"),
    "sincos": ("sine or cosine", "sines and cosines"),
    "compare": ("comparison", "comparisons"),
    "function": ("call of exp, log, tanh or atan2", "calls of exp, log, tanh and atan2"),
    "prepare": ("operation of the parameter-only step", "operations of the parameter-only step"),
}
"""Descriptions of one and of several operations of each kind in `Source.operations`."""

_NAMES = (
    "The functions have the names of those in double precision, so a program can use only one of the two."
)

_ARITHMETICS = {
    DOUBLE: "All is computed in double precision.",
    FLOAT: "All is computed in single precision.",
    LONG_DOUBLE: "All is computed in long double, which has 64 bits or more; platforms where it is no wider "
    "than double are refused.",
    DOUBLE_DOUBLE: "All is computed in double-double, about 32 digits (kanegen_double_double.h); what is "
    "stored as double is rounded once. Angles beyond 1e6 rad give NaN, and so does what overflows.",
}


def context(
    model: ModelDescription,
    functions: Sequence[Function],
    outputs: Sequence[str],
    operations: Mapping[str, int],
    variant: Variant,
    steps: Sequence[Function] = (),
) -> Context:
    """Return the variables that depend on the functions and the variant, but not on printed code.

    Args:
        model: Names and sizes of the model.
        functions: Every generated function.
        outputs: Names of the outputs that were asked for.
        operations: Operation counts of one evaluation of all outputs.
        variant: The choices that shape the code.
        steps: The functions of one step that functions of many steps contain.
    """
    model_formats = formats(variant)
    has_batches = any(function.has_batch for function in functions)
    return {
        "version": __version__,
        "has_batches": has_batches,
        "has_lanes": has_batches and model_formats.arithmetic in SIMD,
        "model": model,
        "prefix": model.prefix,
        "outputs": outputs,
        "operations": _operations(operations),
        **_arithmetic(model, variant, model_formats, has_batches),
        **_status(model, functions, FINITE in variant.semantics),
        **_tables(model, outputs),
        "sizes": declarations.sizes(model, functions, steps),
        "limits": declarations.limits(model, model_formats),
        "limit_type": (DOUBLE if model_formats.storage is DOUBLE_DOUBLE else model_formats.storage).c_type,
        "patterns": declarations.patterns(model, functions),
        "parameter_places": declarations.parameter_places(model),
    }


def _arithmetic(
    model: ModelDescription, variant: Variant, model_formats: Formats, has_batches: bool
) -> Context:
    """Return the variables of precisions, of sine and cosine, and of compiler semantics."""
    sincos = sincos_named(variant.sincos, model_formats.arithmetic)
    return {
        "precision": model_formats.arithmetic,
        "formats": model_formats,
        "double_double": DOUBLE_DOUBLE_HEADER if model_formats.arithmetic is DOUBLE_DOUBLE else None,
        "simd": SIMD.get(model_formats.arithmetic),
        "sincos": sincos,
        "flags": variant.flags,
        "flushes": variant.flushes,
        "is_strict": variant.is_strict,
        "is_multiversioned": variant.is_multiversioned,
        "arithmetic": _wrapped(_about_arithmetic(model_formats, bool(model.parameters))),
        "sines": _wrapped(_about_sines(sincos, model_formats.arithmetic, has_batches)),
    }


def _status(model: ModelDescription, functions: Sequence[Function], is_finite_assumed: bool) -> Context:
    """Return the variables of statuses: what they mean, the functions with conditions, and these.

    Args:
        model: Names of the model.
        functions: Every generated function.
        is_finite_assumed: Whether the compiler may assume that no number is infinite or NaN.
    """
    name = model.name
    return {
        "may_fail": [f"`{name}_{f.name}`" for f in functions if f.may_fail],
        "may_be_inaccurate": [f"`{name}_{f.name}`" for f in functions if f.may_be_inaccurate],
        "quantity": " or ".join(dict.fromkeys(c.quantity for f in functions for c in f.conditions)),
        "failure": " or ".join(dict.fromkeys(c.failure for f in functions for c in f.conditions)),
        "rows": _statuses_of_rows(model, functions),
        "status": _wrapped(_about_status(model, functions, is_finite_assumed)),
    }


def _statuses_of_rows(model: ModelDescription, functions: Sequence[Function]) -> list[str]:
    """Return a sentence on the statuses that name a row of an output, for each kind of rows."""
    found: list[str] = []
    for condition in dict.fromkeys(c for f in functions for c in f.row_conditions):
        names = [f"`{model.name}_{f.name}`" for f in functions if condition in f.row_conditions]
        status = f"{declarations.not_finite(model)} + " + f"{condition.first} + " * bool(condition.first)
        found.append(
            f"{' and '.join(names)} return {status}i for row i, from 1, of the {condition.rows}, whose "
            f"{condition.quantity} is not positive or is NaN: {condition.failure}."
        )
    return found


def _tables(model: ModelDescription, outputs: Sequence[str]) -> Context:
    """Return the variables of the tables of elements, one for every array."""
    freedoms = zip(model.freedom_names, model.freedom_units, model.speeds, strict=True)
    coordinates = zip(model.coordinate_names, model.coordinate_units, strict=True)
    points = [name for name, _ in model.points]
    reactions = declarations.reactions(model, outputs)
    contact_rows = declarations.contacts(model, outputs)
    return {
        "freedoms": [(place, *row) for place, row in enumerate(freedoms)],
        "coordinates": [(place, *row) for place, row in enumerate(coordinates)] * model.has_other_coordinates,
        "frames": declarations.frames(model, outputs),
        "reactions": reactions,
        "about_reactions": _wrapped(_about_reactions(model)) if reactions else [],
        "contact_rows": contact_rows,
        "contacts": _listed(model.contacts) if contact_rows else [],
        "loads": _loaded_rows(zip(model.body_names, strict=True), model.loaded),
        "point_loads": _loaded_rows(zip(points, model.load_frames, strict=True), model.loaded_points),
        "force_elements": _listed(model.force_elements),
        "motors": _listed(model.motors),
        "couplings": _listed(model.couplings),
        "locked": _listed(model.locked),
    }


def _loaded_rows(entries: Iterable[tuple[str, ...]], loaded: Sequence[bool]) -> list[tuple[Any, ...]]:
    """Return the row of every body or point that takes loads, with what its entry says on it."""
    rows = enumerate(zip(entries, loaded, strict=True))
    return [(row, *entry) for row, (entry, is_loaded) in rows if is_loaded]


def _operations(counts: Mapping[str, int]) -> list[str]:
    """Return the number and the name of each kind of operation."""
    return [
        counted(number, *OPERATIONS[kind]) for kind, number in counts.items() if number or kind != PREPARE
    ]


def _listed(texts: Sequence[str]) -> list[str]:
    """Return comment lines with texts that describe parts of the model."""
    width = WIDTH - len(" *     ")
    lines = [textwrap.wrap(text, width, subsequent_indent="    ") for text in map(c_comment, texts)]
    return [line for wrapped in lines for line in wrapped]


def _about_arithmetic(model_formats: Formats, has_parameters: bool) -> str:
    """Return the sentences on the precisions for users; "" where all is double."""
    if model_formats == uniform(FLOAT):
        prepared = ", by _prepare in double," if has_parameters else ""
        return (
            f"Single precision: all numbers are of type float. Constants are computed in 96 digits{prepared} "
            f"and rounded once; below 1.2e-38 they lose digits or become 0. {_NAMES}"
        )
    if model_formats == uniform(DOUBLE):
        return ""
    kinds = f"States, loads and results are of type {model_formats.storage.c_type}"
    kinds += f", parameters of type {model_formats.parameters.c_type}." if has_parameters else "."
    return f"{_ARITHMETICS[model_formats.arithmetic]} {kinds} {_NAMES}"


def _about_sines(sincos: Sincos | None, arithmetic: Precision, has_batches: bool) -> str:
    """Return the sentences on the implementation of sine and cosine and on its errors."""
    if sincos is None:
        where = "kanegen_double_double.h" if arithmetic is DOUBLE_DOUBLE else "the C library"
        everywhere = ", for one state and in batches" if has_batches else ""
        return f"Sine and cosine are those of {where}{everywhere}."
    if sincos.plain:
        degrees = f"{sincos.degree} and {sincos.degree + 1}"
        return (
            f"Sine and cosine are polynomials of degree {degrees} ({sincos.header}.h), for angles of every "
            f"size. Their largest errors are {sincos.error}."
        )
    return (
        f"Sine and cosine are kanegen's own ({sincos.header}.h), for angles of every size, and off by at "
        f"most {sincos.error}. Compiled with -ffp-contract=off and without -ffast-math they have the same "
        "bits everywhere, whatever the C library."
    )


def _about_reactions(model: ModelDescription) -> str:
    """Return the sentences on what reaction loads are, of locked directions and in frames."""
    in_frames = [bool(frame) for _, _, frame in model.reactions]
    directions = (
        "The load of an angle is the moment on the body about its origin, along the axis of the angle; that "
        "of a translation is the force on the body along its axis of the joint frame."
    )
    loads = (
        "`moment1` to `moment3` and `force1` to `force3` of a frame are all that the joint below its body "
        "transmits, efforts on its freedoms included: the moment on the body about the origin of the frame, "
        "and the force, in components along the axes of the frame."
    )
    parts = [directions] * (not all(in_frames)) + [loads] * any(in_frames)
    return f"{' '.join(parts)} They come from the lower body."


def _about_status(model: ModelDescription, functions: Sequence[Function], is_finite_assumed: bool) -> str:
    """Return the sentences on the status that every function returns."""
    text = (
        "Every function returns a status: 0 where all its results are finite numbers, "
        f"{declarations.not_finite(model)} where one is infinite or NaN. Further statuses stand with the "
        "functions that have them."
    )
    if any(function.has_batch for function in functions):
        text += " The _batch functions return how many states have a status other than 0."
    if is_finite_assumed:
        text += " But the compiler may assume that no number is infinite or NaN, so the status may miss one."
    return text


def _wrapped(text: str) -> list[str]:
    """Return `text` as lines of a block comment."""
    return textwrap.wrap(text, WIDTH - len(" * "))
