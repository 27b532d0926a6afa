"""Names of a model in Rust: of the crate, of members of structs, in strings and in documentation comments."""

from __future__ import annotations

import re
import textwrap

from kanegen.model.identifiers import RESERVED, identifiers
from kanegen.model.quoting import markdown

WIDTH = 100
"""Columns of a line of Rust, those of rustfmt."""

CRATES = frozenset("alloc build core deps doc examples incremental proc_macro std sysroot test tmp".split())
"""Names that a crate cannot have: crates of the language, and folders of Cargo."""

_ENDINGS = {"double": "", "float": "_f32", "double-double": "_dd"}
"""What distinguishes the crates of one model in several precisions."""


def crate_name(name: str, arithmetic: str) -> str:
    """Return the name of the crate of a model.

    Args:
        name: The C identifier of the model.
        arithmetic: Name of the precision of the arithmetic.

    Example:
        crate_name("panda_arm", "float")  # 'panda_arm_f32'
        crate_name("match", "double")  # 'match_model'
    """
    usual = f"{name}{_ENDINGS[arithmetic]}"
    return f"{usual}_model" if usual in RESERVED["rust"] | CRATES else usual


def identifier(name: str) -> str:
    """Return the identifier of an array or a function.

    Example:
        identifier("mass_matrix")  # 'mass_matrix'
    """
    return identifiers([name], "rust")[0]


def camel_case(name: str) -> str:
    """Return the name of a type from that of a function.

    Example:
        camel_case("state_rates")  # 'StateRates'
    """
    return "".join(part.capitalize() for part in name.split("_"))


def string(text: str) -> str:
    r"""Return a text as a string literal of Rust.

    Example:
        string('a"b')  # '"a\\"b"'
    """
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def doc(text: str, indent: str = "", marker: str = "///", bullet: str = "") -> list[str]:
    """Return the lines of a documentation comment, in which no part of a text is a link, a tag or a list.

    Args:
        text: The text.
        indent: Indentation of the lines.
        marker: What begins a line, "///" or "//!".
        bullet: What begins the first line, such as "- "; the others are indented by two columns.
    """
    start = f"{indent}{marker} "
    words = " ".join(markdown(word) for word in text.split())
    width = WIDTH - len(start) - len(bullet)
    lines = textwrap.wrap(words, width, break_long_words=False, break_on_hyphens=False)
    starts = (bullet, *["  " * bool(bullet)] * (len(lines) - 1))
    return [f"{start}{one}{_LIST.sub(_escaped, line)}" for one, line in zip(starts, lines, strict=True)]


def sentence(text: str, indent: str) -> list[str]:
    """Return the lines of a documentation comment that begins with a capital letter."""
    return doc(f"{text[:1].upper()}{text[1:]}", indent)


_LIST = re.compile(r"^([-+]|\d+[.)])(?= |$)")
"""What at the beginning of a line would begin a list in Markdown."""


def _escaped(found: re.Match[str]) -> str:
    return f"{found[1][:-1]}\\{found[1][-1]}"


def plain(text: str) -> list[str]:
    """Return the lines of a text that is Markdown already, for a documentation comment in a block."""
    return textwrap.wrap(text, WIDTH - 8, break_long_words=False, break_on_hyphens=False)


def listed(head: str, items: list[str], tail: str, indent: str, fits: int = WIDTH) -> list[str]:
    """Return a list in brackets on one line, or on a line for each item where it is too long.

    Args:
        head: Text up to the opening bracket, with it.
        items: The items.
        tail: Text from the closing bracket, with it.
        indent: Indentation.
        fits: Columns that all items may have together on one line.
    """
    inside = ", ".join(items)
    line = f"{indent}{head}{inside}{tail}"
    if len(line) <= WIDTH and len(inside) <= fits:
        return [line]
    return [f"{indent}{head}", *(f"{indent}    {item}," for item in items), f"{indent}{tail}"]
