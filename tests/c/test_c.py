"""The C text: exactly the operations of the program, in the same order, and as a person would write them."""

import math

import cffi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kanegen.c import render
from kanegen.c.expression import literal
from kanegen.c.function_body import LONGEST, statements
from kanegen.c.layout import WIDTH, comment, wrap
from kanegen.errors import ModelError
from kanegen.library.native import cache
from kanegen.library.native.build import build
from kanegen.options import Variant
from kanegen.program.check import check
from kanegen.program.ir import Module, Op
from tests.support.handmade import Listing, array, bits, description, evaluate
from tests.support.random_programs import programs

IN, OUT = array("x", 3), array("f", 1)


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


def body(make, inputs=(IN,), out=OUT):
    """Return the body of the function whose program `make` writes; `a`, `b`, `c` are x[0], x[1], x[2]."""
    code = Listing()
    letters = [code.read("x", i, name) for i, name in enumerate(["a", "b", "c"])]
    values = make(code, *letters)
    outputs = {out: values if isinstance(values, list) else [values]}
    return [line.strip() for line in statements(check(code.program(inputs, outputs)))]


def expression(make):
    """Return the C expression of a program with one result."""
    *_, last = body(make)
    return last.removeprefix("f[0] = ").removesuffix(";")


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda k, a, b, c: k(Op.ADD, k(Op.ADD, a, b), c), "a + b + c"),
        (lambda k, a, b, c: k(Op.ADD, a, k(Op.ADD, b, c)), "a + (b + c)"),
        (lambda k, a, b, c: k(Op.SUBTRACT, a, k(Op.SUBTRACT, b, c)), "a - (b - c)"),
        (lambda k, a, b, c: k(Op.MULTIPLY, k(Op.MULTIPLY, a, b), c), "a*b*c"),
        (lambda k, a, b, c: k(Op.MULTIPLY, a, k(Op.MULTIPLY, b, c)), "a*(b*c)"),
        (lambda k, a, b, c: k(Op.MULTIPLY, k(Op.ADD, a, b), c), "(a + b)*c"),
        (lambda k, a, b, c: k(Op.DIVIDE, k(Op.MULTIPLY, a, b), c), "a*b/c"),
        (lambda k, a, b, c: k(Op.DIVIDE, a, k(Op.DIVIDE, b, c)), "a/(b/c)"),
        (lambda k, a, b, c: k(Op.MULTIPLY, k(Op.NEGATE, a), b), "-a*b"),
        (lambda k, a, b, c: k(Op.MULTIPLY, a, k(Op.NEGATE, b)), "-a*b"),
        (lambda k, a, b, c: k(Op.DIVIDE, k(Op.NEGATE, a), k(Op.NEGATE, b)), "a/b"),
        (lambda k, a, b, c: k(Op.ADD, k(Op.NEGATE, a), b), "b - a"),
        (lambda k, a, b, c: k(Op.ADD, k(Op.NEGATE, a), k(Op.NEGATE, b)), "-a - b"),
        (lambda k, a, b, c: k(Op.SUBTRACT, a, k(Op.NEGATE, b)), "a + b"),
        (lambda k, a, b, c: k(Op.SUBTRACT, k(Op.NEGATE, a), k(Op.NEGATE, b)), "b - a"),
        (lambda k, a, b, c: k(Op.NEGATE, k(Op.ADD, a, b)), "-(a + b)"),
        (lambda k, a, b, c: k(Op.SUBTRACT, c, k(Op.NEGATE, k(Op.ADD, a, b))), "c + (a + b)"),
        (lambda k, a, b, c: k(Op.NEGATE, k(Op.SUBTRACT, k(Op.NEGATE, a), b)), "-(-a - b)"),
        (lambda k, a, b, c: k(Op.NEGATE, k(Op.NEGATE, a)), "a"),
        (lambda k, a, b, c: k(Op.SIN, k(Op.NEGATE, k(Op.ADD, a, b))), "sin(-(a + b))"),
        (lambda k, a, b, c: k(Op.ADD, a, k(Op.MULTIPLY, k.number(-2.5), b)), "a - 2.5*b"),
        (lambda k, a, b, c: k(Op.SUBTRACT, a, k.number(-0.0)), "a + 0.0"),
    ],
)
def test_signs_and_brackets(make, text):
    assert expression(make) == text


@pytest.mark.parametrize("number", [1.0, 0.1, 1 / 3, 1e22, 1e-7, 5e-324, 1.7976931348623157e308, 2.0**53])
def test_literals_are_doubles_that_read_back_the_same(number):
    text = str(literal(number))
    assert float(text) == number
    assert "." in text or "e" in text
    assert str(literal(-number)) == f"-{text}"


def test_a_value_used_once_is_inlined_and_one_used_again_gets_a_number():
    def make(k, a, b, c):
        once, twice = k(Op.ADD, a, b), k(Op.ADD, b, c)
        return k(Op.MULTIPLY, once, k(Op.MULTIPLY, twice, twice))

    assert body(make)[3:] == ["const double t1 = b + c;", "f[0] = (a + b)*(t1*t1);"]


