"""How a function for one state differs from one for several states side by side.

The statements are the same; types, functions, and how a value that must be positive is watched are not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.program.ir import Array


@dataclass(frozen=True)
class Dialect:
    """Words of the C functions of one kind.

    Attributes:
        number: Type of a value that differs between states.
        prefix: Start of the names of functions of such values.
        reserved: Names that no local may take.
        opening: Begins a function that watches values.
    """

    number: str
    prefix: str
    reserved: frozenset[str]
    opening: str

    @property
    def is_scalar(self) -> bool:
        """Whether it is for one state."""
        return not self.prefix

    def everywhere(self, text: str) -> str:
        """An expression that is the same in all states, as one of type `number`."""
        return text if self.is_scalar else f"{self.prefix}of({text})"

    def condition(self, text: str, place: int) -> str:
        """Watch the value `text`; the first to be computed that is not positive decides."""
        if self.is_scalar:
            return f"if (!failed && !({text} > 0.0)) failed = {place};"
        return f"good &= {self.prefix}positive({text});"

    def closing(self, spoilt: Sequence[Array]) -> list[str]:
        """End a function that watches values; `spoilt` are the outputs that may not hold."""
        if not self.is_scalar:
            return ["    return good;"]
        lines = []
        for array in spoilt:
            lines += [
                f"    for (int i = 0; failed && i < {array.size}; ++i) {{",
                f"        {array.name}[i] = (double)NAN;",
                "    }",
            ]
        return [*lines, "    return failed;"]


SCALAR = Dialect("double", "", frozenset({"sin", "cos", "sqrt", "failed", "i"}), "    int failed = 0;")
"""One state: doubles, and the functions of libm."""

LANES = Dialect(
    "lanes",
    "lanes_",
    SCALAR.reserved
    | {"lanes", "good", *(f"lanes_{f}" for f in ("sin", "cos", "sincos", "sqrt", "of", "positive"))},
    "    lanes_bits good = ~(lanes_bits){0};",
)
"""Several states: the types and functions of kanegen_lanes.h."""
