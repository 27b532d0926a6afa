"""Which variants of a model are tried: a table, a line for every choice.

What multiplies is crossed: every level of one choice with every level of the others. The other choices are
tried one at a time, starting from the `ANCHORS`. A new choice is a new line.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from kanegen.errors import OptionError
from kanegen.lowering.accept import reformulated
from kanegen.model.system import System
from kanegen.options import AUTO, SINCOS, STRICT, Variant
from kanegen.program.semantics import CONTRACTED, FLUSH, RELAXED

Changes = Mapping[str, Any]
"""Fields of a `Variant`, or `OF_THE_SYSTEM`, and their values."""

NATIVE: Changes = {"machine": "native", "optimisation": 3}
"""For this processor."""

REORDERED = (*RELAXED, "associative")
"""What may change the order of sums as well."""

CROSSED: tuple[tuple[Changes, ...], ...] = (
    ({"precision": "double"}, {"precision": "float"}),
    (
        {"solver": "articulated bodies", "refinement": 0},
        {"solver": "factorisation", "refinement": 0},
        {"solver": "factorisation", "refinement": 1},
    ),
    (
        {},
        NATIVE,
        {"semantics": (CONTRACTED,), **NATIVE},
        {"semantics": RELAXED, **NATIVE},
        {"semantics": REORDERED, **NATIVE},
    ),
)
"""Choices of which every combination is tried."""

ALONE: tuple[Changes, ...] = (
    {"solver": "cheapest", "refinement": AUTO},
    {"refinement": 1},
    {"refinement": 2},
    {"solver": "factorisation", "refinement": 2},
    {"speeds": "angular_velocity"},
    {"coordinates": "quaternion"},
    {"precision": "double", "storage": "float"},
    {"precision": "long double"},
    {"precision": "long double", "storage": "double"},
    {"precision": "double-double"},
    {"precision": "double-double", "storage": "double-double"},
    *({"sincos": name} for name in SINCOS if name != STRICT.sincos),
    {"optimisation": 1},
    {"machine": "native", "optimisation": 2},
    {"semantics": RELAXED, "machine": "portable"},
    {"semantics": (FLUSH,)},
    {"without": ("fold",)},
    {"without": ("factor",)},
    {"without": ("fold", "prune", "factor")},
)
"""Choices that are tried one at a time."""

_PLAIN: Changes = {"solver": "articulated bodies", "refinement": 0}
_FAST: Changes = {**_PLAIN, "semantics": RELAXED, **NATIVE}

ANCHORS: tuple[Changes, ...] = (_PLAIN, _FAST, {**_FAST, "precision": "float"})
"""From where: the strict one, the fast one, and the fast one in single precision."""

OF_THE_SYSTEM = ("speeds", "coordinates")
"""The choices that belong to it: its generalized speeds, and what stands for orientations."""


@dataclass(frozen=True)
class Candidate:
    """A way to compute the forward dynamics of a system that takes part.

    Attributes:
        variant: Its choices.
        speeds: Generalized speeds of joints with three free angles, one of `body.SPEEDS`; None as they are.
        coordinates: Of their orientations, one of `body.ORIENTATIONS`; None as they are.
    """

    variant: Variant
    speeds: str | None = None
    coordinates: str | None = None

    @property
    def label(self) -> str:
        """Its choices in a few words."""
        if self == Candidate(STRICT):
            return "default"
        own = {name: value for name in OF_THE_SYSTEM if (value := getattr(self, name))}
        return described(dict(self.variant.described()) | own)

    @property
    def changes_system(self) -> bool:
        """Whether its arrays hold something else than those of the system as it is."""
        return bool(self.speeds or self.coordinates)

    def of(self, system: System) -> System:
        """The system with the speeds and coordinates of this candidate."""
        return reformulated(system, self.speeds, self.coordinates)


@dataclass(frozen=True)
class Refusal:
    """A choice that cannot take part, and why."""

    label: str
    reason: str


def choices() -> list[Changes]:
    """Every combination of the table, each once, the crossed ones first."""
    merged = [_merged(levels) for levels in itertools.product(*CROSSED)]
    merged += [_merged((anchor, change)) for change in ALONE for anchor in ANCHORS]
    return list({repr(sorted(changes.items())): changes for changes in merged}.values())


def candidates(combinations: Iterable[Changes] | None = None) -> tuple[list[Candidate], list[Refusal]]:
    """The variants of the table, or of other combinations of choices, and those that no variant can be."""
    found: list[Candidate] = []
    refused: list[Refusal] = []
    for changes in choices() if combinations is None else combinations:
        try:
            found.append(_candidate(changes))
        except OptionError as error:
            words = {name: ", ".join(v) if isinstance(v, tuple) else str(v) for name, v in changes.items()}
            refused.append(Refusal(described(words), str(error)))
    return list(dict.fromkeys(found)), refused


def described(changes: Mapping[str, str]) -> str:
    """Choices in a few words; the usual ones go without saying."""
    named = [name for name in changes if _SILENT.get(name) != changes[name]]
    ordered = sorted(named, key=lambda name: _ORDER.get(name, len(_ORDER)))
    return ", ".join(_PHRASES.get(name, "{}").format(_short(name, changes[name])) for name in ordered)


_PHRASES = {"optimisation": "-O{}", "storage": "{} arrays", "without": "without {}"}
_SILENT = {**dict(STRICT.described()), "solver": "", "refinement": "0"}
_SOLVERS = {"articulated bodies": "articulated"}
_REFINED = {"1": "refined once", "2": "refined twice", AUTO: "refined as needed"}
_ORDER = {field.name: place for place, field in enumerate(fields(Variant))}
_SHORT = {
    "speeds": {"angular_velocity": "angular velocity"},
    "solver": _SOLVERS,
    "refinement": _REFINED,
    "semantics": {", ".join(RELAXED): "relaxed", ", ".join(REORDERED): "reordered"},
}


def _short(name: str, value: str) -> str:
    return _SHORT.get(name, {}).get(value, value)


def _candidate(changes: Changes) -> Candidate:
    fields = {name: value for name, value in changes.items() if name not in OF_THE_SYSTEM}
    own = {name: value for name, value in changes.items() if name in OF_THE_SYSTEM}
    return Candidate(replace(STRICT, **fields), **own)


def _merged(levels: Iterable[Changes]) -> Changes:
    return {name: value for level in levels for name, value in level.items()}
