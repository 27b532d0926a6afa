"""Tables of a crate: names, units, limits, members of structs, columns of derivatives, statuses."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.artifacts.rust.names import WIDTH, doc, string
from kanegen.artifacts.statuses import requirements
from kanegen.c.declarations import LIMITS, contacts, reactions
from kanegen.c.description import ModelDescription
from kanegen.c.formats import Formats
from kanegen.c.source import Source
from kanegen.c.steps import DERIVATIVES_OF_STEP
from kanegen.model.identifiers import identifiers
from kanegen.program.precision import DOUBLE, Precision
from kanegen.recursion.outputs import DIFFERENTIATED, OF_FRAMES


@dataclass(frozen=True)
class Table:
    """A constant array.

    Attributes:
        name: Its name.
        doc: Lines of its documentation.
        kind: Type of its elements.
        length: Number of these.
        lines: The elements.
    """

    name: str
    doc: tuple[str, ...]
    kind: str
    length: int
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Struct:
    """A struct whose members are the elements of an array.

    Attributes:
        name: Its name.
        doc: Lines of its documentation.
        members: Name and lines of documentation of each member.
        kind: Type of the members.
        defaults: Default of each member, () where there are none.
    """

    name: str
    doc: tuple[str, ...]
    members: tuple[tuple[str, tuple[str, ...]], ...]
    kind: str
    defaults: tuple[str, ...] = ()


def _number(value: float, precision: Precision, kind: str) -> str:
    """Return the expression of a number of the type `kind`, as short as it can be."""
    if not math.isfinite(value) or abs(value) > float(np.finfo(precision.dtype).max):
        return f"{'-' if value < 0 else ''}{kind}::INFINITY"
    digits = precision.literal(abs(value)).removesuffix(precision.libm_suffix)
    return f"{'-' if value < 0 else ''}{digits}"


def sizes(model: ModelDescription) -> list[tuple[str, int, str]]:
    """Return name, value and meaning of every size."""
    found = [
        ("COORDINATES", len(model.coordinate_names), "Number of elements of `x`."),
        ("FREEDOMS", len(model.freedom_names), "Number of freedoms n, of elements of `y`."),
        ("BODIES", len(model.body_names), "Number of bodies N."),
        ("PARAMETERS", len(model.parameters), "Number of run-time parameters."),
    ]
    if model.points:
        found.append(("POINTS", len(model.points), "Number of points of the bodies."))
    if model.prescribed:
        found.append(("PRESCRIBED", len(model.prescribed), "Number of prescribed freedoms."))
    return found


def tables(source: Source, formats: Formats, kind: str) -> Iterator[Table]:
    """Yield the tables of names, units, parameters and limits.

    Args:
        source: The code.
        formats: The precisions of arrays.
        kind: Type of states and results.
    """
    model = source.model
    yield _texts("COORDINATE_NAMES", "Names of the coordinates, in the order of `x`.", model.coordinate_names)
    yield _texts("COORDINATE_UNITS", "Units of the coordinates.", model.coordinate_units)
    yield _texts("FREEDOM_NAMES", "Names of the freedoms, in the order of `y`.", model.freedom_names)
    speeds = model.speed_names or model.freedom_names
    yield _texts("SPEED_NAMES", "Names of the generalized speeds, in the order of `y`.", speeds)
    yield _texts(
        "SPEED_UNITS", "Units of the generalized speeds.", [f"{one}/s" for one in model.freedom_units]
    )
    yield _texts("BODY_NAMES", "Names of the bodies.", model.body_names)
    yield _texts("FREEDOM_BODIES", "Names of the bodies to which the freedoms belong.", model.freedom_bodies)
    yield _texts("ROW_NAMES", "Names of the rows of results that a status can name.", model.rows)
    if model.points:
        yield _texts("POINT_NAMES", "Names of the points, by row.", [name for name, _ in model.points])
    if set(OF_FRAMES).intersection(source.outputs):
        yield _texts("FRAME_NAMES", "Names of the frames of outputs about frames, by row.", model.poses)
    if rows := reactions(model, source.outputs):
        yield _texts("REACTION_NAMES", "Names of the reaction loads.", [name for _, name, _ in rows])
    if rows := contacts(model, source.outputs):
        yield _texts("CONTACT_ROW_NAMES", "Names of the loads of contacts.", [name for _, name, _ in rows])
    if model.prescribed:
        yield _texts("PRESCRIBED_NAMES", "Names of the prescribed freedoms.", model.prescribed_names)
    yield _texts(
        "PARAMETER_NAMES", "Names of the run-time parameters.", [name for name, _ in model.parameters]
    )
    meanings = ("Smallest coordinates", "Largest coordinates", "Largest speeds", "Largest efforts")
    for name, meaning, values in zip(LIMITS, meanings, model.limits, strict=False):
        storage = formats.storage if formats.storage.c_type == "float" else DOUBLE
        shown = [_number(value, storage, kind) for value in values]
        yield _table(name, f"{meaning}, infinite where there is no limit.", kind, shown)


def _texts(name: str, meaning: str, texts: Iterable[str]) -> Table:
    return _table(name, meaning, "&str", [string(text) for text in texts])


def _table(name: str, meaning: str, kind: str, elements: Sequence[str]) -> Table:
    return Table(name, tuple(f"/// {meaning}".splitlines()), kind, len(elements), tuple(_lines(elements)))


def _lines(elements: Sequence[str]) -> Iterator[str]:
    """Yield elements as lines, as many on one as there is room for."""
    line = ""
    for element in elements:
        if line and len(line) + len(element) + 2 > WIDTH:
            yield line
            line = ""
        line = f"{line} {element}," if line else f"    {element},"
    if line:
        yield line


def structs(model: ModelDescription, formats: Formats, kind: str, parameter_kind: str) -> list[Struct]:
    """Return the structs of coordinates, speeds and parameters.

    Args:
        model: Names of the model.
        formats: The precisions of arrays.
        kind: Type of states.
        parameter_kind: Type of parameters.
    """
    names = model.speed_names or model.freedom_names
    coordinates = zip(model.coordinate_names, model.coordinate_units, strict=True)
    speeds = [(name, f"{unit}/s") for name, unit in zip(names, model.freedom_units, strict=True)]
    found = [
        _struct("Coordinates", "The coordinates `x` by name.", coordinates, kind),
        _struct("Speeds", "The generalized speeds `y` by name.", speeds, kind),
    ]
    if model.parameters:
        precision = formats.parameters if formats.parameters.c_type == "float" else DOUBLE
        described = [(name, f"default {value!r}") for name, value in model.parameters]
        defaults = [_number(value, precision, parameter_kind) for _, value in model.parameters]
        found.append(
            _struct("Parameters", "The run-time parameters (SI).", described, parameter_kind, defaults)
        )
    return found


def _struct(
    name: str, meaning: str, members: Iterable[tuple[str, str]], kind: str, defaults: Sequence[str] = ()
) -> Struct:
    described = list(members)
    fields = identifiers((label for label, _ in described), "rust")
    docs = [tuple(doc(f"{label} ({unit})", "    ")) for label, unit in described]
    return Struct(name, (f"/// {meaning}",), tuple(zip(fields, docs, strict=True)), kind, tuple(defaults))


def columns(source: Source) -> list[tuple[str, list[tuple[str, int, int]]]]:
    """Return the columns of each array of derivatives: name of the variables, first and behind the last."""
    arrays = dict.fromkeys(array.name for one in source.functions for array in one.outputs)
    found = []
    for name in arrays:
        output = "forward_dynamics_derivatives" if name == DERIVATIVES_OF_STEP else name
        if output in DIFFERENTIATED and source.system is not None:
            parts = DIFFERENTIATED[output].columns_of(source.system).items()
            found.append((name, [(by.upper(), part.start, part.stop) for by, part in parts]))
    return found


def shown_requirements(source: Source) -> list[tuple[str, ...]]:
    """Return the expressions of what must be positive for each function."""
    return [
        (
            string(one.function),
            "None" if one.first is None else f"Some({one.first})",
            *map(string, (one.quantity, one.failure, one.loss)),
        )
        for one in requirements(source)
    ]
