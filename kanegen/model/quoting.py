"""Texts of a model, such as names of bodies, as parts of other languages: comments of C, Markdown, Python.

Whatever a name contains, it ends no comment, no code span and no string, and it appears as it is wherever the
other language can show it.
"""

from __future__ import annotations

import re

_IN_COMMENT = re.compile(r"[^ -~]|[\\@]|\*(?=/)|(?<=\*)/|/(?=\*)|(?<=/)\*|\?(?=\?)|(?<=\?)\?")
"""Characters that C, its preprocessor or Doxygen could read in a comment, and all that are not ASCII."""

LONGEST = 480
"""Largest number of characters of a name in generated files; of a longer one, beginning and end are shown."""


def shortened(text: str) -> str:
    """Return a text of at most `LONGEST` characters, or the beginning and the end of a longer one.

    Example:
        shortened("arm")  # 'arm'
    """
    half = LONGEST // 2
    return text if len(text) <= LONGEST else f"{text[:half]}...{text[-half:]}"


def c_comment(text: str) -> str:
    r"""Return a text as part of a comment in C, in ASCII; another character becomes `\u{...}`.

    Example:
        c_comment("左腿 */")  # '\\u{5de6}\\u{817f} \\u{2a}\\u{2f}'
    """
    return _IN_COMMENT.sub(lambda found: rf"\u{{{ord(found[0]):x}}}", text)


def c_name(name: str) -> str:
    """Return a name of any length as part of a comment in C.

    Example:
        c_name("left leg")  # 'left leg'
    """
    return c_comment(shortened(name))


def markdown_code(text: str) -> str:
    """Return a text as a code span of Markdown that may stand in a cell of a table.

    Example:
        markdown_code("arm.theta1")  # '`arm.theta1`'
    """
    text = shortened(text).replace("|", r"\|")
    fence = "`" * (max(map(len, re.findall("`+", text)), default=0) + 1)
    blank = " " if len(fence) > 1 else ""
    return f"{fence}{blank}{text}{blank}{fence}"


def markdown(text: str) -> str:
    r"""Return a text for a heading, a paragraph or a cell of a table in Markdown.

    Example:
        markdown("a|b")  # 'a\|b'
    """
    return re.sub(r"([\\`*<>|\[\]#&$]|(?<![A-Za-z0-9])_|_(?![A-Za-z0-9]))", r"\\\1", shortened(text))


def python_text(text: str) -> str:
    r"""Return a text as part of a string in Python between double quotes, one or three.

    Example:
        python_text('a"b')  # 'a\\"b'
    """
    return text.replace("\\", r"\\").replace('"', r"\"")


def c_text(text: str) -> str:
    r"""Return a text as part of a string in C between double quotes, in ASCII; its bytes are those of UTF-8.

    Example:
        c_text('a"b\u00e9')  # 'a\\"b\\303\\251'
    """
    escaped = {"\\": r"\\", '"': r"\"", "?": r"\?"}
    return "".join(
        escaped.get(one, one) if " " <= one <= "~" else "".join(f"\\{byte:03o}" for byte in one.encode())
        for one in shortened(text)
    )


def matlab_text(text: str) -> str:
    """Return a text as part of a string in MATLAB between single quotes.

    Example:
        matlab_text("Kane's")  # "Kane''s"
    """
    return text.replace("'", "''")
