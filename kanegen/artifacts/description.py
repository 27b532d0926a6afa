"""The artifact "description": structures with members by name, and what a program may ask at run time.

The header holds, for each kind of array with named elements, a union of the array and of a structure whose
members are its elements by name. So a name leads to its place without a conversion, in ways that C defines.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kanegen.artifacts.example import constant
from kanegen.artifacts.model_fields import model_fields
from kanegen.c.declarations import enumeration
from kanegen.c.element_names import AXES, MOTION, names_of_y
from kanegen.c.formats import formats
from kanegen.c.layout import BREAK, HINGE, columns, wrap
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.model.identifiers import identifiers
from kanegen.model.quoting import c_name

Names = Sequence[str]


@dataclass(frozen=True)
class Structure:
    """An array with named elements, as a union of the array and of a structure.

    Attributes:
        name: Name of the type without the prefix of the model.
        doc: What stands in the array, in one sentence.
        type: Type of a number in C.
        size: Number of elements.
        lines: Lines of the members of the structure, in the order of the array.
        places: Lines of an enumeration of the places of the elements, () where there is none.
    """

    name: str
    doc: str
    type: str
    size: int
    lines: Sequence[str]
    places: Sequence[str] = ()


def description(source: Source) -> dict[str, str]:
    """Return `<model>_description.h` and `<model>.json`, by their names."""
    model, fields = source.model, model_fields(source)
    text = fill(
        "artifacts/model_description.h",
        model=model,
        prefix=model.prefix,
        structures=list(_structures(source)),
        first=identifiers(model.coordinate_names, "c")[0],
        type=formats(source.variant).storage.c_type,
        defaults=_defaults(source),
        characters=_characters(json.dumps(fields, separators=(",", ":"), allow_nan=False)),
    )
    whole = json.dumps(fields, indent=1, allow_nan=False).removeprefix("{\n") + "\n"
    return {f"{model.name}_description.h": text, f"{model.name}.json": whole}


def _structures(source: Source) -> Iterator[Structure]:
    """Yield the types of the arrays of a source whose elements have names."""
    model, kinds = source.model, formats(source.variant)
    kind = kinds.storage.c_type
    yield _vector(
        "coordinates",
        "{x} or {xdot}: a number for each coordinate; units of {x}.",
        kind,
        model.coordinate_names,
        model.coordinate_units,
        f"{model.prefix}_X",
    )
    yield _vector(
        "speeds",
        "{y}, {ydot}, {tau} or {f}: a number for each freedom; units of {y}.",
        kind,
        names_of_y(model),
        [f"{unit}/s" for unit in model.freedom_units],
        f"{model.prefix}_Y",
    )
    if model.parameters:
        names = [name for name, _ in model.parameters]
        yield _vector("parameters", "The run-time parameters.", kinds.parameters.c_type, names)
    if model.takes_loads:
        doc = "`force` or `torque`: a vector for each body."
        yield _table("body_vectors", doc, kind, model.body_names, AXES)
    if model.points:
        doc = "A vector for each point, such as `point_positions` or `point_force`."
        yield _table("point_vectors", doc, kind, [name for name, _ in model.points], AXES)
    if model.prescribed:
        doc = "`prescribed`: values of prescribed freedoms, their rates and second derivatives."
        yield _table("prescribed_motion", doc, kind, MOTION, model.prescribed_names)


def _vector(name: str, doc: str, kind: str, names: Names, units: Names = (), places: str = "") -> Structure:
    """Return the type of an array with one axis; `places` begins the names of enumerators of its places."""
    members = identifiers(names, "c")
    rows = []
    for place, member in enumerate(members):
        words = [*units[place : place + 1], *([c_name(names[place])] if member != names[place] else [])]
        rows.append((f"{kind} {member};", f"/* {', '.join(words)} */" if words else ""))
    enumerators = (
        [(f"{places}_{member}", place, "") for place, member in enumerate(members)] if places else []
    )
    return Structure(name, doc, kind, len(members), columns(rows, gap=" "), enumeration(enumerators))


def _table(name: str, doc: str, kind: str, rows: Names, columns_of_row: Names) -> Structure:
    """Return the type of an array with two axes, a structure for each row."""
    inner = f",{BREAK}".join(identifiers(columns_of_row, "c"))
    lines = []
    for member, row in zip(identifiers(rows, "c"), rows, strict=True):
        comment = f" /* {c_name(row)} */" if member != row else ""
        lines += wrap(
            f"struct {{{BREAK}{kind} {inner};{BREAK}}} {member};{comment}", indent="", hanging="    "
        )
    return Structure(name, doc, kind, len(rows) * len(columns_of_row), lines)


def _defaults(source: Source) -> list[str]:
    """Return the lines of a macro that initialises parameters with their defaults, [] without parameters."""
    model, precision = source.model, formats(source.variant).parameters
    if not model.parameters:
        return []
    values = f",{BREAK}".join(constant(default, precision) for _, default in model.parameters)
    lines = wrap(f"#define {model.prefix}_PARAMETER_DEFAULTS {{ {{ {values} }} }}", indent="", hanging="    ")
    return [*(f"{line} \\" for line in lines[:-1]), lines[-1]]


def _characters(text: str) -> list[str]:
    """Return the lines of an initialiser with the characters of a text, and the character that ends it.

    A string in C99 holds 4095 characters at most; an array of characters has no such limit.
    """
    escaped = {"'": r"'\''", "\\": r"'\\'"}
    return wrap(
        f",{HINGE}".join([*(escaped.get(one, f"'{one}'") for one in text), r"'\0'"]),
        hanging="        ",
        indent="        ",
    )
