"""Reads XML into elements with the number of their line.

Namespaces are not resolved, so that a prefix may stay unbound, as in real robot files. A document type
declaration is refused, and with it every entity beyond XML's own five and every reference to another file.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from kanegen.errors import QUOTED, ReadError, excerpt, quoted
from kanegen.model.rotations import Triple

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True)
class Element:
    """One element of an XML document.

    Attributes:
        tag: Name of the element, with its prefix.
        attributes: Values of its attributes as written, by name.
        where: File and line, for messages.
        line: The line.
        children: The elements directly inside.
        texts: The pieces of text directly inside.
    """

    tag: str
    attributes: dict[str, str]
    where: str
    line: int
    children: list[Element] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    @property
    def shown(self) -> str:
        """The tag for messages, shortened if it is long."""
        return excerpt(self.tag, QUOTED)

    @property
    def content(self) -> str:
        """The text directly inside, without blanks around it."""
        return "".join(self.texts).strip()

    def walk(self) -> Iterator[Element]:
        """Yield this element and every element inside, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))

    def error(self, message: str) -> ReadError:
        """Return an error whose message begins with file and line of this element."""
        return ReadError(f"{self.where}: {message}")

    def all(self, tag: str) -> list[Element]:
        """Return the children with this tag."""
        return [child for child in self.children if child.tag == tag]

    def optional(self, tag: str) -> Element | None:
        """Return the only child with this tag, or None; a second one is an error."""
        found = self.all(tag)
        if len(found) > 1:
            raise found[1].error(f"<{self.shown}> holds a second <{tag}>. Keep one.")
        return found[0] if found else None

    def child(self, tag: str) -> Element:
        """Return the only child with this tag; none or a second one is an error."""
        found = self.optional(tag)
        if found is None:
            raise self.error(f"<{self.shown}> lacks <{tag}>.")
        return found

    def text(self, name: str) -> str:
        """Return the text of an attribute, which must be there and not be empty."""
        value = self.attributes.get(name, "").strip()
        if not value:
            raise self.error(f'<{self.shown}> lacks the attribute {name}="...".')
        if "${" in value or "$(" in value:
            raise self.error(
                f"<{self.shown} {name}>: {quoted(value)} is a xacro expression. Run xacro on the file first."
            )
        return value

    def number(self, name: str) -> float:
        """Return the one finite number that an attribute contains."""
        return self._number(self.text(name), name)

    def numbers(self, name: str, count: int) -> list[float]:
        """Return the `count` finite numbers that an attribute contains."""
        words = self.text(name).split()
        if len(words) != count:
            raise self.error(
                f'<{self.shown} {name}="{excerpt(self.text(name), QUOTED)}">: expected {count} numbers.'
            )
        return [self._number(word, name) for word in words]

    def vector(self, name: str) -> Triple:
        """Return the three finite numbers that an attribute contains; zeros where it is absent."""
        if name not in self.attributes:
            return 0.0, 0.0, 0.0
        x, y, z = self.numbers(name, 3)
        return x, y, z

    def _number(self, word: str, name: str) -> float:
        """Return a word of an attribute as a finite number."""
        value = float(word) if _NUMBER.fullmatch(word) else math.nan
        if not math.isfinite(value):
            raise self.error(f"<{self.shown} {name}>: {quoted(word)} is not a finite number.")
        return value


def parse(text: str, file: str) -> Element:
    """Return the root element of an XML document.

    Args:
        text: The document; its own encoding declaration is ignored.
        file: Name of the file, for messages.

    Raises:
        ReadError: If the text is not well formed, or declares a document type.
    """
    parser = expat.ParserCreate()
    parser.buffer_text = True
    top = Element("", {}, file, 0)
    open_elements = [top]

    def start(tag: str, attributes: dict[str, str]) -> None:
        line = parser.CurrentLineNumber
        element = Element(tag, attributes, f"{file}:{line}", line)
        open_elements[-1].children.append(element)
        open_elements.append(element)

    def end(_: str) -> None:
        open_elements.pop()

    def characters(text: str) -> None:
        if not text.isspace():
            open_elements[-1].texts.append(text)

    def refuse(*_: object) -> None:
        raise ReadError(
            f"{file}:{parser.CurrentLineNumber}: a document type declaration (<!DOCTYPE ...>) can define "
            "entities and refer to other files, so it is not accepted. Delete it."
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        before = text.encode()[: parser.ErrorByteIndex].decode("utf-8", "replace")
        reason = _reason(error.code, text[: len(before) + 2], open_elements[-1])
        raise ReadError(f"{file}:{error.lineno}: not well-formed XML: {reason}.") from None
    return top.children[0]


def _reason(code: int, before: str, inside: Element) -> str:
    """Return why a document is not well formed, with the rule of XML that is broken where it is known.

    Args:
        code: Number of the error in `expat`.
        before: The document up to two characters after the error.
        inside: The element in which the error stands, without a tag at the top.
    """
    message = expat.ErrorString(code)
    if code == expat.errors.codes[expat.errors.XML_ERROR_MISPLACED_XML_PI]:
        return "<?xml ...?> may only stand at the very beginning. Delete the blanks or lines before it"
    _, opened, comment = before.rpartition("<!--")
    if opened and "--" in comment and "-->" not in comment:
        return "a comment may hold '--' only in its end '-->'. Delete one of the hyphens"
    if inside.tag and code in _LEFT_OPEN:
        return f"{message}: <{inside.shown}> of line {inside.line} is not closed"
    return message


_LEFT_OPEN = {
    expat.errors.codes[name]
    for name in (expat.errors.XML_ERROR_TAG_MISMATCH, expat.errors.XML_ERROR_NO_ELEMENTS)
}
"""Errors of `expat` by an element that is not closed."""
