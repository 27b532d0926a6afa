"""Batches: several states side by side, whatever the width, the compiler and the place of a state."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kanegen as kg
from kanegen.c import interface, render
from kanegen.c.dialect import SIMD
from kanegen.c.function_body import statements
from kanegen.library import load
from kanegen.library.native import cache
from kanegen.library.native.calls import Constants
from kanegen.program.ir import Module, Op
from tests.support.c_compilers import C
from tests.support.handmade import Listing, array, bits, description, evaluate, source
from tests.support.random_programs import EXACT, programs
from tests.support.simd import FLAGS, sine_and_cosine, wide
from tests.support.systems import random_system

WIDTHS = (1, 2, 4, 8)
IN, OUT, SHARED = array("x", 3), array("f", 2), array("prepared", 2)


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


def of_one(program, width, compiler=None, flags=()):
    """Compile `program` and return its function of x."""
    made = render(description(parameters=False, loads=False), Module(None, {"mass_matrix": program}), {})
    return load(made, compiler, wide(width, *flags), on_status="ignore").mass_matrix


def body(make):
    code = Listing()
    letters = [code.read("x", i, name) for i, name in enumerate(["a", "b", "c"])]
    values = make(code, *letters)
    return [
        line.strip() for line in statements(code.program([IN, SHARED], {OUT: values}), SIMD, ["prepared"])
    ]


def test_sine_and_cosine_of_an_angle_come_from_one_call():
    def make(k, a, b, c):
        turn = k(Op.ADD, a, b)
        return [k(Op.MULTIPLY, k(Op.COS, turn, name="C_1"), k(Op.SIN, c)), k(Op.SIN, turn)]

    assert body(make)[4:] == [
        "const simd t1 = a + b;",
        "simd t2, C_1;",
        "simd_sincos(1, &t1, &t2, &C_1);",
        "f[0] = C_1*simd_sin(c);",
        "f[1] = t2;",
    ]


def test_what_is_the_same_in_all_states_is_a_double():
    def make(k, a, b, c):
        mass, length = k.read("prepared", 0, "p_m"), k.read("prepared", 1)
        product = k(Op.MULTIPLY, mass, k(Op.SIN, length), name="ml")
        return [product, k(Op.SUBTRACT, k(Op.SQRT, a), product)]

    assert body(make) == [
        "const simd a = x[0];",
        "const double p_m = prepared[0];",
        "const double ml = p_m*sin(prepared[1]);",
        "f[0] = simd_of(ml);",
        "f[1] = simd_sqrt(a) - ml;",
    ]


SPECIAL = [0.0, -0.0, 1e300, 5e-324, np.inf, np.nan]


@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    programs([*EXACT, Op.SQRT]),
    st.sampled_from(WIDTHS),
    st.lists(st.tuples(*[st.sampled_from(SPECIAL) | st.floats()] * 3), min_size=1, max_size=11),
)
def test_a_batch_computes_the_same_bits_as_the_instructions_one_by_one(program, width, states):
    made = render(description(parameters=False, loads=False), Module(None, {"forcing": program}), {})
    library = load(made, flags=wide(width))
    found = library._native.calls["forcing"]._general(Constants(), (np.array(states),))[0]
    assert bits(found) == bits([evaluate(program, x=np.array(state))["f"] for state in states])


def angles():
    """Return angles of every size, and those next to multiples of pi/2."""
    rng = np.random.default_rng(7)
    multiples = rng.integers(0, 636_619, 3000) * (np.pi / 2)
    sizes = 10.0 ** rng.uniform(-300, 6, 500)
    close = [multiples, np.nextafter(multiples, 1e9), multiples * (1 + rng.normal(size=3000) * 1e-12)]
    everyday = [rng.uniform(-7, 7, 4000), rng.uniform(-1e6, 1e6, 2000), sizes, -sizes]
    limits = [0.0, -0.0, 5e-324, 1e6, -1e6]
    return np.minimum(np.concatenate([*everyday, *close, limits]), 1e6)


def places(found, exact):
    """Return errors in units of the last place."""
    unit = np.spacing(np.abs([float(e) for e in exact]))
    return [abs(mpmath.mpf(f) - e) / u for f, e, u in zip(found.tolist(), exact, unit.tolist(), strict=True)]


def test_sine_and_cosine_are_right_to_the_last_place():
    x = angles()
    found = of_one(sine_and_cosine(), 8)(np.stack([x, x], axis=1))
    with mpmath.workprec(160):
        for column, f in enumerate((mpmath.sin, mpmath.cos)):
            assert max(places(found[:, column], [f(mpmath.mpf(v)) for v in x.tolist()])) < 0.81
    assert bits(found[-4:-2, 0]) == bits([-0.0, 5e-324])


@pytest.mark.parametrize("width", WIDTHS)
def test_large_angles_harm_no_neighbour(width):
    function = of_one(sine_and_cosine(), width)
    x = np.array([0.3, 1.5e6, 2.0, np.inf, -1e300, np.nan, 1.0, np.nextafter(1e5, 2e5), -0.1])
    found = function(np.stack([x, x], axis=1))
    assert bits(found) == bits([function([[v, v]])[0] for v in x])
    assert bits(found) == bits([function([v, v]) for v in x])
    libm = [evaluate(sine_and_cosine(), x=[v, v])["f"] for v in x]
    np.testing.assert_allclose(found, libm, rtol=2.3e-16)


@pytest.mark.parametrize("compiler", C.values(), ids=C)
@pytest.mark.parametrize(
    "flags",
    [pytest.param(FLAGS, marks=pytest.mark.slow), ("-O3", "-ffp-contract=off", "-march=native")],
    ids=["O1", "O3"],
)
def test_every_width_and_compiler_gives_the_same_bits(compiler, flags):
    rng = np.random.default_rng(11)
    x, y = rng.normal(size=(2, 13, 2)) * 3
    expected = load(source(loads=False), flags=wide(1)).evaluate(x, y)
    for width in WIDTHS:
        library = load(source(loads=False), " ".join(compiler), wide(width, *flags))
        found = library.evaluate(x, y)
        assert bits(found.mass_matrix) == bits(expected.mass_matrix), width
        assert bits(found.forcing) == bits(expected.forcing), width


@pytest.mark.parametrize("width", WIDTHS)
def test_place_and_neighbours_do_not_matter(width):
    """A state has the same bits at every place of a batch, and with any number of states behind it."""
    library = load(source(), flags=wide(width))
    rng = np.random.default_rng(12)
    x, y = rng.normal(size=(2, 17, 2))
    whole = library.evaluate(x, y)
    for count in range(1, 18):
        for rows in (slice(count), slice(None, -count - 1, -1)):
            part = library.evaluate(x[rows], y[rows])
            assert bits(part.mass_matrix) == bits(whole.mass_matrix[rows])
            assert bits(part.forcing) == bits(whole.forcing[rows])


def test_arrays_too_large_for_the_stack_go_one_by_one(monkeypatch):
    monkeypatch.setattr(interface, "LARGEST_BATCH_ROW", 5)
    made = source()
    assert "simd" not in made.files["handmade_batch.c"].replace("kanegen_simd.h", "")
    library = load(made)
    x, y = np.random.default_rng(13).normal(size=(2, 5, 2))
    assert bits(library.mass_matrix(x)) == bits([library.mass_matrix(row) for row in x])
    assert bits(library.forcing(x, y)) == bits([library.forcing(*s) for s in zip(x, y, strict=True)])


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("form", ["full", "lower"])
def test_matrices_that_hold_values_several_times(form, width):
    """Every value is stored once for several states, found at all its places, and tested at each of them.

    So it is with threads, too.
    """
    system = random_system(np.random.default_rng(3), 6, connection=(0, 1, 1, 0, 4, 4), name="forked")
    made = kg.generate(system, ("mass_matrix",), mass_matrix=form)
    assert "A_places" in made.files["forked_batch.c"]
    library = load(made, flags=wide(width, "-fopenmp", "-DKANEGEN_THREADED=4"), on_status="ignore")
    x = np.random.default_rng(14).uniform(-1.0, 1.0, (19, len(system.coordinates)))
    assert bits(library.mass_matrix(x)) == bits([library.mass_matrix(one) for one in x])
    x[[4, 11, 18]] = np.nan
    call = library.bind("mass_matrix", states=len(x))
    call.x = x
    assert call() == 3
    assert np.isnan(call.A).any(axis=(1, 2)).nonzero()[0].tolist() == [4, 11, 18]
