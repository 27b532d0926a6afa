"""Limits of the freedoms of a joint and of a system: position, speed and effort; infinity means no limit.

The equations of motion do not contain limits. Limits describe where a mechanism works, and are the default
ranges of states in comparisons, studies, budgets, bounds and benches.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.choices import did_you_mean
from kanegen.errors import ModelError, quoted
from kanegen.model import validation
from kanegen.model.coordinates import ANGLES, FREEDOMS
from kanegen.model.finite import is_plain
from kanegen.model.numbers import is_fixed, number, toml_number, value_of

KEYS = ("position", "speed", "effort")
"""Keys of the limits of one freedom in a model file and in `System.with_limits`."""

Floats = NDArray[np.float64]

Six = tuple[float, ...]
"""(6,) one number for each of `FREEDOMS`."""

_NONE: Six = (math.inf,) * 6


@dataclass(frozen=True)
class Limits:
    """Limits of the six freedoms of a joint, in the order of `FREEDOMS`; infinite where there is none.

    Attributes:
        lower: (6,) smallest positions (rad, m).
        upper: (6,) largest positions (rad, m).
        speed: (6,) largest magnitudes of the generalized speeds (rad/s, m/s).
        effort: (6,) largest magnitudes of the generalized forces of the drives (N m, N).

    Raises:
        ModelError: If a limit is no number or leaves no motion, a lower one exceeds its upper one, or a speed
            or an effort is negative.

    Example:
        limits = kg.Limits.of({"theta3": {"position": (-1.5, 1.5), "speed": 2.0, "effort": 87.0}})
    """

    lower: Six = (-math.inf,) * 6
    upper: Six = _NONE
    speed: Six = _NONE
    effort: Six = _NONE

    def __post_init__(self) -> None:
        for name in ("lower", "upper", "speed", "effort"):
            items = validation.sequence(getattr(self, name), len(FREEDOMS), f"limits: {name}")
            labels = (f"limits: {name} of {freedom}" for freedom in FREEDOMS)
            values = tuple(_limit(item, label) for item, label in zip(items, labels, strict=True))
            validation.store(self, **{name: values})
        for index, freedom in enumerate(FREEDOMS):
            lower, upper = self.lower[index], self.upper[index]
            if lower > upper:
                raise ModelError(
                    f"limits: the lower position of {freedom}, {lower!r}, exceeds the upper one, {upper!r}. "
                    "Exchange them."
                )
            if lower in (upper, math.inf) or upper == -math.inf:
                raise ModelError(
                    f"limits: {freedom} cannot move between {lower!r} and {upper!r}. Lock it, or leave the "
                    "limit out."
                )
            if self.speed[index] == 0:
                raise ModelError(
                    f"limits: {freedom} cannot move at the speed 0. Lock it, or leave the limit out."
                )
            for name, value in (("speed", self.speed[index]), ("effort", self.effort[index])):
                if value < 0:
                    raise ModelError(
                        f"limits: the {name} of {freedom} is {value!r}. A limit of the {name} is its largest "
                        "magnitude, which is not negative."
                    )

    @classmethod
    def of(cls, table: Any) -> Limits:
        """Return limits from a table by freedom, with the keys `KEYS`, each of which may be left out.

        Raises:
            ModelError: If a freedom or a key is unknown, or a limit is not usable.

        Example:
            kg.Limits.of({"s1": {"position": (0.0, 0.4)}})
        """
        example = "{theta3 = {position = [-1, 1], speed = 2, effort = 87}}"
        found = cls()
        for freedom, own in validation.table(table, "limits", example).items():
            if freedom not in FREEDOMS:
                raise ModelError(
                    f"limits: {quoted(freedom)} is no freedom. {did_you_mean(freedom, FREEDOMS)}"
                )
            found = found.with_freedom(FREEDOMS.index(freedom), own)
        return found

    def with_freedom(self, index: int, table: Any) -> Limits:
        """Return the same limits with those of freedom `index` of `FREEDOMS` replaced.

        Args:
            index: Index of the freedom.
            table: "position" (two numbers), "speed" and "effort" by name; what is left out has no limit.

        Raises:
            ModelError: If a key is unknown or a limit is not usable.

        Example:
            limits.with_freedom(2, {"position": (-1.0, 1.0)})
        """
        label = f"limits: {FREEDOMS[index]}"
        for key in validation.table(table, label, "{position = [-1, 1], speed = 2, effort = 87}"):
            if key not in KEYS:
                raise ModelError(f"{label}: unknown key {quoted(key)}. {did_you_mean(key, KEYS)}")
        position = table.get("position", (-math.inf, math.inf))
        lower, upper = validation.sequence(position, 2, f"{label}: position")
        values = {"lower": lower, "upper": upper}
        values |= {key: table.get(key, math.inf) for key in KEYS[1:]}
        return replace(self, **{name: _with(getattr(self, name), index, v) for name, v in values.items()})

    def without(self, *indices: int) -> Limits:
        """Return the same limits without those of some freedoms, given by their indices in `FREEDOMS`.

        Example:
            limits.without(0, 1, 2)  # translations keep theirs
        """
        found = self
        for index in indices:
            found = found.with_freedom(index, {})
        return found

    def limited(self) -> tuple[bool, ...]:
        """Return (6,) which freedoms have a limit.

        Example:
            any(joint.limits.limited())
        """
        return tuple(bool(self.table_of(index)) for index in range(len(FREEDOMS)))

    def as_table(self) -> dict[str, dict[str, Any]]:
        """Return the limits by freedom, as a model file holds them; freedoms without limits are left out.

        Example:
            kg.Limits().as_table()  # {}
        """
        tables = {name: self.table_of(index) for index, name in enumerate(FREEDOMS)}
        return {name: table for name, table in tables.items() if table}

    def table_of(self, index: int) -> dict[str, Any]:
        """Return the limits of freedom `index` of `FREEDOMS` by name, without those that are infinite.

        Example:
            joint.limits.table_of(2).get("speed")
        """
        ends = {"speed": self.speed[index], "effort": self.effort[index]}
        table: dict[str, Any] = {name: value for name, value in ends.items() if math.isfinite(value)}
        position = (self.lower[index], self.upper[index])
        return {"position": position, **table} if any(map(math.isfinite, position)) else table


@dataclass(frozen=True)
class SystemLimits:
    """Limits of a system in the order of {x} and {y}; infinite where there is none.

    Attributes:
        lower: (m,) smallest coordinates (rad, m).
        upper: (m,) largest coordinates (rad, m).
        speed: (n,) largest magnitudes of the generalized speeds (rad/s, m/s).
        effort: (n,) largest magnitudes of the generalized forces of the drives (N m, N).
        not_kept: Names of coupled freedoms that may leave their own limits within these.
    """

    lower: Floats
    upper: Floats
    speed: Floats
    effort: Floats
    not_kept: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Return whether there is any limit."""
        return any(self.counts().values())

    def counts(self) -> dict[str, int]:
        """Return the number of limited coordinates, speeds and efforts, by "position", "speed", "effort".

        Example:
            system.limits.counts()["effort"]
        """
        positions = np.isfinite(self.lower) | np.isfinite(self.upper)
        limited = (positions, np.isfinite(self.speed), np.isfinite(self.effort))
        return {key: int(flags.sum()) for key, flags in zip(KEYS, limited, strict=True)}

    @property
    def words(self) -> str:
        """How many coordinates, speeds and efforts have limits, and which are not kept; "" for no limits."""
        sizes = (len(self.lower), len(self.speed), len(self.effort))
        nouns = ("coordinates", "speeds", "efforts")
        parts = zip(self.counts().values(), sizes, nouns, strict=True)
        text = ", ".join(f"{count} of {size} {noun}" for count, size, noun in parts if count)
        if not self.not_kept:
            return text
        names = ", ".join(map(repr, self.not_kept))
        kind = "freedom" if len(self.not_kept) == 1 else "freedoms"
        return f"{text or 'no coordinate'}, but not those of the coupled {kind} {names}"

    def positions(self, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Return ranges of the coordinates: the limits, and `low` to `high` where there are none.

        A coordinate that is limited on one side keeps its other end, or the length of its range where that
        end lies beyond the limit.

        Args:
            low: (m,) lower ends without limits (rad, m, 1).
            high: (m,) upper ends without limits.

        Example:
            low, high = system.limits.positions(-np.ones(m), np.ones(m))
        """
        has_lower, has_upper = np.isfinite(self.lower), np.isfinite(self.upper)
        length = high - low
        lower, upper = np.where(has_lower, self.lower, low), np.where(has_upper, self.upper, high)
        crossed = lower >= upper
        upper = np.where(crossed & has_lower & ~has_upper, lower + length, upper)
        lower = np.where(crossed & has_upper & ~has_lower, upper - length, lower)
        return lower, upper

    def speeds(self, largest: Floats) -> Floats:
        """Return (n,) largest magnitudes of the speeds: the limits, and `largest` where there are none.

        Example:
            system.limits.speeds(np.ones(n))
        """
        return np.where(np.isfinite(self.speed), self.speed, largest)

    def efforts(self, largest: Floats) -> Floats:
        """Return (n,) largest magnitudes of the efforts: the limits, and `largest` where there are none.

        Example:
            system.limits.efforts(np.zeros(n))
        """
        return np.where(np.isfinite(self.effort), self.effort, largest)


def check_limits(limits: Limits, moving: Sequence[bool], coordinate_kinds: Collection[int]) -> None:
    """Make sure that limits fit a joint.

    Args:
        limits: The limits.
        moving: (6,) which of `FREEDOMS` are free or prescribed.
        coordinate_kinds: Indices of the coordinates of the joint in `COORDINATE_KINDS`.

    Raises:
        ModelError: If a freedom that is locked has a limit, or one that is no coordinate has one of its
            position.
    """
    for index, (name, is_limited) in enumerate(zip(FREEDOMS, limits.limited(), strict=True)):
        if is_limited and not moving[index]:
            raise ModelError(
                f"limits: {name} is locked, so a limit says nothing. Leave it out, or free {name}."
            )
        finite = math.isfinite(limits.lower[index]) or math.isfinite(limits.upper[index])
        if finite and index not in coordinate_kinds:
            raise ModelError(
                f"limits: {name} is no coordinate of this joint, so its position has no limit. Leave it out, "
                "or take angles as coordinates."
            )


def without_angles(limits: Limits) -> Limits:
    """Return the same limits without those of the three angles.

    Example:
        without_angles(joint.limits).limited()[:3]  # (False, False, False)
    """
    return limits.without(*ANGLES)


def _limit(value: Any, label: str) -> float:
    """Return one limit as a float, which may be infinite.

    Raises:
        ModelError: If it is no number, or depends on parameters.
    """
    if not is_plain(value):
        found = number(value, label)
        if not is_fixed(found):
            shown = quoted(str(toml_number(found)))
            raise ModelError(
                f"{label}: {shown} depends on parameters and is not a number, as a limit must be."
            )
        return value_of(found)
    try:
        limit = float(value) + 0.0
    except OverflowError:
        limit = math.inf if value > 0 else -math.inf
    if math.isnan(limit):
        raise ModelError(f"{label}: nan is not a number.")
    return limit


def _with(values: Six, index: int, value: Any) -> tuple[Any, ...]:
    """Return the same values with another one at one place."""
    return (*values[:index], value, *values[index + 1 :])


NO_LIMITS = Limits()
"""The limits of a joint that has none."""
