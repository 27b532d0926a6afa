"""Bound calls, broadcasting and C functions by address give the bits of the methods of a library."""

from __future__ import annotations

import ctypes
import pickle
from typing import Any

import dask.array
import numpy as np
import pytest
import xarray

import kanegen as kg
from kanegen.errors import ArrayError, KanegenWarning, ModelError, OptionError, StatusError
from kanegen.library.bound import BoundCall
from kanegen.options import Variant
from kanegen.recursion.outputs import OUTPUTS, available, input_arrays
from kanegen.reference.states import random_states
from tests.support.cases import slow_except
from tests.support.pages import blocks
from tests.support.paths import MODELS, ROOT
from tests.support.random_trees import everything, other_parameters

QUICK = "-O1 -ffp-contract=off"
TWO = ("mass_matrix", "forward_dynamics")


@pytest.fixture(scope="module")
def pendulum() -> kg.Library:
    system = kg.load(MODELS / "double_pendulum.toml")
    return kg.build(system, (*TWO, "step_rk4"), flags=QUICK, parameters_by_state=True)


@pytest.fixture(scope="module")
def satellite() -> kg.Library:
    return kg.build(kg.load(MODELS / "satellite.toml"), TWO, flags=QUICK)


def same(found: Any, expected: Any) -> bool:
    """Whether two arrays have the same shape and bits, NaN included."""
    return found.shape == expected.shape and bool(np.array_equal(found, expected, equal_nan=True))


@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_every_input_of_random_trees(seed: int) -> None:
    """Loads on some bodies and points, the time, quaternions and parameters: one state, and a batch."""
    system, count = everything(seed, 2), 5
    library = kg.build(system, TWO, flags=QUICK, on_status="ignore")
    states = random_states(system, count, seed)
    loads = {} if states.force is None else {"force": states.force, "torque": states.torque}
    named = {**states.inputs, **loads}
    expected = library.forward_dynamics(states.x, states.y, **named)
    many, one = library.bind("forward_dynamics", states=count), library.bind("forward_dynamics")
    given = {"x": states.x, "y": states.y, **named}
    assert {*many.inputs} == {*given, "tau"}
    for name, value in given.items():
        many.inputs[name][...] = value
    many()
    assert same(many.acceleration, expected)
    for k in range(count):
        for name, value in given.items():
            setattr(one, name, value[k])
        one()
        assert same(one.acceleration, expected[k])


def test_all_outputs_together(satellite: kg.Library) -> None:
    call = satellite.bind("evaluate")
    call.y = np.linspace(0.1, 0.8, satellite.n)
    assert call() == 0
    A, acceleration = satellite.evaluate(call.x, call.y)
    assert same(call.A, A)
    assert same(call.acceleration, acceleration)
    assert call.x.tolist().count(1.0) == 1  # no rotation


def test_a_step_repeated_in_place(pendulum: kg.Library) -> None:
    call = pendulum.bind("step_rk4")
    call.x, call.y, call.step = [0.3, -0.2], [0.1, 0.0], 1e-3
    x, y = call.x.copy(), call.y.copy()
    following = list(call.outputs.values())
    for _ in range(5):
        x, y = pendulum.step(x, y, step=1e-3)
        call()
        call.x[:], call.y[:] = following
    assert same(call.x, x)
    assert same(call.y, y)


def test_parameters(pendulum: kg.Library) -> None:
    call, many = pendulum.bind("forward_dynamics"), pendulum.bind("forward_dynamics", states=3)
    call.x, many.x = [0.3, 0.4], [0.3, 0.4]
    call.parameters = {"m1": 3.0}
    call()
    assert same(call.acceleration, pendulum.with_parameters({"m1": 3.0}).forward_dynamics(call.x, call.y))
    assert call.parameters.tolist() == list((pendulum.parameters | {"m1": 3.0}).values())
    with pytest.raises(ValueError, match="read-only"):
        call.parameters[0] = 1.0
    sets = np.array(list(pendulum.parameters.values())) * np.array([[1.0], [1.1], [1.2]])
    many.parameters = sets
    many()
    assert same(many.acceleration, pendulum.forward_dynamics(many.x, many.y, parameters=sets))
    with pytest.raises(ArrayError, match="expected shape"):
        many.parameters = sets[:2]
    with pytest.raises(ModelError, match="m9"):
        call.parameters = {"m9": 1.0}


