"""What is computed in every row of a sweep: a motion in steps of fixed length, and results of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

from kanegen.choices import chosen, did_you_mean, flag, known_spelling, require_one
from kanegen.errors import OptionError, quoted
from kanegen.model.system import System
from kanegen.recursion.outputs import METHODS
from kanegen.sweeps import axes
from kanegen.sweeps.quantities import outputs_of
from kanegen.sweeps.statistics import STATISTICS

MOST_STEPS = 1_000_000_000
"""Largest number of steps of a motion."""

_WHOLE = 1e-9
"""Relative distance of a number of steps from a whole number that counts as rounding."""


@dataclass(frozen=True)
class RolloutJob:
    """A motion from the initial state of a row, in steps in C, and what is kept of it.

    Attributes:
        duration: Simulated time, s; 0 evaluates the results in the initial state.
        step: Length of a step, s, of which the duration is a whole number.
        method: Name of the method in C, such as "rk4"; see docs/rollouts.md.
        results: Names of results, each a statistic and a quantity: "end.x" is the last coordinates,
            "max.y.elbow" the largest speed, "drift.energy" the largest change of energy. Statistics are
            "end", "max", "min", "time_of_max", "time_of_min", "time_of_zero", "mean", "rms", "drift", and
            "path" for the values at all times. Quantities are "x", "y", "x.<coordinate>", "y.<speed>",
            "energy", and every output or element of one, such as "point_positions.tip.z".
        every: Results, other than those at the end, are those at every `every`-th step.
        compensated: Whether rounding errors of the additions to the state are added later (Kahan); it needs
            strict semantics.
        bands: Names of quantities whose distribution over all rows is kept at every `every`-th step, without
            keeping the motions; see `SweepResult.bands`.

    Raises:
        OptionError: If a value is unknown or does not fit.

    Example:
        job = kg.RolloutJob(10.0, 1e-3, results=("end.x", "max.y.q2", "drift.energy"))
    """

    duration: float
    step: float
    method: str = "rk4"
    results: Iterable[str] = ("end.x", "end.y")
    every: int = 1
    bands: Iterable[str] = ()
    compensated: bool = False

    def __post_init__(self) -> None:
        """Check every value, and that they go together."""
        for name in ("duration", "step"):
            object.__setattr__(self, name, axes.number(f"job: {name}", getattr(self, name)))
        if self.duration < 0:
            raise OptionError(f"job: duration: {self.duration!r} s is negative.")
        if self.step <= 0:
            raise OptionError(f"job: step: {self.step!r} s is not positive.")
        if isinstance(self.every, bool) or not isinstance(self.every, int) or self.every < 1:
            raise OptionError(f"job: every: {quoted(self.every)} is no positive number of steps.")
        object.__setattr__(self, "compensated", flag("job: compensated", self.compensated))
        object.__setattr__(self, "method", known_spelling(self.method, METHODS))
        require_one("method", self.method, METHODS)
        for name in ("results", "bands"):
            names = chosen(getattr(self, name))
            if names is None or not all(isinstance(one, str) for one in names):
                raise OptionError(f"job: {name}: expected names, got {quoted(getattr(self, name))}.")
            object.__setattr__(self, name, tuple(dict.fromkeys(names)))
        if not (self.names or self.bands):
            raise OptionError('job: results: none is named. Name one at least, such as "end.x".')
        for name in self.names:
            statistic, _, quantity = name.partition(".")
            if statistic not in STATISTICS or not quantity:
                raise OptionError(
                    f"job: results: {quoted(name)} does not begin with a statistic, such as 'end.x'. "
                    f"{did_you_mean(statistic, STATISTICS)}"
                )
        self.count_of_steps()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the results, each once."""
        return tuple(self.results)

    @property
    def rollout(self) -> str:
        """Name of the function that makes the steps."""
        return METHODS[self.method].functions[1]

    @property
    def plain(self) -> dict[str, Any]:
        """The job in plain data."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: list(value) if isinstance(value, tuple) else value for name, value in found.items()}

    def count_of_steps(self) -> int:
        """Return the number of steps, a multiple of `every`.

        Raises:
            OptionError: If the duration is no whole number of steps, or these no multiple of `every`.
        """
        steps = (
            round(self.duration / self.step) if self.duration / self.step < 2 * MOST_STEPS else 2 * MOST_STEPS
        )
        if steps > MOST_STEPS:
            raise OptionError(f"job: more than {MOST_STEPS} steps. Take a longer step than {self.step!r} s.")
        if abs(steps * self.step - self.duration) > _WHOLE * self.duration:
            raise OptionError(
                f"job: duration: {self.duration!r} s is no whole number of steps of {self.step!r} s. Take "
                f"{max(1, steps) * self.step:.12g} s, for example."
            )
        if steps % self.every:
            raise OptionError(f"job: every: {steps} steps are no multiple of {self.every}.")
        return steps

    def looks(self) -> tuple[int, int]:
        """Return the number of steps between the times that results need, and the number of these times.

        Only the first and the last time are needed if all results are those at the end.
        """
        steps = self.count_of_steps()
        if not self.bands and all(name.startswith("end.") for name in self.names):
            return max(1, steps), min(1, steps) + 1
        return self.every, steps // self.every + 1

    def outputs(self, system: System) -> tuple[str, ...]:
        """Return the outputs of C that the results need, beside those of the method.

        Raises:
            OptionError: If the system has no such quantity.
        """
        named = [name.partition(".")[2] for name in self.names]
        return outputs_of("job: results", [*named, *self.bands], system)
