"""A hypothesis strategy for random programs."""

from hypothesis import strategies as st

from kanegen.program.check import check
from kanegen.program.ir import ARITY, CHOICES, Op
from tests.support.handmade import Listing, array

ARITHMETIC = [Op.ADD, Op.SUBTRACT, Op.MULTIPLY, Op.DIVIDE]
EXACT = [Op.NEGATE, Op.ABS, *CHOICES]
FUNCTIONS = [*EXACT, Op.SQRT, Op.SIN, Op.COS]
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)


@st.composite
def programs(draw, functions=FUNCTIONS, numbers=NUMBERS):
    """Draw random programs with repeats, names, notes, constants and several outputs."""
    code = Listing()
    for i in range(3):
        code.read("x", i, draw(st.sampled_from(["", f"theta_{i}"])))
    constants = {code.number(draw(numbers)) for _ in range(draw(st.integers(0, 3)))}
    for i in range(draw(st.integers(1, 60))):
        size = len(code.instructions)
        recent = st.one_of(st.integers(max(0, size - 4), size - 1), st.integers(0, size - 1))
        op = draw(st.sampled_from(ARITHMETIC * 3 + functions))
        operands = [draw(recent) for _ in range(ARITY[op])]
        if all(j in constants for j in operands):
            operands[0] = 0  # a compiler may round sin(0.5) better than libm does
        name = f"v_{i}" if draw(st.integers(0, 3)) == 0 else ""
        code(op, *operands, name=name, note=draw(st.sampled_from(["", "Body 1: a", "Body 2: b"])))
    last = len(code.instructions) - 1
    results = [last, *draw(st.lists(st.integers(0, last), min_size=8, max_size=8))]
    return check(code.program([array("x", 3)], {array("f", 9): results}))
