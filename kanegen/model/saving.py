"""A system as a TOML model file: the table of a model, and the text of a table."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from kanegen.model.description import SystemDescription
from kanegen.model.force_elements.elements import KINDS
from kanegen.model.numbers import map_numbers, toml_number

_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def system_table(system: SystemDescription) -> dict[str, Any]:
    """Return the keys and values of the model file of a system, defaults left out."""
    table: dict[str, Any] = {"name": system.name, "gravity": map_numbers(system.gravity, toml_number)}
    if system.parameters:
        table["parameters"] = {parameter.name: parameter.value for parameter in system.parameters}
    outputs = {"body_poses": system.poses, "reaction_loads": system.reactions}
    if chosen := {output: names for output, names in outputs.items() if names}:
        table["outputs"] = chosen
    # In a file, "ground" always means the ground; a body of this name is called by its number.
    names = ["ground", *(body.name for body in system.bodies)]
    lower = [k if k > 0 and name == "ground" else name for k, name in enumerate(names)]
    frames: list[dict[str, Any]] = [{} for _ in names]
    for frame in system.frames:
        frames[frame.body][frame.name] = frame.as_toml()
    if frames[0]:
        table["frames"] = frames[0]
    table["body"] = [
        body.as_table(lower[body.lower], frames[k]) for k, body in enumerate(system.bodies, start=1)
    ]
    if system.couplings:
        table["coupling"] = [coupling.as_table() for coupling in system.couplings]
    if system.rotors:
        table["rotor"] = [rotor.as_table() for rotor in system.rotors]
    if system.contacts:
        table["contact"] = [contact.as_table() for contact in system.contacts]
    elements = {kind: [e.as_table() for e in system.force_elements if type(e) is kind] for kind in KINDS}
    return table | {kind.KEY: tables for kind, tables in elements.items() if tables}


def toml_text(table: Mapping[str, Any]) -> str:
    """Return a TOML document, laid out for people: one quantity a line, one row of a matrix a line.

    Args:
        table: Tuples become arrays, a dictionary a table, a list of dictionaries an array of tables; tables
            inside tables become dotted keys. Everything else is a string, a bool, an int or a float,
            which is written with the fewest digits that give the same number again.
    """
    lines = list(_lines({key: value for key, value in table.items() if not isinstance(value, dict | list)}))
    for key, section in table.items():
        if isinstance(section, dict):
            lines += ["", f"[{key}]", *_lines(section)]
        if isinstance(section, list):
            for item in section:
                lines += ["", f"[[{key}]]", *_lines(item)]
    return "\n".join(lines) + "\n"


def _lines(table: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Yield a line `key = value` for every value of a table, nested tables with dotted keys."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _lines(value, f"{prefix}{_key(key)}.")
        else:
            yield f"{prefix}{_key(key)} = {_value(value)}"


def _key(key: str) -> str:
    """Return a key of TOML, quoted if necessary."""
    return key if _BARE_KEY.fullmatch(key) else json.dumps(key, ensure_ascii=False)


def _value(value: Any) -> str:
    """Return the text of a value in TOML."""
    if isinstance(value, float) and math.isinf(value):
        return "inf" if value > 0 else "-inf"
    if not isinstance(value, tuple):
        return json.dumps(value, ensure_ascii=False)
    if value and isinstance(value[0], tuple):
        return "".join(["[\n", *(f"    {_value(row)},\n" for row in value), "]"])
    return f"[{', '.join(map(_value, value))}]"
