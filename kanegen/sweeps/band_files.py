"""Files of the bins of bands in the folder of a sweep, merged level by level while chunks finish."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from kanegen.errors import WriteError
from kanegen.files import reason
from kanegen.sweeps.bands import FIELDS, Bins, merged
from kanegen.sweeps.parquet import DIGEST_KEY, mark_of, parquet_bytes, read_parquet
from kanegen.sweeps.stores import Layout, Staging

BANDS = "bands"
"""Folder of the files."""

_NAME = re.compile(r"variant-(\d+)-level-(\d+)-(\d+)\.parquet")
_FAN = 16
"""Files of one level that become one of the next."""


class BandStore(Protocol):
    """Keeps the bins of finished chunks."""

    def keep(self, number: int, bins: Bins) -> None:
        """Keep the bins of a chunk, before its columns are kept."""

    def compact(self, number: int, is_finished: Callable[[int], bool]) -> None:
        """Merge the bins around a chunk, as far as the columns of all chunks there are kept."""

    def holds(self, number: int) -> bool:
        """Whether the bins of a chunk are kept."""

    def bins(self, variant: int) -> list[Bins]:
        """Return the bins of a variant in parts, each chunk in one of them."""


class BandsInMemory:
    """Keeps the bins of finished chunks in memory, merged as they come."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._bins: dict[int, Bins] = {}
        self._numbers: set[int] = set()

    def keep(self, number: int, bins: Bins) -> None:
        """Add the bins of a chunk to those of its variant."""
        variant = self._layout.part(number)[0]
        known = [self._bins[variant]] if variant in self._bins else []
        self._bins[variant] = merged([*known, bins])
        self._numbers.add(number)

    def compact(self, number: int, is_finished: Callable[[int], bool]) -> None:
        """Leave the bins as they are: they are merged already."""

    def holds(self, number: int) -> bool:
        """Whether the bins of a chunk are kept."""
        return number in self._numbers

    def bins(self, variant: int) -> list[Bins]:
        """Return the bins of a variant."""
        return [self._bins[variant]] if variant in self._bins else []


class BandFiles:
    """Keeps the bins of finished chunks in few files.

    A file of level 0 has the bins of one chunk, a file of the next level those of 16 consecutive ones, and so
    on; when all chunks of a variant are finished, all of them are in one file. A merged file appears before
    those that it replaces disappear, and these do not count as soon as it is there.
    """

    def __init__(self, path: Path, layout: Layout, staging: Staging | None = None) -> None:
        """Open the folder `bands` of a sweep, to read if there is no `staging`."""
        self._path = path / BANDS
        self._layout = layout
        self._staging = staging
        if staging is not None:
            self._remove_damaged()

    def _remove_damaged(self) -> None:
        """Remove files that are not whole or of another sweep; the chunks in them are not finished.

        Raises:
            WriteError: If a file cannot be read or removed.
        """
        digest = self._layout.digest.encode()
        for file in self._path.glob("*.parquet"):
            try:
                if mark_of(file.read_bytes()) != digest:
                    file.unlink()
            except OSError as error:
                raise WriteError(f"{file}: cannot be read or removed: {reason(error)}.") from None

    def holds(self, number: int) -> bool:
        """Whether there is a file with the bins of a chunk."""
        variant, place = divmod(number, self._layout.chunks_of_variant)
        return self._file(variant, 0, place).exists() or self._is_merged(variant, 1, place)

    def keep(self, number: int, bins: Bins) -> None:
        """Write the bins of a chunk, unless a merged file has them already.

        Raises:
            WriteError: If the file cannot be written.
        """
        variant, place = divmod(number, self._layout.chunks_of_variant)
        if not self._is_merged(variant, 1, place):
            self._write(self._file(variant, 0, place), bins)

    def compact(self, number: int, is_finished: Callable[[int], bool]) -> None:
        """Merge the files around a chunk, as far as all chunks that they cover are finished.

        Args:
            number: Number of the chunk.
            is_finished: Function that tells whether the columns of a chunk are kept.

        Raises:
            WriteError: If a file cannot be written.
        """
        count = self._layout.chunks_of_variant
        variant, place = divmod(number, count)
        for level, width in self._levels():
            target = self._file(variant, level, place // width)
            first = place // width * width
            last = min(first + width, count)
            if not all(is_finished(variant * count + one) for one in range(first, last)):
                return
            inner = width // _FAN
            children = [
                self._file(variant, level - 1, one) for one in range(first // inner, -(-last // inner))
            ]
            if not self._is_merged(variant, level, place):
                self._write(target, merged(map(_read, children)))
            for child in children:
                child.unlink(missing_ok=True)

    def bins(self, variant: int) -> list[Bins]:
        """Return the bins of a variant in parts, each chunk in one of them.

        Raises:
            ReadError: If a file cannot be read.
        """
        matches = map(_NAME.fullmatch, sorted(entry.name for entry in self._path.glob("*.parquet")))
        found = [tuple(map(int, match.groups())) for match in matches if match]
        return [
            _read(self._file(variant, level, place))
            for own, level, place in found
            if own == variant and not self._is_merged(variant, level + 1, place * _FAN**level)
        ]

    def _is_merged(self, variant: int, least: int, place: int) -> bool:
        """Whether a file of a level, or of a higher one, has the bins of a chunk."""
        return any(
            self._file(variant, level, place // width).exists()
            for level, width in self._levels()
            if level >= least
        )

    def _levels(self) -> list[tuple[int, int]]:
        """Return the levels of merged files, each with the number of chunks of a file."""
        found = [(1, _FAN)]
        while found[-1][1] < self._layout.chunks_of_variant:
            found.append((found[-1][0] + 1, found[-1][1] * _FAN))
        return found

    def _file(self, variant: int, level: int, place: int) -> Path:
        """Return the file of a level."""
        return self._path / f"variant-{variant}-level-{level}-{place:07d}.parquet"

    def _write(self, file: Path, bins: Bins) -> None:
        """Write bins into a file with the digest of the sweep."""
        assert self._staging is not None
        columns = {name: getattr(bins, name) for name in FIELDS}
        self._staging.write(file, parquet_bytes(columns, {DIGEST_KEY: self._layout.digest.encode()}))


def _read(file: Path) -> Bins:
    """Return the bins of a file."""
    table = read_parquet(file, FIELDS)
    return Bins(*(table[name].to_numpy() for name in FIELDS))
