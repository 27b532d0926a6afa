"""The variants that a study measures: a table with a line for every choice.

Choices whose effects multiply are crossed: every level of one choice with every level of the others. The
other choices are changed one at a time, starting from the `BASELINES`. A new choice is a new line.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from kanegen.errors import OptionError
from kanegen.lowering.accept import reformulated
from kanegen.model.coordinates import ORIENTATIONS
from kanegen.model.system import System
from kanegen.options import AUTO, SINCOS, STRICT, Variant
from kanegen.program.semantics import CONTRACTED, FLUSH, RELAXED

Changes = Mapping[str, Any]
"""Values of some fields of a `Variant` or of `SYSTEM_CHOICES`, by name; the others keep their defaults."""

NATIVE: Changes = {"machine": "native", "optimisation": 3}
"""The choices for the processor of this machine."""

REORDERED = (*RELAXED, "associative")
"""The relaxed semantics that also allow another order of sums."""

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
"""Levels of the choices that are crossed."""

SINGLE_CHANGES: tuple[Changes, ...] = (
    {"solver": "cheapest", "refinement": AUTO},
    {"refinement": 1},
    {"refinement": 2},
    {"solver": "factorisation", "refinement": 2},
    {"speeds": "angular_velocity"},
    *({"coordinates": name} for name in ORIENTATIONS[1:]),
    {"precision": "double", "storage": "float"},
    {"precision": "long double"},
    {"precision": "long double", "storage": "double"},
    {"precision": "double-double"},
    {"precision": "double-double", "storage": "double-double"},
    *({"sincos": name} for name in SINCOS if name != STRICT.sincos),
    {"optimisation": 1},
    {"machine": "native", "optimisation": 2},
    {"semantics": RELAXED, "machine": AUTO},
    {"semantics": (FLUSH,)},
    {"without": ("fold",)},
    {"without": ("factor",)},
    {"without": ("fold", "prune", "factor")},
)
"""Choices that are changed one at a time."""

_PLAIN: Changes = {"solver": "articulated bodies", "refinement": 0}
_FAST: Changes = {**_PLAIN, "semantics": RELAXED, **NATIVE}

BASELINES: tuple[Changes, ...] = (_PLAIN, _FAST, {**_FAST, "precision": "float"})
"""The variants from which single changes start: strict, fast, and fast in single precision."""

QUICK: tuple[Changes, ...] = (
    {},
    *({**_PLAIN, **changes} for changes in (NATIVE, {"semantics": RELAXED, **NATIVE})),
    *(
        {"solver": "factorisation", "refinement": refined, "semantics": semantics, **NATIVE}
        for refined, semantics in ((0, ()), (0, REORDERED), (1, RELAXED))
    ),
    {**_FAST, "precision": "float"},
    {**_FAST, "sincos": "polynomial-9"},
    {**_FAST, "precision": "float", "sincos": "polynomial-5"},
    {**_FAST, "speeds": "angular_velocity"},
    {**_PLAIN, "precision": "double-double"},
)
"""The few variants of a quick study: the default, and the usual winners and losers of full studies."""

SYSTEM_CHOICES = ("speeds", "coordinates")
"""The choices that change the system: its generalized speeds and the coordinates of its orientations."""

_PHRASES = {"optimisation": "-O{}", "storage": "{} arrays", "without": "without {}"}
"""Phrases for the values of choices that need more than the value itself."""

_UNNAMED = {**dict(STRICT.choices()), "solver": "", "refinement": "0"}
"""Values of choices that a label leaves out."""

_ORDER = {field.name: place for place, field in enumerate(fields(Variant))}
"""Index of each choice in a label."""

_SHORT = {
    "speeds": {"angular_velocity": "angular velocity"},
    "solver": {"articulated bodies": "articulated"},
    "refinement": {"1": "refined once", "2": "refined twice", AUTO: "refined as needed"},
    "semantics": {", ".join(RELAXED): "relaxed", ", ".join(REORDERED): "reordered"},
}
"""Short names of the values of choices."""


@dataclass(frozen=True)
class Candidate:
    """A way to compute the forward dynamics of a system.

    Attributes:
        variant: The choices of the generator and the compiler.
        speeds: Generalized speeds of joints with three free angles, one of the names that
            `System.with_speeds` takes; None for those of the system.
        coordinates: Coordinates of the orientations of these joints, one of the names that
            `System.with_coordinates` takes; None for those of the system.
    """

    variant: Variant
    speeds: str | None = None
    coordinates: str | None = None

    @property
    def label(self) -> str:
        """The choices in a few words."""
        if self == Candidate(STRICT):
            return "default"
        own = {name: value for name in SYSTEM_CHOICES if (value := getattr(self, name))}
        return label_of(dict(self.variant.choices()) | own)

    @property
    def changes_system(self) -> bool:
        """Whether its arrays hold other speeds or coordinates than those of the system."""
        return self.speeds is not None or self.coordinates is not None

    def of(self, system: System) -> System:
        """Return the system with the speeds and coordinates of this candidate."""
        return reformulated(system, self.speeds, self.coordinates)


@dataclass(frozen=True)
class Refusal:
    """A variant that cannot be built.

    Attributes:
        label: The choices of the variant in a few words.
        reason: Reason why the variant cannot be built.
    """

    label: str
    reason: str


def combinations() -> list[Changes]:
    """Return every combination of choices of the tables, each once, the crossed ones first."""
    merged = [_merged(levels) for levels in itertools.product(*CROSSED)]
    merged += [_merged((baseline, change)) for change in SINGLE_CHANGES for baseline in BASELINES]
    return list({repr(sorted(changes.items())): changes for changes in merged}.values())


def candidates(wanted: Iterable[Changes] | None = None) -> tuple[list[Candidate], list[Refusal]]:
    """Return the candidates of combinations of choices, and a refusal for each impossible combination.

    Args:
        wanted: Combinations of choices; by default those of the tables.
    """
    found: list[Candidate] = []
    refused: list[Refusal] = []
    for changes in combinations() if wanted is None else wanted:
        try:
            found.append(_candidate(changes))
        except OptionError as error:
            texts = {name: ", ".join(v) if isinstance(v, tuple) else str(v) for name, v in changes.items()}
            refused.append(Refusal(label_of(texts), str(error)))
    return list(dict.fromkeys(found)), refused


def label_of(changes: Mapping[str, str]) -> str:
    """Return choices in a few words; the usual values are left out."""
    named = [name for name in changes if _UNNAMED.get(name) != changes[name]]
    ordered = sorted(named, key=lambda name: _ORDER.get(name, len(_ORDER)))
    return ", ".join(_PHRASES.get(name, "{}").format(_short(name, changes[name])) for name in ordered)


def _short(name: str, value: str) -> str:
    """Return the short name of a value of a choice, or the value itself."""
    return _SHORT.get(name, {}).get(value, value)


def _candidate(changes: Changes) -> Candidate:
    """Return the candidate with some choices and the defaults of the others.

    Raises:
        OptionError: If no variant can have these choices.
    """
    of_variant = {name: value for name, value in changes.items() if name not in SYSTEM_CHOICES}
    of_system = {name: value for name, value in changes.items() if name in SYSTEM_CHOICES}
    return Candidate(replace(STRICT, **of_variant), **of_system)


def _merged(levels: Iterable[Changes]) -> Changes:
    """Return the choices of all levels together; later levels override earlier ones."""
    return {name: value for level in levels for name, value in level.items()}
