"""Names in a model: their rules, and the identifiers that generated code derives from them.

Bodies, joints, points, frames and the system itself have the names that people and robot files give them, in
any script. They appear in messages, results and comments. A parameter is a variable of expressions and of
the generated code, so its name is an identifier. Where the generated code needs an identifier for a system,
`identifier` derives it from the name. So no name from a file reaches C, a path or a shell as it is.
"""

from __future__ import annotations

import hashlib
import re
import unicodedata

from kanegen.errors import ModelError, quoted

MAX_IDENTIFIER = 63
"""Significant characters of an internal identifier in C99, section 5.2.4.1."""

MAX_LABEL = 10_000
"""Largest number of characters of any other name."""

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

_DIGEST = 6
"""Number of hexadecimal digits that tell identifiers of similar names apart."""

_JOINERS = frozenset(("\u200c", "\u200d", *map(chr, range(0xE0020, 0xE0080))))
"""Invisible characters that belong to words of some scripts and to emoji."""

_INVISIBLE = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))
"""Categories of control characters, marks of direction, surrogates and line ends."""

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

FILES_OF_C = frozenset(
    """
    assert complex ctype errno features fenv float inttypes iso646 kanegen_double_double
    kanegen_device kanegen_elementary kanegen_elementary_dd kanegen_elementaryf kanegen_elementaryl
    kanegen_simd kanegen_simdf kanegen_sincos kanegen_sincosf limits locale main malloc math memory
    pthread sched setjmp signal stdalign stdarg stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib
    stdnoreturn string strings tgmath threads time uchar unistd wchar wctype
    """.split()
)
"""Names, in lower case, of headers of the C library, of the example, and of headers that stand beside
generated code: a file of this name would hide one of them."""


def check_identifier(name: object, label: str) -> str:
    """Return `name` if it can be a C identifier; the message calls it `label`.

    Raises:
        ModelError: If `name` is not an ASCII identifier, is a keyword of C or C++, or is too long.
    """
    name = _text(name, label, MAX_IDENTIFIER)
    if not _IDENTIFIER.fullmatch(name):
        rule = "Use letters, digits and underscores, beginning with a letter."
        raise ModelError(f"{label}: {quoted(name)} cannot be used. {rule}")
    if name in KEYWORDS:
        raise ModelError(f"{label}: {quoted(name)} is a keyword of C or C++. Choose another name.")
    return name


def check_label(name: object, label: str) -> str:
    """Return `name` if it can name a system, a body, a joint, a point or a frame, which text in one line can.

    The message calls it `label`.

    Raises:
        ModelError: If `name` is blank, too long, or contains a control character.
    """
    name = _text(name, label, MAX_LABEL)
    if not name.strip():
        raise ModelError(f"{label}: {quoted(name)} is blank. Choose a name.")
    for character in name:
        if unicodedata.category(character) in _INVISIBLE and character not in _JOINERS:
            raise ModelError(
                f"{label}: {quoted(name)} contains the invisible character U+{ord(character):04X}. Delete it."
            )
    return name


def identifier(name: str) -> str:
    """Return the C identifier of a name: the name itself if it can be one, else one that is derived from it.

    It cannot if it is a keyword, or if a header of this name would hide another one. A derived identifier has
    the letters and digits of the name, and six hexadecimal digits by which the identifiers of different names
    differ. It depends on nothing but the name.

    Example:
        identifier("arm")  # 'arm'
        identifier("2-link arm")  # 'model_2_link_arm_', then six digits
    """
    is_identifier = len(name) <= MAX_IDENTIFIER and _IDENTIFIER.fullmatch(name)
    if is_identifier and name not in KEYWORDS and name.lower() not in FILES_OF_C:
        return name
    letters = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii")
    readable = re.sub(r"[^A-Za-z0-9]+", "_", letters).strip("_")
    if not readable[:1].isalpha():
        readable = f"model_{readable}".rstrip("_")
    digest = hashlib.sha256(name.encode("utf-8", "surrogatepass")).hexdigest()[:_DIGEST]
    return f"{readable[: MAX_IDENTIFIER - _DIGEST - 1]}_{digest}"


def _text(name: object, label: str, longest: int) -> str:
    """Return `name` if it is a string that is neither empty nor too long."""
    if not isinstance(name, str):
        raise ModelError(f"{label}: {quoted(name)} is not a string.")
    if not name:
        raise ModelError(f"{label} is empty. Choose a name.")
    if len(name) > longest:
        raise ModelError(f"{label}: {quoted(name)} is longer than {longest} characters.")
    return name
