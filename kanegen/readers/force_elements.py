"""The force elements of a model file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from typing import Any

from kanegen.errors import ModelError
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import KINDS
from kanegen.model.force_elements.grammar import parse
from kanegen.readers.keys import Table, check_keys
from kanegen.readers.parameters import Parameters

KEYS = tuple(kind.KEY for kind in KINDS)
"""Of their arrays of tables, `[[spring]]` and so on."""

NAMES = ("freedom", "point", "between")
"""What holds names, which are no parameters."""


def read_force_elements(table: Table, parameters: Parameters) -> tuple[ForceElement, ...]:
    """Those of a model file.

    Raises:
        ModelError: If one is not usable; names it by its place in the file.
    """
    found: list[ForceElement] = []
    for kind in KINDS:
        entries = table.get(kind.KEY, [])
        if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
            raise ModelError(f"{kind.KEY}: begin each with a line [[{kind.KEY}]], in double brackets.")
        for number, entry in enumerate(entries, start=1):
            try:
                found.append(_element(kind, entry, parameters))
            except ModelError as error:
                raise ModelError(f"{kind.KEY} {number}: {error}") from None
    return tuple(found)


def _element(kind: type[ForceElement], table: Table, parameters: Parameters) -> ForceElement:
    known = fields(kind)
    required = [field.name for field in known if field.default is MISSING]
    check_keys(table, tuple(field.name for field in known), required)
    values = {}
    for name, value in table.items():
        if name in NAMES:
            values[name] = _end(value, parameters) if name == "between" else value
        elif name in kind.EXPRESSION_FIELDS:
            values[name] = _written(value, parameters)
        else:
            values[name] = parameters.resolve(value, name)
    return kind(**values)


def _end(value: Any, parameters: Parameters) -> Any:
    """Ends of a spring: names of points, or places of the ground in which a string is a parameter."""
    if not isinstance(value, list):
        return value
    return [parameters.resolve(end, "between") if isinstance(end, list) else end for end in value]


def _written(value: Any, parameters: Parameters) -> Any:
    """An expression, or several."""
    if isinstance(value, list):
        return [_written(item, parameters) for item in value]
    found = parse(value, parameters.known.values())
    return parameters.noted(found)
