"""Zarr arrays of the finished chunks of a sweep, one for each column."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.errors import ReadError, WriteError
from kanegen.extras import module
from kanegen.sweeps.axes import EXTRA
from kanegen.sweeps.stores import GO_ON, ROW, TABLE, Columns, Layout, Staging, joined

ARRAYS = "arrays.zarr"
"""Group of the arrays, each (V, R) with R rows for each of V variants, or (V, R, T)."""

_MARKER = re.compile(r"part-(\d{7})")


class ZarrFolder:
    """Keeps each finished chunk as a chunk of every array, and a marker `table/part-<number>` beside them.

    The marker appears after the numbers, so that a chunk that was written in part is computed again.
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
        return [number for number in numbers if number < self.layout.chunks]

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
        self._staging.write(self._markers / f"part-{number:07d}", self.layout.digest.encode())

    def columns(self, names: Iterable[str]) -> Columns:
        """Return some columns of all finished chunks, in the order of the rows."""
        parts = [self.layout.part(number) for number in self.finished()]
        found: Columns = {}
        for name in names:
            array = self._group[_key(name)]
            numbers = [np.asarray(array[variant, first:last]) for variant, first, last in parts]
            if self.layout.columns[name] is None:
                numbers = [one.astype(object) for one in numbers]
            found[name] = joined(self.layout, name, numbers)
        return found

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
