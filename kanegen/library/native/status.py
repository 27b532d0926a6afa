"""What the status of a C function means for its results: an error, or a warning at the line of the caller."""

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
    """The status of one function.

    Attributes:
        name: Of the function.
        freedoms: By freedom its name, and that of the speed where it has one of its own.
        bodies: By freedom the name of its body.
        quantity: What must be positive for a result to exist.
        failure: What is the matter where it is not.
        spoilt: Place of an output whose rows are NaN where a result does not exist.
        is_judged: Whether a result can also be inaccurate.
    """

    name: str
    freedoms: tuple[str, ...]
    bodies: tuple[str, ...]
    quantity: str
    failure: str
    spoilt: int
    is_judged: bool

    @classmethod
    def of(cls, f: Function, model: ModelDescription) -> Status:
        """The status of `f`."""
        pairs = zip(model.freedom_names, model.speeds, strict=True)
        outputs = [array.name for array in f.outputs]
        return cls(
            name=f.name,
            freedoms=tuple(f"{name}, {speed}" if speed else name for name, speed in pairs),
            bodies=model.freedom_bodies,
            quantity=" or ".join(condition.quantity for condition in f.conditions),
            failure=" or ".join(condition.failure for condition in f.conditions),
            spoilt=outputs.index(f.may_fail[0]) if f.may_fail else 0,
            is_judged=bool(f.may_be_inaccurate),
        )

    def complain(self, place: int, frames: int) -> None:
        """Say what a status other than 0 means for one state.

        Args:
            place: It: a freedom from 1, where its result does not exist, or less than 0, where it is not
                accurate.
            frames: From here to the line that is warned.

        Raises:
            SingularError: If the result does not exist.
        """
        if place < 0:
            warnings.warn(
                f"{self.name}: the result is not accurate in this state. The largest correction was at "
                f"freedom {self.freedoms[-place - 1]!r} of body {self.bodies[-place - 1]!r}; an output "
                '"error_estimate" says how large, a higher precision helps.',
                KanegenWarning,
                stacklevel=frames,
            )
            return
        raise SingularError(
            f"{self.name}: the {self.quantity} at freedom {self.freedoms[place - 1]!r} is not positive or "
            f"is NaN: {self.failure} in this state, or the state is not finite."
        )

    def count(self, failed: int, results: Sequence[Floats], frames: int) -> None:
        """Warn of states of a batch; those whose rows are not NaN are not accurate.

        Args:
            failed: How many have a status other than 0.
            results: The outputs.
            frames: From here to the line that is warned.
        """
        spoilt = results[self.spoilt].reshape(len(results[self.spoilt]), -1)
        lost = int(np.isnan(spoilt).any(axis=1).sum()) if self.is_judged else failed
        found = []
        if lost:
            found.append(
                f"in {lost} of {len(spoilt)} states a {self.quantity} is not positive or is NaN; "
                "their rows are NaN"
            )
        if failed > lost:
            found.append(f"in {failed - lost} of {len(spoilt)} states the result is not accurate")
        warnings.warn(f"{self.name}: {', and '.join(found)}.", KanegenWarning, stacklevel=frames)
