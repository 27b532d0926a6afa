"""Generated functions in JAX: values, gradients, batches, statuses and bad input, by JAX itself.

Values are compared with the NumPy reference, gradients with complex steps through it or with differences, and
bits with the same C called from NumPy.
"""

from __future__ import annotations

import importlib
import pickle
import re
import sys
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import ArrayError, KanegenWarning, ModelError, OptionError
from kanegen.interop.slopes import slopes
from kanegen.library.native.build import write
from kanegen.model.arguments import LOADS
from kanegen.options import Variant
from kanegen.recursion.outputs import INTEGRATORS, OUTPUTS, available
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.complex_steps import STEP, dynamics, rates_of
from tests.support.pages import blocks
from tests.support.paths import MODELS, ROOT
from tests.support.random_trees import everything, other_parameters

pytestmark = [
    pytest.mark.embed("jax"),
    pytest.mark.filterwarnings("ignore:os.fork:RuntimeWarning"),  # of compilers that other tests start
]

QUICK = "-O1 -ffp-contract=off"


@pytest.fixture(scope="module", autouse=True)
def jax() -> Any:
    """JAX with numbers of 64 bits; other tests keep their own."""
    jax = importlib.import_module("jax")
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield jax
    jax.config.update("jax_enable_x64", before)


@contextmanager
def rounding(jax: Any) -> Iterator[None]:
    """A context in which JAX rounds numbers to 32 bits, as it does by default."""
    jax.config.update("jax_enable_x64", False)
    try:
        yield
    finally:
        jax.config.update("jax_enable_x64", True)


def functions(*given: Any, **options: Any) -> Any:
    """Call `kanegen.interop.jax.functions`, which is imported only where JAX is there."""
    return importlib.import_module("kanegen.interop.jax").functions(*given, **options)


def made(name: str, outputs: Any = ("forward_dynamics",), **options: Any) -> Any:
    return functions(kg.load(MODELS / f"{name}.toml"), outputs, flags=QUICK, **options)


def state(functions: Any, seed: int = 1, count: int | None = None) -> tuple[Any, Any, Any]:
    """Return coordinates, speeds and generalized forces of one state, or of many."""
    library, rng = functions.library, np.random.default_rng(seed)
    lead = () if count is None else (count,)
    m, n = len(library.coordinate_names), library.n
    return rng.uniform(-1, 1, (*lead, m)), rng.normal(size=(*lead, n)), rng.normal(size=(*lead, n))


@pytest.fixture(scope="module")
def pendulum() -> Any:
    return made("double_pendulum", ("forward_dynamics", "inverse_dynamics", "step_rk4"))


@pytest.fixture(scope="module")
def jacobians() -> Any:
    """Functions of the double pendulum whose derivatives are whole Jacobians alone."""
    names = ("forward_dynamics", "inverse_dynamics", "mass_matrix")
    whole = (f"{name}_derivatives" for name in names[:2])
    return made("double_pendulum", (*names, *whole), derivatives=False)


@pytest.fixture(scope="module")
def satellite() -> Any:
    return made("satellite", ("forward_dynamics", "step_rk4"))


# Values


@pytest.mark.parametrize("name", ["double_pendulum", "panda_arm", "satellite"])
def test_accelerations_are_those_of_the_reference(name: str, jax: Any) -> None:
    system, functions = kg.load(MODELS / f"{name}.toml"), made(name, derivatives=False)
    x, y, tau = state(functions)
    loads = np.zeros((2, system.number_of_bodies, 3))
    named = {}
    if any(body.loads for body in system.bodies):
        for k, body in enumerate(system.bodies):
            loads[:, k] = body.loads * np.array([[1.0, -2.0, 0.5], [0.3, 0.1, -0.7]])
        named = {"force": loads[0], "torque": loads[1]}
    matrix, forcing = dynamics(system, {"x": x, "y": y, "force": loads[0], "torque": loads[1]})
    expected = np.linalg.solve(matrix, forcing + tau)
    found = jax.jit(functions.forward_dynamics)(x, y, tau, **named)
    # The solution of the reference has a rounding error of about the condition of its matrix.
    room = 1e-15 * np.linalg.cond(matrix) * np.abs(expected).max()
    assert np.abs(found - expected).max() <= max(room, 1e-12 * np.abs(expected).max())
    alone = functions.library.forward_dynamics(x, y, tau, **named)
    np.testing.assert_array_equal(found, alone)


OF_EVERY_KIND = (
    "mass_matrix",
    "forcing",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "body_poses",
    "coordinate_rates",
    "point_accelerations",
)
"""Outputs with results of every number of axes, which read all arrays that there are."""


def inputs(function: Any, library: kg.Library, system: kg.System, count: int) -> dict[str, Any]:
    """Return random values of all arrays that a function reads, in some states; loads where they may act."""
    rng = np.random.default_rng(count)
    given = {array.name: rng.uniform(-1, 1, (count, *array.shape)) for array in function.arguments.arrays}
    for load, kind in LOADS.items():
        for row in library.source.model.unloaded(kind) if load in given else ():
            given[load][:, row] = 0.0
    if "parameters" in given:
        given["parameters"] = np.array([[*other_parameters(system, k).values()] for k in range(count)])
    return given


@pytest.mark.parametrize("seed", range(4))
def test_outputs_of_random_trees_have_the_bits_of_numpy(seed: int, jax: Any) -> None:
    system = everything(seed, 2)
    names = [name for name in OF_EVERY_KIND if name in available(system)]
    found = functions(system, names, derivatives=False, flags="-O0 -ffp-contract=off", on_status="ignore")
    library = found.library
    for name in names:
        function = getattr(found, name)
        given = inputs(function, library, system, 3)
        expected = getattr(library, name)(**given)
        np.testing.assert_array_equal(jax.vmap(lambda a, f=function: f(**a))(given), expected, err_msg=name)
        one = {key: value[1] for key, value in given.items()}
        np.testing.assert_array_equal(
            jax.jit(lambda a, f=function: f(**a))(one), getattr(library, name)(**one)
        )


