"""Generated files on disk: safe writing into a folder and the folders below it.

By the line of provenance (`kanegen.c.provenance`) kanegen recognises its files, so that no foreign and no
edited file is overwritten. Either all files appear, each of them whole, or none. Files that an earlier call
made of the same model, and that the new one does not make, go away with it: they would belong to other code.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath

from kanegen.c.provenance import BINARY, is_unchanged
from kanegen.errors import WriteError
from kanegen.files import PREFIX, reason, require_writable, temporary_folder, write_all

_HEAD = 1024
"""Bytes at the beginning of a text within which the line of provenance ends."""

_OF_EVERY_MODEL = ".pc.in"
"""End of the name of a file that stands beside the C of every model, after the name of the model."""

_COMMON = "kanegen_"
"""Start of the names of headers that do not depend on the model, any of which a new version may leave out."""


def write(
    files: Mapping[str, str | bytes],
    folder: Path,
    force: bool = False,
    model: str = "",
    places: Collection[str] = (),
) -> tuple[str, ...]:
    """Write `files` into `folder` under the rules of `Source.write`.

    Args:
        files: Text, or bytes, of every file by its path in the folder, such as "rust/src/lib.rs".
        folder: The folder, which is made where it is missing.
        force: Whether to write beside files of another origin, and over files of the same names; never
            through links that lead out of the folder.
        model: Name of the model, with which names of its files begin; "" if no old files are to go away.
        places: Names of other files and of folders in `folder` that files of the model can have.

    Returns:
        The names of the old files that were removed; of a folder that is gone its name, such as "rust/".

    Raises:
        WriteError: If the files cannot be written; all then is as it was.
    """
    with _reported(folder):
        if folder.is_dir():
            outdated = _outdated(folder, files, force, model, places)
            with _new_folders(folder, files):
                removed = [folder / name for name in outdated]
                write_all({folder / name: content for name, content in files.items()}, removed)
            return _without_empty_folders(folder, outdated)
        else:
            _require_absent(folder)
            folder.parent.mkdir(parents=True, exist_ok=True)
            with temporary_folder(folder.parent) as temporary:
                complete = temporary / "complete"
                for name, content in files.items():
                    (complete / name).parent.mkdir(parents=True, exist_ok=True)
                    (complete / name).write_bytes(content if isinstance(content, bytes) else content.encode())
                complete.rename(folder)
    return ()


def require_room(
    names: Collection[str],
    folder: Path,
    force: bool = False,
    model: str = "",
    places: Collection[str] = (),
) -> None:
    """Check that `write` could write files of these names, before the long work that makes them.

    Raises:
        WriteError: If the files could not be written.
    """
    with _reported(folder):
        if folder.is_dir():
            _outdated(folder, names, force, model, places)
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


def _outdated(
    folder: Path, files: Collection[str], force: bool, model: str, places: Collection[str]
) -> list[str]:
    """Return the names of old files of the model that `files` lack, after a check of all that `folder` holds.

    Names are compared as on a disk that ignores their case.

    Raises:
        WriteError: If the folder holds other files, or edited ones, and `force` is false.
    """
    folders = _folders(files)
    folded = {name.casefold(): name for name in (*files, *folders)}
    other = _other_models(folder, model)
    foreign: list[str] = []
    outdated: list[str] = []
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
        if name not in files and model and _may_be_own(name, model, places, other):
            old, rest = _sorted_out(folder, path)
            outdated += old
            foreign += rest
        elif not _is_replaceable(path, name in files):
            foreign.append(name)
    if foreign and not force:
        raise WriteError(
            f"{folder}: holds {', '.join(sorted(foreign))}, which are not this model's files as kanegen "
            "wrote them. Choose another folder, delete them, or force it: --force, force=True."
        )
    written = {os.path.realpath(folder / name) for name in files}  # also through links
    return sorted(name for name in outdated if os.path.realpath(folder / name) not in written)


def _other_models(folder: Path, model: str) -> list[str]:
    """Return the names of other models whose code is in `folder`, by their files for pkg-config."""
    names = [path.name.removesuffix(_OF_EVERY_MODEL) for path in folder.glob(f"*{_OF_EVERY_MODEL}")]
    return [name for name in names if name != model]


def _may_be_own(name: str, model: str, places: Collection[str], others: Collection[str]) -> bool:
    """Return whether an old file or folder of the model can have this name.

    Names that do not begin with that of the model count only where there is no other model, which may have
    them, too.
    """
    top, _, below = name.partition("/")
    if top in places or PurePosixPath(name).name.startswith(_COMMON):
        return not others
    longer = [one for one in others if len(one) > len(model)]
    return not below and _begins_with(top, model) and not any(_begins_with(top, one) for one in longer)


def _begins_with(name: str, model: str) -> bool:
    """Return whether the name of a file begins with that of a model, as in "arm.h" and "arm_batch.c"."""
    return name.startswith((f"{model}.", f"{model}_"))


def _sorted_out(folder: Path, path: Path) -> tuple[list[str], list[str]]:
    """Return the names of kanegen's unchanged files at or below `path`, and those of what else is there.

    A folder that holds nothing of kanegen counts as one.
    """
    name = path.relative_to(folder).as_posix()
    if path.name.startswith(PREFIX):
        return [], []
    if path.is_symlink() or not path.is_dir():
        is_own = not path.is_symlink() and path.is_file() and _is_unchanged(path)
        return ([name], []) if is_own else ([], [name])
    parts = [_sorted_out(folder, below) for below in path.iterdir()]
    own = [one for part in parts for one in part[0]]
    rest = [one for part in parts for one in part[1]]
    return own, rest if own or not rest else [name]


def _without_empty_folders(folder: Path, removed: Collection[str]) -> tuple[str, ...]:
    """Remove the folders that removed files have left empty; return what is gone, a folder as one name."""
    gone: set[str] = set()
    for name in sorted(_folders(removed), key=len, reverse=True):
        with suppress(OSError):
            (folder / name).rmdir()
            gone.add(name)
    shown = {
        next((f"{one}/" for one in reversed(parents) if one in gone), name)
        for name in removed
        for parents in [[str(parent) for parent in PurePosixPath(name).parents]]
    }
    return tuple(sorted(shown))


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
    return _is_unchanged(path)


def _is_unchanged(path: Path) -> bool:
    """Return whether kanegen wrote exactly this file."""
    with path.open("rb") as file:
        head = file.read(_HEAD)
        if not (b"kanegen" in head or head.startswith(BINARY)):
            return False  # without a look at the rest of what may be a large file
        data = head + file.read()
    if is_unchanged(data):
        return True
    try:
        return is_unchanged(data.decode("utf-8"))
    except UnicodeDecodeError:
        return False
