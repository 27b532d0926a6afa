"""Files written whole or not at all."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from kanegen.errors import WriteError


def write_whole(path: Path, text: str) -> None:
    """Put `text` into the file `path`, by way of a neighbour, so that no reader ever sees half of it.

    Raises:
        WriteError: If the file cannot be written; an older one then stays as it is.
    """
    neighbour = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        neighbour.write_bytes(text.encode())
        os.replace(neighbour, path)
    except (OSError, ValueError) as error:
        with contextlib.suppress(OSError, ValueError):
            neighbour.unlink()
        raise WriteError(f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}.") from None
