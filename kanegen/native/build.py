"""From C to a shared library on disk."""

from __future__ import annotations

import platform
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from kanegen.c import Source
from kanegen.errors import BuildError
from kanegen.native import cache, compilers

FLAGS = ("-O2", "-ffp-contract=off")
"""Default flags: optimised, with the same bits as the operations of the program one by one."""

_ALWAYS = ("-std=c99", "-fPIC", "-shared")
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def build(source: Source, compiler: str | None = None, flags: Sequence[str] | None = None) -> Path:
    """Compile `source`, unless the cache has it already.

    Args:
        source: From `kanegen.generate`.
        compiler: Command of a compiler that takes gcc's options; default `$KANEGEN_CC`, `$CC`, cc, gcc,
            clang, or that of the package ziglang.
        flags: Instead of `FLAGS`.

    Returns:
        The shared library.

    Raises:
        BuildError: If there is no compiler, it fails, or the cache folder cannot be used.
    """
    found = compilers.find(compiler)
    chosen = FLAGS if flags is None else tuple(flags)
    name = source.model.name
    texts = {file: source.files[file] for file in (f"{name}.h", f"{name}.c")}
    library = f"lib{name}{_SUFFIX}"
    command = [*found.command, *_ALWAYS, *chosen, "-o", library, f"{name}.c", "-lm"]

    def fill(folder: Path) -> None:
        for file, text in texts.items():
            (folder / file).write_text(text, encoding="utf-8", newline="\n")
        result = compilers.run(command, str(folder))
        if result.returncode != 0:
            raise BuildError(
                f"the C compiler failed with status {result.returncode}.\n"
                f"command: {shlex.join(command)}\n{result.stdout}"
            )

    parts = (*texts.values(), found.identity, *command, *_machine(chosen))
    return cache.entry(cache.key(parts), fill) / library


def _machine(flags: Sequence[str]) -> tuple[str, ...]:
    """What the code runs on; a home folder may be shared by machines, so `native` code is for one of them."""
    kind = (platform.system(), platform.machine())
    return (*kind, platform.node()) if any("native" in flag for flag in flags) else kind
