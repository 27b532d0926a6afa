"""Files that are written whole or not at all, also several together, by way of temporary folders beside them.

A temporary folder is locked by the process that made it. The operating system releases the lock when the
process ends, however it ends, so that a later process recognises the folders of killed processes and removes
them, and never touches those of processes that still write.
"""

from __future__ import annotations

import errno
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from kanegen.errors import WriteError, quoted

if sys.platform != "win32":
    import fcntl

PREFIX = ".kanegen-"
"""Start of the names of temporary folders."""

_LOCK = "lock"
"""File of a temporary folder that its process keeps locked."""

_DAY = 24 * 3600.0
"""Age in s beyond which a temporary folder counts as abandoned on a file system without locks."""

_ATTEMPTS = 100
"""Temporary folders that are made at most until one is not taken for an abandoned one meanwhile."""

_LONGEST_WAIT = 30.0
"""Time in s for which a process waits while another one renames its files in the same folder."""

_NOT_LOCKED = -1
"""Descriptor of the lock of a folder on a file system that has no locks."""


def path_of(name: object) -> Path:
    """Return the path that a user names by a text or a path.

    Raises:
        WriteError: If it is neither.
    """
    if isinstance(name, (str, Path)):
        return Path(name)
    if isinstance(name, os.PathLike) and isinstance(text := os.fspath(name), str):
        return Path(text)
    raise WriteError(f"{quoted(name)} is not the path of a file or folder.")


def write_whole(path: Path, text: str) -> None:
    """Write `text` to the file `path`, as `write_all` does it.

    Raises:
        WriteError: If the file cannot be written; an existing one then stays as it is.
    """
    write_all({path: text})


def write_all(texts: Mapping[Path, str | bytes], removed: Sequence[Path] = ()) -> None:
    """Write files, all of them or none, and remove others with them.

    All are written to temporary folders first and then renamed. If one cannot be renamed, those before it get
    their old content back. A link is followed, and a file keeps its permissions. Only if the process is
    killed between two renames may some files be new and others old, each of them whole.

    Args:
        texts: Text, or bytes, of every file by its path.
        removed: Paths of other files, on the file system of the first of those that are written. They go
            last, so that a killed process leaves no less than there was.

    Raises:
        WriteError: If a file cannot be written or removed; all files then stay as they are.
    """
    targets = {path: _writable_target(path) for path in texts}
    with ExitStack() as stack:
        staged: dict[Path, Path] = {}
        folders: dict[Path, Path] = {}
        for number, (path, text) in enumerate(texts.items()):
            with _reported(path):
                parent = targets[path].parent
                if parent not in folders:
                    folders[parent] = stack.enter_context(temporary_folder(parent))
                staged[path] = folders[parent] / f"{number}.new"
                staged[path].write_bytes(text if isinstance(text, bytes) else text.encode())
        stack.enter_context(_one_writer_at_a_time(sorted(folders)))
        moves = [(path, staged[path], targets[path]) for path in texts]
        kept = next(iter(folders.values())) if folders else None
        _replace(moves, [(path, kept / f"{number}.removed") for number, path in enumerate(removed) if kept])


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, if they are missing.

    Raises:
        WriteError: If the folder cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise WriteError(f"{path}: the folder cannot be made: {reason(error)}.") from None


def require_writable(*paths: Path | None) -> None:
    """Make sure that `write_all` can write files, before long work whose results go there.

    Args:
        paths: Paths of files that may or may not exist; None is ignored.

    Raises:
        WriteError: If a file cannot be written.
    """
    for path in paths:
        if path is not None:
            target = _writable_target(path)
            with _reported(path), temporary_folder(target.parent) as folder:
                (folder / "0.new").write_bytes(b"")


@contextmanager
def temporary_folder(parent: Path) -> Iterator[Path]:
    """Yield a new folder in `parent`, on the same file system, and remove it at the end.

    The folders that killed processes have left in `parent` are removed first. The folder holds a file `lock`.

    Raises:
        OSError: If the folder cannot be made.
    """
    _remove_abandoned(parent)
    folder, lock = _new_locked_folder(parent)
    try:
        yield folder
    finally:
        try:
            shutil.rmtree(folder, ignore_errors=True)
        finally:
            _close(lock)


@contextmanager
def locked(folder: Path, wait: bool = True) -> Iterator[None]:
    """Keep other processes from locking a folder, where the file system has locks.

    Args:
        folder: The folder.
        wait: Whether to wait for another process that has locked it.

    Raises:
        BlockingIOError: If another process has locked it and `wait` is false.
        OSError: If the folder cannot be opened.
    """
    if sys.platform == "win32":
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            raise
        except OSError:  # the file system has no locks
            pass
        yield
    finally:
        _close(descriptor)


def reason(error: OSError | ValueError) -> str:
    """Return the words of the operating system for an error, or those of Python for a path that cannot be."""
    return getattr(error, "strerror", None) or str(error)


def _writable_target(path: Path) -> Path:
    """Return the path of the file that `path` is or links to, which exists or can be made.

    Raises:
        WriteError: If there is something that is no file, or a link to nothing.
    """
    with _reported(path):
        if path.is_symlink() and not path.exists():
            raise OSError(errno.ENOENT, f"it is a link to {os.readlink(path)}, which does not exist")
        target = path.resolve()
        if target.is_dir():
            raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
        if target.exists() and not target.is_file():
            raise OSError(errno.EINVAL, "it is a device or a pipe, not a file")
        if not target.parent.is_dir():
            code = errno.ENOTDIR if target.parent.exists() else errno.ENOENT
            raise OSError(code, os.strerror(code))
    return target