DIFFERENTIATED = ("forward_dynamics", "inverse_dynamics", "kinetic_energy", "frame_velocities")
"""Outputs with derivatives of each kind: by inputs from outside, by a factor, of a scalar, of matrices."""


@pytest.mark.parametrize("seed", range(2))
def test_derivatives_of_random_trees_are_those_of_differences(seed: int, jax: Any) -> None:
    system = everything(seed, 2)
    found = functions(system, DIFFERENTIATED, flags="-O0 -ffp-contract=off", on_status="ignore")
    for name in DIFFERENTIATED:
        function = getattr(found, name)
        given = {key: value[0] for key, value in inputs(function, found.library, system, 1).items()}
        known = {column for one in slopes(name, found.library.source) for column in one.columns}
        assert known.issuperset(given) or name == "frame_velocities"
        for key in known.intersection(given):
            along = np.random.default_rng(seed).uniform(-1, 1, given[key].shape) * (given[key] != 0)
            line = partial(moved, function, given, key, along)
            _, slope = jax.jvp(line, (0.0,), (1.0,))
            # Differences of fourth order: rounding errors of 1e-16 / h, and h**4 times high derivatives.
            h = 1e-4
            right = (8 * (line(h) - line(-h)) - (line(2 * h) - line(-2 * h))) / (12 * h)
            scale = np.abs(right).max() + np.abs(line(0.0)).max()
            np.testing.assert_allclose(slope, right, rtol=0, atol=1e-8 * scale, err_msg=f"{name} by {key}")
            weights = np.random.default_rng(seed).normal(size=slope.shape)
            (back,) = jax.vjp(line, 0.0)[1](weights)
            np.testing.assert_allclose(back, (weights * slope).sum(), rtol=1e-12, atol=1e-12 * scale)


def moved(function: Any, given: dict[str, Any], key: str, along: Any, h: Any) -> Any:
    """Return the result of a function for an input that is moved along a direction."""
    return function(**given | {key: given[key] + h * along})


def test_subnormal_numbers_are_kept(pendulum: Any, jax: Any) -> None:
    tau = np.array([3e-310, 0.0])
    found = jax.jit(pendulum.forward_dynamics)(np.zeros(2), np.zeros(2), tau)
    np.testing.assert_array_equal(found, pendulum.library.forward_dynamics(np.zeros(2), np.zeros(2), tau))
    assert found[0] == 3e-310


def test_single_precision(jax: Any) -> None:
    functions = made("double_pendulum", precision="float")
    x, y, tau = state(functions, count=5)
    with rounding(jax):
        found = jax.vmap(functions.forward_dynamics)(x, y, tau)
        slope = jax.grad(lambda x: functions.forward_dynamics(x, y, tau).sum())(x)
    assert found.dtype == slope.dtype == np.float32
    np.testing.assert_array_equal(found, functions.library.forward_dynamics(x, y, tau))
    exact = made("double_pendulum").library.forward_dynamics(x, y, tau)
    assert np.abs(found - exact).max() < 1e-4 * np.abs(exact).max()


# Batches


def test_vmapped_parameters_are_those_of_each_row(pendulum: Any, jax: Any) -> None:
    x, y, tau = state(pendulum, count=100)
    usual = np.array([*pendulum.library.parameters.values()])
    sets = usual * np.random.default_rng(3).uniform(0.5, 2.0, (100, 5))
    expected = np.stack(
        [
            pendulum.library.with_parameters(
                dict(zip(pendulum.library.parameters, one, strict=True))
            ).forward_dynamics(x[k], y[k], tau[k])
            for k, one in enumerate(sets)
        ]
    )

    def one(x: Any, y: Any, tau: Any, p: Any) -> Any:
        return pendulum.forward_dynamics(x, y, tau, parameters=p)

    np.testing.assert_array_equal(jax.jit(jax.vmap(one))(x, y, tau, sets), expected)
    np.testing.assert_array_equal(one(x, y, tau, sets), expected)
    columns = dict(zip(pendulum.library.parameters, sets.T, strict=True))
    np.testing.assert_array_equal(one(x, y, tau, columns), expected)
    some = {name: columns[name] for name in ("m1", "l2")}
    full = usual * np.ones((100, 1))
    full[:, [1, 4]] = sets[:, [1, 4]]
    np.testing.assert_array_equal(one(x, y, tau, some), one(x, y, tau, full))
    # One state with a hundred sets, and a hundred states with one set.
    np.testing.assert_array_equal(
        jax.vmap(one, (None, None, None, 0))(x[0], y[0], tau[0], sets),
        one(np.tile(x[0], (100, 1)), np.tile(y[0], (100, 1)), np.tile(tau[0], (100, 1)), sets),
    )
    np.testing.assert_array_equal(
        jax.vmap(one, (0, 0, 0, None))(x, y, tau, sets[7]), one(x, y, tau, np.tile(sets[7], (100, 1)))
    )


