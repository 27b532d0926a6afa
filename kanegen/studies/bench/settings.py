"""Compiler settings of the programs that are compared, and the vector instructions that they allow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from kanegen.measure.machine import AVX2, AVX512, baseline, widest
from kanegen.options import STRICT

_MARCH_AVX2 = "-march=x86-64-v3"
"""Flag of gcc and clang for all x86-64 processors with AVX2, without AVX-512."""


@dataclass(frozen=True)
class Setting:
    """Compiler flags and the name under which they are reported.

    Attributes:
        name: Name of the setting.
        flags: Flags of gcc and clang.
        instructions: Widest vector instructions that the flags allow on the machine of the times, such as
            AVX2.
    """

    name: str
    flags: tuple[str, ...]
    instructions: str = field(default="", compare=False)

    @property
    def words(self) -> str:
        """The name and the vector instructions, as in "native, AVX-512"."""
        named = self.instructions and self.instructions not in self.name
        return f"{self.name}, {self.instructions}" if named else self.name


def _setting(name: str, *flags: str) -> Setting:
    """Return a setting with the vector instructions that its flags allow here."""
    if "-march=native" in flags:
        return Setting(name, flags, widest())
    return Setting(name, flags, AVX2 if _MARCH_AVX2 in flags else baseline())


def _on_avx2(name: str, flags: Sequence[str]) -> Setting:
    """Return the setting that code for this processor has on a processor with AVX2 only."""
    return _setting(name, *(_MARCH_AVX2 if flag == "-march=native" else flag for flag in flags))


PORTABLE = _setting("portable", *STRICT.flags)
"""The setting of code that `kanegen generate` writes for every processor of the architecture."""

DEFAULT = _setting("default", *STRICT.flags_here)
"""The setting of `kanegen.build`: code for this processor with the bits of portable code."""

DEFAULT_AVX2 = _on_avx2("default, AVX2", STRICT.flags_here)
"""What `kanegen.build` takes on a processor with AVX2."""

NATIVE = _setting("native", "-O3", "-march=native")
"""The setting of every program: code for this processor, which may fuse a product and a sum."""

NATIVE_AVX2 = _on_avx2("native, AVX2", NATIVE.flags)
"""The setting of every program on a processor with AVX2."""

AS_SHIPPED = _setting("as shipped", "-O2")
"""The setting of drivers for a library that is installed in compiled form, and chooses instructions
itself."""

COMPILED_BY_XLA = Setting("compiled by XLA", (), widest())
"""The setting of functions that JAX compiles for this processor while the program runs."""

SETTINGS = (DEFAULT, DEFAULT_AVX2, PORTABLE, NATIVE, NATIVE_AVX2, AS_SHIPPED, COMPILED_BY_XLA)
"""All settings, in the order of the documentation."""


def here(settings: Sequence[Setting]) -> list[Setting]:
    """Return those settings that make other code on this machine than the rest of `SETTINGS`.

    Settings for AVX2 are left out where the processor has no wider instructions, since native code is that
    for AVX2 there, and where it has none at all.
    """
    narrower = (DEFAULT_AVX2, NATIVE_AVX2)
    return [one for one in settings if one not in narrower or widest() == AVX512]
