"""How long a compiler takes over generated C."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from kanegen.c import Source
from kanegen.library.native import commands, compilers
from kanegen.library.native.build import code, write


def seconds_to_compile(source: Source) -> float:
    """Return the time in s that the C compiler takes for the functions of one state.

    The flags are those of the variant of `source`.

    Raises:
        BuildError: If there is no C compiler, or it fails.
    """
    file = f"{source.model.name}.c"
    command = [*compilers.find().command, "-std=c99", *source.variant.flags, "-c", file, "-o", "model.o"]
    with tempfile.TemporaryDirectory() as folder:
        write(code(source), Path(folder))
        start = time.perf_counter()
        commands.make(command, "model.o", Path(folder))
        return time.perf_counter() - start
