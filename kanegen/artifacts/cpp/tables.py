"""Constants of a class in C++: sizes, places, names, units, limits and defaults."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from kanegen.artifacts.example import constant
from kanegen.c.declarations import LIMITS
from kanegen.c.element_names import names_of_y
from kanegen.c.formats import Formats
from kanegen.c.layout import BREAK, wrap
from kanegen.c.source import Source
from kanegen.model.identifiers import identifiers


def sizes(source: Source) -> list[tuple[str, int, str]]:
    """Return name, value and meaning of the constants of sizes."""
    model = source.model
    return [
        ("number_of_coordinates", len(model.coordinate_names), "elements of x"),
        ("number_of_freedoms", len(model.freedom_names), "n, elements of y"),
        ("number_of_bodies", len(model.body_names), "N"),
        ("number_of_points", len(model.points), "points of the bodies"),
        ("number_of_parameters", len(model.parameters), "run-time parameters"),
        ("number_of_prescribed", len(model.prescribed), "p, prescribed freedoms"),
    ]


@dataclass(frozen=True)
class Space:
    """A namespace of places in an array."""

    name: str
    doc: str


def places(source: Source) -> list[tuple[Space, list[tuple[str, int]]]]:
    """Return the namespaces with the places of coordinates, of speeds and of parameters."""
    model = source.model
    parameters = [name for name, _ in model.parameters]
    spaces = (
        (Space("coordinate", "coordinates in x"), model.coordinate_names),
        (Space("speed", "speeds in y"), names_of_y(model)),
        (Space("parameter", "run-time parameters"), parameters),
    )
    return [
        (space, [(member, place) for place, member in enumerate(identifiers(names, "c"))])
        for space, names in spaces
        if names
    ]


@dataclass(frozen=True)
class Table:
    """A constant array of names or numbers."""

    name: str
    doc: str
    type: str
    size: int
    lines: list[str]


def row_names(source: Source) -> tuple[str, ...]:
    """Return the names of rows that a status of a function can name, () where there is no such function."""
    return source.model.rows if any(function.row_conditions for function in source.functions) else ()


def tables(source: Source, kinds: Formats) -> Iterator[Table]:
    """Yield the arrays of names, units, limits and defaults."""
    model = source.model
    yield _texts("coordinate_names", "Names of the coordinates, in the order of x.", model.coordinate_names)
    yield _texts("coordinate_units", "Units of the coordinates.", model.coordinate_units)
    yield _texts("freedom_names", "Names of the freedoms, in the order of y.", model.freedom_names)
    yield _texts("speed_names", "Names of the speeds, in the order of y.", names_of_y(model))
    yield _texts("speed_units", "Units of the speeds.", [f"{unit}/s" for unit in model.freedom_units])
    yield _texts("body_names", "Names of the bodies.", model.body_names)
    if model.points:
        yield _texts("point_names", "Names of the points.", [name for name, _ in model.points])
    if model.prescribed:
        yield _texts("prescribed_names", "Names of the prescribed freedoms.", model.prescribed_names)
    if names := row_names(source):
        yield _texts("row_names", "Names of rows of outputs that a status can name.", names)
    for name, values in zip(LIMITS, model.limits, strict=False):
        doc = f"{name.replace('_', ' ').capitalize()}, infinite where there is none."
        yield Table(name.lower(), doc, "double", len(values), _listed(map(_limit, values)))
    if model.parameters:
        names, defaults = zip(*model.parameters, strict=True)
        yield _texts("parameter_names", "Names of the run-time parameters.", names)
        lines = _listed(constant(value, kinds.parameters) for value in defaults)
        kind = kinds.parameters.c_type
        yield Table("parameter_defaults", "Defaults of the run-time parameters.", kind, len(names), lines)


def _texts(name: str, doc: str, texts: Sequence[str]) -> Table:
    """Return an array of names in UTF-8."""
    return Table(name, doc, "::std::string_view", len(texts), _listed(map(_literal, texts)))


def _listed(items: Iterable[str]) -> list[str]:
    """Return the lines of an initialiser."""
    return wrap(f",{BREAK}".join(items), indent="    ", hanging="    ")


def _literal(text: str) -> str:
    """Return a string of C++ in ASCII; quotes, what could be a trigraph, and bytes beyond ASCII are octal."""
    return f'"{"".join(_character(byte) for byte in text.encode())}"'


def _character(byte: int) -> str:
    return chr(byte) if 32 <= byte < 127 and chr(byte) not in '"\\?' else f"\\{byte:03o}"


def _limit(value: float) -> str:
    if math.isinf(value):
        return f"{'-' if value < 0 else ''}::std::numeric_limits<double>::infinity()"
    return repr(float(value))
