"""Proven bounds of rounding errors of generated code, over a whole box of inputs.

- `domain` reads the box, `statement` states it beside the bounds; `arithmetic` lists the rounded operations
  of a C function, in order.
- `ranges` encloses every value, with the structure that `relations` and `lengths` find: sine and cosine of
  one angle meet in turns (`arcs`), which keep lengths. `intervals` rounds outward, `known_values` folds.
- `rounding` bounds single rounding errors; `sines` proves those of kanegen's sine and cosine with
  `reduction` and `approximation`.
- `sensitivities` weighs every rounding error by the range of an adjoint; `subdivision` cuts boxes in parts.
- `outputs` does all of this for the functions of a module; `source` for a generated source.

Nothing here is sampled. `docs/bounds.md` has the method, its sources and its figures.
"""

from kanegen.measure.bounds.domain import InputBox, read_domain
from kanegen.measure.bounds.report import Bounds
from kanegen.measure.bounds.source import bound_source

__all__ = ["Bounds", "InputBox", "bound_source", "read_domain"]
