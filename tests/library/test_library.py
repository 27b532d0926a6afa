"""A library called with NumPy arrays: values, shapes, types, errors, parameters, threads, processes."""

import multiprocessing
import pickle
import re
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from kanegen.errors import ArrayError, BuildError, ModelError, OptionError
from kanegen.library import Library, load
from kanegen.library.native import cache
from kanegen.library.native.build import Recipe
from kanegen.library.native.loaded import NativeLibrary
from kanegen.library.results import Evaluation
from tests.support.handmade import bits, evaluate, module, source

N = 2


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(cache.VARIABLE, str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def library():
    return load(source(sincos="libm"))  # whose bits Python has as well


@pytest.fixture(scope="module")
def plain():
    return load(source("plain", parameters=False, loads=False))


def loads(rng, *batch):
    force = np.zeros((*batch, 3, 3))
    force[..., 1, :] = rng.normal(size=(*batch, 3))
    return force


def expected(function, parameters=(2.0, 0.75), **inputs):
    made = module()
    prepared = evaluate(made.prepare, parameters=parameters)["prepared"]
    inputs = {"force": np.zeros(9), "torque": np.zeros(9), **inputs}
    return evaluate(made.functions[function], prepared=prepared, **inputs)


def test_representation_names_and_parameters(library):
    assert repr(library) == "<Library handmade: 2 freedoms, mass_matrix, forcing>"
    assert library.freedom_names == ("arm.theta1", "elbow")
    assert library.parameters == {"m1": 2.0, "sin": 0.75}
    assert library.source.operations["add"] == 8
    library.parameters["m1"] = 5.0
    assert library.parameters["m1"] == 2.0


def test_one_state(library):
    rng = np.random.default_rng(1)
    x, y, force, torque = rng.normal(size=N), rng.normal(size=N), loads(rng), loads(rng)
    A, f = library.mass_matrix(x), library.forcing(x, y, force, torque)
    assert A.shape == (2, 2)
    assert f.shape == (2,)
    assert bits(A) == bits(expected("mass_matrix", x=x)["A"])
    assert bits(f) == bits(expected("forcing", x=x, y=y, force=force, torque=torque)["f"])
    assert bits(library.forcing(x, y)) == bits(expected("forcing", x=x, y=y)["f"])
    turned = expected("forcing", x=x, y=y, torque=torque)["f"]
    assert bits(library.forcing(x, y, torque=torque)) == bits(turned)


def near(batch, states):
    """Assert that results agree but for a rounding of sines and cosines, which batches compute otherwise."""
    np.testing.assert_allclose(batch, states, rtol=0, atol=8 * np.finfo(float).eps * np.abs(batch).max())


def test_a_batch_equals_its_states(library):
    rng = np.random.default_rng(2)
    x, y, force, torque = rng.normal(size=(7, N)), rng.normal(size=(7, N)), loads(rng, 7), loads(rng)
    result = library.evaluate(x, y, force, torque)
    assert result.mass_matrix.shape == (7, 2, 2)
    assert result.forcing.shape == (7, 2)
    for row in range(7):
        one = library.evaluate(x[row], y[row], force[row], torque)
        near(result.mass_matrix[row], one.mass_matrix)
        near(result.forcing[row], one.forcing)
    assert bits(library.mass_matrix(x)) == bits(result.mass_matrix)
    near(library.forcing(x, y), [library.forcing(a, b) for a, b in zip(x, y, strict=True)])


def test_an_empty_batch(library):
    nothing = np.empty((0, N))
    A, f = library.evaluate(nothing, nothing, np.empty((0, 3, 3)))
    assert A.shape == (0, 2, 2)
    assert f.shape == (0, 2)


def test_results_are_fresh_and_inputs_untouched(library):
    x = np.array([0.3, -0.4])
    first = library.mass_matrix(x)
    kept = first.copy()
    second = library.mass_matrix(x + 1)
    assert not np.shares_memory(first, second)
    assert bits(first) == bits(kept)
    assert x.tolist() == [0.3, -0.4]


def test_evaluation_has_names(library):
    result = library.evaluate([0.1, 0.2], [0.3, 0.4])
    A, f = result
    assert A is result.mass_matrix is result[0]
    assert f is result.forcing
    assert repr(result).startswith("Evaluation(mass_matrix=array(")
    with pytest.raises(AttributeError, match="no output 'energy' here, only mass_matrix, forcing"):
        result.energy  # noqa: B018
    again = pickle.loads(pickle.dumps(result))
    assert isinstance(again, Evaluation)
    assert bits(again.forcing) == bits(f)


@pytest.mark.parametrize(
    "change",
    [
        list,
        tuple,
        np.asfortranarray,
        lambda a: np.repeat(a, 2, axis=-1)[..., ::2],
        lambda a: a[::-1].copy()[::-1],
        lambda a: a.astype(">f8"),
        lambda a: np.frombuffer(b"x" + a.tobytes(), np.uint8)[1:].view(np.float64).reshape(a.shape),
        lambda a: a.astype(np.longdouble),
    ],
)
@pytest.mark.parametrize("shape", [(N,), (5, N)])
def test_other_layouts_give_the_same_bits(library, change, shape):
    rng = np.random.default_rng(3)
    x, y = rng.normal(size=shape), rng.normal(size=shape)
    assert bits(library.forcing(change(x), change(y))) == bits(library.forcing(x, y))


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int8, np.int64, np.uint32])
def test_other_real_numbers_are_converted(library, kind):
    x = np.array([[1, 2], [3, 0]], dtype=kind)
    assert bits(library.mass_matrix(x)) == bits(library.mass_matrix(x.astype(np.float64)))
    assert bits(library.mass_matrix([1, 2])) == bits(library.mass_matrix([1.0, 2.0]))


