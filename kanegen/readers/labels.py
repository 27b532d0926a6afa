"""Names that a robot file may hold and kanegen may not."""

from __future__ import annotations

import re

from kanegen.model.names import KEYWORDS, MAX_LENGTH


def label(name: str) -> str:
    """`name` for a body or a joint: every character that `check_label` refuses becomes an underscore."""
    name = re.sub(r"[^A-Za-z0-9_.:-]|\.(?=\.)", "_", name)
    return _no_keyword(name if re.match(r"[A-Za-z0-9_]", name) else f"_{name}")


def identifier(name: str) -> str:
    """`name` for a system: a C identifier, `robot` where nothing is given."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", name) or "robot"
    return _no_keyword(name if re.match(r"[A-Za-z]", name) else f"robot_{name}")[:MAX_LENGTH]


def _no_keyword(name: str) -> str:
    return f"{name}_" if name in KEYWORDS else name