def test_axes_are_broadcast_as_in_numpy(pendulum: Any, jax: Any) -> None:
    x, y, tau = state(pendulum, count=6)
    sets = np.array([*pendulum.library.parameters.values()]) * np.array([[1.0], [1.5], [0.7], [2.0]])

    def one(*given: Any) -> Any:
        return pendulum.forward_dynamics(*given[:3], parameters=given[3])

    expected = np.array([[[np.array(one(a, b, tau[0], p)) for p in sets] for b in y] for a in x])
    nested = jax.vmap(
        jax.vmap(jax.vmap(one, (None, None, None, 0)), (None, 0, None, None)), (0, None, None, None)
    )
    np.testing.assert_array_equal(nested(x, y, tau[0], sets), expected)
    broadcast = one(x[:, None, None], y[:, None], tau[0], sets)
    np.testing.assert_array_equal(broadcast, expected)
    # Rows of 130 states fill two blocks and begin a third.
    many = np.tile(x, (22, 1))[:130]
    np.testing.assert_array_equal(
        one(many, y[0], tau[0], sets[0]), one(many, *([a] * 130 for a in (y[0], tau[0])), sets[0])
    )
    assert one(np.zeros((0, 2)), np.zeros((0, 2)), tau[0], sets[0]).shape == (0, 2)
    out_axes = jax.vmap(one, (1, 0, None, None), out_axes=1)(x.T, y, tau[0], sets[0])
    np.testing.assert_array_equal(out_axes.T, one(x, y, tau[0], sets[0]))


def test_threads_of_openmp_change_no_bit(pendulum: Any, jax: Any) -> None:
    alone, shared = (made("double_pendulum", derivatives=False, threads=one) for one in (False, True))
    x, y, tau = state(pendulum, count=5000)
    sets = np.array([*pendulum.library.parameters.values()]) * np.random.default_rng(2).uniform(
        0.5, 2, (5000, 5)
    )
    for parameters in (sets[0], sets):
        one, other = (f.forward_dynamics(x, y, tau, parameters=parameters) for f in (alone, shared))
        np.testing.assert_array_equal(one, other)


def test_compiled_once(pendulum: Any, jax: Any) -> None:
    compiled = jax.jit(pendulum.forward_dynamics)
    for seed in range(3):
        compiled(*state(pendulum, seed))
    assert compiled._cache_size() == 1


# Derivatives


def test_both_modes_give_the_generated_derivatives(pendulum: Any, jacobians: Any, jax: Any) -> None:
    """By products, and by whole Jacobians where these alone were generated."""
    given, library = state(pendulum), jacobians.library
    for name in ("forward_dynamics", "inverse_dynamics"):
        derivatives = getattr(library, f"{name}_derivatives")(*given)
        columns = library.derivative_columns(f"{name}_derivatives")
        for functions in (pendulum, jacobians):
            function = getattr(functions, name)
            for mode in (jax.jacfwd, jax.jacrev):
                by = mode(function, (0, 1, 2))(*given)
                for one, found in zip(function.arguments.names.positional, by, strict=False):
                    right = library.mass_matrix(given[0]) if one == "ydot" else derivatives[..., columns[one]]
                    np.testing.assert_allclose(found, right, rtol=1e-13, atol=1e-14 * np.abs(right).max())


def called(jax: Any, function: Any, *given: Any) -> set[str]:
    """Return the names of the functions in C that a compiled function calls."""
    text = jax.jit(function).lower(*given).as_text()
    return set(re.findall(r"kanegen_[0-9a-f]+_(\w+)", text))


def test_gradients_call_no_jacobian(pendulum: Any, jax: Any) -> None:
    x, y, tau = state(pendulum)

    def total(x: Any) -> Any:
        return pendulum.forward_dynamics(x, y, tau).sum()

    assert called(jax, jax.grad(total), x) == {"forward_dynamics_vjp"}
    assert called(jax, lambda x: jax.jvp(total, (x,), (y,))[1], x) == {"forward_dynamics_jvp"}
    whole = {"forward_dynamics_derivatives"}
    every = made("scara", ("forward_dynamics", "forward_dynamics_hvp", *whole))
    x, y, tau = state(every)

    def one(x: Any, tau: Any = tau) -> Any:
        return every.forward_dynamics(x, y, tau)

    assert called(jax, jax.grad(lambda x: one(x).sum()), x) == {"forward_dynamics_vjp"}
    assert called(jax, jax.jacfwd(one), x) == called(jax, jax.jacrev(one), x) == whole
    many = jax.vmap(lambda tau: jax.grad(lambda x: one(x, tau).sum())(x))
    assert called(jax, many, np.tile(tau, (9, 1))) == {"forward_dynamics_vjp"}
    assert called(jax, jax.hessian(lambda x: one(x).sum()), x) == {"forward_dynamics_hvp"}


@pytest.fixture(scope="module")
def twice() -> Any:
    """Functions of the double pendulum with second derivatives."""
    names = ("forward_dynamics", "inverse_dynamics", "forcing")
    return made("double_pendulum", (*names, *(f"{name}_hvp" for name in names)))


def test_second_derivatives_are_those_of_differences(twice: Any, jax: Any) -> None:
    test_util = importlib.import_module("jax.test_util")
    x, y, tau = state(twice, 3)
    parameters = np.array([*twice.library.parameters.values()])
    for name in ("forward_dynamics", "inverse_dynamics", "forcing"):
        given = (x, y, *((tau,) if name != "forcing" else ()), parameters)

        def function(*given: Any, name: str = name) -> Any:
            return getattr(twice, name)(*given[:-1], parameters=given[-1])

        test_util.check_grads(function, given, order=2, modes=("fwd", "rev"), eps=1e-4, rtol=1e-5, atol=1e-5)


