"""Single precision: the same statements on floats, constants rounded once, several states side by side."""

import math
import pickle
import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import kanegen as kg
from kanegen.c import render
from kanegen.errors import ArrayError, KanegenWarning, ModelError, OptionError, SingularError
from kanegen.library import load
from kanegen.library.native import cache
from kanegen.library.native.calls import Constants
from kanegen.measure.comparison import compare
from kanegen.options import TIERS
from kanegen.program.check import check
from kanegen.program.ir import Module, Op
from kanegen.program.precision import DOUBLE, FLOAT
from tests.support.handmade import Listing, array, bits, description, evaluate, module, source
from tests.support.pivot_programs import BAD, GOOD, forward
from tests.support.random_programs import EXACT, programs
from tests.support.robots import robot_file
from tests.support.simd import FLAGS, sine_and_cosine, wide
from tests.support.systems import chain, random_system, systems

WIDTHS = (1, 2, 4, 8, 16)
LARGEST = float(np.finfo(np.float32).max)


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def library():
    return load(source(precision=FLOAT))


def of_one(program, flags):
    """Compile `program` and return its function of x."""
    made = render(
        description(parameters=False, loads=False),
        Module(None, {"mass_matrix": program}),
        {},
        TIERS["single"],
    )
    return load(made, flags=flags, on_status="ignore").mass_matrix


# Numbers


@given(st.floats(0.0, LARGEST) | st.floats(0.0, 1e-37))
def test_a_literal_reads_back_to_the_nearest_and_no_shorter_one_does(number):
    text = FLOAT.literal(number)
    assert text.endswith("f")
    assert "." in text or "e" in text
    nearest = np.float32(number)
    assert np.float32(text[:-1]) == nearest
    digits = text[:-1].split("e")[0].replace(".", "").strip("0")
    if len(digits) > 1:
        assert np.float32(f"{number:.{len(digits) - 2}e}") != nearest


@given(st.floats(0.0, allow_infinity=False))
def test_a_literal_in_double_precision_is_what_python_prints(number):
    assert DOUBLE.literal(number) == repr(number)


def test_prepare_computes_in_double_and_rounds_once(library):
    prepare = module().prepare
    once = 0
    for mass in np.linspace(0.1, 3.0, 50):
        parameters = np.array([mass, 0.7]).astype(np.float32)
        found = library._native.calls["prepare"](Constants(), (parameters,))[0]
        expected = evaluate(prepare, parameters=parameters)["prepared"].astype(np.float32)
        assert bits(found) == bits(expected)
        once += bits(expected) != bits(evaluate(prepare, np.float32, parameters=parameters)["prepared"])
    assert once >= 4


def constant(number, op=Op.MULTIPLY):
    code = Listing()
    result = code(op, code.read("x", 0), code.number(number))
    return check(code.program([array("x", 2)], {array("f", 1): [result]}))


def test_numbers_out_of_range():
    """Numbers that are too large are refused; those that are too small are rounded where they may be 0."""
    beyond = (
        r"system 'handmade': a constant: 1e\+39 leaves the range of single precision; choose units nearer"
    )
    with pytest.raises(ModelError, match=beyond):
        of_one(constant(1e39), FLAGS)
    with pytest.raises(
        ModelError, match=r"a constant: 1e-46 is 0 in single precision, but something is divided"
    ):
        of_one(constant(1e-46, Op.DIVIDE), FLAGS)
    assert bits(of_one(constant(1e-46), FLAGS)([2.0, 0.0])) == bits([0.0])
    assert of_one(constant(1e-44), FLAGS)([2.0, 0.0]) == [np.float32(1e-44) * np.float32(2.0)]
    body = kg.Body("body", 0, kg.Parameter("heavy", 1e39), np.eye(3))
    with pytest.raises(
        ModelError, match=r"system 'big': parameter 'heavy': 1e\+39 leaves the range of single"
    ):
        kg.generate(kg.System("big", (body,)), precision="float")


# Values


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    programs([*EXACT, Op.SQRT], st.floats(1e-9, 1e9)),
    st.sampled_from(WIDTHS),
    st.lists(
        st.tuples(*[st.sampled_from([0.0, -0.0, 1e38, np.inf, np.nan]) | st.floats(width=32)] * 3),
        min_size=1,
        max_size=19,
    ),
)
def test_one_state_and_a_batch_are_the_instructions_one_by_one(program, width, states):
    made = render(
        description(parameters=False, loads=False), Module(None, {"forcing": program}), {}, TIERS["single"]
    )
    call = load(made, flags=wide(width))._native.calls["forcing"]
    expected = [evaluate(program, np.float32, x=np.array(state))["f"] for state in states]
    assert bits(call._general(Constants(), (np.array(states),))[0]) == bits(expected)
    assert bits([call._general(Constants(), (np.array(state),))[0] for state in states]) == bits(expected)


