"""Tables of inputs over the time: CSV, Parquet and NPZ files, or columns of the caller."""

from __future__ import annotations

import csv
import zipfile
import zlib
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import did_you_mean, require_one
from kanegen.errors import OptionError, ReadError, excerpt, quoted
from kanegen.extras import module
from kanegen.files import path_of, reason
from kanegen.library import Library
from kanegen.model.arrays import Floats
from kanegen.simulation.signals import variable_names
from kanegen.simulation.tables import EXTRA, TIME

HOLDS = ("zero", "linear")
"""How a value continues to the next time: it stays, or a straight line leads to the next value."""

_SLACK = 1e-9
"""Share of the time by which a table may end early, so that rounding of times refuses nothing."""


@dataclass(frozen=True)
class InputTable:
    """Values of inputs at increasing times.

    Attributes:
        label: What the table is called in errors, such as the name of its file.
        times: (K,) times, s.
        names: Names of the inputs.
        values: (K, C) values, one column for each name.
        hold: One of `HOLDS`.
    """

    label: str
    times: Floats
    names: tuple[str, ...]
    values: Floats
    hold: str

    def at(self, column: int, time: float, interval: tuple[float, float]) -> float:
        """Return the value of a column at a time (s) within an interval in which nothing jumps."""
        if self.hold == "linear":
            return float(np.interp(time, self.times, self.values[:, column]))
        middle = 0.5 * (interval[0] + interval[1])
        row = max(int(np.searchsorted(self.times, middle, "right")) - 1, 0)
        return float(self.values[row, column])

    def over(self, column: int, times: Floats, inside: Floats) -> Floats:
        """Return the values of a column at (K,) times (s).

        Args:
            column: Number of the column.
            times: The times.
            inside: (K,) times (s) between which and `times` nothing jumps, but for at `times` themselves.
        """
        if self.hold == "linear":
            return np.interp(times, self.times, self.values[:, column])
        rows = np.maximum(np.searchsorted(self.times, inside, "right") - 1, 0)
        found: Floats = self.values[rows, column]
        return found

    def require_span(self, begin: float, end: float) -> None:
        """Make sure that there are values from a first time to a last one (s).

        A value that is held ends where the next one would begin: after the last one it holds for the last
        interval once more.

        Raises:
            OptionError: If the table begins later or ends earlier.
        """
        last = self.times[-1] + (self.times[-1] - self.times[-2] if self.hold == "zero" else 0.0)
        slack = _SLACK * max(abs(begin), abs(end))
        if self.times[0] > begin + slack:
            raise OptionError(
                f"{self.label}: the inputs begin at t = {self.times[0]:.9g} s, the simulation at "
                f"{begin:.9g} s. Add earlier values."
            )
        if last < end - slack:
            raise OptionError(
                f"{self.label}: the inputs end at t = {last:.9g} s, before the simulation does at "
                f"{end:.9g} s. Add values, or simulate up to {last:.9g} s."
            )


def read_table(
    source: str | Path | Mapping[str, ArrayLike], hold: str, known: Collection[str], library: Library
) -> InputTable:
    """Return a table of inputs.

    Args:
        source: A .csv, .parquet or .npz file, or columns by name. One column is "t" (s), the others have the
            names of inputs. Those that have names of states and outputs, as in a saved motion, are left out.
        hold: One of `HOLDS`.
        known: Names of the inputs that there are.
        library: The library on which the inputs act.

    Raises:
        OptionError: If a column is no input, or the times do not increase.
        ReadError: If the file cannot be read; the message has the line where that is known.
        MissingError: If a package is needed that is not installed.
    """
    require_one("hold", hold, HOLDS)
    if isinstance(source, Mapping):
        label, columns = "inputs", {str(name): _column(name, values) for name, values in source.items()}
    else:
        path = path_of(source)
        label, columns = str(path), read_columns(path)
    if TIME not in columns:
        raise OptionError(f"{label}: there is no column {TIME!r}, the time in s. Add it.")
    times = columns.pop(TIME)
    others = set(variable_names(library))
    for name, values in columns.items():
        if name not in known and name not in others:
            raise OptionError(f"{label}: there is no input {quoted(name)}. {did_you_mean(name, known)}")
        if values.shape != times.shape:
            raise OptionError(
                f"{label}: column {quoted(name)} has {len(values)} values, the column of times {len(times)}."
            )
    names = tuple(name for name in columns if name in known)
    if not names:
        raise OptionError(f"{label}: no column is an input. There are {', '.join(known)}.")
    if len(times) < 2 or not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
        raise OptionError(f"{label}: the times must be two or more, finite, and increase.")
    values = np.stack([columns[name] for name in names], axis=1)
    if not np.isfinite(values).all():
        row, column = map(int, np.argwhere(~np.isfinite(values))[0])
        raise OptionError(
            f"{label}: {names[column]} at t = {times[row]:.9g} s is {values[row, column]}, no finite number."
        )
    return InputTable(label, times, names, values, hold)


