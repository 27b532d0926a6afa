"""Generated files on disk: safe writing into a folder and the folders below it.

By the line of provenance (`kanegen.c.provenance`) kanegen recognises its files, so that no foreign and no
edited file is overwritten. Either all files appear, each of them whole, or none.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

from kanegen.c.provenance import is_unchanged
from kanegen.errors import WriteError
from kanegen.files import PREFIX, reason, require_writable, temporary_folder, write_all

_COMMON = "kanegen_"
"""Start of the names of headers that do not depend on the model, any of which a new version may leave out."""


def write(files: Mapping[str, str | bytes], folder: Path, force: bool = False) -> Path:
    """Write `files` into `folder` under the rules of `Source.write`.

    Args:
        files: Text, or bytes, of every file by its path in the folder, such as "rust/src/lib.rs".
        folder: The folder, which is made where it is missing.
        force: Whether to write beside files of another origin, and over files of the same names; never
            through links that lead out of the folder.

    Raises:
        WriteError: If the files cannot be written; all then is as it was.
    """
    with _reported(folder):
        if folder.is_dir():
            _refuse_foreign(folder, files, force)
            with _new_folders(folder, files):
                write_all({folder / name: content for name, content in files.items()})
        else:
            _require_absent(folder)
            folder.parent.mkdir(parents=True, exist_ok=True)
            with temporary_folder(folder.parent) as temporary:
                complete = temporary / "complete"
                for name, content in files.items():
                    (complete / name).parent.mkdir(parents=True, exist_ok=True)
                    (complete / name).write_bytes(content if isinstance(content, bytes) else content.encode())
                complete.rename(folder)
    return folder


def require_room(names: Collection[str], folder: Path, force: bool = False) -> None:
    """Check that `write` could write files of these names, before the long work that makes them.

    Raises:
        WriteError: If the files could not be written.
    """
    with _reported(folder):
        if folder.is_dir():
            _refuse_foreign(folder, names, force)
            with _new_folders(folder, names, stay=False):
                require_writable(*(folder / name for name in names))
        else:
            _require_absent(folder)
            folder.parent.mkdir(parents=True, exist_ok=True)
            with temporary_folder(folder.parent):
                pass


@contextmanager
def _new_folders(folder: Path, names: Collection[str], stay: bool = True) -> Iterator[None]:
    """Make the folders of files that are missing below `folder`; at an error, or if not to stay, undo it."""
    made: list[Path] = []
    try:
        for name in sorted(_folders(names)):
            path = folder / name
            if not path.is_dir():
                path.mkdir()
                made.append(path)
        yield
    except BaseException:
        stay = False
        raise
    finally:
        for path in reversed([] if stay else made):
            with suppress(OSError):
                path.rmdir()


def _folders(names: Collection[str]) -> set[str]:
    """Return the path of every folder above a file, such as "rust" and "rust/src", without the lowest one."""
    return {str(parent) for name in names for parent in PurePosixPath(name).parents} - {"."}


@contextmanager
def _reported(folder: Path) -> Iterator[None]:
    """Turn an error of the operating system, or an impossible path, into a `WriteError` about `folder`."""
    try:
        yield
    except WriteError:
        raise
    except (OSError, ValueError) as error:
        raise WriteError(f"{folder}: cannot be written: {reason(error)}. Choose another folder.") from error


def _require_absent(folder: Path) -> None:
    """Make sure that nothing, not even a link to nothing, stands where a folder is to be made.

    Raises:
        OSError: If there is something, or the path is too long.
        ValueError: If there can be no such path.
    """
    try:
        folder.lstat()
    except FileNotFoundError:
        return
    raise OSError(errno.ENOTDIR, os.strerror(errno.ENOTDIR))


def _refuse_foreign(folder: Path, files: Collection[str], force: bool) -> None:
    """Raise unless every file in `folder` may be replaced, also on a disk that ignores the case of names."""
    folders = _folders(files)
    folded = {name.casefold(): name for name in (*files, *folders)}
    foreign = []
    for path in _met(folder, folders):
        name = path.relative_to(folder).as_posix()
        if name in files or name in folders:
            _refuse_way_out(path, folder)
        same = folded.get(name.casefold(), name)
        if same != name:
            raise WriteError(
                f"{folder}: holds {name}, which is the same file as {same} on disks that ignore "
                "the case of names. Choose another folder or another name of the model."
            )
        if not _is_replaceable(path, name in files):
            foreign.append(name)
    if foreign and not force:
        raise WriteError(
            f"{folder}: holds {', '.join(sorted(foreign))}, which are not this model's files as kanegen "
            "wrote them. Choose another folder, delete them, or force it: --force, force=True."
        )


def _refuse_way_out(path: Path, folder: Path) -> None:
    """Raise if what is to be written in `folder` is a link to a place outside of it, also where forced."""
    target = Path(os.path.realpath(path))
    if path.is_symlink() and not target.is_relative_to(os.path.realpath(folder)):
        raise WriteError(
            f"{folder}: {path.relative_to(folder).as_posix()} is a link to {target}, outside of the folder, "
            "which is not written. Delete the link, or choose another folder."
        )


def _met(folder: Path, folders: Collection[str]) -> Iterator[Path]:
    """Yield all that stands in `folder` and, instead of each of its own `folders`, all that stands in it."""
    pending = [folder]
    while pending:
        for path in pending.pop().iterdir():
            if path.relative_to(folder).as_posix() in folders and path.is_dir() and not path.is_symlink():
                pending.append(path)
            else:
                yield path


def _is_replaceable(path: Path, is_own: bool) -> bool:
    """Return whether `path` is one of the files or a common header, and still as kanegen wrote it."""
    if path.name.startswith(PREFIX):
        return True
    if not (is_own or path.name.startswith(_COMMON)) or not path.is_file():
        return False
    if is_unchanged(path.read_bytes()):
        return True
    try:
        return is_unchanged(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        return False
