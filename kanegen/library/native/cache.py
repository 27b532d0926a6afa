"""Compiled code on disk, shared by all processes of a user.

An entry is a folder whose name is a digest of everything that the code depends on. It is filled under a
temporary name and renamed when it is complete, so that any number of processes may make it at once, and a
process that is killed leaves only a folder that nobody reads and the next one removes. A list of the digests
of its files shows whether an entry is damaged; a damaged entry is made anew. When the cache is full or is
cleared, entries disappear by a rename as well: a process either finds all of an entry or makes it again, and
code that is loaded stays loaded. Nothing is loaded from a folder in which others can write.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import platformdirs

from kanegen.errors import BuildError
from kanegen.files import locked, reason, temporary_folder
from kanegen.library.native import environment, ownership

VARIABLE = "KANEGEN_CACHE"
"""Environment variable that may name another folder than `kanegen` in the user's cache folder."""

_DIGESTS = "SHA256SUMS"
"""File of an entry that lists the SHA-256 digests of all other files, as `sha256sum` prints them."""

_DIGITS = 32
"""Hexadecimal digits of the name of an entry."""

_NAME = re.compile(f"[0-9a-f]{{{_DIGITS}}}")
"""The names of entries, by which they differ from temporary folders."""

_ATTEMPTS = 20
"""How often an entry is made at most that other processes remove or damage before it is used."""

_RESOLUTION = 600.0
"""Time in s after which another use of an entry is noted."""

_IN_USE = 3600.0
"""Time in s after its last use during which an entry is kept, also where the cache is full."""

_FILL = 0.8
"""Part of the limit to which the cache is emptied when it is full."""

_UNCOUNTED = 0.1
"""Part of what is free that a process may fill before it adds up the sizes of all entries again."""

_WRITTEN_BY_OTHERS = 0o022
"""Bits of the mode of a file with which others may write it."""

_SOURCES = (".c", ".h", ".cpp", ".hpp")
"""Ends of the names of files from which others are made."""

_MEGABYTE = 1e6
"""Bytes of a megabyte."""

_ROOM: dict[tuple[Path, float], float] = {}
"""Bytes that this process may add to a folder with a limit before it adds up all sizes again."""

_LOCKS: defaultdict[str, threading.Lock] = defaultdict(threading.Lock)
"""A lock for each entry: of several threads that need an entry one makes it and the others wait."""

if hasattr(os, "register_at_fork"):  # a forked process has no thread that would release a lock
    os.register_at_fork(after_in_child=_LOCKS.clear)

Used = TypeVar("Used")


@dataclass(frozen=True)
class Entry:
    """A complete entry of the cache.

    Attributes:
        path: Its folder.
        name: Name of the library or program, or of the file of results, that it holds.
        size: Size of its files, in bytes.
        last_use: Time of its last use to within ten minutes, in seconds since the epoch.
    """

    path: Path
    name: str
    size: int
    last_use: float


def folder() -> Path:
    """Return the folder of the cache: `$KANEGEN_CACHE`, or `kanegen` in the user's cache folder.

    Raises:
        BuildError: If `$KANEGEN_CACHE` begins with the home folder of a user that there is not.
    """
    named = os.environ.get(VARIABLE)
    if not named:
        return platformdirs.user_cache_path("kanegen", appauthor=False)
    try:
        return Path(named).expanduser().absolute()
    except RuntimeError as error:
        raise BuildError(f"${VARIABLE}: {named!r} is no folder: {error}") from None


def key(parts: Iterable[str]) -> str:
    """Return the name of the entry that depends on exactly `parts`, in their order."""
    digest = hashlib.sha256()
    for part in parts:
        data = part.encode("utf-8", "surrogateescape")
        digest.update(b"%d:" % len(data) + data)
    return digest.hexdigest()[:_DIGITS]


def use(name: str, file: str, fill: Callable[[Path], None], take: Callable[[Path], Used]) -> Used:
    """Return what `take` returns for a file of an entry, which is made first if it is missing or damaged.

    Args:
        name: Name of the entry, from `key`.
        file: Name of the file that is used, which `fill` writes.
        fill: Function that writes the files of the entry into the empty folder that it is given.
        take: Function that reads, loads or only names the file that it is given. It is called again if
            another process has removed the entry meanwhile.

    Raises:
        BuildError: If the cache folder cannot be used, or others can write in it.
        Exception: Whatever `fill` raises, and what `take` raises for a file that is not damaged.
    """
    root = folder()
    with _reported(root):
        for _ in range(_ATTEMPTS):
            complete = _complete(root, name, file, fill)
            try:
                return take(complete / file)
            except (OSError, BuildError):
                if _is_intact(complete, file):
                    raise
    raise BuildError(f"cache folder {root}: other processes keep removing entry {name}. Stop them.")


