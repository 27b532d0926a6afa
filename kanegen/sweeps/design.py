"""The rows of a sweep: every combination of variants, grid values and samples, numbered from 0.

Variants, such as the precision, and lists of expressions change slowest, then the axes with numbers in the
order in which they stand, the last of them fastest; samples change fastest. Rows are made when they are
needed, since there may be many.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.model.arrays import Floats
from kanegen.model.components import AXES
from kanegen.model.nodes import TIME
from kanegen.model.numbers import listed
from kanegen.model.system import System
from kanegen.sweeps import formulas
from kanegen.sweeps.axes import (
    Axis,
    Distribution,
    Formula,
    Values,
    distribution_of,
    items,
    number,
    values_between,
)
from kanegen.sweeps.sampling import Sampling
from kanegen.sweeps.stores import OVER_TIME, REASON, ROW, SAMPLE

MOST_ROWS = 100_000_000
"""Largest number of rows of a sweep."""

BUILD_VARIANTS = ("tier", "precision", "storage", "sincos")
"""Axes that change the code, with the arguments of `options.chosen_variant` as names."""

RUN_VARIANTS = ("method", "step", "duration")
"""Axes that change how a motion is computed, with the names of the fields of a job."""

NUMBERS = ("step", "duration")
"""Variants that are numbers, in s; the others are names."""

VARIANTS = (*BUILD_VARIANTS, *RUN_VARIANTS)
"""Axes whose values differ between chunks, never within one."""

_TAKEN = {
    **dict.fromkeys(VARIANTS, "a variant"),
    **dict.fromkeys((ROW, REASON), "a column of every table"),
    **dict.fromkeys((SAMPLE, OVER_TIME), "a dimension of results"),
}
"""What names stand for that no parameter on an axis can have."""

LOADS = ("force", "torque", "point_force", "point_moment")
"""Inputs with three components for each body or point."""

INPUTS = ("tau", "prescribed", *LOADS)
"""Inputs, which may depend on the time."""


@dataclass(frozen=True)
class Design:
    """The rows of a sweep.

    Attributes:
        variants: Values of variants and texts of lists of expressions, in the order of the axes.
        grid: Values of the other axes.
        samples: (S,) values of each axis with a distribution.
        formulas: Formulas by name of the axis.
        alternatives: Formulas by name of an input with a list of expressions, which is one of the variants,
            and by their text.
        defaults: What names in formulas stand for where they are no axes.
        plain: All axes in plain data, by name.
        sampling: How axes with distributions are sampled.
    """

    variants: tuple[Values, ...]
    grid: tuple[Values, ...]
    samples: Mapping[str, Floats]
    formulas: Mapping[str, Formula]
    defaults: Mapping[str, float]
    plain: Mapping[str, Any]
    sampling: Sampling = field(default_factory=Sampling)
    alternatives: Mapping[str, Mapping[str, Formula]] = field(default_factory=dict)

    @cached_property
    def combinations(self) -> tuple[dict[str, Any], ...]:
        """For each variant the values of its axes by name."""
        count = math.prod(len(axis.rows) for axis in self.variants)
        return tuple(dict(self._chosen(self.variants, place)) for place in range(count))

    @cached_property
    def rows_of_variant(self) -> int:
        """Number of rows with the same variant."""
        inner = self.sampling.count if self.samples else 1
        return inner * math.prod(len(axis.rows) for axis in self.grid)

    @property
    def rows(self) -> int:
        """Number of rows of the whole sweep."""
        return self.rows_of_variant * math.prod(len(axis.rows) for axis in self.variants)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers that differ from row to row and have one value in each, in their order."""
        timed = formulas.depending_on_time(self.formulas)
        of_grid = (name for axis in self.grid for name in axis.names)
        return (
            *of_grid,
            *self.samples,
            *(name for name in formulas.ordered(self.formulas) if name not in timed),
        )

    @property
    def dimensions(self) -> list[dict[str, Any]]:
        """The directions in which rows differ, the slowest first: names of axes and number of values.

        The direction of samples has no names.
        """
        found = [{"names": list(axis.names), "size": len(axis.rows)} for axis in (*self.variants, *self.grid)]
        return found + ([{"names": [], "size": self.sampling.count}] if self.samples else [])

    def timed(self, variant: Mapping[str, Any]) -> Mapping[str, Formula]:
        """Return the formulas that depend on the time, each after those from which it follows.

        Args:
            variant: One of `combinations`, which chooses from lists of expressions.
        """
        timed = formulas.depending_on_time(self.formulas)
        found = {name: self.formulas[name] for name in formulas.ordered(self.formulas) if name in timed}
        return found | {name: texts[variant[name]] for name, texts in self.alternatives.items()}

    def columns(self, first: int, last: int) -> dict[str, Floats]:
        """Return the numbers of `names` in the rows `first` to `last` - 1 of a variant, each (B,)."""
        place = np.arange(first, last)
        found: dict[str, Floats] = {}
        if self.samples:
            place, sample = np.divmod(place, self.sampling.count)
            found = {name: values[sample] for name, values in self.samples.items()}
        for axis, array in reversed(list(zip(self.grid, self._grid_values, strict=True))):
            place, own = np.divmod(place, len(axis.rows))
            found |= dict(zip(axis.names, array[:, own], strict=True))
        for name in self.names:
            if name in self.formulas:
                known: dict[str, Any] = {**self.defaults, **found}
                found[name] = formulas.values(self.formulas[name], known, (last - first,))
        return {name: found[name] for name in self.names}

    @cached_property
    def _grid_values(self) -> tuple[Floats, ...]:
        """For each part of the grid its (names, values) numbers."""
        return tuple(np.array(axis.rows, np.float64).T.copy() for axis in self.grid)

    @staticmethod
    def _chosen(axes: Iterable[Values], place: int) -> list[tuple[str, Any]]:
        """Return name and value of each axis at a place in the product of axes, the last of them fastest."""
        found: list[tuple[str, Any]] = []
        for axis in reversed(list(axes)):
            place, own = divmod(place, len(axis.rows))
            found = [*zip(axis.names, axis.rows[own], strict=True), *found]
        return found


