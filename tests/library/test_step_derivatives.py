"""Derivatives of a step: complex steps through the method with the NumPy reference, and every form of the C.

A complex step has no error but the rounding of the reference, which computes no derivative: it takes complex
states, and its imaginary part is the derivative (Squire and Trapp 1998).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.options import Variant
from kanegen.recursion.outputs import METHODS
from tests.support.c_compilers import WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.complex_steps import STEP, dynamics, rates_of, state
from tests.support.orientation_trees import KINDS, tree_of_kind
from tests.support.paths import MODELS

QUICK = "-O1 -ffp-contract=off"
OUTPUT = "step_rk4_derivatives"
DIFFERENTIATED = [name for name, method in METHODS.items() if method.has_derivatives]
OUTPUTS = tuple(METHODS[name].derivatives for name in DIFFERENTIATED)
LENGTH = 0.02


def step(system: kg.System, method: str, given: dict[str, Any]) -> Any:
    """Return {x, y} after a step, with [A] and {f} of the reference; quaternions keep their lengths."""
    start = np.concatenate([given["x"], given["y"]])
    m = len(system.coordinates)

    def rates(now: Any) -> Any:
        matrix, forcing = dynamics(system, given | {"x": now[:m], "y": now[m:]})
        return np.concatenate(
            [rates_of(system, now[:m], now[m:]), np.linalg.solve(matrix, forcing + given["tau"])]
        )

    end = start + change(method, rates, start, m)
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.coordinates == "quaternion":
            places = [i for i, c in enumerate(system.coordinates) if c.body == k and not c.is_translation]
            squares = [(one[places] ** 2).sum() for one in (start, end)]
            end[places] = end[places] * np.sqrt(squares[0] / squares[1])
    return end


def change(method: str, rates: Callable[[Any], Any], start: Any, m: int) -> Any:
    """Return the change of a state in a step of one of `METHODS`, before quaternions get their lengths."""
    h, one = LENGTH, rates(start)
    match method:
        case "euler":
            return h * one
        case "semi_implicit_euler":
            faster = np.concatenate([start[:m], (start + h * one)[m:]])
            return h * np.concatenate([rates(faster)[:m], one[m:]])
        case "implicit_midpoint":
            for _ in range(40):  # a contraction by about 1/10, so that nothing is left of the start
                one = rates(start + h / 2 * one)
            return h * one
    two = rates(start + h / 2 * one)
    three = rates(start + h / 2 * two)
    return h / 6 * (one + 2 * two + 2 * three + rates(start + h * three))


def expected(system: kg.System, method: str, given: dict[str, Any]) -> tuple[Any, Any]:
    """Return the end of a step and its derivatives by {x}, {y} and {tau}."""
    columns = []
    for name in ("x", "y", "tau"):
        for place in range(len(given[name])):
            moved = {one: given[one].astype(complex) for one in ("x", "y", "tau")}
            moved[name][place] += 1j * STEP
            columns.append(step(system, method, given | moved).imag / STEP)
    return step(system, method, given), np.stack(columns, axis=1)


@pytest.mark.parametrize("kind", slow_except(KINDS[:3], "quaternions"))
@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_complex_steps_through_the_reference(seed: int, kind: str) -> None:
    system = tree_of_kind(kind, seed)
    library = built(system)
    given = state(system, seed)
    loads = {name: given[name] for name in ("force", "torque")}
    state_before = given["x"], given["y"], given["tau"]
    m, n = len(system.coordinates), len(system.freedoms)
    # [A]^-1 of the reference is a solution with a matrix whose condition is that of the tree.
    condition = np.linalg.cond(dynamics(system, given)[0])
    room = 1e-14 * max(condition, 1e3)
    for method in DIFFERENTIATED:
        end, slopes = expected(system, method, given)
        found = library.step_derivatives(*state_before, step=LENGTH, method=method, **loads)
        assert found.A.shape == (m + n, m + n)
        assert found.B.shape == (m + n, n)
        assert np.abs(np.concatenate([found.x, found.y]) - end).max() <= room * np.abs(end).max(), method
        for part, right in ((found.A, slopes[:, : m + n]), (found.B, slopes[:, m + n :])):
            assert np.abs(part - right).max() <= room * np.abs(right).max(), method


@pytest.fixture(scope="module")
def crane() -> kg.Library:
    system = kg.load(MODELS / "gantry_crane.toml")
    return kg.build(
        system, ("step_rk4", "step_implicit_midpoint", *OUTPUTS), flags=QUICK, parameters_by_state=True
    )


@cache
def built(system: kg.System) -> kg.Library:
    """Return a library of nothing but the derivatives of steps."""
    return kg.build(system, OUTPUTS, functions=OUTPUTS, flags="-O0 -ffp-contract=off")


def states(library: kg.Library, count: int) -> tuple[Any, Any, Any]:
    return tuple(np.random.default_rng(5).normal(size=(3, count, library.n)))


def test_parameters_by_differences_in_long_double(crane: kg.Library) -> None:
    """Central differences over 2^-19 of steps in 64 bits are off by about 1e-12, and by their rounding."""
    system = kg.load(MODELS / "gantry_crane.toml")
    wide = kg.build(system, "step_rk4", tier=Variant("long double"), flags=QUICK)
    x, y, tau = (one[0] for one in states(crane, 1))
    usual = np.array(list(crane.parameters.values()), np.longdouble)
    found = crane.step_derivatives(x, y, tau, step=LENGTH, method="rk4")
    assert found.P.shape == (2 * crane.n, len(usual))
    for place in range(len(usual)):
        ends = []
        for sign in (1, -1):
            moved = usual.copy()
            moved[place] += sign * np.longdouble(2.0**-20)
            ends.append(np.concatenate(wide.step(x, y, tau, step=LENGTH, parameters=moved)))
        slope = (ends[0] - ends[1]) / np.longdouble(2.0**-19)
        rounding = 8 * 2.0**-64 * np.abs(ends[0]).max() * 2.0**19
        assert np.abs(found.P[:, place] - slope).max() <= 1e-11 * np.abs(slope).max() + rounding


def test_a_batch_has_the_bits_of_its_states(crane: kg.Library) -> None:
    x, y, tau = states(crane, 13)
    usual = np.array(list(crane.parameters.values()))
    sets = usual * np.random.default_rng(6).uniform(0.8, 1.2, (13, len(usual)))
    for method in DIFFERENTIATED:
        many = crane.step_derivatives(x, y, tau, step=LENGTH, method=method, parameters=sets)
        for i in range(0, 13, 3):
            one = crane.step_derivatives(x[i], y[i], tau[i], step=LENGTH, method=method, parameters=sets[i])
            for name in ("x", "y", "A", "B", "P"):
                assert (getattr(many, name)[i] == getattr(one, name)).all(), (method, name)
        if METHODS[method].functions[0] in crane.outputs:
            ends = crane.step(x, y, tau, step=LENGTH, method=method, parameters=sets)
            assert np.abs(many.x - ends[0]).max() <= 1e-15 * np.abs(ends[0]).max()
            assert np.abs(many.y - ends[1]).max() <= 1e-14 * np.abs(ends[1]).max()


def test_a_longer_quaternion_is_longer_after_the_step_and_changes_nothing_else() -> None:
    system = tree_of_kind("quaternions", 1)
    given = state(system, 1)
    found = built(system).step_derivatives(given["x"], given["y"], given["tau"], step=LENGTH, method="rk4")
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.coordinates == "quaternion":
            places = [i for i, c in enumerate(system.coordinates) if c.body == k and not c.is_translation]
            along = found.A[:, places] @ given["x"][places]
            along[places] -= found.x[places]
            assert np.abs(along).max() <= 1e-13 * np.abs(found.A).max()
            # No other change of the start makes it longer.
            longer = found.x[places] @ found.A[places]
            longer[places] -= given["x"][places]
            assert np.abs(longer).max() <= 1e-13 * np.abs(found.A[places]).max()


@pytest.mark.parametrize("precision", slow_except(("float", "long double"), "float"))
def test_other_precisions(precision: str, crane: kg.Library) -> None:
    system = kg.load(MODELS / "gantry_crane.toml")
    library = kg.build(system, OUTPUT, tier=Variant(precision), flags=QUICK)
    x, y, tau = states(crane, 5)
    found = library.step_derivatives(x, y, tau, step=LENGTH)
    right = crane.step_derivatives(x, y, tau, step=LENGTH, method="rk4")
    size = np.abs(right.A).max()
    assert np.abs(found.A - right.A).max() <= (1e-4 if precision == "float" else 1e-13) * size
    assert found.A.dtype == np.dtype({"float": np.float32}.get(precision, np.longdouble))


def test_what_is_missing_is_said(crane: kg.Library) -> None:
    x, y, tau = states(crane, 3)
    x[1, 0] = np.nan
    with pytest.warns(kg.KanegenWarning, match=r"^step_rk4_derivatives: in 1 of 3 .* x\[0\] is nan"):
        found = crane.step_derivatives(x, y, tau, step=LENGTH, method="rk4")
    assert np.isnan(found.A[1]).all()
    assert np.isfinite(found.A[[0, 2]]).all()
    plain = kg.build(kg.load(MODELS / "gantry_crane.toml"), "step_rk4", flags=QUICK)
    with pytest.raises(kg.OptionError, match=r"built without the output 'step_rk4_derivatives'"):
        plain.step_derivatives(x, y, tau, step=LENGTH)
    without = [name for name, method in METHODS.items() if not method.has_derivatives]
    for name in without:
        with pytest.raises(kg.OptionError, match=f"method '{name}': no derivatives"):
            crane.step_derivatives(x, y, tau, step=LENGTH, method=name)


@pytest.mark.parametrize("compiler", slow_except(C, "gcc"))
@pytest.mark.parametrize("kind", slow_except(("double_pendulum", "satellite"), "satellite"))
def test_the_c_is_clean(kind: str, compiler: str, tmp_path: Any) -> None:
    source = kg.generate(kg.load(MODELS / f"{kind}.toml"), OUTPUTS, functions=OUTPUTS)
    folder = source.write(tmp_path / "out")
    for file in (f"{kind}.c", f"{kind}_batch.c", "main.c"):
        run(*C[compiler], "-std=c99", "-O1", *WARNINGS, "-c", file, "-o", "object.o", folder=folder)
