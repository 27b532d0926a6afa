"""Identifiers in other languages for the names of a model, which may be any text in any script.

`identifiers` makes one for each of several names, such as the members of a structure. A name that can be an
identifier of the language stays as it is.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from kanegen.choices import require_one
from kanegen.model.names import KEYWORDS, MAX_IDENTIFIER

_IDENTIFIER = re.compile(r"(?!.*__)[A-Za-z][A-Za-z0-9_]*")
"""An identifier of every language; C++ reserves those with two underscores in a row."""

_MACROS = frozenset(
    """
    EOF FALSE I INFINITY NAN NULL PI TRUE assert complex errno far huge imaginary interface linux near
    noreturn small stderr stdin stdout unix
    """.split()
)
"""Names that headers of C, compilers, Windows or Arduino define as macros, which no member can have there."""

RESERVED: dict[str, frozenset[str]] = {
    "c": KEYWORDS | _MACROS,
    "rust": frozenset(
        """
        Self abstract as async await become box break const continue crate do dyn else enum extern false
        final fn for gen if impl in let loop macro match mod move mut override priv pub ref return self
        static struct super trait true try type typeof union unsafe unsized use virtual where while yield
        """.split()
    ),
    "typescript": frozenset(
        """
        abstract any arguments as async await bigint boolean break case catch class const constructor
        continue debugger declare default delete do else enum eval export extends false finally for from
        function get if implements import in infer instanceof interface is keyof let module namespace never
        new null number object of package private protected prototype public readonly require return set
        static string super switch symbol this throw toString true try type typeof undefined unique unknown
        valueOf var void while with yield
        """.split()
    ),
    "octave": frozenset(
        """
        __FILE__ __LINE__ break case catch classdef continue do else elseif end end_try_catch
        end_unwind_protect endclassdef endenumeration endevents endfor endfunction endif endmethods endparfor
        endproperties endswitch endwhile enumeration events for function global if methods otherwise parfor
        persistent properties return spmd switch try until unwind_protect unwind_protect_cleanup while
        """.split()
    ),
    "python": frozenset(
        """
        False None True and as assert async await break case class continue def del elif else except finally
        for from global if import in is lambda match nonlocal not or pass raise return try type while with
        yield
        """.split()
    ),
}
"""Words by language that no identifier may be: keywords, and names that have a meaning of their own.

"c" is for C and C++ together, "typescript" for JavaScript, too, and "octave" for MATLAB.
"""


def identifiers(names: Iterable[str], language: str) -> tuple[str, ...]:
    """Return an identifier for each name, all different: the name itself where it can be one.

    From another name the letters and digits are taken, with an underscore for what stands between them and
    "name" where nothing is left or a digit comes first. A reserved word gets an underscore at its end, and
    the second of two equal identifiers the end "_2". An identifier has at most 63 characters.

    Args:
        names: Names of any kind, such as those of the freedoms.
        language: A key of `RESERVED`.

    Raises:
        OptionError: If the language is unknown.

    Example:
        identifiers(["elbow", "arm.theta1", "arm theta1", "for", "2nd"], "c")
        # ('elbow', 'arm_theta1', 'arm_theta1_2', 'for_', 'name_2nd')
    """
    require_one("language", language, RESERVED)
    listed = list(names)
    as_they_are = {name for name in listed if _is_identifier(name, language)}
    found: list[str] = []
    taken = set(as_they_are)
    for name in listed:
        one = name if name in as_they_are and name not in found else _derived(name, language, taken)
        taken.add(one)
        found.append(one)
    return tuple(found)


def _is_identifier(name: str, language: str) -> bool:
    """Return whether a name can be an identifier of a language as it is."""
    return (
        len(name) <= MAX_IDENTIFIER
        and _IDENTIFIER.fullmatch(name) is not None
        and name not in RESERVED[language]
    )


def _derived(name: str, language: str, taken: set[str]) -> str:
    """Return an identifier that is made from a name and is none of those that are taken."""
    letters = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii")
    readable = re.sub(r"[^A-Za-z0-9]+", "_", letters).strip("_")
    if not readable[:1].isalpha():
        readable = f"name_{readable}".rstrip("_")
    one, number = readable[:MAX_IDENTIFIER].rstrip("_"), 1
    if one in RESERVED[language]:
        one = f"{one}_"
    stem = one
    while one in taken:
        number += 1
        end = f"_{number}" if not stem.endswith("_") else str(number)
        one = f"{stem[: MAX_IDENTIFIER - len(end)]}{end}"
    return one
