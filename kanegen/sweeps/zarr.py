"""Zarr arrays of the finished chunks of a sweep, one for each column."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.errors import ReadError, WriteError
from kanegen.extras import module
from kanegen.sweeps.axes import EXTRA
from kanegen.sweeps.stores import AGAIN, GO_ON, ROW, TABLE, Columns, Layout, Staging, joined

ARRAYS = "arrays.zarr"
"""Group of the arrays, each (V, R) with R rows for each of V variants, or (V, R, T)."""

_MARKER = re.compile(r"part-(\d{7})")


class ZarrFolder:
    """Keeps each finished chunk as a chunk of every array, and a marker `table/part-<number>` beside them.

    The marker appears after the numbers, so that a chunk that was written in part is computed again. It has a
    digest of the numbers, so that a chunk that has changed since is computed again, too.
    """

    def __init__(self, path: Path, layout: Layout, staging: Staging | None = None) -> None:
        """Open a folder, to read if there is no `staging`.

        Raises:
            MissingError: If Zarr is not installed.
        """
        zarr = module("zarr", extra=EXTRA)
        self.layout = layout
        self._markers = path / TABLE
        self._staging = staging
        self._whole: dict[int, bytes] = {}
        try:
            self._group = zarr.open_group(path / ARRAYS, mode="r" if staging is None else "a")
            if staging is not None:
                self._make_arrays()
        except (OSError, ValueError) as error:
            raise ReadError(f"{path / ARRAYS}: cannot be opened: {' '.join(str(error).split())}") from None

    def finished(self) -> Sequence[int]:
        """Return the numbers of the finished chunks, in their order."""
        names = sorted(entry.name for entry in self._markers.iterdir()) if self._markers.is_dir() else []
        numbers = [int(match[1]) for match in map(_MARKER.fullmatch, names) if match]
        return [number for number in numbers if number < self.layout.chunks and self._is_whole(number)]

    def _is_whole(self, number: int) -> bool:
        """Whether the numbers of a chunk are those for which its marker was written; they are read once."""
        try:
            marker = self._marker(number).read_bytes()
            if self._whole.get(number) != marker:
                columns = {name: self._read(name, number) for name in self.layout.columns}
                if marker != self._mark(number, columns):
                    return False
                self._whole[number] = marker
        except (OSError, ReadError):
            return False
        return True

    def _marker(self, number: int) -> Path:
        """Return the file that tells that a chunk is finished."""
        return self._markers / f"part-{number:07d}"

    def _mark(self, number: int, columns: Columns) -> bytes:
        """Return the content of the marker of a chunk: of which sweep it is, and a digest of its numbers."""
        digest = hashlib.sha256(f"{self.layout.digest} {number}".encode())
        for name, shape in self.layout.columns.items():
            column = columns[name]
            if shape is None:
                digest.update("\0".join(map(str, column)).encode())
            else:  # Zarr may lose the sign of a zero
                digest.update((np.ascontiguousarray(column) + 0).tobytes())
        return f"{self.layout.digest} {digest.hexdigest()}".encode()

    def _read(self, name: str, number: int) -> Any:
        """Return a column of a chunk.

        Raises:
            ReadError: If it cannot be read.
        """
        variant, first, last = self.layout.part(number)
        try:
            found = np.asarray(self._group[_key(name)][variant, first:last])
        except (OSError, ValueError, RuntimeError, KeyError, TypeError) as error:
            why = " ".join(str(error).split())
            raise ReadError(
                f"{self._markers.parent / ARRAYS}: {name}: cannot be read: {why}. {AGAIN}"
            ) from None
        return found.astype(object) if self.layout.columns[name] is None else found

    def keep(self, number: int, columns: Columns) -> None:
        """Write the columns of a finished chunk, then its marker.

        Raises:
            WriteError: If they cannot be written.
        """
        assert self._staging is not None
        variant, first, last = self.layout.part(number)
        try:
            for name in self.layout.columns:
                self._group[_key(name)][variant, first:last] = columns[name]
        except OSError as error:
            why = error.strerror or str(error)
            raise WriteError(f"{self._staging.path / ARRAYS}: cannot be written: {why}. {GO_ON}") from None
        self._staging.write(self._marker(number), self._mark(number, columns))

    def columns(self, names: Iterable[str]) -> Columns:
        """Return some columns of all finished chunks, in the order of the rows."""
        parts = self.finished()
        return {
            name: joined(self.layout, name, [self._read(name, number) for number in parts]) for name in names
        }

    def _make_arrays(self) -> None:
        """Make the arrays that are missing."""
        size, rows = (self.layout.variants, self.layout.rows_of_variant), self.layout.chunk_rows
        for name, shape in self.layout.columns.items():
            if _key(name) in self._group:
                continue
            kind: Any = "string" if shape is None else "int64" if name == ROW else "float64"
            inner = shape or ()
            self._group.create_array(
                _key(name),
                shape=(*size, *inner),
                chunks=(1, rows, *inner),
                dtype=kind,
                attributes={"units": self.layout.unit(name), "name": name},
                dimension_names=["variant", "row", *["time"] * len(inner)],
            )


def _key(column: str) -> str:
    """Return the name of the array of a column, without separators of folders."""
    return column.replace("/", "_")
