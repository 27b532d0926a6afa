"""The methods of integration by name, each with its step or tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from kanegen.choices import known_spelling, require_one
from kanegen.errors import MissingError, ModelError, OptionError, quoted
from kanegen.extras import is_installed
from kanegen.model.numbers import finite
from kanegen.simulation.compiled_steps import CompiledSteps, why_not_in_c
from kanegen.simulation.extrapolation import extrapolation
from kanegen.simulation.integration import (
    Leapfrog,
    Step,
    implicit_midpoint,
    runge_kutta,
    semi_implicit_euler,
)
from kanegen.simulation.motion import Motion
from kanegen.simulation.stretches import EXTRA, AdaptiveSteps, FixedSteps, Integrator

ADAPTIVE = ("DOP853", "Radau")
"""Solvers of SciPy: an explicit one of order 8, and an implicit one of order 5 for stiff systems."""

FIXED: dict[str, Callable[[], Step]] = {
    "RK4": lambda: runge_kutta,
    "semi_implicit_euler": lambda: semi_implicit_euler,
    "leapfrog": Leapfrog,
    "implicit_midpoint": lambda: implicit_midpoint,
    "extrapolation": lambda: extrapolation,
}
"""Functions that return the step of each method with fixed steps."""

ONLY_IN_C = ("euler", "variational_midpoint", "linearly_implicit")
"""Methods with fixed steps that only rollouts in C have: of order 1; of order 2, which keeps momenta to
rounding; and of order 2, for stiff systems."""

METHODS = (*FIXED, *ONLY_IN_C, *ADAPTIVE)
"""Methods of `simulate`: those with fixed steps, and those with a tolerance.

Capitals, blanks, hyphens and underscores make no difference in the name that a caller gives.
"""

TOLERANCE = 1e-10
"""Tolerance of the adaptive methods unless another is given."""


@dataclass(frozen=True)
class Method:
    """A method with its step or tolerance.

    Attributes:
        name: One of `METHODS`.
        step: Largest fixed step, s; None for an adaptive method.
        tolerance: Relative and absolute error of a step of an adaptive method.
        compensated: Whether fixed steps are added with a compensated sum.
    """

    name: str
    step: float | None = None
    tolerance: float = TOLERANCE
    compensated: bool = False

    def __str__(self) -> str:
        if self.step is None:
            return f"{self.name}, tolerance {self.tolerance:g}"
        return f"{self.name}, step {self.step:g} s{', compensated' * self.compensated}"

    @property
    def is_adaptive(self) -> bool:
        """Whether the method chooses its steps."""
        return self.step is None

    def integrator(self, motion: Motion) -> Integrator:
        """Return the method for a motion; it runs in C where the library has it there.

        Raises:
            OptionError: If the method runs in C only, and not this motion.
        """
        if self.step is None:
            return AdaptiveSteps(motion, self.name, self.tolerance)
        hindrance = why_not_in_c(self.name, motion)
        if self.name in ONLY_IN_C:
            if hindrance:
                raise OptionError(f"method {self.name!r}: {hindrance}")
            return CompiledSteps(motion, self.name, None, self.step, self.compensated)
        if not hindrance:
            return CompiledSteps(motion, self.name, FIXED[self.name](), self.step, self.compensated)
        return FixedSteps(motion, FIXED[self.name], self.step, self.compensated)


def chosen_method(
    name: str | None, step: float | None, tolerance: float | None, compensated: bool = False
) -> Method:
    """Return the method of a caller, by default "RK4" with a step and "DOP853" without.

    Raises:
        OptionError: If there is no such method, or its options do not fit it.
        MissingError: If the method is one of SciPy, which is not installed.
    """
    if name is None:
        name = "RK4" if step is not None else "DOP853"
    name = known_spelling(name, METHODS)
    require_one("method", name, METHODS)
    if name in ADAPTIVE:
        if step is not None or compensated:
            raise OptionError(
                f"method {name!r} chooses its steps: give a tolerance, not a step or compensated."
            )
        if tolerance is not None and not 1e-13 <= _number("tolerance", tolerance) <= 0.1:
            raise OptionError(f"tolerance: {tolerance!r} is not between 1e-13 and 0.1.")
        if not is_installed("scipy"):
            raise MissingError(
                f"method {name!r} is one of SciPy, which is not installed (pip install 'kanegen[{EXTRA}]'). "
                "A step or an error in place of it, such as step 1e-3 or error 1e-6, needs no SciPy."
            )
        return Method(name, tolerance=TOLERANCE if tolerance is None else float(tolerance))
    if tolerance is not None:
        raise OptionError(f"method {name!r} has fixed steps: give a step, not a tolerance.")
    if step is None or not 0 < _number("step", step) < math.inf:
        raise OptionError(f"step: method {name!r} needs a positive number of seconds, got {quoted(step)}.")
    return Method(name, float(step), compensated=compensated)


def _number(name: str, value: Any) -> float:
    """Return `value` as a float; `name` is that of the argument, for the error message."""
    try:
        return finite(value, name)
    except ModelError as error:
        raise OptionError(str(error)) from None
