"""Files into a folder, so that nothing foreign is overwritten and nothing half-written stays."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from kanegen.c.provenance import is_unchanged
from kanegen.errors import WriteError

_STAGING = ".kanegen-"
"""Start of the names of folders in which files wait until all of them are written."""

_COMMON = "kanegen_"
"""Start of the names of headers that do not depend on the model; which of them there are may."""


def write(files: Mapping[str, str], folder: Path, force: bool = False) -> Path:
    """Write `files` (name to text) into `folder`, as `Source.write` says."""
    try:
        if folder.is_dir():
            _refuse_foreign(folder, files, force)
            with _staging(folder) as staging:
                _fill(staging, files)
                for name in files:
                    os.replace(staging / name, folder / name)
        else:
            folder.parent.mkdir(parents=True, exist_ok=True)
            with _staging(folder.parent) as staging:
                complete = staging / "complete"
                complete.mkdir()
                _fill(complete, files)
                complete.rename(folder)
    except OSError as error:
        raise WriteError(f"{folder}: cannot be written: {error.strerror}. Choose another folder.") from error
    return folder


def require_room(names: Collection[str], folder: Path, force: bool = False) -> None:
    """See that `write` will find room for files of these names, before long work whose results they take.

    Raises:
        WriteError: If it will not.
    """
    try:
        if folder.is_dir():
            _refuse_foreign(folder, names, force)
        else:
            folder.parent.mkdir(parents=True, exist_ok=True)
        with _staging(folder if folder.is_dir() else folder.parent):
            pass
    except OSError as error:
        raise WriteError(f"{folder}: cannot be written: {error.strerror}. Choose another folder.") from error


def _refuse_foreign(folder: Path, files: Collection[str], force: bool) -> None:
    """No file may be there but those that are replaced."""
    foreign = sorted(path.name for path in folder.iterdir() if not _is_replaceable(path, files))
    if foreign and not force:
        raise WriteError(
            f"{folder}: holds {', '.join(foreign)}, which are not this model's files as kanegen wrote them. "
            "Choose another folder, delete them, or force it: --force, force=True."
        )


def _is_replaceable(path: Path, files: Collection[str]) -> bool:
    """Whether it is one of the files, or goes with every model, and is as kanegen wrote it."""
    if path.is_dir():
        return path.name.startswith(_STAGING)
    if path.name not in files and not path.name.startswith(_COMMON):
        return False
    try:
        return is_unchanged(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        return False


@contextmanager
def _staging(folder: Path) -> Iterator[Path]:
    """A new folder inside `folder`, on the same file system, gone at the end."""
    staging = Path(tempfile.mkdtemp(prefix=_STAGING, dir=folder))
    try:
        yield staging
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def _fill(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8", newline="\n")
