"""Reads the force elements of a TOML model file."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any

from kanegen.errors import ModelError
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import KINDS
from kanegen.readers.toml_tables import Parameters, Table, check_keys, tables_named

KEYS = tuple(kind.KEY for kind in KINDS)
"""Names of the arrays of tables of force elements: `[[spring]]` and so on."""

NAME_FIELDS = ("freedom", "point", "between", "frame")
"""Fields whose strings are names of freedoms, points or frames, not of parameters."""


def read_force_elements(table: Table, parameters: Parameters) -> tuple[ForceElement, ...]:
    """Return the force elements of a model file.

    Args:
        table: The whole file.
        parameters: The run-time parameters of the model.

    Raises:
        ModelError: If an element is not usable; the message begins with its kind and its place in the file.
    """
    found: list[ForceElement] = []
    for kind in KINDS:
        for number, entry in enumerate(tables_named(table, kind.KEY), start=1):
            try:
                found.append(_element(kind, entry, parameters))
            except ModelError as error:
                raise ModelError(f"{kind.KEY} {number}: {error}") from None
    return tuple(found)


def _element(kind: type[ForceElement], table: Table, parameters: Parameters) -> ForceElement:
    """Return a force element from its table."""
    known = fields(kind)
    required = [field.name for field in known if field.default is MISSING]
    check_keys(table, tuple(field.name for field in known), required)
    values = {}
    for name, value in table.items():
        if name in NAME_FIELDS:
            values[name] = _ends(value, parameters) if name == "between" else value
        elif name in kind.EXPRESSION_FIELDS:
            values[name] = _expressions(value, parameters)
        else:
            values[name] = parameters.resolve(value, name)
    return kind(**values)


def _ends(value: Any, parameters: Parameters) -> Any:
    """Return the ends of a spring: names of points, or places of the ground with parameters for strings."""
    if not isinstance(value, list):
        return value
    return [parameters.resolve(end, "between") if isinstance(end, list) else end for end in value]


def _expressions(value: Any, parameters: Parameters) -> Any:
    """Return the expression of a string or number, or a list of expressions."""
    if isinstance(value, list):
        return [_expressions(item, parameters) for item in value]
    return parameters.expression(value)