def known_names(system: System) -> dict[str, str]:
    """Return the names of all axes that a system can have, other than variants, with their units."""
    found = {parameter.name: "" for parameter in system.parameters}
    units = [coordinate.unit for coordinate in system.coordinates]
    found |= {f"x.{name}": unit for name, unit in zip(system.coordinate_names, units, strict=True)}
    speeds = ["rad/s" if freedom.is_angle else "m/s" for freedom in system.freedoms]
    found |= {f"y.{name}": unit for name, unit in zip(system.speed_names, speeds, strict=True)}
    efforts = ["N m" if freedom.is_angle else "N" for freedom in system.freedoms]
    found |= {f"tau.{name}": unit for name, unit in zip(system.freedom_names, efforts, strict=True)}
    moved = zip(system.prescribed_names, system.prescribed, strict=True)
    found |= {f"prescribed.{name}": "rad" if freedom.is_angle else "m" for name, freedom in moved}
    bodies = [body.name for body in system.bodies if body.loads]
    points = [point.name for _, point in system.points if point.loads]
    for load, names, unit in zip(LOADS, (bodies, bodies, points, points), ("N", "N m") * 2, strict=True):
        found |= {f"{load}.{name}.{axis}": unit for name in names for axis in AXES}
    return found


def read_design(system: System, axes: Mapping[Any, Any], sampling: Sampling, where: str = "axes") -> Design:
    """Return the rows that axes describe.

    Args:
        system: The tree whose parameters, coordinates and inputs the axes name.
        axes: The values of each axis by its name, see `kg.sweep`.
        sampling: How axes with distributions are sampled.
        where: Beginning of error messages.

    Raises:
        OptionError: If a name is unknown, values do not fit, or there is no row or too many.
        MissingError: If SciPy is needed and not installed.
    """
    if not isinstance(axes, Mapping):
        raise OptionError(f'{where}: {quoted(axes)} is no table of axes such as {{"m1": [1.0, 2.0]}}.')
    known = known_names(system)
    read: dict[tuple[str, ...], Axis] = {}
    for key, value in axes.items():
        names = _names(where, key)
        for name in names:
            if any(name in others for others in read):
                raise OptionError(f"{where}: {quoted(name)} stands there twice. Name it once.")
            if name in known and name in _TAKEN:
                raise OptionError(
                    f"{where}: {quoted(name)} is a parameter and {_TAKEN[name]}. Rename the parameter."
                )
            if name not in known and name not in VARIANTS:
                raise OptionError(
                    f"{where}: there is no {quoted(name)}. {did_you_mean(name, (*known, *VARIANTS))}"
                )
        read[names] = _axis(f"{where}: {', '.join(names)}", names, value, system)
    _require_prescribed(where, system, [name for names in read for name in names])
    distributions = {names[0]: axis for names, axis in read.items() if isinstance(axis, Distribution)}
    of_formulas = {names[0]: axis for names, axis in read.items() if isinstance(axis, Formula)}
    several = [axis for axis in read.values() if isinstance(axis, Values)]
    alternatives = _alternatives(where, several, system)
    slowest = [axis for axis in several if axis.names[0] in (*VARIANTS, *alternatives)]
    for name in formulas.depending_on_time(of_formulas):
        if not name.startswith(tuple(f"{kind}." for kind in INPUTS)):
            raise OptionError(
                f"{where}: {name}: only inputs such as tau.{system.freedom_names[0]} depend on {TIME}."
            )
    found = Design(
        variants=tuple(slowest),
        grid=tuple(axis for axis in several if axis not in slowest),
        samples={},
        formulas=of_formulas,
        defaults=formulas.defaults(system),
        plain={", ".join(names): axis.plain for names, axis in read.items()},
        sampling=sampling,
        alternatives=alternatives,
    )
    rows = found.rows * (sampling.count if distributions else 1)
    if rows > MOST_ROWS:
        raise OptionError(f"{where}: {rows} rows are more than {MOST_ROWS}. Take fewer values or samples.")
    return replace(found, samples=sampling.draw(distributions))


