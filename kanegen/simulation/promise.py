"""What is known about the error of a motion for which one was asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.simulation.growth import Growth

FOR_DIGITS = {"float": 2.0**-24, "double": 2.0**-53, "long double": 2.0**-64}
"""Rounding error of one operation, relative, in each precision of states."""


@dataclass(frozen=True)
class Promise:
    """The measured error of a motion, until when it keeps what was asked for, and what a digit more costs.

    Errors are those of coordinates in rad and 1, and of other coordinates and of speeds over the largest one
    of the same unit in the motion.

    Attributes:
        asked: The error that was asked for.
        error: Largest measured error up to `kept_until`.
        kept_until: Time until which the error is kept, s.
        end: Last time of the motion, s.
        measured_by: What the motion was compared with.
        precision: Precision of the states.
        evaluations: Evaluations of {ydot} of the motion.
        rounding: Estimate of the part of the error at the end that rounding makes.
        growth: How differences grow.
        next_digit: Factor on the evaluations for a tenth of the error; infinite where rounding does not
            allow it.
    """

    asked: float
    error: float
    kept_until: float
    end: float
    measured_by: str
    precision: str
    evaluations: int
    rounding: float
    growth: Growth
    next_digit: float

    @property
    def is_kept(self) -> bool:
        """Whether the error is kept up to the end of the motion."""
        return self.kept_until >= self.end

    def __str__(self) -> str:
        until = "" if self.is_kept else f" until t = {self.kept_until:.6g} s"
        lines = [
            f"largest error{until} {self.error:.1e}, asked for {self.asked:g}, measured by {self.measured_by}"
        ]
        if self.growth.is_chaotic:
            horizons = [
                f"{self.growth.horizon(roundoff, self.asked):.3g} s in {name}"
                for name, roundoff in FOR_DIGITS.items()
                if name != "float"
            ]
            lines.append(
                f"chaotic or unstable: a difference grows e-fold in {self.growth.lyapunov_time:.3g} s, by "
                f"{self.growth.factors[-1]:.0e} in all; rounding allows {self.asked:g} until about "
                f"{' and '.join(horizons)} precision"
            )
        if np.isfinite(self.next_digit):
            lines.append(f"one digit more takes {self.next_digit:.1f} times the evaluations")
        else:
            lines.append(
                f"one digit more is not to be had in {self.precision} precision: rounding alone makes "
                f"{self.rounding:.0e}"
            )
        return "\n".join(lines)

    @property
    def refusal(self) -> str:
        """Why the error is not promised up to the end, in one line."""
        period = f"{self.growth.lyapunov_time:.3g} s"
        cause = (
            f"the motion is chaotic or unstable, a difference grows e-fold in {period}"
            if self.growth.is_chaotic
            else "no method reaches it in a bounded number of steps"
        )
        until = f"t = {self.kept_until:.6g} s"
        return (
            f"error: {self.asked:g} cannot be promised after {until}: {cause}. Until then the largest "
            f"measured error is {self.error:.1e}."
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the promise as plain data, for JSON.

        Example:
            trajectory.promise.as_dict()["kept_until"]
        """
        return {
            "asked": self.asked,
            "error": self.error,
            "is_kept": self.is_kept,
            "kept_until": self.kept_until,
            "measured_by": self.measured_by,
            "precision": self.precision,
            "evaluations": self.evaluations,
            "rounding": self.rounding,
            "lyapunov_time": self.growth.lyapunov_time if self.growth.is_chaotic else None,
            "next_digit": self.next_digit if np.isfinite(self.next_digit) else None,
        }
