"""The errors of one program in every state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class ProgramErrors:
    """The errors of one program in B states; `measure_programs` finds them.

    Attributes:
        name: Name of the program.
        values: Its results: (B, n, n) "mass_matrix" and (B, n) "forcing".
        entries: Error of each entry over the magnitudes of its terms, in the same shapes; where an entry has
            no terms, 0 or infinity.
        accelerations: (B,) normwise errors of {ydot}; NaN where there are no exact ones.
    """

    name: str
    values: Mapping[str, Floats]
    entries: Mapping[str, Floats]
    accelerations: Floats
