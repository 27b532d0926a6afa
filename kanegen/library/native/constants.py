"""Prepared constants: what the functions of a compiled library read of the run-time parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from kanegen.errors import ArrayError, quoted
from kanegen.library.native.status import States
from kanegen.model.arguments import Floats, Shape

Pointers = tuple[Any, ...]
"""C pointers, each of which keeps its array alive."""


@dataclass(frozen=True)
class Constants:
    """Prepared constants, the first argument of every `Call`.

    Attributes:
        pointers: A pointer to the constants of one set of parameters, nothing for a model without parameters
            and for many sets.
        array: (C,) constants of one set or (B, C) of a set for each state of a batch; double-double constants
            have a further last axis of 2. None for a model without parameters.
        parameters: (P,) parameters of one set or (B, P) of B sets, None for a model without parameters.
        names: P names of the parameters.
    """

    pointers: Pointers = ()
    array: Floats | None = None
    parameters: Floats | None = None
    names: tuple[str, ...] = ()

    @property
    def sets(self) -> Floats | None:
        """(B, P) parameters of B sets, None for one set, and for a model without parameters."""
        return self.parameters if self.parameters is not None and self.parameters.ndim > 1 else None

    @property
    def inputs(self) -> dict[str, Floats]:
        """() or (B,) values of each parameter, by a label for reports on what is infinite or NaN."""
        if self.parameters is None:
            return {}
        return {f"parameter {quoted(name)}": self.parameters[..., k] for k, name in enumerate(self.names)}

    def of(self, states: States) -> Constants:
        """Return the constants of some states of a batch."""
        if self.array is None or self.sets is None:
            return self
        return replace(self, array=self.array[states], parameters=self.sets[states])

    def alone(self, state: int, pointer: Callable[[Floats], Any]) -> Constants:
        """Return the constants of one state of a batch, as the function for one state reads them.

        Args:
            state: Number of the state.
            pointer: Function that returns a C pointer to an array of constants.
        """
        if self.array is None or self.sets is None:
            return self
        array = np.ascontiguousarray(self.array[state])
        return replace(self, pointers=(pointer(array),), array=array, parameters=self.sets[state])

    def require(self, batch: Shape, first: str) -> None:
        """Require a set of parameters for each state where there are many sets.

        Args:
            batch: `()` for one state or `(B,)` for a batch.
            first: Name of the argument that sets the batch.

        Raises:
            ArrayError: If there are more or fewer sets than states.
        """
        if self.sets is not None and batch != self.sets.shape[:1]:
            expected = (*batch, self.sets.shape[1])
            raise ArrayError(
                f"parameters: expected shape {expected} to go with {first}, got {self.sets.shape}."
            )

    def read(self, batch: Shape, by_state: bool, pointer: Callable[[Floats], Any]) -> Pointers:
        """Return the pointer to the constants as a function reads them.

        Args:
            batch: `()` for one state or `(B,)` for a batch.
            by_state: Whether the function reads a row for each state of a batch.
            pointer: Function that returns a C pointer to an array of constants.
        """
        if self.array is None or not (batch and by_state):
            return self.pointers
        full = (
            self.array if self.sets is not None else np.broadcast_to(self.array, (*batch, *self.array.shape))
        )
        return (pointer(np.ascontiguousarray(full)),)
