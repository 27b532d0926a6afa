"""A compiled library against the reference, over random states, with a bound that has a reason.

With E the difference of an output from the reference, S the sum of the magnitudes of the terms that make up
the reference (`magnitudes`), and D = diag(S_A)^(1/2), with which rows and columns lose their units:

- normwise error: ||D^-1 E D^-1|| / ||D^-1 A D^-1|| (Frobenius) for [A], ||D^-1 E|| / ||D^-1 f|| for {f}.
  Where the sum is zero within the bound on its rounding, the norm of S takes the place of its norm.
- componentwise error: the largest |E_i| / S_i. An entry never exceeds its S_i, and one that has become small
  by cancellation has no digits of its own, so the terms are the yardstick that no program can beat.
- bound on the componentwise error: 4 (N + 8) u, u = 2^-53. See `BOUND_REASON` and docs/accuracy.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from kanegen.arrays import Floats, SystemArrays
from kanegen.check import reference
from kanegen.check.kinematics import kinematics
from kanegen.check.magnitudes import forcing_magnitude, mass_matrix_magnitude, reaches
from kanegen.check.report import Accuracy, Evaluation, Report
from kanegen.check.states import States, random_states
from kanegen.errors import OptionError
from kanegen.system import System

__all__ = ["Accuracy", "ComparedLibrary", "Evaluation", "Report", "bound", "compare"]

UNIT_ROUNDOFF = 2.0**-53

BOUND_REASON = (
    "Bound: |E| <= 4 (N + 8) u S for every entry, u = 2^-53, S the sum of the magnitudes of the entry's terms. "
    "Rounding grows at most linearly with the N bodies along the tree; 8 stands for what happens in every body."
)

BATCH_BYTES = 2**25
"""Memory for one of the arrays of a batch; keeps 64 bodies with 384 freedoms comfortable."""


class ComparedLibrary(Protocol):
    """What `compare` needs of a library; batches have a leading axis B."""

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of what it computes."""

    def mass_matrix(self, x: Floats) -> NDArray[Any]:
        """(B, n, n) from (B, n)."""

    def forcing(
        self, x: Floats, y: Floats, force: Floats | None = None, torque: Floats | None = None
    ) -> NDArray[Any]:
        """(B, n) from (B, n), (B, n), (B, N, 3) and (B, N, 3)."""
