"""Files that are written as a whole or not at all, so that no reader ever sees half of one."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator
from pathlib import Path

from kanegen.errors import WriteError


def write_whole(path: Path, text: str) -> None:
    """Write `text` to the file `path`, by way of a temporary file beside it.

    Raises:
        WriteError: If the file cannot be written; an existing one then stays as it is.
    """
    with _temporary(path) as temporary:
        temporary.write_bytes(text.encode())
        os.replace(temporary, path)


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, if they are missing.

    Raises:
        WriteError: If the folder cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(f"{path}: the folder cannot be made: {error.strerror}.") from None


def require_writable(*paths: Path | None) -> None:
    """Make sure that `write_whole` can write files, before long work whose results go there.

    Args:
        paths: Paths of files that may or may not exist; None is ignored.

    Raises:
        WriteError: If a file cannot be written.
    """
    for path in paths:
        if path is not None:
            with _temporary(path) as temporary:
                temporary.write_bytes(b"")
                temporary.unlink()
                if path.is_dir():
                    raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))


@contextlib.contextmanager
def _temporary(path: Path) -> Iterator[Path]:
    """Yield the path of a temporary file beside `path`; failures become a `WriteError` about `path`."""
    temporary = path
    try:
        temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
        yield temporary
    except (OSError, ValueError) as error:
        with contextlib.suppress(OSError, ValueError):
            if temporary != path:
                temporary.unlink()
        raise WriteError(f"{path}: cannot be written: {getattr(error, 'strerror', None) or error}.") from None
