"""Bytes of a file as text: UTF-8, or in XML the encoding that the file declares.

An XML file says its encoding by a byte order mark, or in its first line as `<?xml version="1.0"
encoding="..."?>`; without either it is UTF-8 (XML 1.0, section 4.3.3). Every encoding of text that Python
knows is read.
"""

from __future__ import annotations

import codecs
import re

from kanegen.errors import ReadError, quoted

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks with their encodings; a longer mark stands before one with which it begins."""

_WIDE = ((b"<\0?\0", "utf-16-le"), (b"\0<\0?", "utf-16-be"))
"""Beginnings of an XML declaration in two bytes a character, without a byte order mark."""

_DECLARATION = re.compile(rb"""\s*<\?xml\s[^>]*?\bencoding\s*=\s*["']([A-Za-z][A-Za-z0-9._-]*)["']""")

_SUPERSETS = {"gb2312": "gb18030", "gbk": "gb18030"}
"""Encodings that are declared although a larger one is meant, by the names of Python."""

_NO_TEXT = frozenset(("idna", "punycode", "unicode-escape", "raw-unicode-escape", "utf-7", "undefined"))
"""Codecs that are no encodings of files."""


def utf8_text(data: bytes, file: str) -> str:
    """Return UTF-8 as text, without a byte order mark.

    Args:
        data: The content of the file.
        file: Name of the file, for messages.

    Raises:
        ReadError: If it is not UTF-8; the message has the line.
    """
    return _decoded(data.removeprefix(codecs.BOM_UTF8), "utf-8", file, "Save the file as UTF-8.")


def xml_text(data: bytes, file: str) -> str:
    """Return an XML document as text, in the encoding that it declares, without a byte order mark.

    Args:
        data: The content of the file.
        file: Name of the file, for messages.

    Raises:
        ReadError: If the encoding is unknown, or the content is not in it; the message has the line.
    """
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return _decoded(data.removeprefix(mark), encoding, file, f"Its first bytes declare {encoding}.")
    for beginning, encoding in _WIDE:
        if data.startswith(beginning):
            return _decoded(data, encoding, file, f"Its first bytes are those of {encoding}.")
    declared = _DECLARATION.match(data)
    if not declared:
        remedy = 'Save it as UTF-8, or declare its encoding: <?xml version="1.0" encoding="..."?>.'
        return _decoded(data, "utf-8", file, remedy)
    name = declared[1].decode("ascii")
    line = data[: declared.start(1)].count(b"\n") + 1
    return _decoded(
        data, _codec(name, f"{file}:{line}"), file, f"This is the encoding that line {line} declares."
    )


def _codec(name: str, where: str) -> str:
    """Return Python's name of a declared encoding, in which a declaration is ASCII."""
    try:
        info = codecs.lookup(name)
    except LookupError:
        info = None
    if info is None or info.name in _NO_TEXT or not getattr(info, "_is_text_encoding", True):
        raise ReadError(f"{where}: the encoding {quoted(name)} is unknown. Save the file as UTF-8.")
    if "<?xml".encode(info.name) != b"<?xml":
        raise ReadError(
            f"{where}: the file declares {quoted(name)} but is not in it. Declare UTF-8 if it is that."
        )
    return _SUPERSETS.get(info.name, info.name)


def _decoded(data: bytes, encoding: str, file: str, remedy: str) -> str:
    """Return bytes as text; `remedy` ends the message if they are not in the encoding."""
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        line = data[: error.start].decode(encoding, "replace").count("\n") + 1
        byte, name = data[error.start], encoding.upper()
        raise ReadError(f"{file}:{line}: byte 0x{byte:02x} is not {name}. {remedy}") from None
