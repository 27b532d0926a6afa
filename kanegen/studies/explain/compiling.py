"""How long a compiler takes over generated C."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from kanegen.c import Source
from kanegen.library.native import compilers


def seconds_to_compile(source: Source) -> float:
    """Seconds for the functions for one state, with the flags of the variant, by the first compiler found.

    Raises:
        BuildError: If there is none, or it fails.
    """
    found = compilers.find()
    file = f"{source.model.name}.c"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for other, text in source.files.items():
            if other.endswith((".c", ".h")):
                (folder / other).write_text(text, encoding="utf-8", newline="\n")
        command = [*found.command, "-std=c99", *source.variant.flags, "-c", file, "-o", "model.o"]
        start = time.perf_counter()
        compilers.make(command, "model.o", folder)
        return time.perf_counter() - start
