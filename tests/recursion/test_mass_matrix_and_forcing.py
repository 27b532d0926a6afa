"""[A] and {f} by recursion: equal to the literal derivation and the reference, and no more operations."""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.program.constants import MULTIPRECISION, as_fraction
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Program
from kanegen.reference import equations as reference
from kanegen.symbolic.symbols import coordinate, force, parameter, speed, torque
from tests.support import systems
from tests.support.cases import slow_among, slow_except
from tests.support.chains import bushes, gimbals, hinges

OUTPUTS = ("mass_matrix", "forcing")


def program(system: kg.System) -> Program:
    return compile_module(system, OUTPUTS).module.functions["evaluate"]


def numeric(system: kg.System, x: np.ndarray, y: np.ndarray, **loads: np.ndarray) -> dict[str, np.ndarray]:
    flat = {name: value.ravel() for name, value in loads.items()}
    results = evaluate(program(system), {"x": x, "y": y, **flat}, np)
    n = len(system.freedoms)
    return {"A": np.reshape(results["A"], (n, n)), "f": np.array(results["f"])}


def small_trees() -> dict[str, kg.System]:
    """Return trees whose literal equations SymPy can simplify; together they use every part of a joint."""
    rod = kg.Body(
        "rod", 0, kg.Parameter("m1", 2.0), ((0.0,) * 3, (0.0, 0.375, 0.0), (0.0, 0.0, 0.375)),
        (kg.Parameter("l1", 0.5), 0.0, 0.0), kg.Joint(free=(False, False, True, False, False, False)),
    )  # fmt: skip
    elbow = kg.Joint((0.75, 0.0, 0.25), ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
                     (True, False, False, False, True, False), (0.0, 0.0, 0.0, 0.0, 0.0, 0.125))  # fmt: skip
    tip = kg.Body("tip", 1, 1.5, ((0.5, 0.0, 0.125), (0.0, 0.75, 0.0), (0.125, 0.0, 1.0)),
                  (0.0, 0.25, 0.5), elbow, loads=True)  # fmt: skip
    tilted = kg.Joint((0.0, 1.0, 0.0), (kg.Parameter("tilt", 0.3), 0.0, 0.0), (False, True) + (False,) * 4)
    gimbal = kg.Joint(free=(True, True, True, False, False, False))
    gravity = (0.0, -1.0, -9.75)
    return {
        "rod_and_tip": kg.System("rod_and_tip", (rod, tip), gravity),
        "tilted": kg.System(
            "tilted", (rod, kg.Body("arm", 1, 1.0, tip.inertia, (0.5, 0.0, 0.0), tilted)), gravity
        ),
        "top": kg.System("top", (kg.Body("top", 0, 1.0, tip.inertia, (0.0, 0.0, 0.5), gimbal),), gravity),
    }


@pytest.mark.parametrize("name", slow_among(small_trees(), "top"))
def test_both_forms_are_equal_symbolically(name: str) -> None:
    system = small_trees()[name]
    literal = kg.derive(system).closed_form()
    module = compile_module(system, OUTPUTS).module
    symbols = {
        "x": [coordinate(f.body, f.index) for f in system.freedoms],
        "y": [speed(f.body, f.index) for f in system.freedoms],
        "parameters": [parameter(p) for p in system.parameters],
        "force": [force(k, i) for k in range(1, system.number_of_bodies + 1) for i in range(3)],
        "torque": [torque(k, i) for k in range(1, system.number_of_bodies + 1) for i in range(3)],
    }
    if module.prepare:
        symbols |= evaluate(module.prepare, symbols, sympy, fraction)
    recursive = evaluate(module.functions["evaluate"], symbols, sympy, fraction)
    for ours, theirs in zip(recursive["A"] + recursive["f"], [*literal.A, *literal.f], strict=True):
        assert sympy.simplify(sympy.expand(ours - rational(theirs))) == 0


def fraction(number: object) -> sympy.Rational:
    """Return a constant of a program, a number of mpmath or a float, as the fraction that it is."""
    exact = as_fraction(MULTIPRECISION.mpf(number))
    return sympy.Rational(exact.numerator, exact.denominator)


def rational(expression: sympy.Expr) -> sympy.Expr:
    """Return an expression with every float as the fraction that it is."""
    return expression.xreplace(
        {number: sympy.Rational(float(number)) for number in expression.atoms(sympy.Float)}
    )


@pytest.mark.parametrize("seed", slow_except(range(40), *range(3)))
def test_equals_the_reference_on_random_trees(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = systems.random_system(rng, bodies=int(rng.integers(1, 9)))
    n, bodies = len(system.freedoms), system.number_of_bodies
    x, y = rng.normal(size=n), rng.normal(size=n)
    loads = {}
    if any(body.loads for body in system.bodies):
        takes = np.array([body.loads for body in system.bodies])[:, None]
        loads = {name: rng.normal(size=(bodies, 3)) * takes for name in ("force", "torque")}
    ours = numeric(system, x, y, **loads)
    scale = np.abs(reference.mass_matrix(system, x)).max()
    assert np.abs(ours["A"] - reference.mass_matrix(system, x)).max() <= 1e-13 * scale
    f = reference.forcing(system, x, y, **loads)
    assert np.abs(ours["f"] - f).max() <= 1e-12 * max(np.abs(f).max(), scale)


COUNTS = {
    "free_body": (lambda: bushes(1), 188),
    "chain of 2": (lambda: bushes(2), 701),
    "chain of 10": (lambda: bushes(10), 12897),
    "eight_body": (lambda: systems.eight_body(loads=False), 4442),
    "gimbals 10": (lambda: gimbals(10), 7380),
    "hinges 6": (lambda: hinges(6), 856),
    "hinges 20": (lambda: hinges(20), 6148),
}
"""Additions and multiplications of [A] and {f} with every number generic: they may fall, never rise."""


@pytest.mark.parametrize("name", slow_among(COUNTS, "chain of 10", "gimbals 10", "hinges 20"))
def test_operations_do_not_rise(name: str) -> None:
    make, most = COUNTS[name]
    counts = compile_module(make(), OUTPUTS).operations
    assert counts["add"] + counts["multiply"] <= most
    assert counts["divide"] == counts["sqrt"] == counts["prepare"] == 0


def test_both_outputs_share_intermediates() -> None:
    system = systems.eight_body()
    alone = [sum(compile_module(system, (name,)).operations.values()) for name in OUTPUTS]
    assert sum(compile_module(system, OUTPUTS).operations.values()) < sum(alone)


def test_run_time_parameters_cost_no_more_than_numbers() -> None:
    """Everything that depends on parameters alone is in `prepare`."""
    numbers = systems.random_system(np.random.default_rng(5), bodies=3)
    named = kg.System(
        "named",
        tuple(
            kg.Body(
                b.name, b.lower, kg.Parameter(f"m{k}", b.mass), b.inertia,
                tuple(kg.Parameter(f"r{k}{i}", v) for i, v in enumerate(b.mass_center)), b.joint, b.loads,
            )
            for k, b in enumerate(numbers.bodies)
        ),
    )  # fmt: skip
    folded, open_ = compile_module(numbers, OUTPUTS).operations, compile_module(named, OUTPUTS).operations
    for kind in ("add", "multiply", "sincos"):
        assert open_[kind] <= folded[kind] + 3, kind
    assert open_["prepare"] > 0
