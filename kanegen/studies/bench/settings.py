"""Compiler settings of the programs that are compared, and the vector instructions that they allow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from kanegen.library.native import compilers, selftest
from kanegen.measure.machine import AVX2, AVX512, baseline, widest
from kanegen.options import STRICT
from kanegen.program.semantics import guaranteed_properties

_MARCH_AVX2 = "-march=x86-64-v3"
"""Flag of gcc and clang for all x86-64 processors with AVX2, without AVX-512."""


@dataclass(frozen=True)
class Setting:
    """Compiler flags and the name under which they are reported; settings of one name are the same.

    Attributes:
        name: Name of the setting.
        flags: Flags of gcc and clang.
        instructions: Widest vector instructions that the flags allow on the machine of the times, such as
            AVX2.
    """

    name: str
    flags: tuple[str, ...] = field(compare=False)
    instructions: str = field(default="", compare=False)

    @property
    def words(self) -> str:
        """The name and the vector instructions, as in "contracted, AVX-512"."""
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

CONTRACTED = _setting("contracted", "-O3", "-march=native")
"""The setting of every program: code for this processor in which the compiler may contract a product and a
sum to one instruction, which rounds once, so that the last bits of results change."""

CONTRACTED_AVX2 = _on_avx2("contracted, AVX2", CONTRACTED.flags)
"""The setting of every program on a processor with AVX2."""

AS_SHIPPED = _setting("as shipped", "-O2")
"""The setting of drivers for a library that is installed in compiled form, and chooses instructions
itself."""

COMPILED_BY_XLA = Setting("compiled by XLA", (), widest())
"""The setting of functions that JAX compiles for this processor while the program runs."""

SETTINGS = (DEFAULT, DEFAULT_AVX2, PORTABLE, CONTRACTED, CONTRACTED_AVX2, AS_SHIPPED, COMPILED_BY_XLA)
"""All settings, in the order of the documentation."""

MEANINGS = {
    DEFAULT.name: "what `kanegen.build` takes here, with the bits of portable code",
    DEFAULT_AVX2.name: "what it takes on a processor with AVX2",
    PORTABLE.name: "code for every processor of the architecture, which `kanegen generate` writes",
    CONTRACTED.name: "code for this processor that may fuse products and sums, which changes the last bits",
    CONTRACTED_AVX2.name: "the same for processors with AVX2",
    AS_SHIPPED.name: "a library in compiled form; the flags are those of the C that calls it",
    COMPILED_BY_XLA.name: "functions that JAX compiles while the program runs",
}
"""What the compiler settings mean, by name."""


def here(settings: Sequence[Setting]) -> list[Setting]:
    """Return those settings that make other code on this machine than the rest of `SETTINGS`.

    Settings for AVX2 are left out where the processor has no wider instructions, since code for this
    processor is that for AVX2 there, and where it has none at all. Settings with the bits of portable code
    have the flags that the compiler needs for them, as in `kanegen.build`.

    Raises:
        BuildError: If there is no C compiler, or it fails.
    """
    narrower = (DEFAULT_AVX2, CONTRACTED_AVX2)
    chosen = [one for one in settings if one not in narrower or widest() == AVX512]
    return [keeping_bits(one) if one in (DEFAULT, DEFAULT_AVX2, PORTABLE) else one for one in chosen]


def keeping_bits(setting: Setting) -> Setting:
    """Return a setting with the flags that the compiler of this machine needs for strict arithmetic.

    Raises:
        BuildError: If there is no C compiler, or it fails.
    """
    strict = frozenset(guaranteed_properties(STRICT.semantics))
    return replace(setting, flags=selftest.with_remedies(compilers.find(), setting.flags, strict))
