"""Prescribed freedoms: every output compared with the same tree with these freedoms free, and textbooks."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.library.native import commands, compilers
from kanegen.model.coordinates import Freedom
from kanegen.program.evaluate import evaluate
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.literal.orientation import skew
from kanegen.symbolic.printing.formats import render
from tests.support.cases import slow_except
from tests.support.orientation_trees import close
from tests.support.prescribed_trees import EQUATIONS, KINDS, POINTS, SAME, Arrays, freed, state, tree, values


def merged(system: kg.System, other: kg.System, given: Arrays) -> Arrays:
    """Return the same state of the tree in which the prescribed freedoms are free."""
    x, y, ydot = np.zeros(len(other.coordinates)), *np.zeros((2, len(other.freedoms)))
    for coordinate, place in other.coordinate_places.items():
        known = system.coordinate_places.get(coordinate)
        freedom = Freedom(coordinate.body, coordinate.index)
        x[place] = (
            given["prescribed"][0, system.prescribed.index(freedom)] if known is None else given["x"][known]
        )
    free, moved = parts(system, other)
    y[free], y[moved] = given["y"], given["prescribed"][1]
    ydot[free], ydot[moved] = given["ydot"], given["prescribed"][2]
    return given | {"x": x, "y": y, "ydot": ydot}


def parts(system: kg.System, other: kg.System) -> tuple[list[int], list[int]]:
    """Return the places of free and of prescribed freedoms in {y} of the tree with all of them free."""
    return [other.places[f] for f in system.freedoms], [other.places[f] for f in system.prescribed]


def partitioned(system: kg.System, other: kg.System, given: Arrays) -> Arrays:
    """Return [A], {f} and what follows from them, by partition of the tree with all freedoms free."""
    free, moved = parts(system, other)
    whole = merged(system, other, given)
    loads = {"force": given["force"], "torque": given["torque"]}
    a = reference.mass_matrix(other, whole["x"])
    f = reference.forcing(other, whole["x"], whole["y"], **loads)
    coupled, own = a[np.ix_(free, moved)], a[np.ix_(free, free)]
    accelerations = given["prescribed"][2]
    forcing = f[free] - coupled @ accelerations
    return {
        "mass_matrix": own,
        "forcing": forcing,
        "inverse_dynamics": own @ given["ydot"] - forcing,
        "forward_dynamics": np.linalg.solve(own, forcing + given["tau"]),
        "prescribed_efforts": coupled.T @ given["ydot"] + a[np.ix_(moved, moved)] @ accelerations - f[moved],
    }


def require_equal(kind: str, seed: int) -> None:
    """Require a partition of [A] and {f}, and equal energies, momentum, poses and points."""
    system = tree(kind, seed)
    other, given = freed(system), state(system, seed)
    free, _ = parts(system, other)
    right = partitioned(system, other, given)
    right |= values(other, merged(system, other, given), *SAME, *POINTS)
    right["point_jacobians"] = right["point_jacobians"][..., free]
    outputs = (*EQUATIONS, *SAME, *POINTS)
    together = values(system, given, *outputs)
    for name in outputs:
        close(together[name], right[name], 1e-10 if name == "forward_dynamics" else 1e-12)
    alone = EQUATIONS[seed % len(EQUATIONS)]
    close(values(system, given, alone)[alone], right[alone], 1e-10)


@pytest.mark.parametrize("kind", slow_except(KINDS, *KINDS[::3]))
def test_outputs_equal_those_of_the_tree_with_these_freedoms_free(kind: str) -> None:
    assert tree(kind, 0).prescribed
    require_equal(kind, 0)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_many_trees(kind: str) -> None:
    seeds = [seed for seed in range(1, 30) if tree(kind, seed).prescribed]
    assert len(seeds) > 15
    for seed in seeds:
        require_equal(kind, seed)


@pytest.mark.parametrize("kind", KINDS)
def test_the_reference(kind: str) -> None:
    """The reference of the prescribed tree equals a partition of that of the tree with all freedoms free."""
    system = tree(kind, 3)
    given = state(system, 3)
    right = partitioned(system, freed(system), given)
    x, y, ydot, prescribed = (given[name] for name in ("x", "y", "ydot", "prescribed"))
    loads = {"force": given["force"], "torque": given["torque"]}
    close(reference.mass_matrix(system, x, prescribed), right["mass_matrix"])
    close(reference.forcing(system, x, y, **loads, prescribed=prescribed), right["forcing"])
    close(reference.prescribed_efforts(system, x, y, ydot, prescribed, **loads), right["prescribed_efforts"])


@pytest.mark.parametrize("solver", ["articulated bodies", "factorisation"])
def test_both_solvers(solver: str) -> None:
    system = tree("slides and hinges", 1)
    given = state(system, 1)
    variant = kg.Variant(solver=solver, refinement=1)
    module = compile_module(system, ("forward_dynamics", "regularity"), variant=variant).module
    inputs = {name: np.ravel(value) for name, value in given.items()}
    found = evaluate(module.functions["evaluate"], inputs, np)
    close(
        np.array(found["acceleration"]), partitioned(system, freed(system), given)["forward_dynamics"], 1e-11
    )
    assert all(0 < value <= 1 + 1e-12 for value in found["regularity"])


def test_a_prescribed_freedom_at_rest_equals_a_locked_one() -> None:
    """With zero rates and accelerations, outputs are those of the tree locked at the prescribed values."""
    system = tree("sequences", 4)
    given = state(system, 4)
    given["prescribed"][1:] = 0
    bodies = list(system.bodies)
    for freedom, value in zip(system.prescribed, given["prescribed"][0], strict=True):
        body = bodies[freedom.body - 1]
        locked, prescribed = list(body.joint.locked), list(body.joint.prescribed)
        locked[freedom.index], prescribed[freedom.index] = float(value), False
        joint = replace(body.joint, locked=tuple(locked), prescribed=tuple(prescribed))
        bodies[freedom.body - 1] = replace(body, joint=joint)
    locked = replace(system, bodies=tuple(bodies))
    outputs = (*EQUATIONS[:-1], *SAME, *POINTS)
    right = values(locked, given, *outputs)
    for name, found in values(system, given, *outputs).items():
        close(found, right[name], 1e-11)


def turntable() -> kg.System:
    """A bob of mass m on a rod of length l that swings in a vertical plane, which a shaft turns."""
    length = kg.Parameter("l", 0.7)
    shaft = kg.Joint(free=(False,) * 6, prescribed=(False, False, True, False, False, False), name="shaft")
    swing = kg.Joint(free=(False, True, False, False, False, False), name="swing")
    nothing = np.zeros((3, 3)).tolist()
    bob = kg.Body("bob", 1, kg.Parameter("m", 1.3), nothing, (0, 0, length), swing)
    gravity = (0.0, 0.0, 9.81)  # axis 3 points down
    return kg.System("turntable", (kg.Body("table", 0, 0, nothing, joint=shaft), bob), gravity)


@pytest.fixture(scope="module")
def governor() -> kg.Library:
    outputs = ("mass_matrix", "forcing", "forward_dynamics", "prescribed_efforts", "kinetic_energy")
    return kg.build(turntable(), (*outputs, "potential_energy", "coordinate_rates"))


def test_a_pendulum_on_a_turning_shaft(governor: kg.Library) -> None:
    """Textbook: phi'' = omega^2 sin(phi) cos(phi) - g sin(phi) / l; the torque changes the momentum."""
    m, length, g = 1.3, 0.7, 9.81
    assert governor.prescribed_names == ("shaft",)
    for phi, rate, turn, omega, alpha in np.random.default_rng(1).normal(size=(5, 5)):
        prescribed = np.array([[turn], [omega], [alpha]])
        sine, cosine = np.sin(phi), np.cos(phi)
        found = governor.forward_dynamics([phi], [rate], prescribed=prescribed)
        assert found == pytest.approx([omega**2 * sine * cosine - g / length * sine])
        torque = m * length**2 * (alpha * sine**2 + 2 * omega * rate * sine * cosine)
        assert governor.prescribed_efforts([phi], [rate], found, prescribed=prescribed) == pytest.approx(
            [torque]
        )
        energy = m * length**2 * (rate**2 + (omega * sine) ** 2) / 2
        assert governor.kinetic_energy([phi], [rate], prescribed=prescribed) == pytest.approx(energy)


def test_a_pendulum_on_a_shaken_pivot() -> None:
    """Textbook: l phi'' = -(g + z'') sin(phi); the pivot carries the bob and accelerates it."""
    m, length, g = 0.4, 1.2, 9.81
    system = kg.System.from_arrays(
        connection=[0],
        mass=[m],
        inertia=np.zeros((1, 3, 3)),
        mass_center=[[0, 0, -length]],
        joint_position=np.zeros((1, 3)),
        free=[[False, True, False, False, False, False]],
        prescribed=[[False, False, False, False, False, True]],
    )
    assert system.prescribed_names == ("body1.s3",)
    for phi, rate, z, zdot, zddot in np.random.default_rng(2).normal(size=(5, 5)):
        given = {"x": [phi], "y": [rate], "prescribed": [[z], [zdot], [zddot]], "tau": [0.0]}
        given = {name: np.array(value) for name, value in given.items()}
        (found,) = values(system, given, "forward_dynamics")["forward_dynamics"]
        assert found == pytest.approx(-(g + zddot) / length * np.sin(phi))
        (push,) = values(system, given | {"ydot": np.array([found])}, "prescribed_efforts")[
            "prescribed_efforts"
        ]
        lifted = zddot + length * (found * np.sin(phi) + rate**2 * np.cos(phi))
        assert push == pytest.approx(m * (lifted + g))


def test_energy_is_the_work_of_the_efforts() -> None:
    """The motion is integrated by the method of Runge and Kutta, whose error is far below the tolerance."""
    system = tree("rates", 1)
    outputs = ("forward_dynamics", "prescribed_efforts", "kinetic_energy", "potential_energy")
    library = kg.build(system, outputs)
    p, n = len(system.prescribed), len(system.freedoms)
    size, pace, phase = np.random.default_rng(5).uniform(0.2, 0.9, (3, p))

    def motion(t: float) -> np.ndarray:
        sine, cosine = np.sin(pace * t + phase), np.cos(pace * t + phase)
        return np.array([size * sine, size * pace * cosine, -size * pace**2 * sine])

    def rates(t: float, s: np.ndarray) -> np.ndarray:
        x, y, prescribed = s[:n].copy(), s[n : 2 * n].copy(), motion(t)
        ydot = library.forward_dynamics(x, y, prescribed=prescribed)
        power = library.prescribed_efforts(x, y, ydot, prescribed=prescribed) @ prescribed[1]
        return np.concatenate([y, ydot, [power]])

    def energy(t: float, s: np.ndarray) -> float:
        x, y, prescribed = s[:n].copy(), s[n : 2 * n].copy(), motion(t)
        return float(
            library.kinetic_energy(x, y, prescribed=prescribed)
            + library.potential_energy(x, prescribed=prescribed)
        )

    s, h = np.concatenate([np.full(n, 0.1), np.zeros(n + 1)]), 1 / 1024
    start = energy(0.0, s)
    for step in range(256):
        t = step * h
        one = rates(t, s)
        two = rates(t + h / 2, s + h / 2 * one)
        three = rates(t + h / 2, s + h / 2 * two)
        four = rates(t + h, s + h * three)
        s = s + h / 6 * (one + 2 * two + 2 * three + four)
    change = energy(256 * h, s) - start
    assert abs(s[-1]) > 0.01
    assert s[-1] == pytest.approx(change, rel=1e-7)


def test_one_state_and_many_in_c() -> None:
    """A batch gives the same bits whether each state has its own prescribed motion or all share one."""
    system = tree("slides and hinges", 0)
    outputs = (
        *("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "prescribed_efforts"),
        *("kinetic_energy", "momentum", "body_poses"),
    )
    library = kg.build(system, outputs)
    states = [state(system, seed) for seed in range(11)]
    batch = {name: np.stack([each[name] for each in states]) for name in states[0]}
    many = library.evaluate(**batch)
    shared = library.evaluate(**batch | {"prescribed": states[0]["prescribed"]})
    right = partitioned(system, freed(system), states[3])
    for k in (0, 3, 10):
        one = library.evaluate(**states[k])
        for name in outputs:
            assert getattr(one, name).tobytes() == getattr(many, name)[k].tobytes(), name
    for name in outputs:
        assert getattr(shared, name)[0].tobytes() == getattr(many, name)[0].tobytes(), name
    for name, expected in right.items():
        close(getattr(many, name)[3], expected, 1e-11)


@pytest.mark.parametrize("name", slow_except(("forcing", "forward_dynamics"), "forcing"))
def test_derivatives(name: str) -> None:
    """Derivatives with respect to {x} and {y} equal central differences."""
    system = tree("sequences", 0)
    library = kg.build(system, (name, f"{name}_derivatives"))
    given = state(system, 7)
    given = {key: given[key] for key in ("x", "y", "force", "torque", "prescribed")}
    found = getattr(library, f"{name}_derivatives")(**given)
    columns = library.derivative_columns(f"{name}_derivatives")
    step = 2.0**-17
    for by in ("x", "y"):
        for j, column in enumerate(range(columns[by].start, columns[by].stop)):
            ends = []
            for sign in (1, -1):
                moved = given[by].copy()
                moved[j] += sign * step
                ends.append(getattr(library, name)(**given | {by: moved}))
            close(found[:, column], (ends[0] - ends[1]) / (2 * step), 1e-6)


@pytest.mark.parametrize("kind", slow_except(KINDS, "angular velocities", "sequences"))
def test_the_literal_equations(kind: str) -> None:
    system = tree(kind, 2)
    given = state(system, 2)
    literal = derive(system, intermediates=True).lambdify()
    x, y, prescribed = given["x"], given["y"], given["prescribed"]
    right = values(system, given, "mass_matrix", "forcing")
    close(literal.mass_matrix(x, prescribed=prescribed), right["mass_matrix"])
    close(literal.forcing(x, y, given["force"], given["torque"], prescribed=prescribed), right["forcing"])


def test_the_accelerations_of_the_literal_equations() -> None:
    """Accelerations are the time derivatives of velocities, with all freedoms as functions of time."""
    equations = derive(tree("slides and hinges", 5), intermediates=False)
    columns = [
        equations.x,
        equations.y,
        equations.ydot,
        *(row.T for row in map(equations.prescribed.row, range(3))),
    ]
    values, rates, accelerations = (
        free.col_join(prescribed) for free, prescribed in zip(columns[:3], columns[3:], strict=True)
    )
    state = values.col_join(rates)
    symbols = list(state.col_join(accelerations))
    numbers = dict(zip(symbols, np.random.default_rng(1).normal(size=len(symbols)).tolist(), strict=True))
    body = equations.bodies[-1]
    turning = skew(body.angular_velocity) * body.velocity_of_center
    for velocity, acceleration in (
        (body.angular_velocity, body.angular_acceleration),
        (body.velocity_of_center, body.acceleration_of_center - turning),
    ):
        rate = velocity.jacobian(state) * rates.col_join(accelerations)
        found, right = (np.array(m.xreplace(numbers).evalf(), float) for m in (acceleration, rate))
        close(found, right, 1e-11)


@pytest.mark.parametrize("closed", [False, True])
def test_the_printed_module(closed: bool, governor: kg.Library) -> None:
    equations = kg.derive(turntable())
    assert "prescribed[1] = shaft, shaft_dot, shaft_ddot: shaft (rad)" in render(equations)
    assert r"\ddot{\mathit{shaft}}" in render(equations, "latex")
    module: dict[str, object] = {}
    exec(render(equations, "python", closed=closed), module)
    prescribed = np.array([[0.3], [1.1], [-0.7]])
    x, y = np.array([0.4]), np.array([-0.9])
    close(module["mass_matrix"](x, prescribed), governor.mass_matrix(x, prescribed=prescribed))
    close(module["forcing"](x, y, prescribed), governor.forcing(x, y, prescribed=prescribed))


def test_a_report_holds_the_prescribed_motion() -> None:
    report = kg.compare(tree("quaternions", 2), 20)
    assert report.passed
    worst = report.accuracies[0].worst
    assert worst.inputs["prescribed"] is not None
    assert len(worst.inputs["prescribed"]) == 3


def test_c_compiles_without_a_warning(tmp_path: Path) -> None:
    """Functions that do not depend on prescribed motion take it as an argument, too."""
    system = tree("angular velocities", 0)
    outputs = ("forward_dynamics", "body_poses", "coordinate_rates", "prescribed_efforts")
    source = kg.generate(system, outputs)
    header, name, p = source.files["tree.h"], system.prescribed_names[0], len(system.prescribed)
    assert re.search(rf"TREE_PRESCRIBED += {p} ", header)
    assert f" *     0  {name}  " in header
    assert f"| 0 | `{name}` |" in source.files["README.md"]
    assert f"/* second derivative of {name} */" in source.files["main.c"]
    assert header.count(f"const double prescribed[3 * {p}]") == len(outputs) + 1
    folder = source.write(tmp_path / "out")
    flags = "-std=c99 -O0 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()
    files = ("main.c", "tree.c", "tree_batch.c")
    commands.make([*compilers.find().command, *flags, *files, "-lm", "-o", "example"], "example", folder)
