"""Docstrings of kanegen as reStructuredText.

They are plain sentences with `code`, and sections as Google writes them. Brackets, bars and stars are part of
formulas such as |cos(theta2)| and mean nothing else, and what is returned has no type before a colon.
"""

import re
from collections.abc import Iterator
from textwrap import dedent

from docutils import nodes
from sphinx.application import Sphinx

_HEADING = re.compile(r"^(Args|Attributes|Returns|Yields|Raises|Example|Examples):$")
_ENTRY = re.compile(r"^(?P<name>\*{0,2}\w[\w, ]*): (?P<text>.*)$")
_SPECIAL = re.compile(r"([\\*|_])")


def prose(text: str) -> str:
    """Return a text in which only `code` has a meaning for reStructuredText."""
    parts = re.split(r"(`[^`]*`)", text)
    escaped = (part if part.startswith("`") else _SPECIAL.sub(r"\\\1", part) for part in parts)
    return re.sub(r"(`[^`]*`)(?=\w)", r"\1\\ ", "".join(escaped))


def _sections(lines: list[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield the sections of a docstring by their headings; the text before them has the heading ""."""
    heading = ""
    body: list[str] = []
    for line in lines:
        match = _HEADING.match(line)
        if match:
            yield heading, body
            heading, body = match[1], []
        else:
            body.append(line)
    yield heading, body


def _entries(body: list[str]) -> Iterator[tuple[str, str]]:
    """Yield the names of a section such as Args with what it says of them."""
    name = ""
    words: list[str] = []
    for line in dedent("\n".join(body)).strip().splitlines():
        match = _ENTRY.match(line)
        if match:
            if words:
                yield name, " ".join(words)
            name, words = match["name"], [match["text"]]
        else:
            words.append(line.strip())
    if words:
        yield name, " ".join(words)


def _text(body: list[str]) -> str:
    return dedent("\n".join(body)).strip()


def _fields(kind: str, body: list[str]) -> list[str]:
    return [f":{kind} {prose(name)}: {prose(text)}" for name, text in _entries(body)]


def _attributes(body: list[str]) -> list[str]:
    lines = [".. rubric:: Attributes", ""]
    for name, text in _entries(body):
        lines += [f"`{name}`", f"   {prose(text)}", ""]
    return lines


def _example(body: list[str]) -> list[str]:
    code = [f"   {line}".rstrip() for line in _text(body).splitlines()]
    return [".. code-block:: python", "", *code]


def restructured(lines: list[str]) -> list[str]:
    """Return a docstring of kanegen as lines of reStructuredText."""
    result: list[str] = []
    for heading, body in _sections(lines):
        if heading:
            result.append("")
        if heading == "Args":
            result += _fields("param", body)
        elif heading == "Raises":
            result += _fields("raises", body)
        elif heading == "Attributes":
            result += _attributes(body)
        elif heading in {"Returns", "Yields"}:
            result.append(f":{heading.lower()}: {prose(' '.join(_text(body).split()))}")
        elif heading:
            result += [*_example(body), ""]
        else:
            result += prose("\n".join(body)).splitlines()
    return result


def _process(app: Sphinx, what: str, name: str, value: object, options: object, lines: list[str]) -> None:
    """Replace a docstring by its reStructuredText."""
    lines[:] = restructured(lines)


def _use_dashes(app: Sphinx, doctree: nodes.document) -> None:
    """Put a dash where Sphinx puts two hyphens, between the name of an argument and what is said of it."""
    for text in list(doctree.findall(nodes.Text)):
        if text == " -- ":
            text.parent.replace(text, nodes.Text(" – "))  # noqa: RUF001


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the docstrings with Sphinx."""
    app.connect("autodoc-process-docstring", _process)
    app.connect("doctree-read", _use_dashes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
