"""The status that a C function returns, as an exception or as a warning at the line of the caller."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.c import ModelDescription
from kanegen.c.interface import Function
from kanegen.errors import KanegenWarning, SingularError
from kanegen.model.arguments import Floats


@dataclass(frozen=True)
class Status:
    """The meanings of the statuses of one C function.

    Attributes:
        name: Name of the function.
        freedoms: For each freedom its name, and the name of the speed where the speed is no rate.
        bodies: For each freedom the name of its body.
        quantity: Name of the quantity that is positive where a result exists.
        failure: Clause on the state where the quantity is not positive, such as "[A] is singular".
        may_fail: Index of an output that is NaN where it does not exist.
        may_be_inaccurate: Whether a result that exists can be inaccurate.
    """

    name: str
    freedoms: tuple[str, ...]
    bodies: tuple[str, ...]
    quantity: str
    failure: str
    may_fail: int
    may_be_inaccurate: bool

    @classmethod
    def of(cls, function: Function, model: ModelDescription) -> Status:
        """Return the meanings of the statuses of `function`."""
        pairs = zip(model.freedom_names, model.speeds, strict=True)
        outputs = [array.name for array in function.outputs]
        return cls(
            name=function.name,
            freedoms=tuple(f"{name}, {speed}" if speed else name for name, speed in pairs),
            bodies=model.freedom_bodies,
            quantity=" or ".join(condition.quantity for condition in function.conditions),
            failure=" or ".join(condition.failure for condition in function.conditions),
            may_fail=outputs.index(function.may_fail[0]) if function.may_fail else 0,
            may_be_inaccurate=bool(function.may_be_inaccurate),
        )

    def report(self, status: int, frames: int) -> None:
        """Report a status other than 0 of one state.

        Args:
            status: Freedom, from 1, at which the result does not exist, or minus the freedom at which it is
                least accurate.
            frames: Stack frames from here to the line that a warning names.

        Raises:
            SingularError: If the result does not exist.
        """
        if status < 0:
            place = -status - 1
            warnings.warn(
                f"{self.name}: the result is not accurate in this state. The largest correction was at "
                f"freedom {self.freedoms[place]!r} of body {self.bodies[place]!r}; an output "
                '"error_estimate" says how large, a higher precision helps.',
                KanegenWarning,
                stacklevel=frames,
            )
            return
        raise SingularError(
            f"{self.name}: the {self.quantity} at freedom {self.freedoms[status - 1]!r} is not positive or "
            f"is NaN: {self.failure} in this state, or the state is not finite."
        )

    def report_batch(self, failed: int, results: Sequence[Floats], frames: int) -> None:
        """Warn of the states of a batch whose results do not exist or are not accurate.

        Args:
            failed: Number of states with a status other than 0.
            results: Arrays of the outputs; rows of states without a result are NaN.
            frames: Stack frames from here to the line that the warning names.
        """
        rows = results[self.may_fail].reshape(len(results[self.may_fail]), -1)
        absent = int(np.isnan(rows).any(axis=1).sum()) if self.may_be_inaccurate else failed
        found = []
        if absent:
            found.append(
                f"in {absent} of {len(rows)} states a {self.quantity} is not positive or is NaN; "
                "their rows are NaN"
            )
        if failed > absent:
            found.append(f"in {failed - absent} of {len(rows)} states the result is not accurate")
        warnings.warn(f"{self.name}: {', and '.join(found)}.", KanegenWarning, stacklevel=frames)