@pytest.mark.parametrize("variant", [Variant("float"), Variant("long double"), Variant("double-double")])
def test_every_precision(variant: Variant) -> None:
    library = kg.build(kg.load(MODELS / "satellite.toml"), TWO, tier=variant, flags=QUICK)
    call = library.bind("forward_dynamics")
    call.y[:] = np.linspace(0.1, 0.2, call.y.size).reshape(call.y.shape)
    call.force[...] = 0.0
    call()
    assert same(call.acceleration, library.forward_dynamics(call.x, call.y))
    assert np.isfinite(call.acceleration).all()


def test_what_does_not_fit_says_so(pendulum: kg.Library, satellite: kg.Library) -> None:
    call, many = pendulum.bind("forward_dynamics"), pendulum.bind("forward_dynamics", states=2)
    many.x = [0.3, 0.4]
    assert many.x.tolist() == [[0.3, 0.4]] * 2
    with pytest.raises(ArrayError, match=r"x: expected shape \(2,\), got \(3,\)"):
        call.x = [1.0, 2.0, 3.0]
    with pytest.raises(AttributeError, match="there is no input 'acceleration'"):
        call.acceleration = [1.0, 2.0]
    with pytest.raises(AttributeError, match=r"there is no array 'ydot'.*acceleration"):
        _ = call.ydot
    with pytest.raises(OptionError, match="without the output 'forcing'"):
        pendulum.bind("forcing")
    with pytest.raises(OptionError, match="prepare"):
        pendulum.bind("prepare")
    with pytest.raises(OptionError, match="no whole number"):
        pendulum.bind("forward_dynamics", states=-1)
    for states in (10**12, 2**62, 10**30):
        with pytest.raises(OptionError, match=f"memory cannot hold the arrays of {states} states"):
            pendulum.bind("forward_dynamics", states=states)
    with pytest.raises(AttributeError, match="'x' cannot be deleted: a bound call needs all"):
        del call.x
    with pytest.raises(ValueError, match="cannot resize this array"):
        call.x.resize(1000, refcheck=False)
    with pytest.raises(TypeError, match="pickle the library, and bind it again there"):
        pickle.dumps(call)
    with pytest.raises(ArrayError, match="has no run-time parameters"):
        satellite.bind("forward_dynamics").parameters = [1.0]


@pytest.mark.parametrize("states", [None, 3])
def test_loads_where_none_are_taken(satellite: kg.Library, states: int | None) -> None:
    call = satellite.bind("forward_dynamics", states=states)
    row = satellite.source.model.loaded.index(False)
    call.force[..., row, 1] = -0.0
    call()
    call.force[..., row, 1] = 1.0
    with pytest.raises(ArrayError, match=rf"force: row {row} is not zero"):
        call()


def test_the_rule_of_the_library_holds(pendulum: kg.Library) -> None:
    def undefined(rule: str) -> BoundCall:
        call = pendulum.with_on_status(rule).bind("forward_dynamics")
        call.x = [np.nan, 0.0]
        return call

    message = r"forward_dynamics: acceleration\[0\] is nan, .*x\[0\] is nan"
    with pytest.raises(StatusError, match=message):
        undefined("raise")()
    with pytest.warns(KanegenWarning, match=message):
        undefined("warn")()
    assert undefined("ignore")() == pendulum.n + 1
    many = pendulum.with_on_status("warn").bind("forward_dynamics", states=3)
    many.x[1, 0] = np.inf
    with pytest.warns(KanegenWarning, match="in 1 of 3 states .* in state 1"):
        assert many() == 1
    assert np.isnan(many.acceleration[1]).all()


def test_no_array_has_the_name_of_an_attribute() -> None:
    """Over all outputs of a system with everything, since each array is an attribute."""
    system = everything(1, 2)
    arrays = {OUTPUTS[name].array(system).name for name in available(system)}
    arrays |= {array.name for array in input_arrays(system)} - {"parameters"}
    assert {"x", "acceleration", "A", "point_force"} <= arrays
    assert not arrays & {name for name in dir(BoundCall) if not name.startswith("__")}


