"""The entries of the package: `sweep` computes rows and keeps them, and `open_sweep` reads them again."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, SweepError, counted, quoted, warn
from kanegen.files import path_of
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.sweeps.band_files import BandFiles, BandsInMemory, BandStore
from kanegen.sweeps.chunk import Finished, PackedProgram, Task
from kanegen.sweeps.design import read_design
from kanegen.sweeps.executors import Workers, workers_of
from kanegen.sweeps.job import RolloutJob
from kanegen.sweeps.parquet import ParquetFolder
from kanegen.sweeps.plan import Plan, make_plan, require_format
from kanegen.sweeps.results import SweepResult
from kanegen.sweeps.running import Progress, run
from kanegen.sweeps.sampling import Sampling
from kanegen.sweeps.stores import (
    GO_ON,
    REASON,
    RESULT,
    ROW,
    Columns,
    Layout,
    Memory,
    Staging,
    Store,
    prepared_folder,
    read_manifest,
    require_unchanged,
)
from kanegen.sweeps.zarr import ZarrFolder

Report = Callable[[Progress], None]
"""Function that is called after every chunk with how far a sweep is."""


def sweep(
    system: System,
    axes: Mapping[Any, Any],
    job: RolloutJob,
    executor: Any = None,
    *,
    samples: Sampling | int | Mapping[str, Any] | None = None,
    folder: str | Path | None = None,
    format: str = "parquet",
    workers: int | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
) -> SweepResult:
    """Compute a job for every combination of the values of some axes, in batches of C on many cores.

    Axes are parameters such as "m1", initial coordinates and speeds such as "x.q1" and "y.q1", inputs such as
    "tau.q1", "force.hand.z" and "prescribed.cart", and variants: "tier", "precision", "storage" and "sincos"
    of the code, and "method", "step" and "duration" of the job. The values of an axis are a number, a list,
    or `{"from": 0.5, "to": 2.0, "count": 16, "spacing": "log"}`; a distribution `{"uniform": [low, high]}`,
    `{"log_uniform": [low, high]}` or `{"normal": [mean, deviation]}`, which is sampled; or the text of an
    expression of other axes and parameters such as "2*x.q1", which for an input may depend on the time t;
    an input takes a list of expressions, too.
    Rows of values for several axes that go together stand under their names with commas:
    `{"m1, m2": [[1.0, 2.0], [1.5, 1.0]]}`. All other values are combined with each other. What no axis names
    has its default; coordinates are neutral, speeds and inputs 0. Each prescribed freedom needs an axis.

    A row whose parameters no model can have, or whose state stops being finite, has NaN and a reason. Rows do
    not depend on the executor, on the number of workers, or on each other.

    Args:
        system: The tree.
        axes: Values of each axis by its name.
        job: What is computed in each row.
        executor: Where rows are computed: None for threads of this process, any executor of
            `concurrent.futures`, a client of Dask or the address of its scheduler, or "mpi". Processes on
            other machines compile the C once, and need kanegen and a C compiler.
        samples: How distributions are sampled: a `Sampling`, its fields by name, or the number of samples.
        folder: Folder for the results, which appear there chunk by chunk. If it holds a part of the same
            sweep, only the rest is computed. None keeps results in memory.
        format: "parquet" or "zarr", the format of the table in the folder.
        workers: Number of threads; by default one for each processor that the process may use.
        chunk_rows: Number of rows that are computed at once; by default as many as take about a tenth of a
            second. Results do not depend on it.
        progress: Function that is called with a `Progress` after every chunk.

    Raises:
        OptionError: If an axis, the job or another option is unknown or does not fit, or there is no row or
            there are too many; or if a scheduler does not answer.
        WriteError: If the folder holds anything but this sweep, or cannot be written; finished chunks are
            kept.
        SweepError: If a worker fails or ends; finished chunks are kept.
        MissingError: If a package is needed that is not installed, see the extras `sweep` and `dask`.
        ModelError, SingularError, BuildError: As `kanegen.build`.

    Example:
        job = kg.RolloutJob(10.0, 1e-3, results=("end.x", "max.y.q2", "drift.energy"))
        axes = {"m2": [0.5, 1.0, 2.0], "x.q1": {"uniform": [-3.0, 3.0]}}
        found = kg.sweep(kg.load("models/double_pendulum.toml"), axes, job, samples=4096, folder="pendulum")
        print(found.table)
    """
    if not isinstance(system, System):
        raise OptionError(f"system: {quoted(system)} is no system. Load one with kg.load(...).")
    if not isinstance(job, RolloutJob):
        raise OptionError(f"job: {quoted(job)} is no job. Make one with kg.RolloutJob(duration, step).")
    require_format(format, folder is not None)
    design = read_design(system, axes, _sampling(samples))
    with ExitStack() as stack:
        found = stack.enter_context(workers_of(executor, workers))
        plan = make_plan(system, design, job, "memory" if folder is None else format, chunk_rows)
        layout = Layout(plan.manifest)
        staging = None if folder is None else stack.enter_context(prepared_folder(folder, layout))
        store, bands = _stores(layout, staging)
        try:
            _Run(plan, store, bands, progress).with_workers(found)
        except SweepError as error:
            raise error if staging is None else SweepError(f"{error} {GO_ON}") from error
    return SweepResult(store, bands) if staging is None else _opened(staging.path, layout)


def open_sweep(folder: str | Path) -> SweepResult:
    """Return the results in the folder of a sweep, also of one that runs or was ended.

    Raises:
        ReadError: If it is no folder of a sweep of this version of kanegen.
        MissingError: If PyArrow or Zarr is not installed.

    Example:
        print(kg.open_sweep("pendulum").table)
    """
    path = path_of(folder)
    manifest = read_manifest(path)
    require_unchanged(path, manifest)
    return _opened(path, Layout(manifest))


def _opened(path: Path, layout: Layout) -> SweepResult:
    """Return the results in a folder, to read."""
    return SweepResult(_table(path, layout), BandFiles(path, layout), path)


def _stores(layout: Layout, staging: Staging | None) -> tuple[Store, BandStore]:
    """Return where the chunks and the bins of a sweep are kept: in memory if there is no folder."""
    if staging is None:
        return Memory(layout), BandsInMemory(layout)
    return _table(staging.path, layout, staging), BandFiles(staging.path, layout, staging)


def _table(path: Path, layout: Layout, staging: Staging | None = None) -> Store:
    """Return the table in a folder, to read if there is no `staging`."""
    kind = ZarrFolder if layout.manifest["store"] == "zarr" else ParquetFolder
    return kind(path, layout, staging)


def _sampling(samples: Sampling | int | Mapping[str, Any] | None) -> Sampling:
    """Return how distributions are sampled.

    Raises:
        OptionError: If a field is unknown or does not fit.
    """
    if samples is None or isinstance(samples, Sampling):
        return samples or Sampling()
    if not isinstance(samples, Mapping):
        return Sampling(samples)
    known = [field.name for field in fields(Sampling)]
    for name in samples:
        if name not in known:
            raise OptionError(f"samples: there is no {quoted(name)}. {did_you_mean(name, known)}")
    return Sampling(**samples)


class _Run:
    """One run of a sweep, from the chunks that are finished already to the end."""

    def __init__(self, plan: Plan, store: Store, bands: BandStore, report: Report | None) -> None:
        self._plan, self._store, self._bands, self._report = plan, store, bands, report
        self._layout = store.layout
        kept = store.finished()
        has_bins = [not plan.manifest["bands"] or bands.holds(number) for number in kept]
        self._finished = {number for number, is_there in zip(kept, has_bins, strict=True) if is_there}
        self._rows = sum(map(self._layout.size, self._finished))
        is_finished = np.repeat(np.array(has_bins, bool), [self._layout.size(number) for number in kept])
        failed = store.columns([REASON])[REASON] != "" if kept else is_finished
        self._failed = int(np.count_nonzero(failed & is_finished))
        self._new, self._start = 0, time.monotonic()
        self._outside: dict[str, int] = {}
        for number in self._finished:
            self._compact(number)

    def with_workers(self, workers: Workers) -> None:
        """Compute the chunks that are missing."""
        self._tell()
        run(self._tasks(), workers, self._take)
        if self._outside:
            parts = [f"{name} in {counted(rows, 'row')}" for name, rows in self._outside.items()]
            warn(f"the first state is outside of limits of the model: {', '.join(parts)}.")

    def _tasks(self) -> Iterator[Task]:
        """Yield the chunks that are missing."""
        packed: dict[int, PackedProgram] = {}
        for number in range(self._layout.chunks):
            if number not in self._finished:
                variant, first, last = self._layout.part(number)
                if variant not in packed:
                    packed[variant] = PackedProgram.of(self._plan.programs[variant])
                columns = self._plan.design.columns(first, last)
                self._watch_limits(columns)
                yield Task(number, packed[variant], columns, last - first, self._unusable(columns))

    def _watch_limits(self, columns: Mapping[str, Floats]) -> None:
        """Count the rows that begin outside of the limits of a coordinate or a speed."""
        system = self._plan.system
        limits = system.limits
        speeds = zip(system.speed_names, -limits.speed, limits.speed, strict=True)
        ranges = {f"y.{name}": (low, high) for name, low, high in speeds}
        positions = zip(system.coordinate_names, limits.lower, limits.upper, strict=True)
        ranges |= {f"x.{name}": (low, high) for name, low, high in positions}
        for name, values in columns.items():
            low, high = ranges.get(name, (-np.inf, np.inf))
            if rows := int(np.count_nonzero((values < low) | (values > high))):
                self._outside[name] = self._outside.get(name, 0) + rows

    def _unusable(self, columns: Mapping[str, Floats]) -> dict[int, str]:
        """Return why no model has the parameters of a row, by its place."""
        sets = self._plan.programs[0].inputs.parameter_sets(columns)
        return self._plan.system.unusable_parameters(sets) if sets else {}

    def _take(self, chunk: Finished) -> None:
        """Keep a chunk: first its bins, then its columns, with which it is finished."""
        if chunk.bins is not None:
            self._bands.keep(chunk.number, chunk.bins)
        self._store.keep(chunk.number, self._columns(chunk))
        self._finished.add(chunk.number)
        self._compact(chunk.number)
        rows = self._layout.size(chunk.number)
        self._rows, self._new = self._rows + rows, self._new + rows
        self._failed += chunk.failed
        self._tell()

    def _compact(self, number: int) -> None:
        """Merge the bins of finished chunks around one of them."""
        if self._plan.manifest["bands"]:
            self._bands.compact(number, self._finished.__contains__)

    def _columns(self, chunk: Finished) -> Columns:
        """Return the columns of the table in the rows of a chunk."""
        variant, first, last = self._layout.part(chunk.number)
        size = last - first
        found: Columns = {ROW: np.arange(first, last) + variant * self._layout.rows_of_variant}
        for name, value in self._plan.design.combinations[variant].items():
            text = self._layout.columns[name] is None
            found[name] = np.full(size, value, object if text else np.float64)
        found |= self._plan.design.columns(first, last)
        results = (numbers[..., place] for numbers in chunk.results for place in range(numbers.shape[-1]))
        found |= dict(zip(self._layout.named(RESULT), results, strict=True))
        return found | {REASON: np.array(chunk.reasons, object)}

    def _tell(self) -> None:
        """Report how far the sweep is."""
        if self._report is not None:
            seconds = time.monotonic() - self._start
            total = self._layout.variants * self._layout.rows_of_variant
            self._report(Progress(self._rows, total, self._failed, self._new, seconds))
