"""Some rows of a sweep, computed at once: what a worker is sent, does and returns."""

from __future__ import annotations

import hashlib
import pickle
import threading
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.library import Library
from kanegen.library.native import cache
from kanegen.model.arrays import Flags, Floats
from kanegen.sweeps.bands import Bins, bins_of, merged
from kanegen.sweeps.inputs import Inputs
from kanegen.sweeps.job import RolloutJob
from kanegen.sweeps.motion import Motion
from kanegen.sweeps.quantities import Quantity, values
from kanegen.sweeps.statistics import STATISTICS, ZERO

_PROGRAMS: dict[str, Program] = {}
"""The programs that this process has opened, by their digests."""

_MOST_PROGRAMS = 16
"""Programs that a process keeps open."""

_OPENING, _LOCK = threading.Lock(), threading.Lock()
"""Locks of threads: one opens a program while others wait, and one changes the table of programs."""


@dataclass(frozen=True)
class Result:
    """A result: one statistic of some quantities.

    Attributes:
        statistic: Name among `STATISTICS`.
        quantities: The quantities.
    """

    statistic: str
    quantities: tuple[Quantity, ...]


@dataclass(frozen=True)
class Program:
    """Everything that the rows of one variant have in common.

    Attributes:
        library: Compiled code with the method and the outputs that results need.
        job: The job of this variant.
        results: What is kept of each row.
        bands: Quantities whose distribution over the rows is kept.
        inputs: How the numbers of the axes become arguments of the library.
    """

    library: Library
    job: RolloutJob
    results: tuple[Result, ...]
    bands: tuple[Quantity, ...]
    inputs: Inputs


@dataclass(frozen=True)
class PackedProgram:
    """A program as it is sent to other processes.

    Attributes:
        digest: Digest of its content.
        content: The program as `pickle` writes it, compressed, since every task carries it.
    """

    digest: str
    content: bytes

    @classmethod
    def of(cls, program: Program) -> PackedProgram:
        """Pack a program; this process uses it as it is."""
        content = zlib.compress(pickle.dumps(program, protocol=pickle.HIGHEST_PROTOCOL), level=1)
        packed = cls(hashlib.sha256(content).hexdigest(), content)
        _keep(packed.digest, program)
        return packed

    def open(self) -> Program:
        """Return the program; a process loads its library once, and a machine compiles it once."""
        with _OPENING:
            program = _PROGRAMS.get(self.digest)
            if program is None:
                with cache.one_process():
                    program = pickle.loads(zlib.decompress(self.content))
                _keep(self.digest, program)
        return program


def _keep(digest: str, program: Program) -> None:
    """Keep a program open, and forget the oldest one if there are many."""
    with _LOCK:
        _PROGRAMS[digest] = program
        while len(_PROGRAMS) > _MOST_PROGRAMS:
            _PROGRAMS.pop(next(iter(_PROGRAMS)))


@dataclass(frozen=True)
class Task:
    """One chunk: rows that are computed at once.

    Attributes:
        number: Number of the chunk.
        program: The program of its variant.
        columns: (B,) numbers of the axes, by name.
        size: Number of rows B.
        unusable: Why no model has the parameters of a row, by its place.
    """

    number: int
    program: PackedProgram
    columns: Mapping[str, Floats]
    size: int
    unusable: Mapping[int, str]


@dataclass(frozen=True)
class Finished:
    """A chunk that was computed.

    Attributes:
        number: Number of the chunk.
        results: For each result its (B, E) or (B, T, E) numbers; NaN in rows that failed.
        reasons: (B,) why a row failed or may be inaccurate, "" for the others.
        bins: Distribution of the quantities of bands over the rows that did not fail.
    """

    number: int
    results: tuple[Floats, ...]
    reasons: tuple[str, ...]
    bins: Bins | None = None

    @property
    def failed(self) -> int:
        """Number of rows with a reason."""
        return sum(map(bool, self.reasons))


def compute(task: Task) -> Finished:
    """Compute a chunk; an executor calls this function in a thread, a process, or on another machine."""
    program = task.program.open()
    has_model: Flags = np.array([row not in task.unusable for row in range(task.size)])
    motion = Motion(program.library, program.job, program.inputs, task.columns, task.size)
    statistics = [STATISTICS[result.statistic]() for result in program.results]
    bins: list[Bins] = []
    looks = 0
    with np.errstate(all="ignore"):
        for states in motion.blocks():
            for statistic, result in zip(statistics, program.results, strict=True):
                statistic.add(states.times, values(result.quantities, states.array))
            if program.bands:
                bins.append(bins_of(values(program.bands, states.array)[has_model], looks))
            looks += len(states.times)
    found = tuple(statistic.result() for statistic in statistics)
    own = _with_results_that_are_not_finite(motion.reasons, program.results, found)
    for numbers in found:
        numbers[motion.failed | ~has_model] = np.nan
    reasons = tuple(task.unusable.get(row, reason) for row, reason in enumerate(own))
    return Finished(task.number, found, reasons, merged(bins) if bins else None)


def _with_results_that_are_not_finite(
    reasons: Sequence[str], results: Sequence[Result], found: Sequence[Floats]
) -> list[str]:
    """Return the reasons of rows, also of those with a result that is not finite and without one so far."""
    completed = list(reasons)
    for result, numbers in zip(results, found, strict=True):
        if result.statistic == ZERO:
            continue
        is_bad = ~np.isfinite(numbers)
        for row in np.flatnonzero(is_bad.reshape(len(numbers), -1).any(axis=1)):
            place = np.argwhere(is_bad[row])[0, -1]
            completed[row] = (
                completed[row] or f"{result.statistic}.{result.quantities[place].name} is not finite."
            )
    return completed
