"""Files written whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

from kanegen.errors import WriteError


def write_whole(path: Path, text: str) -> None:
    """Put `text` into the file `path`, by way of a neighbour, so that no reader ever sees half of it.

    Raises:
        WriteError: If the file cannot be written; an older one then stays as it is.
    """
    with _neighbour(path) as neighbour:
        neighbour.write_bytes(text.encode())
        os.replace(neighbour, path)


def make_folder(path: Path) -> None:
    """Make a folder and those above it, where they are missing.

    Raises:
        WriteError: If it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(f"{path}: the folder cannot be made: {error.strerror}.") from None


def require_writable(*paths: Path | None) -> None:
    """See that `write_whole` will be able to write files, before long work whose results they take.

    Args:
        paths: Of files, there or not; None is none.

    Raises:
        WriteError: If one cannot be written.
    """
    for path in paths:
        if path is not None:
            with _neighbour(path) as neighbour:
                neighbour.write_bytes(b"")
                neighbour.unlink()
                if path.is_dir():
                    raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))


@contextlib.contextmanager
def _neighbour(path: Path) -> Iterator[Path]:
    """A name beside `path`, which is free again afterwards; what fails is a `WriteError` about `path`."""
    neighbour = path
    try:
        neighbour = path.with_name(f".{path.name}.{os.getpid()}.part")
        yield neighbour
    except (OSError, ValueError) as error:
        with contextlib.suppress(OSError, ValueError):
            if neighbour != path:
                neighbour.unlink()
        raise WriteError(f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}.") from None
