"""Angular velocities as generalized speeds: values against truth, the reference and the other form."""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.measure import truth as certified
from kanegen.model.coordinates import Freedom
from kanegen.program.evaluate import evaluate
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from kanegen.symbolic import derive
from tests.recursion.test_recursive import bushes, gimbals, hinges
from tests.support import systems

SPINS = "angular_velocity"
OUTPUTS = (
    "mass_matrix",
    "forcing",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "momentum",
    "mass_center",
    "body_poses",
    "coordinate_rates",
)
ARRAYS = {"mass_matrix": "A", "forcing": "f", "inverse_dynamics": "generalized_force"}
ARRAYS |= {"forward_dynamics": "acceleration"}


@cache
def mixed(seed: int) -> kg.System:
    """A random tree in which about half of the bodies have three free angles; speeds are angle rates."""
    rng = np.random.default_rng(seed)
    bodies = int(rng.integers(1, 5))
    free = systems.random_free(rng, bodies, 0.4)
    free[rng.random(bodies) < 0.5, :3] = True
    free[rng.integers(bodies), :3] = True
    return systems.random_system(rng, bodies, free=free, loads=True, orientations=bool(seed % 3))


def state(system: kg.System, seed: int = 0) -> dict[str, np.ndarray]:
    """Everything that a function may read, loads included."""
    rng = np.random.default_rng(seed)
    n, bodies = len(system.freedoms), system.number_of_bodies
    values = {name: rng.normal(size=n) for name in ("x", "y", "ydot", "tau")}
    for k, body in enumerate(system.bodies, start=1):
        if body.joint.has_free_orientation:  # away from where the rates of the angles do not exist
            values["x"][system.places[Freedom(k, 1)]] = rng.uniform(-1.2, 1.2)
    return values | {name: rng.normal(size=(bodies, 3)) for name in ("force", "torque")}


def values(system: kg.System, given: dict[str, np.ndarray], *outputs: str) -> dict[str, np.ndarray]:
    """Results of the program that becomes C."""
    program = compile_module(system, outputs).module.functions
    function = program["evaluate" if len(outputs) > 1 else outputs[0]]
    found = evaluate(function, {name: value.ravel() for name, value in given.items()}, np)
    return {name: np.array(value, dtype=float) for name, value in found.items()}


def maps(system: kg.System, given: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """[T] and its rate with {y} = [T]{xdot}, by Eq. (8) as it stands, and {xdot}."""
    n = len(system.freedoms)
    whole, rate, xdot = np.eye(n), np.zeros((n, n)), given["y"].copy()
    for k, body in enumerate(system.bodies, start=1):
        if not body.joint.speeds_are_rates:
            place = [system.places[Freedom(k, i)] for i in range(3)]
            (s2, s3), (c2, c3) = np.sin(given["x"][place[1:]]), np.cos(given["x"][place[1:]])
            block = np.array([[c2 * c3, s3, 0.0], [-c2 * s3, c3, 0.0], [s2, 0.0, 1.0]])
            _, d2, d3 = xdot[place] = np.linalg.solve(block, given["y"][place])
            whole[np.ix_(place, place)] = block
            rate[np.ix_(place, place)] = [
                [-s2 * c3 * d2 - c2 * s3 * d3, c3 * d3, 0.0],
                [s2 * s3 * d2 - c2 * c3 * d3, -s3 * d3, 0.0],
                [c2 * d2, 0.0, 0.0],
            ]
    return whole, rate, xdot


def close(found: np.ndarray, expected: np.ndarray, factor: float = 1e-12) -> None:
    found, expected = np.ravel(found), np.ravel(expected)
    assert np.abs(found - expected).max() <= factor * max(np.abs(expected).max(), 1e-3)


@pytest.mark.parametrize("seed", range(5))
def test_truth_and_reference(seed: int) -> None:
    """Two algorithms in ball arithmetic, the notes' equations in NumPy, and the recursion."""
    system = mixed(seed).with_speeds(SPINS)
    given = state(system, seed)
    exact = certified.truth(system, **given, outputs=tuple(ARRAYS))
    found = values(system, given, *ARRAYS)
    for output, array in ARRAYS.items():
        close(found[array], exact[output].value)
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, given["x"]), exact["mass_matrix"].value)
    close(reference.forcing(system, given["x"], given["y"], **loads), exact["forcing"].value)


@pytest.mark.parametrize("seed", range(6))
def test_the_form_in_angle_rates_mapped(seed: int) -> None:
    """[A] = [T]^-T [A'] [T]^-1, {f} = [T]^-T ({f'} + [A'][T]^-1 [Tdot]{xdot}); energy and poses stay."""
    rates = mixed(seed)
    spins = rates.with_speeds(SPINS)
    given = state(spins, seed)
    whole, rate, xdot = maps(spins, given)
    back = np.linalg.inv(whole)
    xddot = back @ (given["ydot"] - rate @ xdot)
    theirs = values(rates, given | {"y": xdot, "ydot": xddot, "tau": whole.T @ given["tau"]}, *OUTPUTS)
    ours = values(spins, given, *OUTPUTS)
    n = len(xdot)
    matrix = theirs["A"].reshape(n, n)
    close(ours["A"], back.T @ matrix @ back)
    close(ours["f"], back.T @ (theirs["f"] + matrix @ back @ rate @ xdot))
    close(ours["generalized_force"], back.T @ theirs["generalized_force"])
    close(ours["acceleration"], whole @ theirs["acceleration"] + rate @ xdot, 1e-11)
    close(ours["xdot"], xdot)
    close(theirs["xdot"], xdot, 0.0)
    for array in ("kinetic_energy", "momentum", "mass_center", "body_poses"):
        close(ours[array], theirs[array])
    close(ours["kinetic_energy"], given["y"] @ ours["A"].reshape(n, n) @ given["y"] / 2)