def _replace(moves: Sequence[tuple[Path, Path, Path]], removals: Sequence[tuple[Path, Path]] = ()) -> None:
    """Rename new files to their targets; at a failure those before it get their old content back.

    Args:
        moves: The path that the caller named, the new file, and the target, for each file.
        removals: The path of each file to remove, and the path in a temporary folder to which it goes.

    Raises:
        WriteError: If a file cannot be renamed.
    """
    replaced: list[tuple[Path, Path]] = []
    try:
        for path, new, target in moves:
            with _reported(path):
                old = new.with_suffix(".old")
                if target.exists():
                    shutil.copymode(target, new)
                    _copy(target, old)
                replaced.append((old, target))
                os.replace(new, target)
        for path, old in removals:
            with _reported(path), suppress(FileNotFoundError):  # another process may have removed it
                os.replace(path, old)
                replaced.append((old, path))
    except BaseException:
        for old, target in reversed(replaced):
            with suppress(OSError):
                if old.exists():
                    os.replace(old, target)
                else:
                    target.unlink(missing_ok=True)
        raise


@contextmanager
def _one_writer_at_a_time(folders: Sequence[Path]) -> Iterator[None]:
    """Let processes that write into the same folders rename their files one process after the other.

    Raises:
        WriteError: If another process takes longer than `_LONGEST_WAIT`.
    """
    with ExitStack() as stack:
        if sys.platform != "win32":
            for folder in folders:
                descriptor = os.open(folder, os.O_RDONLY)
                stack.callback(_close, descriptor)
                _wait_for_lock(descriptor, folder)
        yield


def _wait_for_lock(descriptor: int, folder: Path) -> None:
    """Lock an open folder as soon as no other process has locked it, where the file system has locks."""
    deadline = time.monotonic() + _LONGEST_WAIT
    while sys.platform != "win32":
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > deadline:
                raise WriteError(f"{folder}: another process keeps writing there. Try again.") from None
            time.sleep(0.01)
        except OSError:  # the file system has no locks
            return
        else:
            return


def _copy(file: Path, other: Path) -> None:
    """Give a file a second name, or copy it on a file system without hard links."""
    try:
        os.link(file, other)
    except OSError:
        shutil.copy2(file, other)


@contextmanager
def _reported(path: Path) -> Iterator[None]:
    """Turn an error of the operating system, or an impossible path, into a `WriteError` about `path`."""
    try:
        yield
    except (OSError, ValueError) as error:
        if isinstance(error, WriteError):
            raise
        raise WriteError(f"{path}: cannot be written: {reason(error)}.") from None


def _new_locked_folder(parent: Path) -> tuple[Path, int]:
    """Return a new folder in `parent`, and the descriptor of its lock.

    Another process may take the folder for an abandoned one before it is locked; then there is another.
    """
    for _ in range(_ATTEMPTS):
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=parent))
        with suppress(BlockingIOError, FileNotFoundError):
            return folder, _locked(folder)
    raise OSError(errno.EBUSY, f"{parent} holds temporary folders that cannot be locked")


def _locked(folder: Path) -> int:
    """Lock a temporary folder and return the descriptor of the lock, `_NOT_LOCKED` where there are no locks.

    Raises:
        BlockingIOError: If another process has locked it.
        FileNotFoundError: If another process has removed it.
    """
    if sys.platform == "win32":
        return _NOT_LOCKED
    path = folder / _LOCK
    lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.stat(path)  # which fails if the process that held the lock has removed the folder
    except (BlockingIOError, FileNotFoundError):
        os.close(lock)
        raise
    except OSError:  # the file system has no locks
        os.close(lock)
        return _NOT_LOCKED
    return lock


def _close(lock: int) -> None:
    """Release a lock, also for processes that were forked meanwhile and have the descriptor, too."""
    if sys.platform != "win32" and lock != _NOT_LOCKED:
        with suppress(OSError):
            fcntl.flock(lock, fcntl.LOCK_UN)
        os.close(lock)


def _remove_abandoned(parent: Path) -> None:
    """Remove the temporary folders of this user in `parent` whose processes have ended."""
    with suppress(OSError):
        for entry in os.scandir(parent):
            if entry.name.startswith(PREFIX) and entry.is_dir(follow_symlinks=False):
                with suppress(OSError):
                    if sys.platform == "win32" or entry.stat().st_uid == os.getuid():
                        _remove_if_abandoned(Path(entry.path))


def _remove_if_abandoned(folder: Path) -> None:
    """Remove a temporary folder, unless a process has locked it or, without locks, may still use it.

    It is renamed first, so that the process that made it, if it has not locked it yet, finds it missing.
    """
    lock = _locked(folder)
    try:
        if lock != _NOT_LOCKED or time.time() - folder.stat().st_mtime > _DAY:
            abandoned = folder.with_name(PREFIX + "abandoned-" + folder.name.removeprefix(PREFIX))
            shutil.rmtree(folder.rename(abandoned), ignore_errors=True)
    finally:
        _close(lock)
