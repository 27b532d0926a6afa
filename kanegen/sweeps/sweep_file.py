"""Sweeps in TOML files: a model, axes, samples, a job, and where results go."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from kanegen.choices import did_you_mean
from kanegen.errors import KanegenError, OptionError, ReadError, quoted
from kanegen.extras import module
from kanegen.model.system import System
from kanegen.readers import load
from kanegen.readers.reader import read_text
from kanegen.readers.toml import parse_toml
from kanegen.simulation.input_tables import number_in
from kanegen.sweeps.axes import DISTRIBUTIONS, EXTRA
from kanegen.sweeps.design import INPUTS
from kanegen.sweeps.job import RolloutJob
from kanegen.sweeps.sampling import Sampling

KEYS = ("model", "axes", "job", "samples", "folder", "format", "chunk_rows")
"""Keys of a file."""

_MODEL_KEYS = ("file", "floating_base", "joint_dynamics")
_VECTORS = ("x", "y", *INPUTS)
_FORMS = ("from", "file", *DISTRIBUTIONS)


@dataclass(frozen=True)
class SweepFile:
    """What a file says of a sweep; the fields are arguments of `sweep`.

    Attributes:
        path: The file.
        system: The tree.
        axes: Values of each axis by its name.
        job: What is computed in each row.
        samples: How distributions are sampled.
        folder: Folder for the results; relative paths begin in the folder from which the command runs.
        format: Format of the table.
        chunk_rows: Number of rows that are computed at once, None for the default.
    """

    path: Path
    system: System
    axes: Mapping[Any, Any]
    job: RolloutJob
    samples: Sampling | None
    folder: Path
    format: str = "parquet"
    chunk_rows: int | None = None


def read_sweep_file(path: Path) -> SweepFile:
    """Return what a file says of a sweep.

    Raises:
        ReadError: If the file cannot be read, or is not valid TOML.
        OptionError: If a key is unknown or missing, or a value does not fit; the message has the path.
        ModelError: If the model cannot be read.
    """
    table = parse_toml(read_text(path), path)
    _require_keys(str(path), table, KEYS, ("model", "axes", "job"))
    for name in ("axes", "job"):
        if not isinstance(table[name], Mapping):
            raise OptionError(f"{path}: {name}: write a table, [{name}].")
    system = _model(path, table["model"])
    try:
        return SweepFile(
            path,
            system,
            _axes(path.parent, table["axes"]),
            _fields(RolloutJob, "job", table["job"]),
            _fields(Sampling, "samples", table["samples"]) if "samples" in table else None,
            Path(_text("folder", table.get("folder", f"{path.stem}-results"))),
            **{key: table[key] for key in ("format", "chunk_rows") if key in table},
        )
    except KanegenError as error:
        raise type(error)(f"{path}: {error}") from None


def _model(path: Path, value: Any) -> System:
    """Return the system of the key `model`: the path of a model file beside this one, or a table with one."""
    table = {"file": value} if isinstance(value, str) else value
    if not isinstance(table, Mapping):
        raise OptionError(f'{path}: model: write the name of a model file, such as "arm.toml".')
    _require_keys(f"{path}: model", table, _MODEL_KEYS, ("file",))
    options: dict[str, Any] = {key: value for key, value in table.items() if key != "file"}
    for key, flag in options.items():
        if not isinstance(flag, bool):
            raise OptionError(f"{path}: model: {key}: {quoted(flag)} is not true or false.")
    return load(path.parent / _text("model", table["file"]), **options)


def _axes(folder: Path, table: Mapping[str, Any]) -> dict[str, Any]:
    """Return axes by their names; TOML takes the dots in `x.q1 = 0.3` for tables in each other."""
    found: dict[str, Any] = {}
    for key, value in table.items():
        nested = key in _VECTORS and isinstance(value, Mapping)
        for name, one in _joined(key, value).items() if nested else [(key, value)]:
            is_file = isinstance(one, Mapping) and "file" in one
            found[name] = _columns(folder, name, one) if is_file else one
    return found


def _joined(name: str, value: Any) -> dict[str, Any]:
    """Return values by names with dots, from tables in each other."""
    if not isinstance(value, Mapping) or any(form in value for form in _FORMS):
        return {name: value}
    found: dict[str, Any] = {}
    for key, inner in value.items():
        found |= _joined(f"{name}.{key}", inner)
    return found


def _columns(folder: Path, name: str, table: Mapping[str, Any]) -> list[Any]:
    """Return the rows of values for axes from a CSV or Parquet file that has columns of their names."""
    where = f"axes: {name}"
    _require_keys(where, table, ("file",), ("file",))
    path = folder / _text(where, table["file"])
    names = [part.strip() for part in name.split(",")]
    columns = _parquet(path) if path.suffix == ".parquet" else _csv(path)
    for one in names:
        if one not in columns:
            raise OptionError(f"{path}: there is no column {quoted(one)}. {did_you_mean(one, columns)}")
    if len(names) == 1:
        return columns[names[0]]
    return [list(row) for row in zip(*(columns[one] for one in names), strict=True)]


def _csv(path: Path) -> dict[str, list[Any]]:
    """Return the numbers of a CSV file by the names in its first line."""
    lines = csv.reader(io.StringIO(read_text(path)), skipinitialspace=True)
    names = [name.strip() for name in next(lines, [])]
    columns: dict[str, list[Any]] = {name: [] for name in names}
    for row in lines:
        if len(row) not in (0, len(names)):
            raise ReadError(f"{path}:{lines.line_num}: {len(row)} entries in place of {len(names)}.")
        for name, entry in zip(names, row, strict=False):
            try:
                columns[name].append(number_in(entry))
            except ValueError:
                raise ReadError(f"{path}:{lines.line_num}: {quoted(entry)} is not a number.") from None
    return columns


def _parquet(path: Path) -> dict[str, list[Any]]:
    """Return the columns of a Parquet file by their names."""
    try:
        table = module("pyarrow.parquet", extra=EXTRA).read_table(path)
    except (OSError, ValueError) as error:
        raise ReadError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    found: dict[str, list[Any]] = table.to_pydict()
    return found


def _fields(kind: Any, where: str, table: Any) -> Any:
    """Return an instance of a dataclass from a table with its fields."""
    if not isinstance(table, Mapping):
        raise OptionError(f"{where}: write a table, [{where}].")
    names = [field.name for field in fields(kind)]
    needed = ("duration", "step") if kind is RolloutJob else ()
    _require_keys(where, table, tuple(names), needed)
    return kind(**table)


def _text(where: str, value: Any) -> str:
    """Return a value that is a text."""
    if not isinstance(value, str) or not value:
        raise OptionError(f"{where}: {quoted(value)} is no name of a file or folder.")
    return value


def _require_keys(
    where: str, table: Mapping[str, Any], known: tuple[str, ...], needed: tuple[str, ...]
) -> None:
    """Require that every key of a table is known, and that none is missing."""
    for key in table:
        if key not in known:
            raise OptionError(f"{where}: unknown key {quoted(key)}. {did_you_mean(key, known)}")
    for key in needed:
        if key not in table:
            raise OptionError(f"{where}: the key {key!r} is missing.")
