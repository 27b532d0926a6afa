"""Bounds on the errors of exp, log, tanh and atan2 in generated code.

They hold for kanegen's own C in double and single precision (`kanegen.c.elementary`), and are assumed of a
C library where that computes them.
"""

from __future__ import annotations

from types import MappingProxyType

from kanegen.program.ir import Op

PLACES = MappingProxyType({Op.EXP: 0.8, Op.LOG: 1.2, Op.TANH: 1.0, Op.ATAN2: 2.5})
"""Bounds of the errors in units in the last place of the result, where that is a normal number."""

SUBNORMAL_PLACES = 2.0
"""Bound of the error of a subnormal result, in multiples of the smallest number."""


def roundoffs(op: Op) -> float:
    """Return the bound of the relative error of a function in roundoffs; a place is at most two of them."""
    return 2 * PLACES[op]
