"""TOML from nested dictionaries, laid out for people: one quantity a line, one matrix row a line."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_text(table: Mapping[str, Any]) -> str:
    """A TOML document.

    Args:
        table: Tuples become arrays, a dictionary a table, a list of dictionaries an array of tables; tables
            inside tables become dotted keys. Everything else is a string, a bool, an int or a finite float,
            which is written with the fewest digits that give the same number again.
    """
    lines = list(_pairs({key: value for key, value in table.items() if not isinstance(value, dict | list)}))
    for key, section in table.items():
        if isinstance(section, dict):
            lines += ["", f"[{key}]", *_pairs(section)]
        if isinstance(section, list):
            for item in section:
                lines += ["", f"[[{key}]]", *_pairs(item)]
    return "\n".join(lines) + "\n"


def _pairs(table: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _pairs(value, f"{prefix}{_key(key)}.")
        else:
            yield f"{prefix}{_key(key)} = {_value(value)}"


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else json.dumps(key)


def _value(value: Any) -> str:
    if not isinstance(value, tuple):
        return json.dumps(value)
    if value and isinstance(value[0], tuple):
        return "".join(["[\n", *(f"    {_value(row)},\n" for row in value), "]"])
    return f"[{', '.join(map(_value, value))}]"