def test_a_sign_used_twice_does_not_repeat_what_it_applies_to():
    def make(k, a, b, c):
        minus = k(Op.NEGATE, k(Op.MULTIPLY, a, b))
        return k(Op.ADD, minus, k(Op.MULTIPLY, minus, c))

    assert body(make)[3:] == ["const double t1 = -a*b;", "f[0] = t1 + t1*c;"]


def test_inputs_are_loaded_first_and_unread_ones_are_named():
    code = Listing()
    half = code(Op.MULTIPLY, code.number(0.5), code.read("x", 2))
    sum_ = code(Op.ADD, half, code.read("x", 0, "theta_1_1"))
    program = code.program([IN, array("y", 3)], {array("f", 2): [half, sum_]})
    assert [line.strip() for line in statements(program)] == [
        "(void)y;",
        "const double theta_1_1 = x[0];",
        "const double t1 = 0.5*x[2];",
        "f[0] = t1;",
        "f[1] = t1 + theta_1_1;",
    ]


def test_equal_elements_are_stored_together_and_matrices_show_row_and_column():
    zeros = body(lambda k, a, b, c: [k(Op.MULTIPLY, a, b)] + [k.number(0.0)] * 24, out=array("A", 5, 5))
    assert "A[5*0 + 0] = a*b;" in zeros
    assert sum(line.count("A[") for line in zeros) == 25
    assert any(line.startswith("A[5*0 + 1] = A[5*0 + 2] = ") for line in zeros)
    pair = body(lambda k, a, b, c: [a, *[k(Op.MULTIPLY, a, b)] * 2, c], out=array("A", 2, 2))
    assert "A[2*0 + 1] = A[2*1 + 0] = a*b;" in pair


def test_dead_code_is_left_out():
    def make(k, a, b, c):
        k(Op.SIN, a, name="unused_1")
        return b

    assert body(make) == ["const double b = x[1];", "f[0] = b;"]


def test_a_note_stands_once_above_its_group():
    def make(k, a, b, c):
        first = k(Op.MULTIPLY, a, b, name="v_1", note="Body 1: velocity")
        second = k(Op.MULTIPLY, b, first, name="v_2", note="Body 1: velocity")
        return k(Op.ADD, second, c, name="w_1", note="Body 2: velocity")

    assert [line for line in body(make) if "/*" in line] == [
        "/* Body 1: velocity */",
        "/* Body 2: velocity */",
    ]


def test_a_note_cannot_end_its_comment():
    assert comment("a */ b") == [r"    /* a \u{2a}\u{2f} b */"]


def test_long_expressions_are_cut():
    def make(k, a, b, c):
        total = a
        for _ in range(60):
            total = k(Op.ADD, total, k(Op.MULTIPLY, b, c))
        return total

    lines = body(make)
    operators = [sum(line.count(o) for o in "+*") for line in " ".join(lines).split(";")]
    assert sum(operators) == 120
    assert max(operators) <= LONGEST


@pytest.mark.parametrize("name", ["sin", "x", "f", "t1"])
def test_locals_give_way_to_arrays_and_functions(name):
    def make(k, a, b, c):
        own = k(Op.MULTIPLY, a, b, name=name)
        twice = k(Op.ADD, own, c)
        return k(Op.MULTIPLY, k(Op.SIN, twice), twice)

    text = "\n".join(body(make))
    assert f"const double {name} =" in text if name == "t1" else f"const double {name}_ =" in text
    declared = [line.split()[2] for line in text.splitlines() if line.startswith("const double")]
    assert len(declared) == len(set(declared))


def test_lines_break_before_operators_and_within_the_width():
    def make(k, a, b, c):
        total = k(Op.MULTIPLY, a, k.number(1 / 3))
        for i in range(12):
            total = k(Op.MULTIPLY, total, k.number(1 / (i + 3)))
        return total

    code = "\n".join(body(make))
    assert max(map(len, code.splitlines())) <= WIDTH
    assert wrap("a" * 200) == ["    " + "a" * 200]
    assert all(line.startswith(("const", "f[", "*")) for line in code.splitlines())


@pytest.mark.parametrize("name", ["math", "Math", "main", "stddef"])
def test_a_model_must_not_hide_a_header(name):
    with pytest.raises(ModelError, match=f"system name '{name}': the file {name}.h .* would hide another"):
        render(description(name), Module(None, {}), {})


SPECIAL = [0.0, -0.0, 1.0, -2.5, 1e300, -1e-300, 5e-324, math.inf, -math.inf, math.nan]


@settings(max_examples=30, deadline=None, derandomize=True)
@given(programs(), st.lists(st.tuples(*[st.sampled_from(SPECIAL) | st.floats()] * 3), min_size=4, max_size=4))
def test_c_computes_the_same_bits_as_the_instructions_one_by_one(program, states):
    libm = Variant(sincos="libm")
    source = render(description(parameters=False, loads=False), Module(None, {"forcing": program}), {}, libm)
    text = source.files["handmade.c"]
    assert "--" not in text.split("*/", 2)[-1]
    ffi = cffi.FFI()
    ffi.cdef(source.cdef)
    library = ffi.dlopen(str(build(source)))
    for state in states:
        result = ffi.new("double[9]")
        library.handmade_forcing(ffi.new("double[3]", state), result)
        expected = evaluate(program, x=np.array(state))["f"]
        assert bits(list(result)) == bits(expected)
