"""How the C of the contestants is compiled."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.options import STRICT


@dataclass(frozen=True)
class Setting:
    """Flags of a compiler and what they are called."""

    name: str
    flags: tuple[str, ...]


EXACT = Setting("exact", STRICT.flags)
"""kanegen's default."""

NATIVE = Setting("native", ("-O3", "-march=native"))
"""What everybody gets: for this processor; the compiler may fuse a product and a sum."""

RELAXED = Setting(
    "relaxed",
    (
        "-O3",
        "-march=native",
        "-ffp-contract=fast",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-fno-signed-zeros",
        "-fassociative-math",
    ),
)
"""Nothing here changes the floating-point environment of the process, as -ffast-math does when linking."""

AS_SHIPPED = Setting("as shipped", ("-O2",))
"""For drivers of a library that comes compiled."""

SETTINGS = (EXACT, NATIVE, RELAXED, AS_SHIPPED)
