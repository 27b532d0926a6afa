"""What varies in a sweep: lists of values, distributions that are sampled, and expressions of other axes.

Every kind of axis has a form in plain data, such as `{"uniform": [0.5, 2.0]}`, which stands in files, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, OptionError, quoted
from kanegen.extras import module
from kanegen.model.arrays import Floats
from kanegen.model.expression import Expression
from kanegen.model.numbers import finite, listed

EXTRA = "sweep"
"""The extra that installs what draws samples and holds results: SciPy, PyArrow, pandas, xarray, Zarr."""

MOST_VALUES = 10_000_000
"""Largest number of values of one axis."""

_SPACINGS: Mapping[str, Callable[[float, float, int], Floats]] = {
    "linear": np.linspace,
    "log": np.geomspace,
}
"""Functions that place values between two ends."""


@dataclass(frozen=True)
class Values:
    """Values of one axis, or of several whose values go together; they are combined with all other axes.

    Attributes:
        names: Names of the axes.
        rows: For each combination one value for each name: numbers, or names of variants.
    """

    names: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    @property
    def plain(self) -> Any:
        """The values in plain data."""
        return [row[0] for row in self.rows] if len(self.names) == 1 else [list(row) for row in self.rows]


@dataclass(frozen=True)
class Formula:
    """An axis whose values follow from those of other axes, of parameters and of the time.

    Attributes:
        text: The expression as it was written.
        expression: The expression; every name in it is a variable.
    """

    text: str
    expression: Expression

    @property
    def plain(self) -> Any:
        """The axis in plain data."""
        return self.text


@dataclass(frozen=True)
class Distribution:
    """An axis whose values are drawn from a distribution.

    Attributes:
        kind: One of `DISTRIBUTIONS`.
        numbers: Lower and upper end; of "normal" the mean and the standard deviation.
    """

    kind: str
    numbers: tuple[float, float]

    @property
    def plain(self) -> Any:
        """The axis in plain data."""
        return {self.kind: list(self.numbers)}

    def quantiles(self, shares: Floats) -> Floats:
        """Return the values below which given shares of the distribution lie.

        Args:
            shares: (S,) numbers between 0 and 1, without the ends.
        """
        return DISTRIBUTIONS[self.kind](shares, *self.numbers)


UNIFORM, LOG_UNIFORM, NORMAL = "uniform", "log_uniform", "normal"


def _uniform(shares: Floats, low: float, high: float) -> Floats:
    """Return quantiles between two ends, without overflow of their difference."""
    return low * (1 - shares) + high * shares


def _log_uniform(shares: Floats, low: float, high: float) -> Floats:
    """Return quantiles whose logarithms are uniform."""
    found: Floats = np.exp(_uniform(shares, math.log(low), math.log(high)))
    return found


def _normal(shares: Floats, mean: float, deviation: float) -> Floats:
    """Return quantiles of the normal distribution."""
    found: Floats = mean + deviation * module("scipy.special", extra=EXTRA).ndtri(shares)
    return found


DISTRIBUTIONS: Mapping[str, Callable[[Floats, float, float], Floats]] = {
    UNIFORM: _uniform,
    LOG_UNIFORM: _log_uniform,
    NORMAL: _normal,
}
"""Functions of shares between 0 and 1 and two numbers, by the name of the distribution."""

Axis = Values | Formula | Distribution


def values_between(where: str, table: Mapping[str, Any]) -> list[float]:
    """Return the values of a table such as `{"from": 0.5, "to": 2.0, "count": 16, "spacing": "log"}`.

    Raises:
        OptionError: If the table has another form; the message begins with `where`.
    """
    _require_keys(where, table, ("from", "to", "count", "spacing"), tuple(DISTRIBUTIONS))
    for key in ("from", "to", "count"):
        if key not in table:
            raise OptionError(f"{where}: {key!r} is missing. Write {{from = 1.0, to = 2.0, count = 11}}.")
    count, spacing = table["count"], table.get("spacing", "linear")
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_VALUES:
        raise OptionError(f"{where}: count: {quoted(count)} is no whole number from 1 to {MOST_VALUES}.")
    if spacing not in _SPACINGS:
        raise OptionError(f"{where}: unknown spacing {quoted(spacing)}. {did_you_mean(spacing, _SPACINGS)}")
    first, last = (number(f"{where}: {key}", table[key]) for key in ("from", "to"))
    if spacing == "log" and not first * last > 0:
        raise OptionError(f"{where}: spacing 'log' needs two ends of one sign, got {first!r} and {last!r}.")
    found: list[float] = _SPACINGS[spacing](first, last, count).tolist()
    return found


def distribution_of(where: str, table: Mapping[str, Any]) -> Distribution | None:
    """Return the distribution of a table such as `{"normal": [0.0, 0.1]}`, None for another table.

    Raises:
        OptionError: If the numbers do not fit; the message begins with `where`.
    """
    for kind in DISTRIBUTIONS:
        if kind in table:
            _require_keys(where, table, (kind,))
            return _distribution(f"{where}: ", kind, table[kind])
    return None


def items(where: str, value: Any) -> list[Any]:
    """Return the values of an axis in a list, also a single one.

    Raises:
        OptionError: If there is no value, or there are too many.
    """
    several = listed(value)
    if several is None:
        several = [value]
    if not several:
        raise OptionError(f"{where}: there is no value. Give one at least.")
    if len(several) > MOST_VALUES:
        raise OptionError(f"{where}: {len(several)} values are more than {MOST_VALUES}.")
    return several


def number(where: str, value: Any) -> float:
    """Return a value as a finite number.

    Raises:
        OptionError: If it is none; the message begins with `where`.
    """
    try:
        return finite(value, where)
    except ModelError as error:
        raise OptionError(str(error)) from None


def _distribution(where: str, kind: str, given: Any) -> Distribution:
    """Return the distribution of a kind with two numbers, checked."""
    pair = listed(given)
    if pair is None or len(pair) != 2:
        raise OptionError(f"{where}{kind} takes two numbers, got {quoted(given)}.")
    first, second = (number(f"{where}{kind}", one) for one in pair)
    if kind == NORMAL and not second > 0:
        raise OptionError(f"{where}{kind}: the standard deviation {second!r} is not positive.")
    if kind != NORMAL and not first < second:
        raise OptionError(f"{where}{kind}: the lower end {first!r} is not below the upper end {second!r}.")
    if kind == LOG_UNIFORM and not first > 0:
        raise OptionError(f"{where}{kind}: the lower end {first!r} is not positive.")
    return Distribution(kind, (first, second))


def _require_keys(
    where: str, table: Mapping[str, Any], known: tuple[str, ...], others: tuple[str, ...] = ()
) -> None:
    """Require that every key of a table is known; `others` are keys of other tables, for the hint."""
    for key in table:
        if key not in known:
            raise OptionError(f"{where}: unknown key {quoted(key)}. {did_you_mean(key, (*others, *known))}")
