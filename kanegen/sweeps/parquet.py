"""Parquet files of finished chunks and of bands, with the same bytes for the same numbers."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.errors import ReadError
from kanegen.extras import module
from kanegen.files import reason
from kanegen.sweeps.axes import EXTRA
from kanegen.sweeps.stores import AGAIN, TABLE, Columns, Layout, Staging, joined

DIGEST_KEY = b"kanegen sweep"
"""Key of the digest of the sweep in the metadata of a file."""

_CONTENT_KEY = b"kanegen sha256"
"""Key of the digest of the file itself, which is computed with zeros in its own place."""

_CONTENT = re.compile(_CONTENT_KEY + rb".{1,8}?sha256:([0-9a-f]{64})", re.DOTALL)
_ZEROS = b"0" * 64

_PART = re.compile(r"part-(\d{7})\.parquet")


class ParquetFolder:
    """Keeps each finished chunk as a file `table/part-<number>.parquet`; other programs read all together."""

    def __init__(self, path: Path, layout: Layout, staging: Staging | None = None) -> None:
        """Open a folder, to read if there is no `staging`.

        Raises:
            MissingError: If PyArrow is not installed.
        """
        module("pyarrow", extra=EXTRA)
        self.layout = layout
        self._table = path / TABLE
        self._staging = staging
        self._whole: dict[str, tuple[int, int]] = {}

    def finished(self) -> Sequence[int]:
        """Return the numbers of the finished chunks, in their order; files of other sweeps do not count."""
        numbers = []
        for entry in sorted(self._table.iterdir()) if self._table.is_dir() else ():
            match = _PART.fullmatch(entry.name)
            if match and (number := int(match[1])) < self.layout.chunks and self._is_whole(entry, number):
                numbers.append(number)
        return numbers

    def _is_whole(self, file: Path, number: int) -> bool:
        """Whether a file holds a chunk of this sweep, bit for bit; it is read again if it has changed."""
        try:
            state = file.stat()
            seen = (state.st_mtime_ns, state.st_size)
            if self._whole.get(file.name) != seen:
                if mark_of(file.read_bytes()) != self._mark(number):
                    return False
                self._whole[file.name] = seen
        except OSError:
            return False
        return True

    def _mark(self, number: int) -> bytes:
        """Return what the metadata of the file of a chunk say: of which sweep it is, and which chunk."""
        return f"{self.layout.digest} {number}".encode()

    def keep(self, number: int, columns: Columns) -> None:
        """Write the columns of a finished chunk.

        Raises:
            WriteError: If the file cannot be written.
        """
        assert self._staging is not None
        arrays = {name: _arrow(columns[name], shape) for name, shape in self.layout.columns.items()}
        self._staging.write(self._file(number), parquet_bytes(arrays, {DIGEST_KEY: self._mark(number)}))

    def columns(self, names: Iterable[str]) -> Columns:
        """Return some columns of all finished chunks, in the order of the rows.

        Raises:
            ReadError: If a file cannot be read.
        """
        wanted = list(names)
        parts = [read_parquet(self._file(number), wanted) for number in self.finished()]
        return {
            name: joined(self.layout, name, [_numpy(part[name], self.layout.columns[name]) for part in parts])
            for name in wanted
        }

    def _file(self, number: int) -> Path:
        """Return the file of a chunk."""
        return self._table / f"part-{number:07d}.parquet"


def parquet_bytes(columns: Mapping[str, Any], metadata: Mapping[bytes, bytes]) -> bytes:
    """Return a Parquet file of columns of PyArrow or NumPy, with a digest of its bytes in its metadata."""
    arrow, parquet = module("pyarrow", extra=EXTRA), module("pyarrow.parquet", extra=EXTRA)
    table = arrow.table(dict(columns)).replace_schema_metadata(metadata)
    sink = arrow.BufferOutputStream()
    with parquet.ParquetWriter(sink, table.schema, compression="zstd") as writer:
        writer.write_table(table)
        writer.add_key_value_metadata({_CONTENT_KEY: b"sha256:" + _ZEROS})
    content: bytes = sink.getvalue().to_pybytes()
    first, last = _place_of_digest(content)
    return content[:first] + hashlib.sha256(content).hexdigest().encode() + content[last:]


def mark_of(content: bytes) -> bytes:
    """Return what the metadata of a file say of which sweep it is; b"" if any bit of the file has changed."""
    if not _is_whole(content):
        return b""
    source = module("pyarrow", extra=EXTRA).BufferReader(content)
    metadata = module("pyarrow.parquet", extra=EXTRA).read_metadata(source).metadata
    return bytes(metadata.get(DIGEST_KEY, b""))


def _is_whole(content: bytes) -> bool:
    """Whether the bytes of a file are those that `parquet_bytes` has returned."""
    first, last = _place_of_digest(content)
    blank = content[:first] + _ZEROS + content[last:]
    return hashlib.sha256(blank).hexdigest().encode() == content[first:last]


def _place_of_digest(content: bytes) -> tuple[int, int]:
    """Return where the digest of a file stands in it, (0, 0) if there is none."""
    tail = max(content.rfind(_CONTENT_KEY), 0)
    match = _CONTENT.match(content, tail)
    return match.span(1) if match else (0, 0)


def read_parquet(file: Path, names: Sequence[str]) -> Any:
    """Return some columns of a Parquet file as a table of PyArrow.

    Raises:
        ReadError: If the file cannot be read, or any bit of it has changed since it was written.
    """
    try:
        content = file.read_bytes()
    except OSError as error:
        raise ReadError(f"{file}: cannot be read: {reason(error)}. {AGAIN}") from None
    if not _is_whole(content):
        raise ReadError(f"{file}: the file is damaged. {AGAIN}")
    source = module("pyarrow", extra=EXTRA).BufferReader(content)
    return module("pyarrow.parquet", extra=EXTRA).ParquetFile(source).read(columns=list(names))


def _arrow(column: Any, shape: tuple[int, ...] | None) -> Any:
    """Return a column as PyArrow has it: numbers, texts, or lists of numbers of one length."""
    arrow = module("pyarrow", extra=EXTRA)
    if not shape:
        return arrow.array(column, arrow.string()) if shape is None else arrow.array(column)
    return arrow.FixedSizeListArray.from_arrays(arrow.array(np.ravel(column)), shape[0])


def _numpy(column: Any, shape: tuple[int, ...] | None) -> Any:
    """Return a column of a table as NumPy has it."""
    if shape is None:
        return np.array(column.to_pylist(), object)
    if not shape:
        return column.to_numpy()
    values = column.combine_chunks().flatten().to_numpy(zero_copy_only=False)
    return values.reshape(-1, *shape)