def angles():
    """Return angles of every size, and those next to multiples of pi/2."""
    rng = np.random.default_rng(7)
    multiples = (np.arange(6367) * (np.pi / 2)).astype(np.float32)
    close = (multiples.view(np.int32) + np.arange(-3, 4)[:, None]).view(np.float32).ravel()
    every = np.arange(0, np.float32(1e4).view(np.int32), 2999, dtype=np.int32).view(np.float32)
    everyday = rng.uniform(-10, 10, 500_000).astype(np.float32)
    limits = np.array([0.0, -0.0, 1e-45, 1e4, -1e4], np.float32)
    return np.clip(np.concatenate([close[close >= 0], every, everyday, limits]), -1e4, 1e4)


@pytest.mark.parametrize("width", [1, 16])
def test_sine_and_cosine_are_right_to_the_last_place(width):
    """The largest error over all floats up to 1e4 is 0.7994 units in the last place; this is a part."""
    x = angles()
    found = of_one(sine_and_cosine(), wide(width))(np.stack([x, x], axis=1))
    for column, f in enumerate((np.sin, np.cos)):
        exact = f(x.astype(float))
        place = np.spacing(np.abs(exact.astype(np.float32))).astype(float)
        assert 0.75 < (np.abs(found[:, column] - exact) / place).max() < 0.8
    assert bits(found[-5:-2, 0]) == bits(x[-5:-2])


@pytest.mark.parametrize("width", WIDTHS)
def test_large_angles_harm_no_neighbour(width):
    function = of_one(sine_and_cosine(), wide(width))
    x = np.array(
        [0.3, 1.5e6, 2.0, np.inf, -1e30, np.nan, 1.0, np.nextafter(np.float32(1e4), np.float32(2e4)), -0.1]
    )
    found = function(np.stack([x, x], axis=1))
    assert bits(found) == bits([function([[v, v]])[0] for v in x])
    x = x.astype(np.float32).astype(float)
    exact = [[f(v) if math.isfinite(v) else math.nan for f in (math.sin, math.cos)] for v in x]
    np.testing.assert_allclose(found, exact, rtol=1e-7)


@pytest.mark.parametrize("width", WIDTHS)
def test_place_and_neighbours_do_not_matter(width):
    library = load(source(precision=FLOAT), flags=wide(width))
    x, y = np.random.default_rng(12).normal(size=(2, 33, 2))
    whole = library.evaluate(x, y)
    for count in range(1, 34):
        for rows in (slice(count), slice(None, -count - 1, -1)):
            part = library.evaluate(x[rows], y[rows])
            assert bits(part.mass_matrix) == bits(whole.mass_matrix[rows])
            assert bits(part.forcing) == bits(whole.forcing[rows])


def test_threads_change_no_bit():
    x, y = np.random.default_rng(5).normal(size=(2, 5003, 2)).astype(np.float32)
    alone = load(source(precision=FLOAT), "gcc").evaluate(x, y)
    together = load(source(precision=FLOAT), "gcc", threads=True).evaluate(x, y)
    assert bits(alone.mass_matrix) == bits(together.mass_matrix)
    assert bits(alone.forcing) == bits(together.forcing)


@settings(max_examples=5, deadline=None, derandomize=True)
@given(systems(max_bodies=5))
def test_random_trees_agree_with_the_reference(system):
    library = kg.build(system, flags=FLAGS, precision="float")
    report = compare(system, library, states=20, precision=FLOAT)
    assert report.passed, str(report)
    assert report.accuracies[0].bound == 8 * (system.number_of_bodies + 8) * 2.0**-24
    assert "2^-24" in report.reason


def test_the_check_is_not_idle():
    """A library in single precision is far from the bound of doubles; one that is wrong fails its own."""
    system = random_system(np.random.default_rng(1), 4)
    library = kg.build(system, flags=FLAGS, precision="float")
    assert not compare(system, library, 20).passed
    assert not compare(replace(system, gravity=(0.0, 0.0, -9.8)), library, 20, precision=FLOAT).passed
    assert kg.compare(system, 20, precision="float").passed