def read_columns(path: Path) -> dict[str, Floats]:
    """Return the columns of a file by name."""
    if path.suffix not in _READERS:
        raise OptionError(
            f"{path}: there is no format {quoted(path.suffix)}. {did_you_mean(path.suffix, _READERS)}"
        )
    try:
        return _READERS[path.suffix](path)
    except OSError as error:
        raise ReadError(f"{path}: cannot be read: {reason(error)}.") from None


def _csv(path: Path) -> dict[str, Floats]:
    """Return the columns of a CSV file: a line of names, then lines of numbers."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = csv.reader(file)
            names = [name.strip() for name in next(lines, [])]
            rows = [
                _numbers(f"{path}:{lines.line_num}", names, line)
                for line in lines
                if any(map(str.strip, line))
            ]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ReadError(f"{path}: it is no CSV file: {excerpt(str(error), 200)}.") from None
    if len(set(names)) < len(names):
        raise ReadError(f"{path}:1: two columns have the same name. Name each once.")
    values = np.array(rows, np.float64).reshape(len(rows), len(names))
    return {name: values[:, k] for k, name in enumerate(names)}


def _numbers(where: str, names: list[str], line: list[str]) -> list[float]:
    """Return the numbers of a line of a CSV file."""
    if len(line) != len(names):
        raise ReadError(f"{where}: {len(line)} values for {len(names)} columns.")
    found = []
    for name, text in zip(names, line, strict=True):
        try:
            found.append(number_in(text))
        except ValueError:
            raise ReadError(f"{where}: {quoted(text)} in column {quoted(name)} is no number.") from None
    return found


def number_in(text: str) -> float:
    """Return the number of an entry of a CSV file.

    Raises:
        ValueError: If it is none; also with the underscores of numbers in Python, such as 1_000.

    Example:
        number_in("1.5e-3")
    """
    if "_" in text:
        raise ValueError(text)
    return float(text)


def _parquet(path: Path) -> dict[str, Floats]:
    """Return the columns of a Parquet file."""
    arrow, parquet = (module(name, extra=EXTRA) for name in ("pyarrow", "pyarrow.parquet"))
    with path.open("rb") as file:
        try:
            table = parquet.read_table(file)
        except arrow.ArrowException as error:
            raise ReadError(f"{path}: it is no Parquet file: {excerpt(str(error), 200)}.") from None
    return {name: _column(name, table[name].to_numpy(), str(path)) for name in table.column_names}


def _npz(path: Path) -> dict[str, Floats]:
    """Return the arrays of an NPZ file with one axis, and the columns of a saved motion.

    Arrays of objects are not read.
    """
    try:
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            raise ValueError("one array without a name; write it with numpy.savez")
        with loaded as arrays:
            found = {name: arrays[name] for name in arrays.files}
    except (ValueError, zipfile.BadZipFile, EOFError, KeyError, zlib.error) as error:
        raise ReadError(f"{path}: it is no NPZ file of numbers: {excerpt(str(error), 200)}.") from None
    numbers = {
        name: values for name, values in found.items() if values.ndim == 1 and values.dtype.kind in "iuf"
    }
    columns = {name: _column(name, values, str(path)) for name, values in numbers.items()}
    return columns | _of_saved_motion(found)


def _of_saved_motion(arrays: Mapping[str, Any]) -> dict[str, Floats]:
    """Return the columns of the arrays that `Trajectory.save` writes: one array a group, and all names."""
    times, names_of_all = arrays.get(TIME), arrays.get("names")
    if times is None or names_of_all is None or times.ndim != 1 or names_of_all.ndim != 1:
        return {}
    names = [str(name) for name in names_of_all if str(name) != TIME]
    groups = [values for name, values in arrays.items() if name not in (TIME, "names", "units")]
    rows = [values for values in groups if values.dtype.kind in "iuf" and values.shape[:1] == times.shape]
    flat = [values.reshape(len(times), -1) for values in rows if len(times)]
    columns = np.concatenate(flat, axis=1).T if flat else ()
    return dict(zip(names, columns, strict=True)) if len(columns) == len(names) else {}


def _column(name: Any, values: Any, label: str = "inputs") -> Floats:
    """Return a column of numbers.

    Raises:
        OptionError: If it has other than one axis, or anything but real numbers.
    """
    found = np.asarray(values)
    if found.dtype.kind not in "iuf" or found.ndim != 1:
        raise OptionError(f"{label}: column {quoted(name)} has no real numbers in one row.")
    return np.asarray(found, np.float64)


_READERS = {".csv": _csv, ".parquet": _parquet, ".npz": _npz}
"""Functions that read the columns of a file, by the end of its name."""
