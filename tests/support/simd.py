"""Flags that set the SIMD width, and a program of one sine and one cosine."""

from kanegen.program.check import check
from kanegen.program.ir import Op
from tests.support.handmade import Listing, array

FLAGS = ("-O1", "-ffp-contract=off")
"""Optimisation that keeps every rounding."""


def wide(width, *flags):
    """Return `flags`, or `FLAGS`, with the number of states that a SIMD vector holds."""
    return [*(flags or FLAGS), f"-DKANEGEN_LANES={width}"]


def sine_and_cosine():
    """Return the program f = (sin x_0, cos x_0)."""
    code = Listing()
    angle = code.read("x", 0)
    results = [code(Op.SIN, angle), code(Op.COS, angle)]
    return check(code.program([array("x", 2)], {array("f", 2): results}))