def test_every_order_of_modes_gives_the_same_hessian(twice: Any, jax: Any) -> None:
    x, y, tau = state(twice, 3)
    fwd, rev = jax.jacfwd, jax.jacrev

    def total(x: Any, tau: Any) -> Any:
        return (twice.forward_dynamics(x, y, tau) * np.array([1.0, -2.0])).sum()

    right = np.array(jax.hessian(total)(x, tau))
    np.testing.assert_allclose(right, right.T, rtol=1e-13)
    # Linear in {tau}: the derivative of the gradient by {tau}, [A]^-1 {w}, with weights of its own.
    mixed = jax.jacfwd(jax.grad(total, 1))(x, tau)
    for outer, inner in ((fwd, fwd), (rev, fwd), (rev, rev)):
        np.testing.assert_allclose(outer(inner(total))(x, tau), right, rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(outer(inner(total, 1), 0)(x, tau), mixed, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(jax.jit(rev(jax.checkpoint(rev(total))))(x, tau), right, rtol=1e-12)
    many = jax.jit(jax.vmap(jax.hessian(total), (0, None)))(np.stack([x, x + 0.1]), tau)
    np.testing.assert_allclose(many[0], right, rtol=1e-12)
    np.testing.assert_allclose(many[1], jax.hessian(total)(x + 0.1, tau), rtol=1e-12)


def test_second_derivatives_through_a_scan(twice: Any, jax: Any) -> None:
    """Semi-implicit steps in JAX, whose Hessian by a constant force is that of differences."""
    x, y, tau = state(twice, 5)

    def end(tau: Any) -> Any:
        def one(now: Any, _: Any) -> Any:
            speeds = now[1] + 0.02 * twice.forward_dynamics(*now, tau)
            return (now[0] + 0.02 * speeds, speeds), None

        (last, _), _ = jax.lax.scan(one, (x, y), None, length=20)
        return (last**2).sum()

    gradient, h = jax.jit(jax.grad(end)), 1e-4
    columns = [
        8 * (gradient(tau + h * d) - gradient(tau - h * d))
        - gradient(tau + 2 * h * d)
        + gradient(tau - 2 * h * d)
        for d in np.eye(2)
    ]
    right = np.array(columns) / (12 * h)
    for mode in (jax.jacfwd, jax.jacrev):
        np.testing.assert_allclose(mode(gradient)(tau), right, rtol=1e-8, atol=1e-9 * np.abs(right).max())


def test_products_called_by_name_have_derivatives(twice: Any, jax: Any) -> None:
    x, y, tau = state(twice, 3)
    weights = np.array([0.5, -1.5])
    direction = np.random.default_rng(1).normal(size=11)

    def gradient(x: Any, weights: Any) -> Any:
        return twice.forward_dynamics_vjp(x, y, weights, tau) @ direction

    def change(x: Any, direction: Any) -> Any:
        return twice.forward_dynamics_jvp(x, y, direction, tau) @ weights

    by_x, by_weights = jax.grad(gradient, (0, 1))(x, weights)
    same, by_direction = jax.grad(change, (0, 1))(x, direction)
    np.testing.assert_allclose(
        by_x, twice.forward_dynamics_hvp(x, y, weights, direction, tau)[:2], rtol=1e-14
    )
    np.testing.assert_allclose(same, by_x, rtol=1e-14)
    np.testing.assert_allclose(by_weights, twice.forward_dynamics_jvp(x, y, direction, tau), rtol=1e-14)
    np.testing.assert_allclose(by_direction, twice.forward_dynamics_vjp(x, y, weights, tau), rtol=1e-14)

    def hessian(weights: Any, direction: Any) -> Any:
        return twice.forward_dynamics_hvp(x, y, weights, direction, tau) @ np.arange(11.0)

    test_util = importlib.import_module("jax.test_util")
    test_util.check_grads(hessian, (weights, direction), order=2, modes=("fwd", "rev"))


def test_gradients_by_loads(satellite: Any, jax: Any) -> None:
    x, y, tau = state(satellite)
    loaded = np.array(satellite.library.source.model.loaded)[:, None]
    force, torque = np.random.default_rng(4).normal(size=(2, 3, 3)) * loaded
    found = jax.jacrev(lambda *loads: satellite.forward_dynamics(x, y, tau, *loads), (0, 1))(force, torque)
    system = kg.load(MODELS / "satellite.toml")
    none = np.zeros((3, 3))
    matrix, _ = dynamics(system, {"x": x, "y": y, "force": none, "torque": none})
    for place, slopes_ in enumerate(found):
        for body, axis in zip(*np.nonzero(loaded * np.ones(3)), strict=True):
            unit = np.zeros((2, 3, 3))
            unit[place, body, axis] = 1.0
            forces = [
                dynamics(system, {"x": x, "y": y, "force": one[0], "torque": one[1]})[1]
                for one in (unit, np.zeros((2, 3, 3)))
            ]  # {f} is a linear function of loads
            right = np.linalg.solve(matrix, forces[0] - forces[1])
            np.testing.assert_allclose(slopes_[:, body, axis], right, rtol=1e-9, atol=1e-9)
    assert not np.asarray(found[0])[:, ~loaded[:, 0]].any()


def test_a_gradient_by_parameters_has_their_names(pendulum: Any, jacobians: Any, jax: Any) -> None:
    x, y, tau = state(pendulum)
    usual = pendulum.library.parameters
    found = jax.grad(lambda p: pendulum.forward_dynamics(x, y, tau, parameters=p).sum())(usual)
    columns = pendulum.library.derivative_columns("forward_dynamics_derivatives")["parameters"]
    right = jacobians.library.forward_dynamics_derivatives(x, y, tau)[:, columns].sum(axis=0)
    np.testing.assert_allclose([found[name] for name in usual], right, rtol=1e-13)


def rates_of_pendulum(now: Any, tau: Any, p: Any) -> Any:
    """Return {xdot} and {ydot} of two point masses on rods, as a textbook has them, for complex numbers."""
    (q1, q2, y1, y2), (m1, m2, l1, l2, g) = now, (p[name] for name in ("m1", "m2", "l1", "l2", "g"))
    turned, near = m2 * l1 * l2 * np.sin(q2), m2 * l1 * l2 * np.cos(q2)
    outer = m2 * l2**2
    matrix = np.array([[(m1 + m2) * l1**2 + outer + 2 * near, outer + near], [outer + near, outer]])
    hanging = m2 * g * l2 * np.sin(q1 + q2)
    forces = [
        turned * (2 * y1 + y2) * y2 - (m1 + m2) * g * l1 * np.sin(q1) - hanging,
        -turned * y1**2 - hanging,
    ]
    return np.array([y1, y2, *np.linalg.solve(matrix, np.array(forces) + tau)])


def end_of_rollout(start: Any, tau: Any, p: Any, steps: int, step: float) -> Any:
    """Return the last state of a motion of the double pendulum by RK4, for real or complex numbers."""
    for k in range(steps):
        held = tau[k] if tau.ndim > 1 else tau
        one = rates_of_pendulum(start, held, p)
        two = rates_of_pendulum(start + step / 2 * one, held, p)
        three = rates_of_pendulum(start + step / 2 * two, held, p)
        four = rates_of_pendulum(start + step * three, held, p)
        start = start + step / 6 * (one + 2 * two + 2 * three + four)
    return start


def test_gradient_through_a_rollout_of_a_hundred_steps(pendulum: Any, jax: Any) -> None:
    steps, step = 100, 0.01
    x, y, tau = state(pendulum, 4)
    weights = np.array([1.0, -0.5, 0.2, 0.3])
    parameters = pendulum.library.parameters

    def cost(x: Any, y: Any, tau: Any, p: Any) -> Any:
        xs, ys = pendulum.rollout(x, y, tau, steps=steps, step=step, parameters=p)
        return jax.numpy.concatenate([xs[-1], ys[-1]]) @ weights

    value, (by_x, by_y, by_tau, by_p) = jax.jit(jax.value_and_grad(cost, (0, 1, 2, 3)))(x, y, tau, parameters)
    start = np.concatenate([x, y])
    found = np.array([*by_x, *by_y, *by_tau, *(by_p[name] for name in parameters)])
    right = []
    for k in range(len(found)):  # a complex step by one variable after the other has no error but rounding
        moved = np.concatenate([start, tau, [*parameters.values()]]).astype(complex)
        moved[k] += 1j * STEP
        own = dict(zip(parameters, moved[6:], strict=True))
        end = end_of_rollout(moved[:4], moved[4:6], own, steps, step) @ weights
        right.append(end.imag / STEP)
    # Rounding errors of 100 steps, 1e-14, grow no more than small changes of the start do, about tenfold.
    assert value == pytest.approx(end.real, rel=1e-11)
    np.testing.assert_allclose(found, right, rtol=1e-10, atol=1e-10 * np.abs(right).max())


def test_gradient_by_held_inputs_and_of_many_rollouts(pendulum: Any, jax: Any) -> None:
    steps, step = 20, 0.02
    x, y, _ = state(pendulum, count=3)
    tau = np.random.default_rng(5).normal(size=(steps, 2))

    def ends(tau: Any) -> Any:
        def one(x: Any, y: Any) -> Any:
            return pendulum.rollout(x, y, tau, steps=steps, step=step)[0][-1]

        return jax.vmap(one)(x, y).sum()

    along = np.random.default_rng(6).normal(size=tau.shape)
    right = 0.0
    for pair in zip(x, y, strict=True):
        moved = tau + 1j * STEP * along
        end = end_of_rollout(np.concatenate(pair), moved, pendulum.library.parameters, steps, step)
        right += end[:2].imag.sum() / STEP
    assert (jax.grad(ends)(tau) * along).sum() == pytest.approx(right, rel=1e-10)


def test_rates_of_a_state_with_a_quaternion(satellite: Any, jax: Any) -> None:
    x, y, tau = state(satellite)
    system = kg.load(MODELS / "satellite.toml")
    now = np.concatenate([x, y])
    none = np.zeros((system.number_of_bodies, 3))

    def reference(now: Any, tau: Any) -> Any:
        x, y = now[:9], now[9:]
        matrix, forcing = dynamics(system, {"x": x, "y": y, "force": none, "torque": none})
        return np.concatenate([rates_of(system, x, y), np.linalg.solve(matrix, forcing + tau)])

    np.testing.assert_allclose(satellite.state_rates(now, tau), reference(now, tau), rtol=1e-11, atol=1e-12)
    along = np.random.default_rng(7).normal(size=17)
    _, found = jax.jvp(lambda s: satellite.state_rates(s, tau), (now,), (along,))
    right = reference(now + 1j * STEP * along, tau).imag / STEP
    np.testing.assert_allclose(found, right, rtol=1e-10, atol=1e-10 * np.abs(right).max())


def test_rates_take_leading_axes(pendulum: Any, satellite: Any, jax: Any) -> None:
    for functions in (pendulum, satellite):
        x, y, tau = state(functions, count=4)
        many = functions.state_rates(np.concatenate([x, y], axis=-1), tau[0])
        for k in range(4):
            np.testing.assert_array_equal(
                many[k], functions.state_rates(np.concatenate([x[k], y[k]]), tau[0])
            )


def test_gradients_over_no_states_are_zero(pendulum: Any, jax: Any) -> None:
    y, none = np.array([0.5, -0.4]), np.zeros((0, 2))
    total = jax.value_and_grad(lambda x, y: pendulum.forward_dynamics(x, y).sum(), argnums=(0, 1))
    value, (by_x, by_y) = total(none, y)
    assert value == 0 and by_x.shape == (0, 2)
    np.testing.assert_array_equal(by_y, [0, 0])
    columns = jax.jvp(pendulum.forward_dynamics, (none, none), (none, none))[1]
    assert columns.shape == (0, 2)


def test_derivatives_that_were_not_generated(pendulum: Any, jacobians: Any, twice: Any, jax: Any) -> None:
    x, y, tau = state(pendulum)
    second = (
        r"asks for second derivatives,? and the library was built without forward_dynamics_hvp\. Ask for it"
    )
    for functions in (pendulum, jacobians):
        for mode in (jax.jacfwd, jax.jacrev):
            with pytest.raises(OptionError, match=second):
                mode(jax.grad(lambda x, f=functions: f.forward_dynamics(x, y, tau).sum()))(x)
    with pytest.raises(OptionError, match="third derivatives, which are not generated"):
        jax.grad(lambda x: jax.hessian(lambda x: twice.forward_dynamics(x, y, tau).sum())(x).sum())(x)
    with pytest.raises(OptionError, match=r"mass_matrix: JAX asks for the derivative by x\. There are no"):
        jax.grad(lambda x: jacobians.mass_matrix(x).sum())(x)
    with pytest.raises(OptionError, match=r"apply jax\.lax\.stop_gradient to x, not to the result\."):
        jax.grad(lambda x: (jax.lax.stop_gradient(jacobians.mass_matrix(x)) @ x).sum())(x)
    found = jax.grad(lambda x: (jacobians.mass_matrix(jax.lax.stop_gradient(x)) @ x).sum())(x)
    np.testing.assert_allclose(found, jacobians.mass_matrix(x).sum(axis=0), rtol=1e-15)
    with pytest.raises(OptionError, match=r"by step\. There are derivatives by x, y, tau, parameters"):
        jax.grad(lambda h: pendulum.step(x, y, tau, step=h)[0].sum())(0.1)
    bare = made("double_pendulum", derivatives=False)
    with pytest.raises(OptionError, match=r"without forward_dynamics_vjp, .* Ask for one with outputs=\("):
        jax.grad(lambda x: bare.forward_dynamics(x, y, tau).sum())(x)


def test_a_library_with_one_product(jax: Any) -> None:
    """What it lacks is computed from whole Jacobians where there are these, and else refused by name."""
    names = ("forward_dynamics", "forward_dynamics_vjp")
    found = made("double_pendulum", names, derivatives=False)
    x, y, tau = state(found)
    gradient = jax.grad(lambda x: found.forward_dynamics(x, y, tau).sum())(x)
    with pytest.raises(
        OptionError, match=r"derivatives along a direction, .* without forward_dynamics_jvp\."
    ):
        jax.jvp(lambda x: found.forward_dynamics(x, y, tau), (x,), (y,))
    for other in ("forward_dynamics_jvp", "forward_dynamics_hvp"):
        some = made("double_pendulum", ("forward_dynamics", other), derivatives=False)
        with pytest.raises(OptionError, match=r"a gradient, .* without forward_dynamics_vjp\. Ask for it"):
            jax.jit(jax.grad(lambda x, f=some: f.forward_dynamics(x, y, tau).sum()))(x)
    both = made("double_pendulum", (*names, "forward_dynamics_derivatives"), derivatives=False)
    _, change = jax.jvp(lambda x: both.forward_dynamics(x, y, tau), (x,), (y,))
    assert float(change.sum()) == pytest.approx(float(gradient @ y), rel=1e-13)


# Statuses


def test_statuses_follow_the_rule(jax: Any) -> None:
    bad = np.array([[0.1, 0.2], [np.nan, 0.0], [0.3, 0.1]])
    y = np.zeros((3, 2))
    found = {
        rule: made("double_pendulum", derivatives=False, on_status=rule)
        for rule in ("warn", "raise", "ignore")
    }
    message = (
        r"forward_dynamics: in 1 of 3 states .* in state 1 acceleration\[0\] is nan.* because x\[0\] is nan"
    )
    with pytest.warns(KanegenWarning, match=message):
        some = found["warn"].forward_dynamics(bad, y)
    assert np.isnan(some[1]).all()
    assert np.isfinite(some[::2]).all()
    with pytest.raises(jax.errors.JaxRuntimeError, match=message):
        jax.jit(jax.vmap(found["raise"].forward_dynamics))(bad, y).block_until_ready()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_array_equal(found["ignore"].forward_dynamics(bad, y), some)


def test_what_does_not_exist(jax: Any) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    found = functions(system, flags=QUICK, derivatives=False)
    weightless = {"m1": 0.0, "m2": 0.0}
    with pytest.raises(jax.errors.JaxRuntimeError, match=r"the pivot of .A. at freedom 'q.' of body"):
        found.forward_dynamics(np.zeros(2), np.zeros(2), parameters=weightless).block_until_ready()
    with pytest.warns(KanegenWarning, match="in 2 of 2 states the result does not exist"):
        rows = found.forward_dynamics(np.zeros((2, 2)), np.zeros((2, 2)), parameters=weightless)
    assert np.isnan(rows).all()
    whole = functions(system, flags=QUICK)

    def total(x: Any) -> Any:
        return whole.forward_dynamics(x, np.zeros((2, 2)), parameters=weightless).sum()

    with pytest.warns(KanegenWarning, match="in 2 of 2 states the result does not exist") as caught:
        assert np.isnan(jax.grad(total)(np.zeros((2, 2)))).all()
    assert {str(one.message).partition(":")[0] for one in caught} == {
        "forward_dynamics",
        "forward_dynamics_vjp",
    }


def test_compiled_functions_that_ran_before_fail_with_the_same_message(jax: Any) -> None:
    """JAX raises one of two classes then."""
    run = jax.jit(made("double_pendulum", derivatives=False, on_status="raise").forward_dynamics)
    state = [jax.numpy.asarray(one) for one in np.zeros((3, 2))]
    for _ in range(3):
        run(*state).block_until_ready()
    message = r"FAILED_PRECONDITION: forward_dynamics: the pivot of .A. at freedom .* x\[0\] is nan"
    with pytest.raises((jax.errors.JaxRuntimeError, ValueError), match=message):
        run(state[0] * np.nan, *state[1:]).block_until_ready()


def test_loads_on_bodies_that_take_none(satellite: Any, jax: Any) -> None:
    x, y, tau = state(satellite)
    (row, *_) = satellite.library.source.model.unloaded("body")
    force = np.zeros((3, 3))
    force[row, 1] = 1.0
    with pytest.raises(
        jax.errors.JaxRuntimeError, match=f"force: row {row} is not zero, but body .* takes no loads"
    ):
        jax.jit(satellite.forward_dynamics)(x, y, tau, force).block_until_ready()


# Bad input


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ((np.zeros(3), np.zeros(2)), ArrayError, r"^x: expected shape \(..., 2\), got \(3,\)\.$"),
        ((np.zeros(2),), ArrayError, r"^y: missing, but the result depends on this input\."),
        (
            (np.zeros((4, 2)), np.zeros((3, 2))),
            ArrayError,
            r"leading axes do not fit together: .*x \(4, 2\), y \(3, 2\)",
        ),
        (([["a", "b"]], np.zeros(2)), ArrayError, r"^x: expected real numbers, got an array of <U1\.$"),
        (([[1.0], [1.0, 2.0]], np.zeros(2)), ArrayError, r"^x: the rows have different lengths\.$"),
        (
            (np.zeros(2), np.zeros(2) * 1j),
            ArrayError,
            r"^y: expected real numbers, got an array of complex128\.$",
        ),
        (
            (*np.zeros((5, 2)), 1, 2),
            ArrayError,
            r"7 arguments without a name; there are x, y, tau, force, torque\.$",
        ),
        (
            (*np.zeros((3, 2)), np.zeros((2, 3))),
            ArrayError,
            r"^force: nothing in system 'double_pendulum' takes it\.",
        ),
    ],
)
def test_wrong_arguments(pendulum: Any, given: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message) as caught:
        pendulum.forward_dynamics(*given)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"parameters": {"m3": 1.0}}, ModelError, "unknown parameter 'm3'"),
        ({"parameters": np.ones(4)}, ArrayError, r"^parameters: expected shape \(..., 5\), got \(4,\)\.$"),
        (
            {"paramters": np.ones(5)},
            ArrayError,
            r"^paramters: there is no such argument\. Did you mean 'parameters'\?$",
        ),
        ({"t": 0.0}, ArrayError, r"^t: forward_dynamics of system 'double_pendulum' does not depend on it\."),
        ({"x": np.zeros(2)}, ArrayError, r"^x: passed twice"),
    ],
)
def test_wrong_named_arguments(pendulum: Any, given: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        pendulum.forward_dynamics(np.zeros(2), np.zeros(2), **given)


def test_lists_of_traced_numbers(pendulum: Any, jax: Any) -> None:
    found = jax.grad(lambda q: pendulum.forward_dynamics([q, 0.2], [0.0, q]).sum())(0.3)
    rows = jax.jacfwd(lambda x, y: pendulum.forward_dynamics(x, y).sum(), (0, 1))(
        *np.array([[0.3, 0.2], [0.0, 0.3]])
    )
    assert float(found) == pytest.approx(float(rows[0][0] + rows[1][1]), rel=1e-14)
    with pytest.raises(ArrayError, match="x: the rows have different lengths, or are no numbers"):
        jax.grad(lambda q: pendulum.forward_dynamics([q, [0.2]], [0.0, q]).sum())(0.3)
    with pytest.raises(ArrayError, match="x: masked arrays have no meaning here"):
        pendulum.forward_dynamics(np.ma.masked_array(np.zeros(2), [True, False]), np.zeros(2))
    with pytest.raises(ArrayError, match=r"x: expected real numbers, got an array of bool"):
        pendulum.forward_dynamics(jax.numpy.zeros(2) > 0, np.zeros(2))


def test_wrong_motions(pendulum: Any, satellite: Any, jax: Any) -> None:
    with pytest.raises(
        ArrayError, match=r"^state: expected shape \(..., 4\), \{x\} then \{y\}, got \(3,\)\.$"
    ):
        pendulum.state_rates(np.zeros(3))
    with pytest.raises(ArrayError, match=r"^tau: expected shape \(2,\) or \(10, 2\), got \(9, 2\)\.$"):
        pendulum.rollout(np.zeros(2), np.zeros(2), np.zeros((9, 2)), steps=10, step=0.1)
    with pytest.raises(
        ArrayError, match=r"^x: expected shape \(2,\), got \(4, 2\)\. For many use jax\.vmap\.$"
    ):
        pendulum.rollout(np.zeros((4, 2)), np.zeros((4, 2)), steps=10, step=0.1)
    for steps in (-1, 2.5, True, "10", None):
        with pytest.raises(OptionError, match=r"steps: .* is no whole number from 0 on\."):
            pendulum.rollout(np.zeros(2), np.zeros(2), steps=steps, step=0.1)
    with pytest.raises(OptionError, match=r"steps: .* is no whole number from 0 on\."):
        jax.jit(lambda steps: pendulum.rollout(np.zeros(2), np.zeros(2), steps=steps, step=0.1))(3)
    with pytest.raises(ArrayError, match=r"step: expected one number for all steps, got shape \(3,\)\."):
        pendulum.rollout(np.zeros(2), np.zeros(2), steps=3, step=np.full(3, 0.1))
    x, _ = pendulum.rollout(np.zeros(2), np.zeros(2), steps=jax.numpy.array(3), step=0.1)
    assert x.shape == (4, 2)
    with pytest.raises(OptionError, match="was built without the output 'step_euler'"):
        pendulum.step(np.zeros(2), np.zeros(2), step=0.1, method="euler")
    with pytest.raises(OptionError, match="unknown method 'rk45'"):
        pendulum.step(np.zeros(2), np.zeros(2), step=0.1, method="rk45")
    with pytest.raises(AttributeError, match="was built without the output 'momentum'"):
        pendulum.momentum  # noqa: B018
    with pytest.raises(
        AttributeError, match=r"no output 'foward_dynamics'\. Did you mean 'forward_dynamics'"
    ):
        pendulum.foward_dynamics  # noqa: B018


def test_wrong_choices(jax: Any) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    pairs = Variant(precision="double-double", storage="double-double")
    for given, message in (
        ({"outputs": "rollout_rk4"}, "Take step_rk4, and call rollout"),
        ({"outputs": "mass"}, "unknown output 'mass'"),
        (
            {"tier": pairs},
            "no numbers in double-double",
        ),
        ({"on_status": "nan"}, "unknown on_status 'nan'"),
    ):
        with pytest.raises(OptionError, match=message):
            functions(system, **given)
    with pytest.raises(OptionError, match="is no system and no library"):
        functions("double_pendulum")
    with pytest.raises(OptionError, match="Build it with parameters_by_state=True"):
        functions(kg.build(system, ("mass_matrix",), flags=QUICK))
    with (
        rounding(jax),
        pytest.raises(OptionError, match=r'jax_enable_x64", True\) first, or build with'),
    ):
        functions(system)


def test_numbers_of_64_bits_switched_off_later(pendulum: Any, jax: Any) -> None:
    with rounding(jax), pytest.raises(OptionError, match="which JAX rounds to 32"):
        pendulum.forward_dynamics(np.zeros(2), np.zeros(2))


# Several models, threads, processes


def test_two_models_of_the_same_name(jax: Any) -> None:
    system = kg.load(MODELS / "double_pendulum.toml")
    other = replace(system, gravity=(1.62, 0.0, 0.0))
    first, second = (functions(one, flags=QUICK, derivatives=False) for one in (system, other))
    x, y = np.array([0.3, 0.1]), np.zeros(2)
    both = jax.jit(lambda x: (first.forward_dynamics(x, y), second.forward_dynamics(x, y)))(x)
    for one, found in zip((first, second), both, strict=True):
        np.testing.assert_array_equal(found, one.library.forward_dynamics(x, y))
    assert not np.allclose(*both)


def test_threads_share_functions(pendulum: Any, jax: Any) -> None:
    compiled = jax.jit(pendulum.forward_dynamics)
    given = [state(pendulum, seed, 50) for seed in range(16)]
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda one: compiled(*one), given))
    for one, result in zip(given, found, strict=True):
        np.testing.assert_array_equal(result, pendulum.library.forward_dynamics(*one))


