"""Comparisons saved as JSON with the machine on which they were timed, and read again."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from kanegen import __version__
from kanegen.errors import OptionError, quoted
from kanegen.measure.machine import Machine
from kanegen.measure.timing import Times
from kanegen.readers.reader import read_text
from kanegen.studies.bench.comparison import Absence, BenchOptions, Comparison, Entry
from kanegen.studies.bench.results import Task
from kanegen.studies.bench.settings import Setting

KIND = "times of kanegen bench"
"""What a file says that it is."""

FORMAT = 1
"""Version of the format; a file of another version is not read."""

_REMEDY = "Save it anew with kanegen bench --save."


@dataclass(frozen=True)
class Record:
    """Comparisons of one run, with what their times depend on.

    Attributes:
        version: Version of kanegen.
        machine: The machine on which the times were taken.
        options: The extent of the comparisons.
        comparisons: One for each model.
    """

    version: str
    machine: Machine
    options: BenchOptions
    comparisons: tuple[Comparison, ...]

    @classmethod
    def here(cls, comparisons: Sequence[Comparison], options: BenchOptions) -> Record:
        """Return the record of comparisons that were made by this process.

        Raises:
            BuildError: If there is no C compiler.
        """
        return cls(__version__, Machine.here(), options, tuple(comparisons))

    def text(self) -> str:
        """Return all numbers as JSON."""
        content = {
            "kind": KIND,
            "format": FORMAT,
            "kanegen": self.version,
            "machine": asdict(self.machine),
            "options": asdict(self.options),
            "comparisons": [_comparison_as_dict(one) for one in self.comparisons],
        }
        return _json(content) + "\n"


def read_record(path: Path) -> Record:
    """Return the comparisons that a file holds.

    Raises:
        OptionError: If the file was not saved by `kanegen bench --save`, is damaged, or has another format;
            names the file and the place in it.
        ReadError: If the file does not exist or is not text.

    Example:
        record = read_record(Path("before.json"))
    """
    text = read_text(path)
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise OptionError(f"{path}: not valid JSON: {error}. {_REMEDY}") from None
    try:
        return _record(_Object(content, ""))
    except _DamagedError as error:
        raise OptionError(f"{path}: {error} {_REMEDY}") from None


def _json(value: Any, indent: str = "") -> str:
    """Return JSON in which an object without further objects, such as an entry, is one line."""
    if not _holds_objects(value):
        return json.dumps(value)
    inner = indent + " "
    if isinstance(value, dict):
        lines = [f"{inner}{json.dumps(key)}: {_json(one, inner)}" for key, one in value.items()]
        return "{\n" + ",\n".join(lines) + f"\n{indent}}}"
    return "[\n" + ",\n".join(f"{inner}{_json(one, inner)}" for one in value) + f"\n{indent}]"


def _holds_objects(value: Any) -> bool:
    """Return whether an object or a list holds an object."""
    if not isinstance(value, dict | list):
        return False
    inside = value.values() if isinstance(value, dict) else value
    return any(isinstance(one, dict) or _holds_objects(one) for one in inside)


class _DamagedError(Exception):
    """A value of a file is missing or of another kind; the message names its place."""


Value = TypeVar("Value")


@dataclass(frozen=True)
class _Object:
    """An object of a JSON file with its place in the file, such as "comparisons[0].entries[2]"."""

    content: Any
    place: str

    def __post_init__(self) -> None:
        if not isinstance(self.content, dict):
            raise _DamagedError(f"{self.place or 'the file'} is no object.")

    def value(self, key: str, kind: type[Value]) -> Value:
        """Return the value of a key, whose type must be `kind`."""
        found = self.content.get(key)
        accepted: tuple[type, ...] = (float, int) if kind is float else (kind,)
        if not isinstance(found, accepted) or (isinstance(found, bool) and kind is not bool):
            name = {"str": "text", "dict": "object", "list": "list", "bool": "truth value"}.get(kind.__name__)
            raise _DamagedError(f"{self._at(key)} is no {name or 'number'}.")
        try:
            return kind(found)  # type: ignore[call-arg]
        except OverflowError:
            raise _DamagedError(f"{self._at(key)} is beyond the numbers of a computer.") from None

    def texts(self, key: str) -> tuple[str, ...]:
        """Return the value of a key that is a list of texts."""
        found = self.value(key, list)
        if not all(isinstance(one, str) for one in found):
            raise _DamagedError(f"{self._at(key)} is no list of texts.")
        return tuple(found)

    def positive(self, key: str) -> tuple[float, ...]:
        """Return the value of a key that is a list of positive, finite numbers."""
        found = self.value(key, list)
        numbers = all(isinstance(one, int | float) and not isinstance(one, bool) for one in found)
        if not numbers or not all(0 < one <= sys.float_info.max for one in found):
            raise _DamagedError(f"{self._at(key)} is no list of positive numbers.")
        return tuple(map(float, found))

    def objects(self, key: str) -> Iterator[_Object]:
        """Yield the objects of a list."""
        for number, one in enumerate(self.value(key, list)):
            yield _Object(one, f"{self._at(key)}[{number}]")

    def object(self, key: str) -> _Object:
        """Return the value of a key that is an object."""
        return _Object(self.value(key, dict), self._at(key))

    def _at(self, key: str) -> str:
        """Return the place of the value of a key."""
        return f"{self.place}.{key}" if self.place else key


def _record(content: _Object) -> Record:
    """Return the record in the object of a file."""
    if content.content.get("kind") != KIND:
        raise _DamagedError("it holds no times of kanegen bench.")
    if (found := content.content.get("format")) != FORMAT:
        raise _DamagedError(f"it has format {quoted(found)}, and this version of kanegen reads {FORMAT}.")
    machine, options = content.object("machine"), content.object("options")
    names = ("processor", "system", "libc", "compiler", "versions")
    comparisons = tuple(_comparison(one) for one in content.objects("comparisons"))
    rounds = options.value("rounds", int)
    for place, one in enumerate(comparisons):
        if any(len(entry.times.rounds) not in (0, rounds) for entry in one.entries):
            raise _DamagedError(f"comparisons[{place}] has entries with times of other than {rounds} rounds.")
    return Record(
        content.value("kanegen", str),
        Machine(*(machine.value(name, str) for name in names)),
        BenchOptions(options.value("states", int), rounds, options.value("seconds", float)),
        comparisons,
    )


def _comparison(content: _Object) -> Comparison:
    """Return the comparison in an object of a file."""
    absences = [
        Absence(one.value("name", str), one.value("reason", str)) for one in content.objects("left_out")
    ]
    entries = tuple(_entry(one) for one in content.objects("entries"))
    if not entries:
        raise _DamagedError(f"{content.place}.entries is empty.")
    n = content.value("freedoms", int)
    return Comparison(content.value("model", str), n, entries, tuple(absences), content.texts("notes"))


def _entry(content: _Object) -> Entry:
    """Return the entry in an object of a file."""
    setting = Setting(
        content.value("setting", str), content.texts("flags"), content.value("instructions", str)
    )
    task = Task(
        content.value("task", str),
        content.value("quantity", str),
        content.value("batch", bool),
        tolerance=content.value("tolerance", float),
    )
    different = content.content.get("difference")
    return Entry(
        content.value("participant", str),
        setting,
        task,
        np.inf if different is None else content.value("difference", float),
        Times(content.positive("nanoseconds")),
        content.value("cores", int),
    )


def _comparison_as_dict(comparison: Comparison) -> dict[str, Any]:
    """Return a comparison as plain data for JSON."""
    return {
        "model": comparison.model,
        "freedoms": comparison.n,
        "standard": comparison.standard,
        "notes": list(comparison.notes),
        "left_out": [{"name": absence.name, "reason": absence.reason} for absence in comparison.absences],
        "entries": [_entry_as_dict(entry) for entry in comparison.entries],
    }


def _entry_as_dict(entry: Entry) -> dict[str, Any]:
    """Return an entry as plain data for JSON."""
    return {
        "participant": entry.participant,
        "setting": entry.setting.name,
        "flags": list(entry.setting.flags),
        "instructions": entry.setting.instructions,
        "task": entry.task.name,
        "quantity": entry.task.quantity,
        "batch": entry.task.batch,
        "tolerance": entry.task.tolerance,
        "cores": entry.cores,
        "difference": entry.error if np.isfinite(entry.error) else None,
        "nanoseconds": list(entry.times.rounds),
    }
