"""The measurements of the growth study, and the exponents of growth fitted to them."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from benchmarks.growth.cases import Case, Curve

FROM = 32
"""Smallest number of bodies to which exponents are fitted; in smaller trees the first and last joint
dominate."""


@dataclass(frozen=True)
class Measure:
    """A measure: its key in a point, the head of its column, and the unit in which the column shows it."""

    name: str
    title: str
    unit: float = 1.0


MEASURES = (
    Measure("freedoms", "freedoms"),
    Measure("operations", "operations"),
    Measure("derive", "derivation, s"),
    Measure("generate", "generation, s"),
    Measure("memory", "memory, MB", 1e6),
    Measure("code", "C, kB", 1e3),
    Measure("compile", "compile, s"),
    Measure("text", ".text, kB", 1e3),
    Measure("code batch", "C batch, kB", 1e3),
    Measure("compile batch", "compile batch, s"),
    Measure("text batch", ".text batch, kB", 1e3),
    Measure("run", "one state, us", 1e3),
)


@dataclass
class Point:
    """A case and the values of all rounds by measure, in SI units, bytes, and ns for "run"."""

    case: Case
    found: dict[str, list[float]] = field(default_factory=dict)

    def add(self, measured: Mapping[str, float]) -> None:
        """Add the values of one more round."""
        for name, value in measured.items():
            self.found.setdefault(name, []).append(value)

    def median(self, name: str) -> float | None:
        """Return the median of all rounds; None without a measurement."""
        return statistics.median(self.found[name]) if self.found.get(name) else None


@dataclass
class Study:
    """All points of the study, and texts on points that were left out."""

    points: list[Point]
    missing: list[str] = field(default_factory=list)

    def curve(self, curve: Curve) -> list[Point]:
        """Return the points of a curve, small trees first."""
        return [point for point in self.points if point.case.curve == curve]


def series(points: Sequence[Point], name: str) -> list[tuple[int, float]]:
    """Return (bodies, median) of every point that has the measure."""
    pairs = ((point.case.bodies, point.median(name)) for point in points)
    return [(bodies, value) for bodies, value in pairs if value is not None]


def exponent(values: Sequence[tuple[int, float]]) -> float | None:
    """Fit p of value ~ bodies^p from `FROM` bodies on by least squares of logarithms; None for fewer than 2
    points."""
    logs = [(math.log(bodies), math.log(value)) for bodies, value in values if bodies >= FROM and value > 0]
    if len(logs) < 2:
        return None
    return statistics.linear_regression(*zip(*logs, strict=True)).slope
