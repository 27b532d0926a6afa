"""The choices that trade speed for accuracy, as one value that goes with the C it shaped.

Every field is an explicit option of the generator or the compiler; named tiers are bundles of them. What a
choice costs and what error it has is measured, never assumed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace

from kanegen import precision as precisions
from kanegen.errors import OptionError
from kanegen.program import passes
from kanegen.suggest import did_you_mean

SOLVERS = ("cheapest", "articulated bodies", "factorisation")
"""Ways to {ydot}: the cheapest by operation count among those that lose no accuracy, or one by name."""


def _one_of(what: str, value: object, known: tuple[str, ...]) -> None:
    if value not in known:
        raise OptionError(f"unknown {what} {value!r}. {did_you_mean(value, known)}")


def _words(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(map(str, value)) or "none"
    return str(value)


@dataclass(frozen=True)
class Variant:
    """One way to compute the equations of a tree.

    Attributes:
        precision: Type of all numbers in C, a name of `precision.PRECISIONS`.
        solver: Way to {ydot}, one of `SOLVERS`.
        without: Passes of the optimiser that are left out.
    """

    precision: str = "double"
    solver: str = "cheapest"
    without: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check every choice.

        Raises:
            OptionError: If one does not exist.
        """
        precisions.named(self.precision)
        _one_of("solver", self.solver, SOLVERS)
        object.__setattr__(self, "without", passes.names(self.without))

    def described(self) -> tuple[tuple[str, str], ...]:
        """Every choice as a pair of words, in the order of the fields."""
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        return tuple((name, _words(value)) for name, value in values)


TIERS = {
    "strict": Variant(),
    "single": Variant(precision="float"),
}
"""Variants by the name of the promise that they keep."""

STRICT = TIERS["strict"]
"""What is generated unless something else is asked for."""


def chosen(
    tier: Variant | str = STRICT,
    *,
    precision: str | None = None,
    without: Iterable[str] | None = None,
) -> Variant:
    """A variant, or the tier of that name, with some choices changed.

    Raises:
        OptionError: If there is no such tier or choice.
    """
    if not isinstance(tier, Variant):
        if tier not in TIERS:
            raise OptionError(f"unknown tier {tier!r}. {did_you_mean(tier, TIERS)}")
        tier = TIERS[tier]
    if precision is not None:
        tier = replace(tier, precision=precision)
    if without is not None:
        tier = replace(tier, without=passes.names(without))
    return tier