def test_broadcasting(pendulum: kg.Library) -> None:
    forward_dynamics = pendulum.ufunc("forward_dynamics")
    assert forward_dynamics.signature == "(2),(2),(2)->(2)"
    rng = np.random.default_rng(3)
    x, y, tau = rng.normal(size=(3, 1, 2)), rng.normal(size=(4, 2)), rng.normal(size=2)
    found = forward_dynamics(x, y, tau)
    rows = np.vectorize(pendulum.forward_dynamics, signature="(n),(n),(n)->(n)")
    assert same(found, rows(x, y, tau))
    assert same(forward_dynamics(x[0, 0], y[0]), pendulum.forward_dynamics(x[0, 0], y[0]))
    sets = np.array(list(pendulum.parameters.values())) * rng.uniform(0.9, 1.1, (3, 1, 5))
    other = forward_dynamics(x, y, parameters=sets)
    assert same(other[2, 3], pendulum.forward_dynamics(x[2, 0], y[3], parameters=sets[2, 0]))
    following = pendulum.ufunc("step_rk4")(x, y, step=np.full((3, 4), 0.01))
    assert [one.shape for one in following] == [(3, 4, 2)] * 2
    assert forward_dynamics(np.zeros((0, 4, 2)), y).shape == (0, 4, 2)
    again = pickle.loads(pickle.dumps(forward_dynamics))
    assert same(again(x, y, tau), found)
    with pytest.raises(ArrayError, match="do not broadcast"):
        forward_dynamics(np.zeros((3, 2)), y)
    with pytest.raises(ArrayError, match=r"y: expected shape \(..., 2\), got \(3,\)"):
        forward_dynamics(x, np.zeros(3))
    with pytest.raises(ArrayError, match="given twice"):
        forward_dynamics(x, y, y=y)
    for many in ((2**45,), (2**23, 2**23)):
        with pytest.raises(ArrayError, match="memory cannot hold the arrays of so many states"):
            forward_dynamics(np.broadcast_to(x[0, 0], (*many, 2)), y[0])
    with pytest.raises(ArrayError, match="no such argument"):
        forward_dynamics(x, y, yy=y)


def test_broadcasting_in_other_libraries(satellite: kg.Library) -> None:
    """xarray and Dask take it as they take a generalized ufunc of NumPy."""
    mass_matrix = satellite.ufunc("mass_matrix")
    x = np.random.default_rng(0).normal(size=(2, 3, 9))
    expected = satellite.mass_matrix(x.reshape(6, 9)).reshape(2, 3, 8, 8)
    named = xarray.apply_ufunc(
        mass_matrix,
        xarray.DataArray(x, dims=("a", "b", "m")),
        input_core_dims=[["m"]],
        output_core_dims=[["i", "j"]],
    )
    assert named.dims == ("a", "b", "i", "j")
    assert same(named.values, expected)
    chunks = dask.array.from_array(x, chunks=(1, 3, 9))
    sizes = {"output_sizes": {"i": 8, "j": 8}, "output_dtypes": float}
    lazy = dask.array.apply_gufunc(mass_matrix, "(m)->(i,j)", chunks, **sizes)
    assert same(lazy.compute(scheduler="sync"), expected)


def test_addresses(pendulum: kg.Library) -> None:
    assert {"prepare", "forward_dynamics", "forward_dynamics_batch"} <= {*pendulum.c_functions}
    function = pendulum.c_function("forward_dynamics")
    assert ctypes.cast(function, ctypes.c_void_p).value == pendulum.address("forward_dynamics")
    arrays = [pendulum.prepared, np.array([0.3, 0.4]), np.array([0.1, 0.2]), np.zeros(2), np.zeros(2)]
    numbers = ctypes.POINTER(ctypes.c_double)
    assert function(*(array.ctypes.data_as(numbers) for array in arrays)) == 0
    assert same(arrays[-1], pendulum.forward_dynamics(*arrays[1:3]))
    with pytest.raises(OptionError, match=r"no C function 'forwrd_dynamics'.*forward_dynamics"):
        pendulum.address("forwrd_dynamics")


def test_prepared_constants(pendulum: kg.Library, satellite: kg.Library) -> None:
    prepare = pendulum.c_function("prepare")
    sets = np.array(list(other_parameters(kg.load(MODELS / "double_pendulum.toml"), 4).values()))
    found = np.zeros_like(pendulum.prepared)
    numbers = ctypes.POINTER(ctypes.c_double)
    prepare(sets.ctypes.data_as(numbers), found.ctypes.data_as(numbers))
    names = pendulum.parameter_names
    other = pendulum.with_parameters(dict(zip(names, sets.tolist(), strict=True)))
    assert same(found, other.prepared)
    assert satellite.prepared.size == 0


def test_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    namespace: dict[str, Any] = {}
    for block in blocks("embedding/bound-calls", "python"):
        exec(block, namespace)
    assert np.isfinite(namespace["call"].acceleration).all()
    assert namespace["grid"].shape == (30, 40, 2)
