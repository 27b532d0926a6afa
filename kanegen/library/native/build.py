"""From C to a shared library on disk."""

from __future__ import annotations

import platform
import shlex
import sys
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.c import Source
from kanegen.errors import BuildError, KanegenWarning
from kanegen.library.native import cache, compilers, selftest
from kanegen.program import precision as precisions
from kanegen.program import semantics
from kanegen.program.precision import LONG_DOUBLE

_CALLER = 5
"""Frames from a warning here to the line that called `kanegen.build`."""

_ALWAYS = ("-std=c99", "-fPIC")
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def build(
    source: Source,
    compiler: str | None = None,
    flags: str | Sequence[str] | None = None,
    threads: bool = False,
) -> Path:
    """Compile `source`, its files at the same time, unless the cache has it already.

    Args:
        source: From `kanegen.generate`.
        compiler: Command of a compiler that takes gcc's options; default `$KANEGEN_CC`, `$CC`, cc, gcc,
            clang, or that of the package ziglang.
        flags: Instead of those of its variant, one by one or as a shell would have them.
        threads: Let OpenMP share large batches among threads. A compiler without it brings a
            `KanegenWarning`, and one thread.

    Returns:
        The shared library.

    Raises:
        BuildError: If there is no compiler, it fails or does not keep what the variant promises, or the
            cache folder cannot be used.
    """
    found = compilers.find(compiler)
    chosen = selftest.honest(found, source) if flags is None else _split(flags)
    _require_digits(source)
    selftest.require(found, chosen, precisions.named(source.precision).needs)
    if threads:
        chosen += _openmp(found)
    texts = {file: text for file, text in source.files.items() if _is_code(file)}
    library = f"lib{source.model.name}{_SUFFIX}"
    start = (*found.command, *_ALWAYS, *chosen)
    objects = {file: f"{file}.o" for file in texts if file.endswith(".c")}
    compile_ = [[*start, "-c", file, "-o", object_] for file, object_ in objects.items()]
    link = [*semantics.linking(start), "-shared", "-o", library, *objects.values(), "-lm"]

    def fill(folder: Path) -> None:
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8", newline="\n")
        with ThreadPoolExecutor() as pool:
            list(pool.map(lambda command: compilers.make(command, command[-1], folder), compile_))
        compilers.make(link, library, folder)
        for object_ in objects.values():
            (folder / object_).unlink()

    parts = (*texts.values(), found.identity, *link, *_machine(chosen))
    return cache.entry(cache.key(parts), fill) / library


def bits(dtype: np.dtype[Any]) -> int:
    """Bits of the significand of a type on this platform."""
    return int(np.finfo(dtype).nmant) + 1


def _require_digits(source: Source) -> None:
    """Refuse `long double` where it is no wider than double."""
    for name in (source.precision, source.storage):
        precision = precisions.named(name)
        digits = bits(precision.dtype)
        if name == LONG_DOUBLE.name and digits < precision.digits:
            raise BuildError(
                f"precision {name!r}: long double has {digits} bits on this platform, no more than double. "
                "Use double-double."
            )


def _openmp(compiler: compilers.Compiler) -> tuple[str, ...]:
    """The flag for threads, where the compiler has them."""
    if compilers.has_openmp(compiler):
        return (compilers.OPENMP,)
    warnings.warn(
        f"{shlex.join(compiler.command)} has no OpenMP, so batches use one thread. Install it, such as "
        "libomp for clang, or name another compiler.",
        KanegenWarning,
        stacklevel=_CALLER,
    )
    return ()


def _split(flags: str | Sequence[str]) -> tuple[str, ...]:
    return tuple(shlex.split(flags) if isinstance(flags, str) else flags)


def _is_code(file: str) -> bool:
    """Whether a generated file is part of the library; the example is not."""
    return file.endswith((".h", ".c")) and file != "main.c"


def _machine(flags: Sequence[str]) -> tuple[str, ...]:
    """What the code runs on; a home folder may be shared by machines, so `native` code is for one of them."""
    kind = (platform.system(), platform.machine())
    return (*kind, platform.node()) if any("native" in flag for flag in flags) else kind
