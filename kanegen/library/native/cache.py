"""Compiled code on disk, shared by all processes of a user.

An entry is a folder whose name is a digest of everything that the code depends on. It is filled under another
name and renamed when it is whole, so any number of processes may build it at once, and one that is killed
leaves only a folder that nobody reads. A list of digests inside tells a damaged entry, which is made anew.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

import platformdirs

from kanegen.errors import BuildError

VARIABLE = "KANEGEN_CACHE"
"""Environment variable that names another folder than the user's cache folder."""

_MANIFEST = "SHA256SUMS"
_UNFINISHED = "unfinished-"
_DAY = 24 * 3600.0


def folder() -> Path:
    """Where the cache is: `$KANEGEN_CACHE`, or `kanegen` in the user's cache folder."""
    named = os.environ.get(VARIABLE)
    return Path(named).absolute() if named else platformdirs.user_cache_path("kanegen", appauthor=False)


def key(parts: Iterable[str]) -> str:
    """A name for what depends on exactly `parts`."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode()
        digest.update(b"%d:" % len(data) + data)
    return digest.hexdigest()[:32]


def entry(name: str, fill: Callable[[Path], None]) -> Path:
    """The folder of the entry `name`, which `fill` makes where it is missing.

    Args:
        name: From `key`.
        fill: Writes the files of the entry into the empty folder that it is given.

    Raises:
        BuildError: If the cache cannot be used; whatever `fill` raises.
    """
    root = folder()
    complete = root / name
    try:
        if not _is_whole(complete):
            root.mkdir(parents=True, exist_ok=True, mode=0o700)
            _sweep(root)
            with tempfile.TemporaryDirectory(prefix=_UNFINISHED, dir=root, ignore_cleanup_errors=True) as new:
                content = Path(new) / name
                content.mkdir()
                fill(content)
                _seal(content)
                _publish(content, complete)
    except OSError as error:
        raise BuildError(
            f"cache folder {root} cannot be used: {error.strerror}. Set ${VARIABLE} to a folder that can be "
            "written."
        ) from error
    return complete


def _publish(content: Path, complete: Path) -> None:
    """Give the entry its name, unless another process was faster."""
    try:
        content.rename(complete)
    except OSError:
        if _is_whole(complete):
            return
        with suppress(FileNotFoundError):
            complete.rename(content.with_name("damaged"))
        content.rename(complete)


def _seal(content: Path) -> None:
    lines = [f"{_digest(path)}  {path.name}\n" for path in sorted(content.iterdir())]
    (content / _MANIFEST).write_text("".join(lines))


def _is_whole(complete: Path) -> bool:
    """Whether every file is there as it was written."""
    try:
        rows = [line.split("  ") for line in (complete / _MANIFEST).read_text().splitlines()]
        return bool(rows) and all(_digest(complete / name) == digest for digest, name in rows)
    except (OSError, ValueError):
        return False


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _sweep(root: Path) -> None:
    """Remove what processes left that were killed long ago."""
    for path in root.glob(f"{_UNFINISHED}*"):
        with suppress(FileNotFoundError):
            if time.time() - path.stat().st_mtime > _DAY:
                shutil.rmtree(path, ignore_errors=True)
