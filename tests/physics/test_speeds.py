"""Angular velocities as generalized speeds, compared with truth, the reference and angle rates as speeds."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.measure import truth as certified
from kanegen.reference import equations as reference
from kanegen.reference.states import random_states
from kanegen.symbolic import derive
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.chains import bushes, gimbals, hinges
from tests.support.orientation_trees import ANGULAR_VELOCITY, ARRAYS, angle_state, close, maps, mixed, values

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


@pytest.mark.parametrize("seed", slow_except(range(5), 0, 1))
def test_truth_and_reference(seed: int) -> None:
    """The recursion agrees with two algorithms in ball arithmetic and the notes' equations in NumPy."""
    system = mixed(seed).with_speeds(ANGULAR_VELOCITY)
    given = angle_state(system, seed)
    exact = certified.truth(system, **given, outputs=tuple(ARRAYS))
    found = values(system, given, *ARRAYS)
    for output, array in ARRAYS.items():
        close(found[array], exact[output].value)
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, given["x"]), exact["mass_matrix"].value)
    close(reference.forcing(system, given["x"], given["y"], **loads), exact["forcing"].value)


@pytest.mark.parametrize("seed", slow_except(range(6), 0, 1))
def test_equations_in_angle_rates_transform_to_these(seed: int) -> None:
    """[A] = [T]^-T [A'] [T]^-1, {f} = [T]^-T ({f'} + [A'][T]^-1 [Tdot]{xdot}); energy and poses are equal."""
    rates = mixed(seed)
    by_velocity = rates.with_speeds(ANGULAR_VELOCITY)
    given = angle_state(by_velocity, seed)
    whole, rate, xdot = maps(by_velocity, given)
    back = np.linalg.inv(whole)
    xddot = back @ (given["ydot"] - rate @ xdot)
    theirs = values(rates, given | {"y": xdot, "ydot": xddot, "tau": whole.T @ given["tau"]}, *OUTPUTS)
    ours = values(by_velocity, given, *OUTPUTS)
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


@pytest.mark.parametrize("intermediates", slow_except((False, True), True))
def test_the_literal_equations(intermediates: bool) -> None:
    free = np.zeros((2, 6), dtype=bool)
    free[0, :3] = free[1, [0, 2, 4]] = True
    rng = np.random.default_rng(3)
    system = systems.random_system(rng, 2, free=free, loads=True, connection=(0, 1)).with_speeds(
        ANGULAR_VELOCITY
    )
    given = angle_state(system)
    equations = derive(system, intermediates)
    literal = equations.lambdify()
    ours = values(system, given, "mass_matrix", "forcing")
    close(ours["A"], literal.mass_matrix(given["x"]))
    close(ours["f"], literal.forcing(given["x"], given["y"], given["force"], given["torque"]))
    if not intermediates:
        numbers = dict(zip([*equations.x, *equations.y], [*given["x"], *given["y"]], strict=True))
        found = np.array(equations.xdot.xreplace(numbers).evalf(), dtype=float)
        close(found, maps(system, given)[2])


@pytest.mark.parametrize("precision", slow_except(("double", "float"), "float"))
def test_regular_at_gimbal_lock(precision: str) -> None:
    """Errors are small with all eight bodies at or near theta2 = +-pi/2."""
    rng = np.random.default_rng(8)
    free = np.ones((8, 6), dtype=bool)
    tree = systems.random_system(rng, 8, connection=systems.EIGHT_BODY_CONNECTION, free=free, loads=False)
    system = tree.with_speeds(ANGULAR_VELOCITY)
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


def test_mass_matrix_of_a_ball_joint_is_constant() -> None:
    """[A] of a ball joint is the inertia, so it takes no operations and is regular at gimbal lock."""
    top = kg.load("models/spinning_top.toml").with_speeds(ANGULAR_VELOCITY)
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


@pytest.mark.parametrize("name", slow_except(TREES, "free body", "ball joints"))
def test_operations_are_fewer(name: str) -> None:
    rates = TREES[name]()
    by_velocity = rates.with_speeds(ANGULAR_VELOCITY)
    for outputs in (("mass_matrix",), ("forcing",), ("mass_matrix", "forcing"), ("forward_dynamics",)):
        before, after = (compile_module(system, outputs).operations for system in (rates, by_velocity))
        assert after["add"] + after["multiply"] < before["add"] + before["multiply"], outputs
        assert after["sincos"] <= before["sincos"]


def test_hinges_keep_their_speeds() -> None:
    tree = hinges(6)
    assert tree.with_speeds(ANGULAR_VELOCITY) == tree
    assert kg.generate(tree, speeds=ANGULAR_VELOCITY).files == kg.generate(tree).files


@pytest.mark.parametrize("precision", ["double", "float"])
def test_compare_passes(precision: str) -> None:
    for seed in (1, 4):
        assert kg.compare(mixed(seed), states=50, speeds=ANGULAR_VELOCITY, precision=precision).passed