def _alternatives(where: str, axes: Iterable[Values], system: System) -> dict[str, dict[str, Formula]]:
    """Return the formulas of lists of expressions by name of the axis and by text."""
    found = {}
    for axis in axes:
        name, texts = axis.names[0], [row[0] for row in axis.rows]
        if name not in VARIANTS and isinstance(texts[0], str):
            found[name] = {text: formulas.formula(f"{where}: {name}", text, system) for text in texts}
    return found


def _require_prescribed(where: str, system: System, names: Iterable[str]) -> None:
    """Make sure that the motion of each prescribed freedom is given."""
    given = set(names)
    missing = [f"prescribed.{name}" for name in system.prescribed_names if f"prescribed.{name}" not in given]
    if missing:
        raise OptionError(
            f"{where}: the motion of prescribed freedoms is missing: {', '.join(missing)}. Give each a "
            f"number, or an expression of t, such as {{{missing[0]!r}: '0.1*sin(t)'}}."
        )


def _names(where: str, key: object) -> tuple[str, ...]:
    """Return the names of an axis, or of several whose values go together."""
    parts = tuple(key) if isinstance(key, tuple) else key.split(",") if isinstance(key, str) else None
    if not parts or not all(isinstance(part, str) and part.strip() for part in parts):
        raise OptionError(f"{where}: {quoted(key)} is no name of an axis.")
    return tuple(part.strip() for part in parts)


def _axis(where: str, names: tuple[str, ...], value: Any, system: System) -> Axis:
    """Return the axis that a value describes in plain data or in NumPy."""
    if len(names) > 1:
        return _joint_axes(where, names, value)
    if names[0] in VARIANTS:
        as_it_is = names[0] not in NUMBERS
        given = [value] if isinstance(value, str) else _between(where, value)
        return Values(names, tuple((one if as_it_is else number(where, one),) for one in given))
    if isinstance(value, str):
        return formulas.formula(where, value, system)
    if isinstance(value, Mapping) and (found := distribution_of(where, value)):
        return found
    given = _between(where, value)
    if any(isinstance(one, str) for one in given):
        return _expressions(where, names, given)
    return Values(names, tuple((number(where, one),) for one in given))


def _expressions(where: str, names: tuple[str, ...], given: Sequence[Any]) -> Values:
    """Return the axis of an input with a list of expressions, among which numbers may be."""
    if names[0].partition(".")[0] not in INPUTS:
        text = next(one for one in given if isinstance(one, str))
        raise OptionError(
            f"{where}: {quoted(text)} is not a number. Lists of expressions are for inputs alone, such as "
            "'tau' and 'prescribed'."
        )
    texts = [one if isinstance(one, str) else repr(number(where, one)) for one in given]
    return Values(names, tuple((text,) for text in texts))


def _between(where: str, value: Any) -> list[Any]:
    """Return the values of an axis from a list, a number, or a table with two ends."""
    return values_between(where, value) if isinstance(value, Mapping) else items(where, value)


def _joint_axes(where: str, names: tuple[str, ...], value: Any) -> Values:
    """Return axes whose values go together, from rows with one value for each."""
    if any(name in VARIANTS for name in names):
        raise OptionError(f"{where}: variants stand alone. Give each of them a line of its own.")
    rows = [listed(row) for row in items(where, value)]
    for place, row in enumerate(rows):
        if row is None or len(row) != len(names):
            raise OptionError(f"{where}: row {place} is {quoted(row)}, not {len(names)} numbers.")
    return Values(names, tuple(tuple(number(where, one) for one in row or ()) for row in rows))