def test_read_only_arrays_are_accepted(library):
    x = np.array([0.1, 0.2])
    x.flags.writeable = False
    assert bits(library.mass_matrix(x)) == bits(library.mass_matrix(x.copy()))


def test_nan_passes_through(library):
    quiet = library.with_on_status("ignore")
    assert np.isnan(quiet.mass_matrix([np.nan, 0.0])[0, 0])
    assert np.isnan(quiet.forcing([0.0, 0.0], [np.inf, 0.0])).all()


@pytest.mark.parametrize(
    ("x", "message"),
    [
        ([1.0], "x: expected shape (2,) or (B, 2), got (1,)."),
        (0.5, "x: expected shape (2,) or (B, 2), got ()."),
        ([], "x: expected shape (2,) or (B, 2), got (0,)."),
        (np.zeros((2, 3)), "x: expected shape (2,) or (B, 2), got (2, 3)."),
        (np.zeros((4, 2, 2)), "x: expected shape (2,) or (B, 2), got (4, 2, 2)."),
        ([[1.0, 2.0], [3.0]], "x: the rows have different lengths."),
        (None, "x: expected real numbers, got None."),
        ([1j, 2], "x: expected real numbers, got an array of complex128."),
        (["1", "2"], "x: expected real numbers, got an array of <U1."),
        ([True, False], "x: expected real numbers, got an array of bool."),
        ([10**400, 1], "x: expected real numbers, got an array of object."),
        (
            np.ma.masked_array([1.0, 2.0], [True, False]),
            "x: masked arrays have no meaning here; fill it first.",
        ),
    ],
)
def test_states_that_do_not_fit(library, x, message):
    with pytest.raises(ArrayError, match=f"^{re.escape(message)}$"):
        library.mass_matrix(x)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"y": [1.0]}, "y: expected shape (2,) to go with x, got (1,)."),
        ({"y": np.zeros((1, 2))}, "y: expected shape (2,) to go with x, got (1, 2)."),
        ({"y": None}, "y: expected real numbers, got None."),
        ({"x": np.zeros((5, 2))}, "y: expected shape (5, 2) to go with x, got (2,)."),
        ({"force": np.zeros(3)}, "force: expected shape (3, 3), got (3,)."),
        ({"torque": np.zeros((2, 3, 3))}, "torque: expected shape (3, 3), got (2, 3, 3)."),
        (
            {"x": np.zeros((5, 2)), "y": np.zeros((5, 2)), "force": np.zeros((4, 3, 3))},
            "force: expected shape (3, 3) or (5, 3, 3), got (4, 3, 3).",
        ),
        (
            {"force": np.ones((3, 3))},
            "force: row 0 is not zero, but body 'arm' takes no loads. Enter it among the loads of the model.",
        ),
        (
            {"torque": [[0, 0, 0], [1, 2, 3], [0, 0, np.nan]]},
            "torque: row 2 is not zero, but body 'hand' takes no loads. Enter it among the loads of the "
            "model.",
        ),
    ],
)
def test_speeds_and_loads_that_do_not_fit(library, arguments, message):
    for function in (library.forcing, library.evaluate):
        with pytest.raises(ArrayError, match=f"^{re.escape(message)}$"):
            function(**{"x": [0.1, 0.2], "y": [0.3, 0.4], **arguments})


