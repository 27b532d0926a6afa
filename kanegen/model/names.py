"""Validation of the names in a model.

System and parameter names become C identifiers. Body and joint names appear in comments, messages and
`freedom_names`, and may also contain dots, hyphens and colons, as robot files do. Every other name is
refused, so that no name from a file reaches C, a path or a shell unchecked.
"""

from __future__ import annotations

import re

from kanegen.errors import ModelError, quoted

MAX_LENGTH = 63
"""Significant characters of an internal identifier in C99, section 5.2.4.1."""

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_LABEL = re.compile(r"[A-Za-z0-9_](?:[A-Za-z0-9_:-]|\.(?!\.))*")

# Keywords of C99, C11, C23 and C++20, and `main`, which the generated example defines.
KEYWORDS = frozenset(
    """
    alignas alignof and and_eq asm atomic_cancel atomic_commit atomic_noexcept auto bitand bitor bool break
    case catch char char8_t char16_t char32_t class compl concept const consteval constexpr constinit
    const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast else enum
    explicit export extern false float for friend goto if inline int long mutable namespace new noexcept not
    not_eq nullptr operator or or_eq private protected public reflexpr register reinterpret_cast requires
    restrict return short signed sizeof static static_assert static_cast struct switch synchronized template
    this thread_local throw true try typedef typeid typename typeof typeof_unqual union unsigned using
    virtual void volatile wchar_t while xor xor_eq main
    """.split()
)


def check_identifier(name: object, label: str) -> str:
    """Return `name` if it can be a C identifier; the message calls it `label`.

    Raises:
        ModelError: If `name` is not an ASCII identifier, is a keyword of C or C++, or is too long.
    """
    rule = "Use letters, digits and underscores, beginning with a letter."
    return _check(name, label, _IDENTIFIER, rule)


def check_label(name: object, label: str) -> str:
    """Return `name` if it can label a body or a joint; the message calls it `label`.

    Raises:
        ModelError: If `name` contains anything but ASCII letters, digits and `_ . - :`, or is a keyword.
    """
    rule = "Use letters, digits, '_', '-', ':' and single dots, beginning with a letter or digit."
    return _check(name, label, _LABEL, rule)


def usable_label(name: str) -> str:
    """Return a label for a body or joint of a robot file: forbidden characters become underscores."""
    name = re.sub(r"[^A-Za-z0-9_.:-]|\.(?=\.)", "_", name)
    return _without_keyword(name if re.match(r"[A-Za-z0-9_]", name) else f"_{name}")


def usable_identifier(name: str) -> str:
    """Return an identifier for a robot file's system: `robot` where the file has no name."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", name) or "robot"
    return _without_keyword(name if re.match(r"[A-Za-z]", name) else f"robot_{name}")[:MAX_LENGTH]


def _without_keyword(name: str) -> str:
    """Return `name`, with an underscore at its end if it is a keyword."""
    return f"{name}_" if name in KEYWORDS else name


def _check(name: object, label: str, pattern: re.Pattern[str], rule: str) -> str:
    """Return `name` if it is a string that fits `pattern`, no keyword and not too long."""
    if not isinstance(name, str):
        raise ModelError(f"{label}: {quoted(name)} is not a string.")
    if not name:
        raise ModelError(f"{label} is empty. {rule}")
    if len(name) > MAX_LENGTH:
        raise ModelError(f"{label}: {quoted(name)} is longer than {MAX_LENGTH} characters.")
    if not pattern.fullmatch(name):
        raise ModelError(f"{label}: {quoted(name)} cannot be used. {rule}")
    if name in KEYWORDS:
        raise ModelError(f"{label}: {quoted(name)} is a keyword of C or C++. Choose another name.")
    return name
