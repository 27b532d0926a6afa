"""Names of variables under the structured naming convention of FMI 2.0 and 3.0."""

from __future__ import annotations

import re

from kanegen.model.quoting import shortened

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

_OUTSIDE = re.compile(r"""[^A-Za-z0-9_!$&()*+,\-./:;<>=@\[\]^|~ ]""")
"""Characters that the convention does not allow between apostrophes, or that C or a log reads otherwise."""


def dotted(*parts: str) -> str:
    """Return parts with dots between them; a part that is no identifier stands between apostrophes.

    Points in names of freedoms, such as "bus.theta1", separate parts, too. A character that the convention
    does not allow becomes its number, such as {U+E4}.

    Example:
        dotted("x", "bus.theta1")  # "x.bus.theta1"
        dotted("force", "left leg")  # "force.'left leg'"
    """
    return ".".join(_part(part) for part in parts)


def _part(name: str) -> str:
    """Return a name as one or several parts of a dotted name."""
    if all(_IDENTIFIER.fullmatch(one) for one in name.split(".")):
        return name
    inside = _OUTSIDE.sub(lambda found: f"{{U+{ord(found[0]):X}}}", shortened(name))
    return f"'{inside}'"
