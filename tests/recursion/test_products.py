"""Products with derivatives: against differences in 60 digits, and complex steps through the reference."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import kanegen as kg
from benchmarks import models
from benchmarks.derivatives import products
from kanegen.compiler import compile_module
from kanegen.options import Variant
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import PARAMETERS, PREPARED, Module
from kanegen.recursion.outputs import OUTPUTS, PRODUCTS
from tests.support.cases import slow_except
from tests.support.complex_steps import STEP, dynamics, state
from tests.support.orientation_trees import ANGULAR_VELOCITY, close, mixed, values, with_quaternions
from tests.support.random_trees import everything

BASES = ("forcing", "inverse_dynamics", "forward_dynamics")
ENDINGS = ("", "_jvp", "_vjp", "_hvp")

DIGITS = mpmath.MPContext()
DIGITS.dps = 60

LENGTH = DIGITS.mpf(10) ** -20
"""Length of a difference, whose truncation error is about its square."""

SYSTEMS = {
    "rates": mixed,
    "angular velocities": lambda seed: mixed(seed).with_speeds(ANGULAR_VELOCITY),
    "quaternions": with_quaternions,
    "everything": lambda seed: everything(seed, 2),
}

Numbers = dict[str, list[Any]]
"""Elements of input arrays by name."""


@cache
def compiled(kind: str, seed: int, base: str) -> tuple[kg.System, Module]:
    """Return a system, and the programs of an output and of its products, with constants of 32 digits."""
    system, wide = SYSTEMS[kind](seed), Variant(precision="double-double")
    return system, compile_module(system, [f"{base}{ending}" for ending in ENDINGS], variant=wide).module


def random_inputs(module: Module, system: kg.System, seed: int) -> Numbers:
    """Return random numbers for all inputs, and the parameters of the system."""
    rng = np.random.default_rng(seed)
    arrays = {array.name: array for program in module.functions.values() for array in program.inputs}
    found = {
        name: [DIGITS.mpf(v) for v in rng.uniform(-1, 1, array.size)]
        for name, array in sorted(arrays.items())
        if name != PREPARED
    }
    return found | {PARAMETERS: [DIGITS.mpf(one.value) for one in system.parameters]}


def result(module: Module, name: str, given: Numbers) -> Any:
    """Return an output in 60 digits, as an array."""
    inputs = dict(given)
    if module.prepare is not None:
        inputs |= evaluate(module.prepare, {PARAMETERS: given[PARAMETERS]}, DIGITS, DIGITS.mpf)
    (found,) = evaluate(module.functions[name], inputs, DIGITS, DIGITS.mpf).values()
    return np.array(found)


def moved(given: Numbers, name: str, system: kg.System, length: Any) -> Numbers:
    """Return inputs that are changed along their direction."""
    product, found = PRODUCTS[name], dict(given)
    for array, places in product.columns_of(system).items():
        if array in given:
            along = given[product.direction][places]
            found[array] = [value + length * one for value, one in zip(given[array], along, strict=True)]
    return found


def difference(module: Module, of: str, system: kg.System, name: str, given: Numbers) -> Any:
    """Return the central difference of an output along the direction of a product."""
    ahead, behind = (result(module, of, moved(given, name, system, s * LENGTH)) for s in (1, -1))
    return (ahead - behind) / (2 * LENGTH)


def agree(found: Any, expected: Any) -> None:
    """Require that two arrays agree to 25 digits of the largest element."""
    assert max(abs(found - expected)) <= DIGITS.mpf(10) ** -25 * max([DIGITS.mpf(1), *abs(expected)])


CASES = [(kind, seed, base) for kind in SYSTEMS for seed in (1, 2, 3, 4) for base in BASES]
USUAL = ("rates", 1, "forward_dynamics"), ("everything", 2, "inverse_dynamics")


@pytest.mark.parametrize("case", slow_except(CASES, *USUAL))
def test_products_are_differences_in_many_digits(case: tuple[str, int, str]) -> None:
    """By all variables at once, run-time parameters among them; Hessians are symmetric."""
    system, module = compiled(*case)
    base = case[2]
    given = random_inputs(module, system, case[1])
    jvp, vjp, hvp = (f"{base}{ending}" for ending in ENDINGS[1:])
    along = result(module, jvp, given)
    agree(along, difference(module, base, system, jvp, given))
    gradient = result(module, vjp, given)
    direction = np.array(given[PRODUCTS[jvp].direction])
    agree(np.array([gradient @ direction]), np.array([np.array(given["weights"]) @ along]))
    curvature = result(module, hvp, given)
    agree(curvature, difference(module, vjp, system, hvp, given))
    other = np.random.default_rng(0).uniform(-1, 1, len(direction))
    mirrored = result(module, hvp, given | {PRODUCTS[hvp].direction: [*map(DIGITS.mpf, other)]})
    agree(np.array([other @ curvature]), np.array([direction @ mirrored]))


@pytest.mark.parametrize(
    "case",
    slow_except([(kind, seed) for kind in [*SYSTEMS][:3] for seed in (1, 2)], ("quaternions", 1)),
)
def test_gradients_agree_with_complex_steps(case: tuple[str, int]) -> None:
    """Of accelerations, through the reference, which shares no code."""
    kind, seed = case
    system = SYSTEMS[kind](seed)
    inputs = state(system, seed)
    n, rng = len(system.freedoms), np.random.default_rng(seed)
    weights = rng.normal(size=n)

    def weighted(changed: dict[str, np.ndarray]) -> Any:
        matrix, forcing = dynamics(system, changed)
        return weights @ np.linalg.solve(matrix, forcing + changed["tau"])

    expected = []
    for array in ("x", "y", "tau"):
        for k in range(len(inputs[array])):
            changed = inputs[array].astype(complex)
            changed[k] += 1j * STEP
            expected.append(weighted(inputs | {array: changed}).imag / STEP)
    (found,) = values(system, inputs | {"weights": weights}, "forward_dynamics_vjp").values()
    close(found[: len(expected)], np.array(expected), 1e-11)


def test_arrays_and_columns() -> None:
    """Every variable has a place, in the direction and in the gradient; parameters come last."""
    system = everything(2, 2)
    for name in PRODUCTS:
        columns = PRODUCTS[name].columns_of(system)
        assert [part.start for part in columns.values()] == [0, *(p.stop for p in columns.values())][:-1]
        assert [*columns][-1] == PARAMETERS
        width = [*columns.values()][-1].stop
        kind = PRODUCTS[name].kind
        array = OUTPUTS[name].array(system)
        assert array.shape == ((width,) if kind.is_weighted else (len(system.freedoms),))


@pytest.mark.parametrize("name", slow_except(("ur5", "panda", "hyq", "talos_reduced", "eight_body"), "ur5"))
def test_the_cost_of_gradients_and_of_products_with_hessians(name: str) -> None:
    """With the value of {ydot}, at most 2.4 and 6.5 times the operations of {ydot} alone.

    Along a direction eight bodies take more, because their solver itself is differentiated.
    """
    ratios = products(models.system(name))
    assert ratios["jvp"] <= (2.6 if name == "eight_body" else 2.4)
    assert ratios["vjp"] <= 2.4
    assert ratios["hvp"] <= 6.5