CHILD = """
import pickle, sys
import jax, numpy as np
jax.config.update("jax_enable_x64", True)
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
functions = pickle.loads(open(sys.argv[1], "rb").read())
x = np.array([0.3, 0.1])
found = jax.jit(lambda x: functions.forward_dynamics(x, np.zeros(2)))(x)
assert (found == functions.library.forward_dynamics(x, np.zeros(2))).all()
print(*found)
"""


def test_other_processes_take_functions_and_compiled_code(pendulum: Any, tmp_path: Any) -> None:
    (tmp_path / "functions.pickle").write_bytes(pickle.dumps(pendulum))
    command = [sys.executable, "-c", CHILD, str(tmp_path / "functions.pickle")]
    cache = {"JAX_COMPILATION_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(ROOT)}
    first = run(*command, folder=tmp_path, **cache)
    assert list((tmp_path / "cache").iterdir()), "JAX has kept nothing on disk"
    assert run(*command, folder=tmp_path, **cache) == first


def test_a_library_becomes_functions(pendulum: Any) -> None:
    again = functions(pendulum.library)
    assert again.library.path == pendulum.library.path
    assert repr(again) == repr(pendulum)
    given = state(pendulum)
    np.testing.assert_array_equal(again.forward_dynamics(*given), pendulum.forward_dynamics(*given))


@pytest.mark.parametrize("compiler", C)
@pytest.mark.parametrize("model", ["double_pendulum", "satellite"])
def test_handlers_compile_without_warnings(compiler: str, model: str, tmp_path: Any) -> None:
    system = kg.load(MODELS / f"{model}.toml")
    source = kg.generate(
        system, ("forward_dynamics", "step_rk4_derivatives"), parameters_by_state=model[0] == "d"
    )
    handlers = importlib.import_module("kanegen.interop.jax.facade").facade(source).files
    own = {name: text for name, text in handlers.items() if not name.startswith("xla/")}
    write(dict(source.files) | own, tmp_path / "own")
    write({name: text for name, text in handlers.items() if name not in own}, tmp_path / "jaxlib")
    run(
        *C[compiler],
        "-std=c99",
        "-O2",
        *WARNINGS,
        "-isystem",
        "../jaxlib",
        "-c",
        f"{source.model.name}_jax.c",
        folder=tmp_path / "own",
    )


def test_slopes_name_outputs_that_there_are(pendulum: Any) -> None:
    for name in (*OUTPUTS, *INTEGRATORS):
        for one in slopes(name, pendulum.library.source):
            assert one.function in {*OUTPUTS, *INTEGRATORS}
            assert all(part.stop > part.start for part in one.columns.values())


def test_the_example(tmp_path: Any) -> None:
    printed = run(
        sys.executable, ROOT / "examples" / "learning_parameters.py", folder=tmp_path, PYTHONPATH=str(ROOT)
    )
    lines = re.findall(r"= ([\d.]+) kg with a standard error of ([\d.]+) kg; true is ([\d.]+) kg", printed)
    assert len(lines) == 2
    for found, error, true in lines:
        assert abs(float(found) - float(true)) < 4 * float(error) < 0.01
    assert (tmp_path / "learning_parameters.svg").read_text().count("<path") > 12


def test_the_page(jax: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    namespace: dict[str, Any] = {}
    for block in blocks("embedding/jax", "python"):
        exec(block, namespace)
    assert np.isfinite(namespace["ydot"]).all()
    assert namespace["by_tau"].shape == (100, 2)
    assert namespace["several"].shape == (50, 2)
    assert "FAILED_PRECONDITION: forward_dynamics: the pivot of [A]" in capsys.readouterr().out