def find(name: str, file: str) -> Path | None:
    """Return the path of a file of an entry that is there and not damaged, otherwise None."""
    with suppress(BuildError, OSError):
        root = folder()
        if (root / name).is_dir():
            _require_private(root)
            if _is_intact(root / name, file):
                _note_use(root / name)
                return root / name / file
    return None


def entries() -> list[Entry]:
    """Return the entries of the cache, the one that was used last at the end.

    Raises:
        BuildError: If the cache folder cannot be read.
    """
    found = []
    root = folder()
    with _reported(root):
        for path in root.iterdir() if root.is_dir() else ():
            with suppress(OSError):  # another process removes it
                if _NAME.fullmatch(path.name) and path.is_dir():
                    found.append(_entry(path))
    return sorted(found, key=lambda entry: (entry.last_use, entry.path))


def clear(unused_for: float = 0.0) -> list[Entry]:
    """Remove the entries that have not been used for some time, and return them.

    Processes that have loaded a library from them keep it, and compile it again when they build it again.

    Args:
        unused_for: Time since the last use, s.

    Raises:
        BuildError: If the cache folder cannot be used, or others can write in it.
    """
    root = folder()
    unused = [entry for entry in entries() if time.time() - entry.last_use >= unused_for]
    with _reported(root):
        if not root.is_dir():
            return []
        _require_private(root)
        return _remove(root, unused)


@contextmanager
def one_process() -> Iterator[None]:
    """Let other processes of this machine that ask for it wait, where the file system has locks.

    Several processes that need the same new library then compile it once, and not each of them.

    Raises:
        BuildError: If the cache folder cannot be used.
    """
    root = folder()
    with ExitStack() as stack:
        with _reported(root):
            if not root.is_dir():
                _make_private(root)
            stack.enter_context(locked(root))
        yield


@contextmanager
def _reported(root: Path) -> Iterator[None]:
    """Turn an error of the operating system into a `BuildError` about the folder of the cache."""
    try:
        yield
    except OSError as error:
        raise BuildError(
            f"cache folder {root} cannot be used: {reason(error)}. Set ${VARIABLE} to a folder that can be "
            "written."
        ) from error


def _complete(root: Path, name: str, file: str, fill: Callable[[Path], None]) -> Path:
    """Return the folder of an entry that is complete and not damaged, which `fill` makes if need be."""
    complete = root / name
    with _LOCKS[str(complete)]:
        if not root.is_dir():
            _make_private(root)
        _require_private(root)
        if _is_intact(complete, file):
            _note_use(complete)
        else:
            limit = environment.limit(environment.CACHE_MEGABYTES) * _MEGABYTE
            _make(complete, file, fill)
            with suppress(OSError, BuildError):
                _keep_below(root, limit, _entry(complete).size)
    return complete


def _make_private(root: Path) -> None:
    """Make the folder of the cache, and those above it that are missing, for the user alone."""
    for missing in reversed([path for path in (root, *root.parents) if not path.exists()]):
        with suppress(FileExistsError):
            missing.mkdir(mode=0o700)


def _require_private(root: Path) -> None:
    """Make sure that nobody else can write in the folder of the cache or replace it.

    Raises:
        BuildError: If others can.
    """
    if objection := ownership.objection(root):
        raise BuildError(
            f"cache folder {root} is not safe to load code from: {objection}, or set ${VARIABLE} to a "
            "folder of your own."
        )


def _make(complete: Path, file: str, fill: Callable[[Path], None]) -> None:
    """Fill an entry under a temporary name, list its digests and give it the name `complete`."""
    with temporary_folder(complete.parent) as temporary:
        content = temporary / "content"
        content.mkdir(mode=0o700)
        fill(content)
        for path in content.rglob("*"):
            _keep_from_others(path)
        lines = [f"{_digest(_content(content / name))}  {name}\n" for name in _files(content)]
        (content / _DIGESTS).write_text("".join(lines), encoding="utf-8")
        _keep_from_others(content / _DIGESTS)
        _publish(content, complete, file)