@pytest.mark.parametrize("intermediates", [False, True])
def test_the_literal_equations(intermediates: bool) -> None:
    free = np.zeros((2, 6), dtype=bool)
    free[0, :3] = free[1, [0, 2, 4]] = True
    rng = np.random.default_rng(3)
    system = systems.random_system(rng, 2, free=free, loads=True, connection=(0, 1)).with_speeds(SPINS)
    given = state(system)
    equations = derive(system, intermediates)
    literal = equations.lambdify()
    ours = values(system, given, "mass_matrix", "forcing")
    close(ours["A"], literal.mass_matrix(given["x"]))
    close(ours["f"], literal.forcing(given["x"], given["y"], given["force"], given["torque"]))
    if not intermediates:
        numbers = dict(zip([*equations.x, *equations.y], [*given["x"], *given["y"]], strict=True))
        found = np.array(equations.xdot.xreplace(numbers).evalf(), dtype=float)
        close(found, maps(system, given)[2])


@pytest.mark.parametrize("precision", ["double", "float"])
def test_regular_at_gimbal_lock(precision: str) -> None:
    """All eight bodies at and near theta2 = +-pi/2: the error does not notice."""
    rng = np.random.default_rng(8)
    free = np.ones((8, 6), dtype=bool)
    tree = systems.random_system(rng, 8, connection=systems.EIGHT_BODY_CONNECTION, free=free, loads=False)
    system = tree.with_speeds(SPINS)
    library = kg.build(system, ("forward_dynamics",), precision=precision)
    middle = [i for i, freedom in enumerate(system.freedoms) if freedom.index == 1]
    distances = [0.0] if precision == "float" else [0.0, 1e-12, 1e-6, 1e-1]
    states = random_states(system, len(distances), 7)
    states.x[:, middle] = np.pi / 2 - np.array(distances)[:, None]
    states.x[:, middle[::2]] *= -1
    measured = certified.measure(system, library, states)["forward_dynamics"]
    roundoff = 2.0**-53 if precision == "double" else 2.0**-24
    assert (measured.kappa_s < 1e6).all()
    assert (measured.normwise <= 80 * 8 * roundoff * measured.chi).all()
    assert measured.within_bound


def test_no_pivot_knows_the_angles() -> None:
    """A ball joint's [A] is the inertia itself, and its {f} the torque and the weight in the body."""
    top = kg.load("models/spinning_top.toml").with_speeds(SPINS)
    counts = compile_module(top, ("mass_matrix",)).operations
    assert counts["sincos"] == counts["add"] == counts["multiply"] == counts["divide"] == 0
    exact = kg.build(top, ("mass_matrix", "forward_dynamics"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        at_lock = exact.forward_dynamics([0.3, np.pi / 2, 0.2], [1.0, 2.0, 3.0])
    assert np.isfinite(at_lock).all()


TREES = {
    "free body": lambda: bushes(1),
    "two free bodies": lambda: bushes(2),
    "eight bodies": lambda: systems.random_system(
        np.random.default_rng(8), 8, connection=systems.EIGHT_BODY_CONNECTION, orientations=False,
        free=np.ones((8, 6), dtype=bool), loads=False, gravity=(0, 0, -9.81),
    ),
    "ball joints": lambda: gimbals(4),
    "turned ball joints": lambda: systems.chain(4, ("theta1", "theta2", "theta3")),
    "turned ball joints that slide": lambda: systems.chain(3, ("theta1", "theta2", "theta3", "s1")),
}  # fmt: skip


@pytest.mark.parametrize("name", TREES)
def test_operations_are_fewer(name: str) -> None:
    rates = TREES[name]()
    spins = rates.with_speeds(SPINS)
    for outputs in (("mass_matrix",), ("forcing",), ("mass_matrix", "forcing"), ("forward_dynamics",)):
        before, after = (compile_module(system, outputs).operations for system in (rates, spins))
        assert after["add"] + after["multiply"] < before["add"] + before["multiply"], outputs
        assert after["sincos"] <= before["sincos"]


def test_what_has_no_three_angles_stays() -> None:
    tree = hinges(6)
    assert tree.with_speeds(SPINS) == tree
    assert kg.generate(tree, speeds=SPINS).files == kg.generate(tree).files


@pytest.mark.parametrize("precision", ["double", "float"])
def test_compare_passes(precision: str) -> None:
    for seed in (1, 4):
        assert kg.compare(mixed(seed), states=50, speeds=SPINS, precision=precision).passed
