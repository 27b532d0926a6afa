"""Where finished chunks are kept: in memory, or in a folder, from which a sweep that was ended goes on.

A folder holds `sweep.json`, which says what the sweep is, and a file, or a marker, for each finished chunk. A
file appears by a rename, so that it is whole or not there, however the process ends. Nothing in the folder
depends on the time, on the number of workers, or on the order in which chunks were finished.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from kanegen.errors import ReadError, WriteError, quoted
from kanegen.files import locked, make_folder, path_of, reason, temporary_folder, write_whole
from kanegen.model.arrays import Floats

MANIFEST = "sweep.json"
"""File that says what a sweep is."""

GO_ON = "Finished chunks are kept; sweep again to go on."
"""What an error says of a sweep in a folder."""

AGAIN = "Sweep again to compute it anew."
"""What an error says of a part of a folder that is damaged or lost."""

FORMAT = "kanegen sweep 1"
"""First entry of the manifest."""

Columns = dict[str, Any]
"""Arrays by name, each with a row for each row of the sweep."""


ROW, AXIS, RESULT, REASON = "row", "axis", "result", "reason"
"""Kinds of columns: the number of the row, a value of an axis, a result, and why a row failed.

The first and the last are also names of columns.
"""


SAMPLE, OVER_TIME = "sample", "time"
"""Dimensions of samples, and of results over time, in xarray."""


@dataclass(frozen=True)
class Layout:
    """What the table of a sweep looks like; it follows from the manifest.

    Attributes:
        manifest: The content of `sweep.json`.
    """

    manifest: Mapping[str, Any]

    @property
    def digest(self) -> str:
        """Digest of everything that the results depend on."""
        return str(self.manifest["digest"])

    @property
    def variants(self) -> int:
        """Number of variants, 1 without axes of variants."""
        return len(self.manifest["times"])

    @property
    def rows_of_variant(self) -> int:
        """Number of rows of each variant."""
        return int(self.manifest["rows"]) // self.variants

    @property
    def chunk_rows(self) -> int:
        """Number of rows of a chunk, but for the last of a variant, which may have fewer."""
        return int(self.manifest["chunk_rows"])

    @cached_property
    def columns(self) -> Mapping[str, tuple[int, ...] | None]:
        """Shape of each column beside the rows, by its name; None for a column of text."""
        return {
            name: None if column.get("text") else (column["times"],) if "times" in column else ()
            for name, column in self.manifest["columns"].items()
        }

    def named(self, kind: str) -> tuple[str, ...]:
        """Return the names of the columns of a kind."""
        return tuple(name for name, one in self.manifest["columns"].items() if one["kind"] == kind)

    def unit(self, column: str) -> str:
        """Return the unit of a column, "" where it has none."""
        return str(self.manifest["columns"][column].get("unit", ""))

    def times(self, variant: int) -> Floats:
        """Return the times of bands and of results over time of a variant, s."""
        interval, count = self.manifest["times"][variant]
        found: Floats = np.arange(count) * float(interval)
        return found

    @property
    def chunks_of_variant(self) -> int:
        """Number of chunks of a variant."""
        return -(-self.rows_of_variant // self.chunk_rows)

    @property
    def chunks(self) -> int:
        """Number of chunks of all variants."""
        return self.variants * self.chunks_of_variant

    def part(self, number: int) -> tuple[int, int, int]:
        """Return the variant of a chunk, and its first and last row, plus 1, in this variant."""
        variant, place = divmod(number, self.chunks_of_variant)
        first = place * self.chunk_rows
        return variant, first, min(first + self.chunk_rows, self.rows_of_variant)

    def size(self, number: int) -> int:
        """Return the number of rows of a chunk."""
        _, first, last = self.part(number)
        return last - first


class Store(Protocol):
    """A place that keeps finished chunks."""

    layout: Layout

    def finished(self) -> Sequence[int]:
        """Return the numbers of the finished chunks, in their order."""

    def keep(self, number: int, columns: Columns) -> None:
        """Keep the columns of a finished chunk."""

    def columns(self, names: Iterable[str]) -> Columns:
        """Return some columns of all finished chunks, in the order of the rows."""


class Memory:
    """Keeps finished chunks in memory."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self._parts: dict[int, Columns] = {}

    def finished(self) -> Sequence[int]:
        """Return the numbers of the finished chunks, in their order."""
        return sorted(self._parts)

    def keep(self, number: int, columns: Columns) -> None:
        """Keep the columns of a finished chunk."""
        self._parts[number] = columns

    def columns(self, names: Iterable[str]) -> Columns:
        """Return some columns of all finished chunks, in the order of the rows."""
        parts = [self._parts[number] for number in self.finished()]
        return {name: joined(self.layout, name, [part[name] for part in parts]) for name in names}


def joined(layout: Layout, name: str, parts: Sequence[Any]) -> Any:
    """Return a column of several chunks as one array, also where there is no chunk."""
    shape = layout.columns[name]
    if parts:
        return np.concatenate(parts)
    return np.empty((0, *(shape or ())), object if shape is None else np.float64)


