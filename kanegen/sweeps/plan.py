"""What a sweep computes, decided before it begins: programs of all variants, size of chunks, and manifest."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from kanegen import __version__, compiler
from kanegen.choices import require_one
from kanegen.errors import OptionError, quoted, warn
from kanegen.extras import require
from kanegen.library import Library
from kanegen.model.saving import toml_text
from kanegen.model.system import System
from kanegen.options import Progress, chosen_variant, quiet
from kanegen.sweeps.axes import EXTRA
from kanegen.sweeps.chunk import Program, Result
from kanegen.sweeps.design import BUILD_VARIANTS, NUMBERS, RUN_VARIANTS, Design, known_names
from kanegen.sweeps.inputs import Inputs
from kanegen.sweeps.job import RolloutJob
from kanegen.sweeps.motion import BLOCK
from kanegen.sweeps.quantities import Quantity, quantities
from kanegen.sweeps.statistics import IN_SECONDS, PATH
from kanegen.sweeps.stores import AXIS, FORMAT, REASON, RESULT, ROW, sealed

FORMATS = {"parquet": ("pyarrow",), "zarr": ("pyarrow", "zarr")}
"""Formats of the table of a sweep in a folder, with the packages that write it and the bands."""

_SECONDS = 0.1
"""Time in s that a chunk should take by its number of operations. An executor needs a millisecond or two for
a chunk, also Dask; what was computed of a chunk that did not finish is lost."""

_OPERATION = 4e-11
"""Time in s of one operation of a state in a batch with AVX-512, about; it takes twice as long with AVX2."""

_EVALUATIONS = 4
"""Evaluations of the rates in a step, about."""

_COSTS = {"divide": 6, "sqrt": 6, "sincos": 25, "compare": 1, "function": 25}
"""Operations as multiples of an addition."""

_LANES = 8
"""Rows of a chunk are a multiple of this number, so that SIMD lanes are full."""

_MOST_ROWS, _MOST_BYTES = 65536, 2**26
"""Largest number of rows of a chunk, and of bytes of its largest arrays."""

_BIN_BYTES, _BINS = 17, 1024
"""Bytes of a bin of a band in a file, and number of bins with values at one time where they spread, about."""

_MANY_LOOKS, _LARGE_BANDS = 1000, 2**26
"""Number of times of a band, and bytes of the bins of all chunks, above which motions may be smaller."""


@dataclass(frozen=True)
class Plan:
    """Everything about a sweep but where it runs and where results are kept.

    Attributes:
        system: The tree.
        design: The rows.
        programs: For each variant what its rows have in common.
        manifest: What the sweep is, in plain data.
    """

    system: System
    design: Design
    programs: tuple[Program, ...]
    manifest: Mapping[str, Any]


def make_plan(
    system: System,
    design: Design,
    job: RolloutJob,
    store: str,
    chunk_rows: int | None = None,
    progress: Progress = quiet,
) -> Plan:
    """Build the programs of all variants and decide on chunks.

    Args:
        system: The tree.
        design: The rows.
        job: What is computed in each row.
        store: One of `FORMATS`, or "memory".
        chunk_rows: Number of rows of a chunk; by default as many as take about a tenth of a second.
        progress: Function that is called with the name of each stage.

    Raises:
        OptionError: If a variant does not exist, or the system has no such results.
        ModelError, SingularError, BuildError: As `kanegen.build`.
    """
    jobs = [_job_of(job, variant) for variant in design.combinations]
    if len({one.looks() for one in jobs}) > 1 and any(name.startswith(f"{PATH}.") for name in job.names):
        raise OptionError("job: results over time ('path') need the same number of times in all variants.")
    built: dict[Any, Library] = {}
    programs = tuple(
        _program(system, design, own, variant, progress, built)
        for own, variant in zip(jobs, design.combinations, strict=True)
    )
    rows = _chunk_rows(programs, design.rows_of_variant) if chunk_rows is None else _checked(chunk_rows)
    for program in programs:
        _warn_of_bands(program, min(rows, design.rows_of_variant), design.rows_of_variant)
    manifest: dict[str, Any] = {
        "format": FORMAT,
        "version": __version__,
        "name": system.name,
        "rows": design.rows,
        "store": store,
        "job": job.plain,
        "axes": dict(design.plain),
        **({"samples": design.sampling.plain} if design.samples else {}),
        "chunk_rows": min(rows, design.rows_of_variant),
        "dimensions": design.dimensions,
        "times": [[every * one.step, looks] for one in jobs for every, looks in [one.looks()]],
        "columns": _columns(system, design, programs[0]),
        "bands": {one.name: one.unit for one in programs[0].bands},
        "model": toml_text(system.as_table()),
        "code": [_digest(program.library.source.files) for program in programs],
    }
    return Plan(system, design, programs, sealed(manifest))


def _job_of(job: RolloutJob, variant: Mapping[str, Any]) -> RolloutJob:
    """Return the job of a variant."""
    return replace(job, **{name: value for name, value in variant.items() if name in RUN_VARIANTS})


def _columns(system: System, design: Design, program: Program) -> dict[str, dict[str, Any]]:
    """Return the kind and the unit of each column of the table, by its name."""
    found: dict[str, dict[str, Any]] = {ROW: {"kind": ROW}}
    for axis in design.variants:
        is_number = axis.names[0] in NUMBERS
        found[axis.names[0]] = {"kind": AXIS, "unit": "s"} if is_number else {"kind": AXIS, "text": True}
    units = known_names(system)
    found |= {name: {"kind": AXIS, "unit": units[name]} for name in design.names}
    for name in design.samples:
        found[name]["sampled"] = True
    for result in program.results:
        for one in result.quantities:
            unit = "s" if result.statistic in IN_SECONDS else one.unit
            column: dict[str, Any] = {"kind": RESULT, "unit": unit}
            if result.statistic == PATH:
                column["times"] = program.job.looks()[1]
            found[f"{result.statistic}.{one.name}"] = column
    return found | {REASON: {"kind": REASON, "text": True}}


def _program(
    system: System,
    design: Design,
    job: RolloutJob,
    variant: Mapping[str, Any],
    progress: Progress,
    built: dict[Any, Library],
) -> Program:
    """Return what the rows of a variant have in common.

    `built` has the libraries so far by outputs and choices: variants of inputs alone share one.
    """
    outputs = (*job.outputs(system), *([job.rollout] if job.duration else []))
    choices = {name: value for name, value in variant.items() if name in BUILD_VARIANTS}
    key = outputs, tuple(choices.items())
    tier = chosen_variant(choices.pop("tier", "strict"), **choices)
    inputs = Inputs.of(system, design.names, design.timed(variant))
    if key not in built:
        built[key] = compiler.build(
            system,
            outputs or ("kinetic_energy",),
            progress=progress,
            tier=tier,
            on_status="ignore",
            parameters_by_state=bool(inputs.parameters),
        )
    library = built[key]
    if library.storage == "double-double":
        raise OptionError(
            "axes: tier: arrays of a sweep hold no double-double numbers. Take storage 'double'."
        )
    return Program(library, job, _results(job, library), _bands(job, library), inputs)


def _results(job: RolloutJob, library: Library) -> tuple[Result, ...]:
    """Return the results of a job with their quantities."""
    found = []
    for name in job.names:
        statistic, _, quantity = name.partition(".")
        found.append(Result(statistic, quantities("job: results", quantity, library.source)))
    _require_once("results", [f"{one.statistic}.{own.name}" for one in found for own in one.quantities])
    return tuple(found)


def _bands(job: RolloutJob, library: Library) -> tuple[Quantity, ...]:
    """Return the quantities of the bands of a job."""
    found = tuple(one for name in job.bands for one in quantities("job: bands", name, library.source))
    _require_once("bands", [one.name for one in found])
    return found


def _require_once(field: str, names: Sequence[str]) -> None:
    """Require that no number is asked for twice, as by "end.x" and "end.x.q1".

    Raises:
        OptionError: If one is.
    """
    for name, count in Counter(names).items():
        if count > 1:
            raise OptionError(
                f"job: {field}: {quoted(name)} stands there twice, alone and in an array. Leave one out."
            )


def _chunk_rows(programs: Sequence[Program], rows: int) -> int:
    """Return how many rows a chunk has; it depends on nothing but the sweep.

    All variants have chunks of the same number of rows, that of the one with the most work for a row.
    """
    found = min(rows, _MOST_ROWS)
    for program in programs:
        library, job = program.library, program.job
        operations = sum(_COSTS.get(name, 1) * count for name, count in library.source.operations.items())
        seconds = _OPERATION * max(operations, 1) * (_EVALUATIONS * job.count_of_steps() + job.looks()[1])
        numbers = len(library.coordinate_names) + library.n
        numbers += sum(len(result.quantities) for result in program.results) + 2 * len(program.bands)
        looks = job.looks()[1]
        paths = sum(len(result.quantities) for result in program.results if result.statistic == PATH)
        size = 8 * (numbers * min(looks, BLOCK + 1) + paths * looks)
        found = min(found, int(_SECONDS / seconds), int(_MOST_BYTES / size))
    return max(-(-found // _LANES) * _LANES, _LANES)


def _warn_of_bands(program: Program, chunk_rows: int, rows: int) -> None:
    """Warn where bands have many times, and the bins of chunks are larger than the motions."""
    looks = program.job.looks()[1]
    values = looks * len(program.bands)
    size = values * -(-rows // chunk_rows) * min(chunk_rows, _BINS) * _BIN_BYTES
    motions = 8 * values * rows
    if looks > _MANY_LOOKS and size > max(_LARGE_BANDS, motions):
        warn(
            f"job: bands: counts at {looks} times in chunks of {chunk_rows} rows have up to "
            f"{size / 1e6:.3g} MB, more than the {motions / 1e6:.3g} MB of the motions. Take a larger "
            "'every', so that a band has a few hundred times."
        )


def _checked(chunk_rows: Any) -> int:
    """Return a number of rows that a user has chosen for a chunk."""
    if isinstance(chunk_rows, bool) or not isinstance(chunk_rows, int) or not 1 <= chunk_rows <= _MOST_ROWS:
        raise OptionError(f"chunk_rows: {quoted(chunk_rows)} is no number of rows from 1 to {_MOST_ROWS}.")
    return chunk_rows


def _digest(files: Mapping[str, str]) -> str:
    """Return the digest of generated code."""
    code = {name: text for name, text in files.items() if name.endswith((".c", ".h"))}
    return hashlib.sha256(json.dumps(code, sort_keys=True).encode()).hexdigest()


def require_format(store: str, in_folder: bool) -> None:
    """Require that there is a format of tables, and what writes it where there is a folder.

    Raises:
        OptionError: If there is none of this name.
        MissingError: If PyArrow, or for "zarr" Zarr, is not installed.
    """
    require_one("format", store, FORMATS)
    for package in FORMATS[store] if in_folder else ():
        require(package, EXTRA)
