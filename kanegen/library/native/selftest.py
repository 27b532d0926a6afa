"""What a compiler makes of floating-point arithmetic with given flags, found out by running a small program.

Compilers have been seen to drop the rounding to float of two neighbouring stores (gcc 12 from -O2 on), to
compile NaN tests away, and to switch subnormal numbers off. Code is only built where what its variant
promises holds.
"""

from __future__ import annotations

import shlex
import subprocess
from functools import cache as remembered
from pathlib import Path

from kanegen.c import Source
from kanegen.c.templates import fill
from kanegen.errors import BuildError
from kanegen.library.native import cache, compilers
from kanegen.program.semantics import NARROWING, promised

MENDS: dict[str, tuple[str, ...]] = {NARROWING: ("-fno-tree-slp-vectorize",)}
"""Flags that bring a property back where it is missing."""

_PROGRAM = "selftest"
_RESULT = "properties"
_PATIENCE = 60.0


def honest(compiler: compilers.Compiler, source: Source) -> tuple[str, ...]:
    """Flags by which `compiler` keeps what the variant of `source` promises.

    Raises:
        BuildError: If there are none.
    """
    flags = source.variant.flags
    wanted = set(promised(source.variant.semantics))
    if any("(float)" in text for file, text in source.files.items() if file.endswith(".c")):
        wanted.add(NARROWING)
    missing = wanted - properties(compiler, flags)
    mends = tuple(flag for name in sorted(missing) for flag in MENDS.get(name, ()))
    if mends:
        flags += mends
        missing = wanted - properties(compiler, flags)
    if missing:
        raise BuildError(
            f"{shlex.join(compiler.command)} with {shlex.join(flags)} does not keep: "
            f"{', '.join(sorted(missing))}. Name another compiler, or semantics that do without."
        )
    return flags


def require(compiler: compilers.Compiler, flags: tuple[str, ...], wanted: frozenset[str]) -> None:
    """See that `compiler` keeps some properties with `flags`.

    Raises:
        BuildError: If it does not.
    """
    missing = wanted - properties(compiler, flags) if wanted else None
    if missing:
        raise BuildError(
            f"{shlex.join(compiler.command)} with {shlex.join(flags)} does not keep: "
            f"{', '.join(sorted(missing))}, which this precision needs. Give up -ffast-math and its parts, "
            "and have -ffp-contract=off."
        )


@remembered
def properties(compiler: compilers.Compiler, flags: tuple[str, ...]) -> frozenset[str]:
    """Lines that `selftest.c` prints, compiled with `flags`.

    Raises:
        BuildError: If the compiler fails, or its program does not run.
    """
    text = fill("selftest.c")

    def examine(folder: Path) -> None:
        (folder / f"{_PROGRAM}.c").write_text(text, encoding="utf-8")
        command = [*compiler.command, "-std=c99", *flags, f"{_PROGRAM}.c", "-o", _PROGRAM, "-lm"]
        compilers.make(command, _PROGRAM, folder)
        (folder / _RESULT).write_text(_printed(folder / _PROGRAM, compiler))
        (folder / _PROGRAM).unlink()

    entry = cache.entry(cache.key((text, compiler.identity, *flags)), examine)
    return frozenset((entry / _RESULT).read_text().splitlines())


def _printed(program: Path, compiler: compilers.Compiler) -> str:
    try:
        result = subprocess.run([program], capture_output=True, text=True, timeout=_PATIENCE, check=True)
    except (OSError, subprocess.SubprocessError) as error:
        raise BuildError(
            f"a small test program of {shlex.join(compiler.command)} does not run: {error}. Does the "
            "compiler make code for this machine?"
        ) from error
    return result.stdout
