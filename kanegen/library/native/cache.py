"""Compiled code on disk, shared by all processes of a user.

An entry is a folder whose name is a digest of everything that the code depends on. It is filled under a
temporary name and renamed when it is complete, so that any number of processes may make it at once, and a
process that is killed leaves only a folder that nobody reads. A list of the digests of its files shows
whether an entry is damaged; a damaged entry is made anew.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

import platformdirs

from kanegen.errors import BuildError

VARIABLE = "KANEGEN_CACHE"
"""Environment variable that may name another folder than `kanegen` in the user's cache folder."""

_DIGESTS = "SHA256SUMS"
"""File of an entry that lists the SHA-256 digests of all other files, as `sha256sum` prints them."""

_UNFINISHED = "unfinished-"
"""Prefix of the temporary folders in which entries are made."""

_DAY = 24 * 3600.0
"""Age in s beyond which an unfinished folder is taken to be abandoned."""

_LOCKS: defaultdict[str, threading.Lock] = defaultdict(threading.Lock)
"""A lock for each entry: of several threads that need an entry one makes it and the others wait."""

if hasattr(os, "register_at_fork"):  # a forked process has no thread that would release a lock
    os.register_at_fork(after_in_child=_LOCKS.clear)


def folder() -> Path:
    """Return the folder of the cache: `$KANEGEN_CACHE`, or `kanegen` in the user's cache folder."""
    named = os.environ.get(VARIABLE)
    return Path(named).absolute() if named else platformdirs.user_cache_path("kanegen", appauthor=False)


def key(parts: Iterable[str]) -> str:
    """Return the name of the entry that depends on exactly `parts`, in their order."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode()
        digest.update(b"%d:" % len(data) + data)
    return digest.hexdigest()[:32]


def entry(name: str, fill: Callable[[Path], None]) -> Path:
    """Return the folder of the entry `name`, which `fill` makes if it is missing or damaged.

    Args:
        name: Name of the entry, from `key`.
        fill: Function that writes the files of the entry into the empty folder that it is given.

    Raises:
        BuildError: If the cache folder cannot be used.
        Exception: Whatever `fill` raises.
    """
    root = folder()
    complete = root / name
    try:
        with _LOCKS[str(complete)]:
            if not _is_intact(complete):
                root.mkdir(parents=True, exist_ok=True, mode=0o700)
                _remove_abandoned(root)
                _make(complete, fill)
    except OSError as error:
        raise BuildError(
            f"cache folder {root} cannot be used: {error.strerror}. Set ${VARIABLE} to a folder that can be "
            "written."
        ) from error
    return complete


def _make(complete: Path, fill: Callable[[Path], None]) -> None:
    """Fill an entry under a temporary name, list its digests and give it the name `complete`."""
    with tempfile.TemporaryDirectory(
        prefix=_UNFINISHED, dir=complete.parent, ignore_cleanup_errors=True
    ) as temporary:
        content = Path(temporary) / complete.name
        content.mkdir()
        fill(content)
        files = sorted(path for path in content.rglob("*") if path.is_file())
        lines = [f"{_digest(path)}  {path.relative_to(content).as_posix()}\n" for path in files]
        (content / _DIGESTS).write_text("".join(lines))
        _publish(content, complete)


def _publish(content: Path, complete: Path) -> None:
    """Rename the folder `content` to `complete`, unless another process has made that entry meanwhile."""
    try:
        content.rename(complete)
    except OSError:
        if _is_intact(complete):
            return
        with suppress(FileNotFoundError):
            complete.rename(content.with_name("damaged"))
        content.rename(complete)


def _is_intact(complete: Path) -> bool:
    """Whether an entry exists and every file of it has the digest that is listed."""
    try:
        rows = [line.split("  ", 1) for line in (complete / _DIGESTS).read_text().splitlines()]
        return bool(rows) and all(_digest(complete / name) == digest for digest, name in rows)
    except (OSError, ValueError):
        return False


def _digest(path: Path) -> str:
    """Return the SHA-256 digest of a file, in hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _remove_abandoned(root: Path) -> None:
    """Remove unfinished folders of processes that were killed more than a day ago."""
    for path in root.glob(f"{_UNFINISHED}*"):
        with suppress(FileNotFoundError):
            if time.time() - path.stat().st_mtime > _DAY:
                shutil.rmtree(path, ignore_errors=True)
