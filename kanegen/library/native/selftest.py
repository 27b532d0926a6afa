"""The test of a compiler's floating-point arithmetic with some flags, by a small program that is run.

Some compilers drop the rounding to float of two neighbouring stores (gcc 12 from -O2 on), fuse products and
sums that stand side by side although they are told not to (gcc 12.2 where the processor can), compile tests
for NaN away, or switch subnormal numbers off. A library is built only where every property that its variant
promises holds.
"""

from __future__ import annotations

import functools
import shlex
from collections.abc import Set
from contextlib import suppress
from pathlib import Path

from kanegen.artifacts.selftest import selftest_text
from kanegen.c import Source
from kanegen.errors import BuildError
from kanegen.library.native import cache, commands, compilers, processor
from kanegen.program.semantics import NARROWING, OWN_ROUNDING, UNFUSED, guaranteed_properties

REMEDIES: dict[str, tuple[str, ...]] = dict.fromkeys((NARROWING, OWN_ROUNDING), (UNFUSED,))
"""Compiler flags that restore a property of arithmetic, by property."""

_PROGRAM = "selftest"
"""Name of the program."""

_RESULT = "properties"
"""File of the cache entry that holds the output of the program."""

_TIME_LIMIT = 120.0
"""Time limit of the compiler and of the program, s."""


def sound_flags(compiler: compilers.Compiler, source: Source) -> tuple[str, ...]:
    """Return compiler flags with which `compiler` keeps the properties that the variant of `source` promises.

    They are those for this machine, or portable ones where the compiler does not know this machine.

    Raises:
        BuildError: If there are no such flags.
    """
    variant = source.variant
    flags = variant.flags_here if _compiles(compiler, variant.flags_here) else variant.flags
    wanted = set(guaranteed_properties(source.variant.semantics))
    if any("(float)" in text for file, text in source.code.items() if file.endswith((".c", "_version.h"))):
        wanted.add(NARROWING)
    flags = with_remedies(compiler, flags, wanted)
    if missing := wanted - properties(compiler, flags):
        raise BuildError(
            f"{shlex.join(compiler.command)} with {shlex.join(flags)} does not keep: "
            f"{', '.join(sorted(missing))}. Name another compiler, or semantics that do without."
        )
    return flags


def with_remedies(compiler: compilers.Compiler, flags: tuple[str, ...], wanted: Set[str]) -> tuple[str, ...]:
    """Return `flags` with remedies for those properties `wanted` that `compiler` gives up otherwise.

    Raises:
        BuildError: If the compiler fails, or its program does not run.
    """
    missing = wanted - properties(compiler, flags)
    return (*flags, *dict.fromkeys(flag for name in sorted(missing) for flag in REMEDIES.get(name, ())))


def _compiles(compiler: compilers.Compiler, flags: tuple[str, ...]) -> bool:
    """Whether `compiler` makes a program that runs with `flags`."""
    with suppress(BuildError):
        return bool(properties(compiler, flags))
    return False


def require(compiler: compilers.Compiler, flags: tuple[str, ...], wanted: frozenset[str]) -> None:
    """Make sure that `compiler` keeps the properties `wanted` with `flags`.

    Raises:
        BuildError: If a property is missing.
    """
    missing = wanted - properties(compiler, flags) if wanted else None
    if missing:
        raise BuildError(
            f"{shlex.join(compiler.command)} with {shlex.join(flags)} does not keep: "
            f"{', '.join(sorted(missing))}, which this precision needs. Give up -ffast-math and its parts, "
            "and have -ffp-contract=off."
        )


@functools.cache
def properties(compiler: compilers.Compiler, flags: tuple[str, ...]) -> frozenset[str]:
    """Return the properties of arithmetic that `compiler` keeps with `flags`, a line each of `selftest.c`.

    Raises:
        BuildError: If the compiler fails, or its program does not run.
    """
    text = selftest_text()

    def examine(folder: Path) -> None:
        (folder / f"{_PROGRAM}.c").write_text(text, encoding="utf-8")
        command = [*compiler.command, "-std=c99", *flags, f"{_PROGRAM}.c", "-o", _PROGRAM, "-lm"]
        commands.make(command, _PROGRAM, folder, _TIME_LIMIT)
        (folder / _RESULT).write_text(_printed(folder / _PROGRAM, compiler))
        (folder / _PROGRAM).unlink()

    name = cache.key((text, compiler.fingerprint, processor.fingerprint(), *flags))
    return frozenset(cache.use(name, _RESULT, examine, Path.read_text).splitlines())


def _printed(program: Path, compiler: compilers.Compiler) -> str:
    """Return the output of the program.

    Raises:
        BuildError: If the program does not run, fails or takes too long.
    """
    try:
        return commands.output([program], seconds=_TIME_LIMIT)
    except commands.CommandError as error:
        raise BuildError(
            f"a small test program of {shlex.join(compiler.command)} does not run: {error} Does the "
            "compiler make code for this machine?"
        ) from error