def _keep_from_others(path: Path) -> None:
    """Let nobody else write a file or folder, whatever modes new files get by default."""
    path.chmod(path.stat().st_mode & ~_WRITTEN_BY_OTHERS)


def _publish(content: Path, complete: Path, file: str) -> None:
    """Rename the folder `content` to `complete`, unless another process has made that entry meanwhile."""
    for attempt in range(_ATTEMPTS):
        try:
            content.rename(complete)
        except OSError:
            if _is_intact(complete, file):
                return
            with suppress(FileNotFoundError):
                complete.rename(content.with_name(f"damaged-{attempt}"))
        else:
            return
    content.rename(complete)


def _is_intact(complete: Path, file: str) -> bool:
    """Whether an entry lists exactly its files, `file` among them, and each has the digest that is listed."""
    try:
        if not ownership.is_private(complete):
            return False
        text = _content(complete / _DIGESTS).decode()
        listed = {name: digest for digest, _, name in (line.partition("  ") for line in text.splitlines())}
        return (
            file in listed
            and sorted(listed) == _files(complete)
            and all(_digest(_content(complete / name)) == digest for name, digest in listed.items())
        )
    except (OSError, ValueError):
        return False


def _files(entry: Path) -> list[str]:
    """Return the relative paths of the files of an entry but for the list of digests, in order."""
    return sorted(name for name, _ in _walked(entry) if name != _DIGESTS)


def _walked(folder: Path, above: str = "") -> Iterator[tuple[str, os.DirEntry[str]]]:
    """Yield every file of a folder and of the folders in it, with its path relative to the first folder.

    Args:
        folder: Where to look.
        above: Path of `folder` relative to the first folder, which ends with a slash, or "".

    Raises:
        OSError: If a folder cannot be read.
    """
    with os.scandir(folder) as found:
        for one in found:
            if one.is_dir(follow_symlinks=False):
                yield from _walked(folder / one.name, f"{above}{one.name}/")
            else:
                yield f"{above}{one.name}", one


def _content(path: Path) -> bytes:
    """Return what is in a file of an entry.

    Raises:
        OSError: If it is no file, or others can write it.
    """
    if not (ownership.is_private(path) and path.is_file()):
        raise PermissionError
    return path.read_bytes()


def _digest(content: bytes) -> str:
    """Return the SHA-256 digest of what is in a file, in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def _note_use(complete: Path) -> None:
    """Note the time of a use, in the times of the list of digests, unless it was noted a short while ago."""
    with suppress(OSError):
        if time.time() - (complete / _DIGESTS).stat().st_mtime > _RESOLUTION:
            os.utime(complete / _DIGESTS)


def _entry(path: Path) -> Entry:
    """Return the entry in a folder.

    Raises:
        OSError: If it is no entry, or another process removes it.
    """
    files = dict(_walked(path))
    made = sorted(name for name in files if name != _DIGESTS and not name.endswith(_SOURCES))
    size = sum(one.stat().st_size for one in files.values())
    noted = files[_DIGESTS].stat() if _DIGESTS in files else path.stat()
    return Entry(path, (made or [""])[0], size, noted.st_mtime)


def _keep_below(root: Path, limit: float, added: int) -> None:
    """Remove the entries that were not used for the longest time, if all together exceed a limit.

    Args:
        root: Folder of the cache.
        limit: The limit, in bytes.
        added: Size of the entry that was made just now, in bytes.
    """
    _ROOM[root, limit] = _ROOM.get((root, limit), 0.0) - added
    if _ROOM[root, limit] > 0.0:
        return
    found = entries()
    total = sum(entry.size for entry in found)
    _ROOM[root, limit] = _UNCOUNTED * (limit - total)
    if total <= limit:
        return
    excess = total - int(_FILL * limit)
    superfluous = []
    for entry in found:
        if excess > 0 and time.time() - entry.last_use > _IN_USE:
            superfluous.append(entry)
            excess -= entry.size
    _remove(root, superfluous)


def _remove(root: Path, superfluous: Iterable[Entry]) -> list[Entry]:
    """Remove entries, each by a rename before its files are deleted, and return those that were there."""
    removed = []
    with temporary_folder(root) as temporary:
        for number, entry in enumerate(superfluous):
            with suppress(OSError):
                entry.path.rename(temporary / str(number))
                removed.append(entry)
                shutil.rmtree(temporary / str(number), ignore_errors=True)
    return removed