@pytest.mark.parametrize("name", ["force", "torque"])
def test_a_system_without_loads_takes_none(plain, name):
    with pytest.raises(ArrayError, match=f"^{name}: no body of system 'plain' takes loads"):
        plain.forcing([0.1, 0.2], [0.3, 0.4], **{name: np.zeros((3, 3))})
    assert plain.forcing([0.1, 0.2], [0.3, 0.4]).shape == (2,)


def test_outputs_that_were_not_generated():
    only = load(source("only", outputs=("mass_matrix",)))
    with pytest.raises(
        OptionError, match=r"'only' was built without the output 'forcing'. It has mass_matrix;"
    ):
        only.forcing([0.1, 0.2], [0.3, 0.4])
    (A,) = only.evaluate([0.1, 0.2], [0.3, 0.4])
    assert bits(A) == bits(only.mass_matrix([0.1, 0.2]))


def test_parameters_make_another_library(library):
    x = [0.3, 0.8]
    heavy = library.with_parameters({"m1": 7.5})
    assert heavy.parameters == {"m1": 7.5, "sin": 0.75}
    assert bits(heavy.mass_matrix(x)) == bits(expected("mass_matrix", (7.5, 0.75), x=x)["A"])
    both = heavy.with_parameters({"sin": np.float32(0.5)})
    assert bits(both.mass_matrix(x)) == bits(expected("mass_matrix", (7.5, 0.5), x=x)["A"])
    assert bits(library.mass_matrix(x)) == bits(expected("mass_matrix", x=x)["A"])


def test_parameters_that_do_not_fit(library, plain):
    with pytest.raises(ModelError, match=r"unknown parameter 'm2'\. Known are 'm1', 'sin'"):
        library.with_parameters({"m2": 1.0})
    with pytest.raises(ModelError, match=r"unknown parameter 'm1'\. None is known"):
        plain.with_parameters({"m1": 1.0})
    with pytest.raises(ModelError, match="parameter 'm1': nan is not finite"):
        library.with_parameters({"m1": float("nan")})
    with pytest.raises(ModelError, match="parameter 'm1': 'heavy' is not a number"):
        library.with_parameters({"m1": "heavy"})


def test_threads_share_a_library(library):
    rng = np.random.default_rng(4)
    states = rng.normal(size=(200, 2, N))
    results = [library.forcing(x, y) for x, y in states]
    with ThreadPoolExecutor(8) as pool:
        again = list(pool.map(lambda state: library.forcing(*state), states))
    assert bits(results) == bits(again)


def test_c_runs_without_the_lock_of_the_interpreter(library):
    """While one thread is in a long call, this thread counts many ticks before the call ends."""
    x, y = np.zeros((2, 2_000_000, N))
    ticks = 0
    worker = threading.Thread(target=library.evaluate, args=(x, y))
    worker.start()
    while worker.is_alive():
        ticks += 1
        time.sleep(0)
    assert ticks > 100


def _in_another_process(library):
    return library.parameters, library.evaluate([0.1, 0.2], [0.3, 0.4])


def test_a_library_is_pickled_to_another_process(library):
    heavy = library.with_parameters({"m1": 3.0})
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        parameters, result = pool.apply(_in_another_process, (heavy,))
    assert parameters == {"m1": 3.0, "sin": 0.75}
    assert bits(result.forcing) == bits(heavy.forcing([0.1, 0.2], [0.3, 0.4]))


def test_compiled_code_that_cannot_be_loaded(tmp_path):
    broken = tmp_path / "libhandmade.so"
    broken.write_text("not a library")
    with pytest.raises(
        BuildError, match=r"libhandmade.so: the compiled library cannot be loaded: .*machine\?"
    ):
        NativeLibrary(Recipe(source()), broken)


def test_compiled_code_of_something_else(library, plain):
    with pytest.raises(BuildError, match=r"cannot be loaded: .*handmade_prepare"):
        Library(NativeLibrary(Recipe(library.source), plain._native.path), library.parameters)
