"""The results of a sweep: a table, arrays over the axes, reasons of failed rows, and reductions over rows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, OptionError, ReadError, counted, quoted
from kanegen.extras import module
from kanegen.model.arrays import Floats
from kanegen.pictures.html import sentence, shown, table
from kanegen.sweeps.axes import EXTRA
from kanegen.sweeps.band_files import BandStore
from kanegen.sweeps.bands import Bins, Integers, merged, quantile
from kanegen.sweeps.stores import AGAIN, OVER_TIME, REASON, RESULT, ROW, SAMPLE, Columns, Layout, Store

MOST_SHOWN, MOST_COLUMNS = 8, 12
"""Numbers of rows and of columns that a notebook shows."""


@dataclass(frozen=True, repr=False)
class SweepResult:
    """What a sweep has computed so far; rows that failed have NaN and a reason.

    Attributes:
        store: Where the finished chunks are.
        band_store: Where the distributions of bands are.
        folder: Folder of the results, None if they are in memory.

    Example:
        found = kg.sweep(system, {"m1": [1.0, 2.0, 3.0]}, kg.RolloutJob(10.0, 1e-3))
        print(found.table)
    """

    store: Store
    band_store: BandStore
    folder: Path | None = None

    def __repr__(self) -> str:
        failed = len(self.reasons)
        rows = f"{self.finished} of {counted(self.rows, 'row')}"
        return f"<SweepResult of {self.name}: {rows}, {failed} with a reason, {', '.join(self.results)}>"

    def _repr_html_(self) -> str:
        """What is computed, and the first rows of the table, for a notebook."""
        layout = self._layout
        single = [name for name, shape in layout.columns.items() if not shape][:MOST_COLUMNS]
        columns = self._columns(single)
        rows = zip(*(columns[name].tolist() for name in single), strict=True)
        cells = [[f"{one:.6g}" if isinstance(one, float) else one for one in row] for row in rows]
        line = f"{self.finished} of {counted(self.rows, 'row')}, {len(self.reasons)} with a reason"
        return shown(sentence("{}", line, strong=self.name), table(single, cells, "found.table", MOST_SHOWN))

    def __len__(self) -> int:
        return self.finished

    @property
    def _layout(self) -> Layout:
        return self.store.layout

    @property
    def name(self) -> str:
        """Name of the system, as its model has it."""
        return str(self._layout.manifest["name"])

    @property
    def results(self) -> tuple[str, ...]:
        """Names of the results, each a column of the table."""
        return self._layout.named(RESULT)

    @property
    def band_names(self) -> tuple[str, ...]:
        """Names of the quantities whose distribution is kept at every time."""
        return tuple(self._layout.manifest["bands"])

    @property
    def rows(self) -> int:
        """Number of rows of the whole sweep."""
        return self._layout.variants * self._layout.rows_of_variant

    @property
    def finished(self) -> int:
        """Number of rows that are computed."""
        return sum(map(self._layout.size, self.store.finished()))

    @property
    def is_complete(self) -> bool:
        """Whether all rows are computed."""
        return self.finished == self.rows

    def column(self, name: str) -> Any:
        """Return one column of the finished rows, in their order.

        Args:
            name: An axis, a result, "row" or "reason".

        Returns:
            (R,) numbers or texts; (R, T) numbers of a result over time.

        Raises:
            OptionError: If there is no such column.

        Example:
            found.column("end.x.q1").max()
        """
        return self._columns([name])[name]

    @property
    def table(self) -> Any:
        """The finished rows as a data frame of pandas; a result over time is a column of arrays.

        Raises:
            MissingError: If pandas is not installed.
        """
        pandas = module("pandas", extra=EXTRA)
        columns = self._columns(self._layout.columns)
        columns = {name: list(one) if np.ndim(one) > 1 else one for name, one in columns.items()}
        return pandas.DataFrame(columns).set_index(ROW)

    @property
    def reasons(self) -> dict[int, str]:
        """Why rows failed or may be inaccurate, by their numbers."""
        columns = self._columns([ROW, REASON])
        pairs = zip(columns[ROW].tolist(), columns[REASON].tolist(), strict=True)
        return {row: reason for row, reason in pairs if reason}

    def to_xarray(self) -> Any:
        """Return the results as a dataset of xarray with a dimension for each axis, and one for samples.

        Rows that are not computed are NaN. Results over time have the dimension "time".

        Raises:
            MissingError: If xarray is not installed.

        Example:
            found.to_xarray()["max.y.q2"].sel(m1=2.0)
        """
        xarray = module("xarray", extra=EXTRA)
        dimensions = self._layout.manifest["dimensions"]
        shape = tuple(one["size"] for one in dimensions)
        names = [", ".join(one["names"]) or SAMPLE for one in dimensions]
        columns = self._columns(self._layout.columns)
        rows = columns.pop(ROW)
        data: dict[str, Any] = {}
        coordinates: dict[str, Any] = {}
        for name, column in columns.items():
            full = self._full(rows, column).reshape(*shape, *np.shape(column)[1:])
            attributes = {"units": unit} if (unit := self._layout.unit(name)) else {}
            is_sampled = self._layout.manifest["columns"][name].get("sampled", False)
            own = [
                place
                for place, one in enumerate(dimensions)
                if name in one["names"] or (is_sampled and not one["names"])
            ]
            if own:
                index = tuple(slice(None) if place in own else 0 for place in range(len(shape)))
                coordinates[name] = ([names[own[0]]], full[index], attributes)
            else:
                target = data if name in (*self.results, REASON) else coordinates
                target[name] = ([*names, *[OVER_TIME] * (full.ndim - len(shape))], full, attributes)
        if any(np.ndim(column) > 1 for column in columns.values()):
            coordinates[OVER_TIME] = ([OVER_TIME], self._layout.times(0), {"units": "s"})
        return xarray.Dataset(data, coordinates, {"title": self.name})

    def quantiles(self, name: str, shares: Iterable[float] = (0.05, 0.5, 0.95)) -> Floats:
        """Return the values below which shares of the finished rows that did not fail lie, without sketches.

        Args:
            name: A result or an axis.
            shares: (Q,) shares, 0 to 1.

        Returns:
            (Q,) values; (Q, T) of a result over time.

        Raises:
            OptionError: If there is no such column of numbers.

        Example:
            low, middle, high = found.quantiles("max.y.q2")
        """
        return np.asarray(np.quantile(self._usable(name), list(shares), axis=0))

    def extremes(self, name: str) -> tuple[Any, Any]:
        """Return the smallest and the largest value of a result or an axis over the rows that did not fail.

        Raises:
            OptionError: If there is no such column of numbers, or all rows failed.

        Example:
            least, greatest = found.extremes("drift.energy")
        """
        values = self._usable(name)
        return values.min(axis=0), values.max(axis=0)

    def histogram(self, name: str, edges: Any = 20) -> tuple[Integers, Floats]:
        """Return how many rows have values between edges.

        Args:
            name: A result or an axis.
            edges: (H + 1,) edges, or a number H of intervals of equal length between the extremes.

        Returns:
            (H,) counts and (H + 1,) edges.

        Raises:
            OptionError: If there is no such column of numbers, or all rows failed.

        Example:
            counts, edges = found.histogram("end.x.q1", 50)
        """
        counts, ends = np.histogram(self._usable(name), edges)
        return counts, ends

    def summary(self) -> list[dict[str, Any]]:
        """Return least, 5 %, median, 95 % and greatest values of each result that is one number a row.

        Rows that failed do not count; a result without any value is left out.

        Example:
            [one["name"] for one in found.summary()]
        """
        shares = (0.0, 0.05, 0.5, 0.95, 1.0)
        single = [name for name in self.results if self._layout.columns[name] == ()]
        columns = self._columns(single)
        found = []
        for name in single:
            values = columns[name][np.isfinite(columns[name])]
            if len(values):
                unit = self._layout.unit(name)
                found.append({"name": name, "unit": unit, "values": np.quantile(values, shares).tolist()})
        return found

    def bands(self, name: str, variant: int = 0) -> Band:
        """Return the distribution of a quantity over all rows at every time.

        Args:
            name: Name of the quantity, one of `band_names`.
            variant: Number of the variant, such as a precision or a method; 0 where there is one.

        Raises:
            OptionError: If the job has no such bands, or there is no such variant.
            ReadError: If bins of finished rows are damaged or lost; sweeping again computes them anew.

        Example:
            low, middle, high = found.bands("x.q1").quantiles([0.05, 0.5, 0.95])
        """
        if name not in self.band_names:
            raise OptionError(f"bands: there is no {quoted(name)}. {did_you_mean(name, self.band_names)}")
        if variant not in range(self._layout.variants):
            raise OptionError(f"bands: there is no variant {quoted(variant)} of {self._layout.variants}.")
        own = [number for number in self.store.finished() if self._layout.part(number)[0] == variant]
        if not all(map(self.band_store.holds, own)):
            raise ReadError(f"{self.folder}: bins of finished chunks are lost. {AGAIN}")
        parts = self.band_store.bins(variant)
        bins = merged(parts) if parts else None
        return Band(name, self._layout.times(variant), bins, self.band_names.index(name))

    def _columns(self, names: Iterable[str]) -> Columns:
        """Return some columns of the finished rows."""
        wanted = list(names)
        for name in wanted:
            if name not in self._layout.columns:
                known = list(self._layout.columns)
                raise OptionError(f"there is no column {quoted(name)}. {did_you_mean(name, known)}")
        return self.store.columns(wanted)

    def _usable(self, name: str) -> Floats:
        """Return the finite values of a column of numbers."""
        if self._layout.columns.get(name, ()) is None:
            raise OptionError(f"column {quoted(name)} has no numbers.")
        values: Floats = self.column(name)
        values = values[np.isfinite(values).reshape(len(values), -1).all(axis=1)]
        if not len(values):
            raise OptionError(f"column {quoted(name)}: no row has a value.")
        return values

    def _full(self, rows: Any, column: Any) -> Any:
        """Return a column with a value for every row of the sweep."""
        empty: Any = "" if column.dtype == object else np.nan
        full = np.full((self.rows, *column.shape[1:]), empty, column.dtype)
        full[rows] = column
        return full


@dataclass(frozen=True, repr=False)
class Band:
    """The distribution of one quantity over the rows of a sweep at every time.

    Values that are not finite are left out. Quantiles are those of counts in bins: linear between two values
    as those of `numpy.quantile`, and off by no more than one part in 128 of the magnitude of these values.
    Extremes are exact.

    Attributes:
        name: Name of the quantity.
        times: (T,) times, s.
        bins: The bins, None before a row is finished.
        place: Place of the quantity among those of the bands.

    Example:
        band = found.bands("x.q1")
        low, high = band.extremes()
    """

    name: str
    times: Floats
    bins: Bins | None
    place: int

    def __repr__(self) -> str:
        span = f" from {self.times[0]:g} to {self.times[-1]:g} s" if len(self.times) else ""
        return f"<Band of {self.name}: {counted(len(self.times), 'time')}{span}>"

    def quantiles(self, shares: Iterable[float] = (0.05, 0.5, 0.95)) -> Floats:
        """Return (Q, T) values below which shares of the rows lie, at every time.

        Raises:
            OptionError: If a share is not between 0 and 1.
        """
        wanted = list(shares)
        columns = [self._column(time) for time in range(len(self.times))]
        return np.array([[quantile(*column, share) for column in columns] for share in wanted])

    def extremes(self) -> tuple[Floats, Floats]:
        """Return the (T,) smallest and the (T,) largest values at every time; NaN where there is none."""
        ends = [
            (least[0], greatest[-1]) if len(counts) else (np.nan, np.nan)
            for counts, least, greatest in map(self._column, range(len(self.times)))
        ]
        low, high = np.array(ends, np.float64).reshape(-1, 2).T
        return low, high

    def histogram(self, edges: Any) -> Integers:
        """Return (T, H) numbers of rows with values between H + 1 edges, each bin counted by its middle.

        Raises:
            ArrayError: If the edges are not increasing numbers.
        """
        ends = np.asarray(edges, np.float64)
        if ends.ndim != 1 or len(ends) < 2 or not (np.diff(ends) > 0).all():
            raise ArrayError("edges: expected two increasing numbers at least.")
        found = [
            np.histogram((least + greatest) / 2, ends, weights=counts)[0]
            for counts, least, greatest in map(self._column, range(len(self.times)))
        ]
        return np.array(found).astype(np.int64)

    def counts(self) -> Integers:
        """Return (T,) numbers of rows with a finite value at every time."""
        return np.array([self._column(time)[0].sum() for time in range(len(self.times))], np.int64)

    def _column(self, time: int) -> tuple[Integers, Floats, Floats]:
        """Return counts and ends of the bins at a time."""
        if self.bins is None:
            nothing = np.empty(0)
            return nothing.astype(np.int64), nothing, nothing
        return self.bins.column(time, self.place)