@contextmanager
def prepared_folder(folder: object, layout: Layout) -> Iterator[Staging]:
    """Yield the place from which files enter the folder of a sweep, which belongs to this process until then.

    Args:
        folder: The folder, which is made if it is missing.
        layout: The sweep that it is for.

    Raises:
        WriteError: If it holds anything but this sweep, another process writes there, or it cannot be
            written.
    """
    path = path_of(folder)
    make_folder(path)
    _require_usable(path, layout)
    with ExitStack() as stack:
        stack.enter_context(_one_process(path))
        _require_usable(path, layout)  # another process may have begun meanwhile
        write_whole(path / MANIFEST, manifest_text(layout.manifest))
        try:
            folder_of_new_files = stack.enter_context(temporary_folder(path))
        except OSError as error:
            raise WriteError(f"{path}: cannot be written: {reason(error)}.") from None
        yield Staging(path, folder_of_new_files)


def _require_usable(path: Path, layout: Layout) -> None:
    """Require that a folder is empty, or that it holds the same sweep.

    Raises:
        ReadError: If it has a manifest that is none of kanegen.
        WriteError: If it holds anything else.
    """
    if (path / MANIFEST).exists():
        require_same(path, read_manifest(path), layout.manifest)
    else:
        _require_empty(path)


def sealed(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a manifest with the digest of its other entries."""
    rest = {name: value for name, value in content.items() if name != "digest"}
    return {**rest, "digest": hashlib.sha256(manifest_text(rest).encode()).hexdigest()}


def manifest_text(manifest: Mapping[str, Any]) -> str:
    """Return the content of `sweep.json`."""
    return json.dumps(manifest, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_manifest(path: Path) -> dict[str, Any]:
    """Return the manifest of a folder.

    Raises:
        ReadError: If there is none, or it is none of kanegen.
    """
    try:
        found = json.loads((path / MANIFEST).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ReadError(f"{path}: there is no {MANIFEST}, so this is no folder of a sweep.") from None
    except OSError as error:
        raise ReadError(f"{path / MANIFEST}: cannot be read: {reason(error)}.") from None
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise ReadError(f"{path / MANIFEST}: this is no file of a sweep of this version of kanegen.")
    return found


def require_unchanged(path: Path, manifest: Mapping[str, Any]) -> None:
    """Require that a manifest has the digest of its entries, so that every entry is there and right.

    Raises:
        ReadError: If it has not.
    """
    try:
        is_right = sealed(manifest)["digest"] == manifest.get("digest")
    except ValueError:  # numbers that JSON has not
        is_right = False
    if not is_right:
        raise ReadError(f"{path / MANIFEST}: it was changed or damaged. Sweep again to write it anew.")


def require_same(path: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Require that a folder holds the sweep that is to be continued.

    Raises:
        WriteError: If it holds another one; the message names the first difference.
    """
    if found.get("digest") == wanted["digest"]:
        return
    difference = _difference(found, json.loads(manifest_text(wanted)))
    raise WriteError(f"{path}: holds another sweep: {difference}. Choose another folder.")


def _difference(found: Any, wanted: Any, name: str = "") -> str:
    """Return a clause on the first entry in which two manifests differ."""
    if isinstance(found, dict) and isinstance(wanted, dict):
        for key in dict.fromkeys((*wanted, *found)):
            if found.get(key) != wanted.get(key) and key != "digest":
                return _difference(found.get(key), wanted.get(key), f"{name}.{key}" if name else key)
    if name in ("model", "code"):
        return "its model differs" if name == "model" else "its generated code differs"
    return f"its {name} is {quoted(found)}, not {quoted(wanted)}" if name else "it has another digest"


def _require_empty(path: Path) -> None:
    """Require that a folder that is no sweep holds nothing.

    Raises:
        WriteError: If it holds something.
    """
    try:
        others = sorted(entry.name for entry in path.iterdir() if not _is_left_over(entry))
    except OSError as error:
        raise WriteError(f"{path}: cannot be read: {reason(error)}.") from None
    if others:
        raise WriteError(
            f"{path}: holds {quoted(others[0])} and is no folder of a sweep. Choose an empty or a new folder."
        )


def _is_left_over(entry: Path) -> bool:
    """Whether a sweep that was killed before its manifest was there leaves such an entry of a folder."""
    return entry.name.startswith(".kanegen-") or (
        entry.name == TABLE and entry.is_dir() and not any(entry.iterdir())
    )


@contextmanager
def _one_process(path: Path) -> Iterator[None]:
    """Keep other processes from writing the same sweep, where the file system has locks.

    Raises:
        WriteError: If another process writes it.
    """
    make_folder(path / TABLE)
    with ExitStack() as stack:
        try:
            stack.enter_context(locked(path / TABLE, wait=False))
        except BlockingIOError:
            raise WriteError(f"{path}: another process runs this sweep.") from None
        except OSError as error:
            raise WriteError(f"{path / TABLE}: cannot be opened: {reason(error)}.") from None
        yield


TABLE = "table"
"""Folder of the files, or of the markers, of finished chunks."""


@dataclass(frozen=True)
class Staging:
    """A temporary folder from which whole files are renamed to their places.

    Attributes:
        path: The folder of the sweep.
        temporary: The temporary folder.
    """

    path: Path
    temporary: Path

    def write(self, target: Path, content: bytes) -> None:
        """Write a file, whole or not at all.

        Raises:
            WriteError: If it cannot be written, as on a disk that is full.
        """
        new = self.temporary / "new"
        try:
            target.parent.mkdir(exist_ok=True)
            new.write_bytes(content)
            os.replace(new, target)
        except OSError as error:
            raise WriteError(f"{target}: cannot be written: {reason(error)}. {GO_ON}") from None