@pytest.mark.filterwarnings("ignore::kanegen.errors.KanegenWarning")
def test_every_output_of_a_robot_agrees_with_double_precision():
    system = kg.load(robot_file("ur5_robot"))
    assert kg.compare(system, 100, precision="float").passed
    outputs = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
    single, double = (kg.build(system, outputs, flags=FLAGS, precision=p) for p in ("float", "double"))
    x, y, ydot, tau = np.random.default_rng(3).uniform(-2, 2, (4, 37, 6)).astype(np.float32)
    inputs = {"ydot": ydot, "tau": tau}
    batch, truth = single.evaluate(x, y, **inputs), double.evaluate(x, y, **inputs)
    for row in (slice(None), 0, 36):
        inputs = {"ydot": ydot[row], "tau": tau[row]}
        for output, value in zip(outputs, single.evaluate(x[row], y[row], **inputs), strict=True):
            exact = getattr(truth, output)[row]
            assert value.dtype == np.float32
            loss = 2e-3 if output == "forward_dynamics" else 4e-6
            np.testing.assert_allclose(value, exact, rtol=0, atol=loss * np.abs(exact).max(), err_msg=output)
    together = single.evaluate(x[36], y[36], ydot=ydot[36], tau=tau[36])
    assert bits(batch.forcing[36]) == bits(together.forcing)
    assert bits(single.forcing(x, y)[36]) == bits(single.forcing(x[36], y[36]))


# Python


def test_numpy_in_numpy_out(library):
    assert library.precision == "float"
    assert load(source()).precision == "double"
    x, y = np.random.default_rng(1).normal(size=(2, 5, 2))
    exact = library.evaluate(x.astype(np.float32), y.astype(np.float32))
    for a, b in (
        (x, y),
        (x.tolist(), y.tolist()),
        (np.asfortranarray(x, np.float32), y.astype(np.longdouble)),
    ):
        assert bits(library.evaluate(a, b).forcing) == bits(exact.forcing)
    for value in (
        *exact,
        library.mass_matrix(x[0]),
        library.forcing([0, 1], [2, 3]),
        library.mass_matrix(x[:0]),
    ):
        assert value.dtype == np.float32
    again = pickle.loads(pickle.dumps(library))
    assert bits(again.forcing(x, y)) == bits(exact.forcing)
    with pytest.raises(ArrayError, match=r"^y: a number leaves the range of float32\.$"):
        library.forcing(x, y * 1e39)
    with pytest.warns(
        KanegenWarning, match=r"^forcing: in 5 of 5 states .*; in state 0 f\[0\] is .*y\[0\] is inf"
    ):
        assert np.isnan(library.forcing(x, np.full_like(y, np.inf))).any()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert library.mass_matrix([1e-60, 0.0]).shape == (2, 2)


def test_parameters(library):
    assert library.parameters == {"m1": 2.0, "sin": 0.75}
    changed = library.with_parameters({"m1": 0.1})
    assert changed.parameters["m1"] == 0.1
    assert bits(changed.mass_matrix([0.1, 0.2])) != bits(library.mass_matrix([0.1, 0.2]))
    with pytest.raises(ModelError, match=r"^parameter 'm1': 1e\+40 leaves the range of single precision"):
        library.with_parameters({"m1": 1e40})


@pytest.mark.parametrize("width", WIDTHS)
def test_status(width):
    made = render(
        description(parameters=False, loads=False),
        Module(None, {"forward_dynamics": forward()}),
        {},
        TIERS["single"],
    )
    library = load(made, flags=wide(width))
    for freedom, x in BAD:
        with pytest.raises(SingularError, match=f"the pivot of .A. at freedom {freedom!r} is not positive"):
            library.forward_dynamics(x, [0.0, 0.0])
    x = np.array([*GOOD, *(x for _, x in BAD)])
    with pytest.warns(KanegenWarning, match=f"in {len(BAD)} of {len(x)} states"):
        found = library.forward_dynamics(x, np.ones((len(x), 2)))
    assert found.dtype == np.float32
    np.testing.assert_array_equal(np.isnan(found).all(axis=1), [False] * len(GOOD) + [True] * len(BAD))


@pytest.mark.parametrize("name", ["Float", "", 32])
@pytest.mark.parametrize("function", [kg.generate, kg.build, kg.compare])
def test_unknown_precisions(function, name):
    known = r"(Known are 'double', 'float', 'long double', 'double-double'|Did you mean 'float')"
    with pytest.raises(OptionError, match=rf"^unknown precision {name!r}\. {known}"):
        function(chain(2), precision=name)


@pytest.mark.parametrize("name", ["single", "singel", "Single"])
def test_another_name_of_single_precision(name):
    with pytest.raises(OptionError, match=rf"^unknown precision '{name}'\. Single precision is 'float'\.$"):
        kg.Variant(precision=name)
