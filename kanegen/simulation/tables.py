"""Motions as tables: pandas, xarray, and files that are written whole or not at all."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.extras import module
from kanegen.files import path_of, write_all
from kanegen.model.arguments import Floats
from kanegen.simulation.elements import Axis, Element

EXTRA = "results"
"""The extra that brings pandas, pyarrow, xarray and h5netcdf."""

TIME = "t"
"""Name of the column of times."""

STATE = "state"
"""Name of the column with the number of the state, from 0, where several moved at once."""


@dataclass(frozen=True)
class Group:
    """Columns that belong together: the coordinates, the speeds, or an output.

    Attributes:
        axes: The axes of one value, none for a single number.
        elements: Names and units of the columns.
        values: (T, ...) or (T, B, ...) with these axes.
    """

    axes: Sequence[Axis]
    elements: Sequence[Element]
    values: Floats


@dataclass(frozen=True)
class Table:
    """A motion as groups of columns over the time.

    Attributes:
        times: (T,) times, s.
        states: Number B of states that moved at once; None for a single one.
        groups: The groups by name: "x", "y", "tau" and outputs.
        attributes: Texts about the whole: model, method, software.
    """

    times: Floats
    states: int | None
    groups: Mapping[str, Group]
    attributes: Mapping[str, str] = field(default_factory=dict)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column by its name."""
        return {TIME: "s", **{one.name: one.unit for group in self.groups.values() for one in group.elements}}

    def columns(self) -> dict[str, Floats]:
        """Return all columns by name: (T,) each, or (T, B)."""
        lead = 1 if self.states is None else 2
        found: dict[str, Floats] = {TIME: self.times}
        for group in self.groups.values():
            flat = group.values.reshape(*group.values.shape[:lead], -1)
            found |= {one.name: flat[..., place] for place, one in enumerate(group.elements)}
        return found

    def rows(self) -> dict[str, np.ndarray[Any, Any]]:
        """Return all columns as single rows of numbers: those of one state after those of another."""
        columns = self.columns()
        if self.states is None:
            return dict(columns)
        T = len(self.times)
        found = {STATE: np.repeat(np.arange(self.states), T), TIME: np.tile(self.times, self.states)}
        return found | {name: values.T.reshape(-1) for name, values in columns.items() if name != TIME}


def data_frame(table: Table) -> Any:
    """Return a table as a `pandas.DataFrame`, see `Trajectory.to_pandas`."""
    pandas = module("pandas", extra=EXTRA)
    rows = table.rows()
    index = [pandas.Index(rows.pop(name), name=name) for name in (STATE, TIME) if name in rows]
    both = index[0] if len(index) == 1 else pandas.MultiIndex.from_arrays(index)
    frame = pandas.DataFrame(np.column_stack(list(rows.values())), both, list(rows))
    frame.attrs = {**table.attributes, "units": {**table.units}}
    return frame


def dataset(table: Table) -> Any:
    """Return a table as an `xarray.Dataset`, see `Trajectory.to_xarray`."""
    xarray = module("xarray", extra=EXTRA)
    lead = (TIME,) if table.states is None else (TIME, STATE)
    coordinates: dict[str, Any] = {TIME: (TIME, table.times, {"units": "s"})}
    if table.states is not None:
        coordinates[STATE] = np.arange(table.states)
    variables = {}
    for name, group in table.groups.items():
        dimensions = _dimensions(name, group.axes, coordinates)
        coordinates |= dict(zip(dimensions, (list(axis.labels) for axis in group.axes), strict=True))
        units = dict.fromkeys(one.unit for one in group.elements)
        variables[name] = ((*lead, *dimensions), group.values, {"units": ", ".join(units)})
    return xarray.Dataset(variables, coordinates, dict(table.attributes))


def _dimensions(group: str, axes: Sequence[Axis], known: Mapping[str, Any]) -> list[str]:
    """Return the names of the axes of a group as dimensions: those with other places have other names."""
    found: list[str] = []
    for axis in axes:
        is_other = axis.name in found or list(known.get(axis.name, axis.labels)) != list(axis.labels)
        found.append(f"{group}_{axis.name}" if is_other else axis.name)
    return found


def save(table: Table, path: str | Path) -> None:
    """Write a table into a file, whole or not at all, see `Trajectory.save`."""
    target = path_of(path)
    write_all({target: writer(target)(table)})


def writer(path: Path) -> Callable[[Table], bytes]:
    """Return the function that makes the content of a file of this name.

    Raises:
        OptionError: If there is no format of its end.
        MissingError: If a package of the format is not installed.
    """
    if path.suffix not in _WRITERS:
        raise OptionError(
            f"{path}: there is no format {quoted(path.suffix)}. {did_you_mean(path.suffix, _WRITERS)}"
        )
    packages, write = _WRITERS[path.suffix]
    for package in packages:
        module(package, extra=EXTRA)
    return write


def _csv(table: Table) -> bytes:
    """Return a table as CSV: a line of names, then a line for each time; numbers have all their digits."""
    columns = table.rows()
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(columns)
    lines.writerows(zip(*(values.tolist() for values in map(_doubles, columns.values())), strict=True))
    return text.getvalue().encode()


def _parquet(table: Table) -> bytes:
    """Return a table as Parquet, with the unit of each column in its metadata and in `attrs` of pandas."""
    arrow, parquet = (module(name, extra=EXTRA) for name in ("pyarrow", "pyarrow.parquet"))
    units = table.units
    columns = {name: _doubles(values) for name, values in table.rows().items()}
    fields = [
        arrow.field(name, arrow.from_numpy_dtype(values.dtype), metadata={"units": units.get(name, "1")})
        for name, values in columns.items()
    ]
    for_pandas = {"PANDAS_ATTRS": json.dumps({**table.attributes, "units": units})}  # as pandas writes them
    schema = arrow.schema(fields, metadata={**table.attributes, **for_pandas})
    content = io.BytesIO()
    parquet.write_table(arrow.table(list(columns.values()), schema=schema), content)
    return content.getvalue()


def _netcdf(table: Table) -> bytes:
    """Return a table as NetCDF 4."""
    plain = {name: _doubles(group.values) for name, group in table.groups.items()}
    groups = {name: Group(one.axes, one.elements, plain[name]) for name, one in table.groups.items()}
    found = dataset(Table(table.times, table.states, groups, table.attributes))
    return bytes(found.to_netcdf(engine="h5netcdf"))


def _npz(table: Table) -> bytes:
    """Return a table as arrays of NumPy: "t", one of each group, and the names and units of all columns."""
    units = table.units
    content = io.BytesIO()
    arrays: dict[str, Any] = {name: group.values for name, group in table.groups.items()}
    names, of_names = np.array(list(units)), np.array(list(units.values()))
    np.savez(content, t=table.times, names=names, units=of_names, **arrays)
    return content.getvalue()


def _doubles(values: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return numbers of more precision than a double as doubles, which other programs read."""
    return values.astype(np.float64) if values.dtype == np.longdouble else values


_WRITERS: dict[str, tuple[tuple[str, ...], Callable[[Table], bytes]]] = {
    ".csv": ((), _csv),
    ".parquet": (("pyarrow",), _parquet),
    ".nc": (("xarray", "h5netcdf", "h5py"), _netcdf),
    ".npz": ((), _npz),
}
"""By the end of a file's name the packages that its format needs, and the function that makes its content."""

FORMATS = tuple(_WRITERS)
"""Ends of the names of files that can be written."""
