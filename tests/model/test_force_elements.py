"""Springs, dampers, drives, point loads and potentials, against the reference, textbooks and invariants."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.cli.app import app
from kanegen.compiler import compile_module
from kanegen.measure.comparison import compare
from kanegen.measure.truth import truth
from kanegen.model.coordinates import FREEDOMS
from kanegen.model.expression import Expression
from kanegen.model.force_elements.elements import Drive, JointSpring, PointLoad, Potential, Spring
from kanegen.model.grammar import parse
from kanegen.model.nodes import Variable
from kanegen.model.numbers import Parameter
from kanegen.program.count import count
from kanegen.recursion.outputs import DERIVATIVES, PRODUCTS, SECOND_DERIVATIVES, available
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states
from kanegen.simulation import simulate
from kanegen.symbolic import derive
from tests.support import systems
from tests.support.acting import acted_on, pointed
from tests.support.c_compilers import CPP, WARNINGS, C, run
from tests.support.cases import slow_except
from tests.support.command import kanegen
from tests.support.general_programs import require_equal
from tests.support.paths import MODELS
from tests.support.programs import values
from tests.support.reactions import efforts, reactions

OUTPUTS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
ARRAYS = {"mass_matrix": "A", "forcing": "f", "inverse_dynamics": "generalized_force"}


def driven(seed: int, bodies: int = 4) -> kg.System:
    """Return a random tree with force elements of every kind."""
    rng = np.random.default_rng(seed)
    tree = systems.random_system(rng, bodies, orientations=bool(seed % 3), loads=False)
    return acted_on(tree, seed)


def first_state(states: States, system: kg.System) -> dict[str, Any]:
    """Return the arrays of the first state by their names."""
    found: dict[str, Any] = {
        "x": states.x[0],
        "y": states.y[0],
        "parameters": [p.value for p in system.parameters],
    }
    return found | {name: one[0] for name, one in states.inputs.items()}


@pytest.mark.parametrize("seed", slow_except(range(12), 0, 1, 2, 3, 6))
def test_programs_agree_with_the_reference(seed: int) -> None:
    """[A], {f}, inverse dynamics, and {ydot} by every solver agree with the reference."""
    system = driven(seed, 1 + seed % 5)
    states = random_states(system, 1, seed)
    inputs, further = first_state(states, system), {name: one[0] for name, one in states.inputs.items()}
    matrix = reference.mass_matrix(system, inputs["x"])
    forcing = reference.forcing(system, inputs["x"], inputs["y"], **further)
    ydot = np.linalg.solve(matrix, forcing)
    rates = np.random.default_rng(seed).normal(size=len(ydot))
    found = values(system, OUTPUTS, inputs | {"ydot": rates, "tau": 0 * ydot})
    size = np.abs(reference.forcing_terms(system, inputs["x"], inputs["y"], **further).elements).max() + 100
    assert np.abs(found["f"] - forcing).max() <= 1e-13 * size
    expected = matrix @ rates - forcing
    assert np.abs(found["generalized_force"] - expected).max() <= 1e-13 * (size + np.abs(expected).max())
    assert np.abs(found["acceleration"] - ydot).max() <= 1e-13 * np.linalg.cond(matrix) * np.abs(ydot).max()


@pytest.mark.parametrize("seed", slow_except(range(5), 2))
def test_literal_equations_agree_with_the_reference(seed: int) -> None:
    system = driven(seed, 2)
    states = random_states(system, 1, seed)
    x, y, further = states.x[0], states.y[0], {name: one[0] for name, one in states.inputs.items()}
    expected = reference.forcing(system, x, y, **further)
    for named in (False, True):
        found = derive(system, intermediates=named).lambdify().forcing(x, y, **further)
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_c_is_within_the_bound_of_its_rounding_in_every_precision() -> None:
    system = driven(3)
    for precision in ("double", "float", "long double", "double-double"):
        report = kg.compare(system, states=200, precision=precision)
        assert report.passed, str(report)
    forcing = report.accuracies[1]
    assert forcing.worst.inputs.keys() == {"point_force", "point_moment", "t"}
    assert kg.compare(system.with_force_elements(JointSpring("body1.s1", 1e9)), states=50).passed


def test_a_wrong_stiffness_is_no_rounding() -> None:
    """An error of a billionth in one stiffness exceeds the bound of the comparison."""
    system = driven(3)
    library = kg.build(system)
    assert compare(system, library, 50).passed
    spring = next(e for e in system.force_elements if isinstance(e, Spring) and e.stiffness == 4.0)
    others = tuple(e for e in system.force_elements if e is not spring)
    other = replace(system, force_elements=(*others, replace(spring, stiffness=4.0 * (1 + 1e-9))))
    assert not compare(other, library, 50).passed


def test_states_alone_and_in_batches_have_the_same_bits() -> None:
    system = driven(4)
    library = kg.build(system, OUTPUTS)
    states = random_states(system, 40, 1)
    many = library.forcing(states.x, states.y, **states.inputs)
    for i in range(0, 40, 7):
        one = {name: values[i] for name, values in states.inputs.items()}
        assert np.array_equal(library.forcing(states.x[i], states.y[i], **one), many[i])
    once = {name: values[0] for name, values in states.inputs.items()}
    assert np.array_equal(library.forcing(states.x, states.y, **once)[0], many[0])
    together = library.evaluate(states.x, states.y, ydot=states.y, tau=states.y, **states.inputs)
    assert np.allclose(together.forcing, many, rtol=1e-12)


def test_what_is_absent_costs_nothing() -> None:
    """Force elements cost no operations in [A], and elements on locked freedoms cost none in {f}."""
    system = driven(2)
    bare = replace(system, force_elements=())
    alone = {name: compile_module(s, ("mass_matrix",)).operations for name, s in (("a", system), ("b", bare))}
    assert alone["a"] == alone["b"]
    locked = next(
        f"{body.name}.{name}"
        for body in bare.bodies
        for name, free in zip(FREEDOMS, body.joint.free, strict=True)
        if not free
    )
    idle = bare.with_force_elements(JointSpring(locked, 5.0, damping=1.0), Drive(locked, parse("t")))
    assert compile_module(idle, ("forcing",)).operations == compile_module(bare, ("forcing",)).operations


def oscillator(*elements: kg.ForceElement, free: str = "s1", gravity: float = 0.0) -> kg.System:
    system = kg.System.from_arrays(
        connection=[0],
        mass=[2.0],
        inertia=[np.eye(3)],
        mass_center=[[0.0, 0.0, 0.0]],
        joint_position=[[0.0, 0.0, 0.0]],
        free=systems.flags(1, [free]),
        gravity=[0.0, 0.0, -gravity],
    )
    return system.with_points({"tip": ("body1", (0.0, 1.0, 0.0))}).with_force_elements(*elements)


def force(system: kg.System, x: float, y: float, **further: float) -> float:
    found = values(system, ("forcing",), {"x": [x], "y": [y], "parameters": [3.0], **further})
    return float(found["f"][0])


def test_one_freedom() -> None:
    """The forces of springs, dampers and drives on one freedom are those of the textbook."""
    assert force(oscillator(JointSpring("body1.s1", 5.0, 0.25, 0.5)), 1.0, 2.0) == -5.0 * 0.75 - 1.0
    assert force(oscillator(JointSpring("body1.s1", damping=0.5)), 1.0, 2.0) == -1.0
    assert force(oscillator(Drive("body1.s1", parse("2*t"))), 0.0, 0.0, t=3.0) == 6.0
    assert force(oscillator(Potential(parse("x.body1.s1**4/4"))), 2.0, 0.0) == -8.0
    assert force(oscillator(PointLoad("tip", (7.0, 1.0, 1.0))), 2.0, 0.0) == 7.0


def test_a_spring_between_points() -> None:
    """In a 3-4-5 triangle the effort is 3/5 of stiffness times stretch plus damping times rate."""
    anchor = (-3.0, -3.0, 0.0)
    sprung = Spring((anchor, "tip"), stiffness=10.0, rest_length=4.0, damping=2.0)
    assert force(oscillator(sprung), 0.0, 5.0) == pytest.approx(-0.6 * (10.0 + 2.0 * 3.0), rel=1e-15)
    free = Spring(("tip", anchor), stiffness=10.0)
    assert force(oscillator(free), 0.0, 5.0) == -30.0
    energy = values(oscillator(sprung, free), ("potential_energy",), {"x": [0.0]})["potential_energy"]
    assert energy == pytest.approx(5.0 + 125.0, rel=1e-15)
    assert count(compile_module(oscillator(free), ("forcing",)).module.together).get("sqrt", 0) == 0


def test_a_spring_that_never_has_a_length_is_refused() -> None:
    """The origin of a link stays where its hinge is on the ground: a rest length there has no direction."""

    def system(hinge: tuple[float, float, float], end: tuple[float, float, float]) -> kg.System:
        joint = kg.Joint(position=hinge, free=(False, False, True, False, False, False))
        link = kg.Body("link", 0, 1.0, np.eye(3).tolist(), (0.3, 0.0, 0.0), joint)
        return kg.System("one", (link,), force_elements=(Spring(("link", end), 3.0, 0.1),))

    message = "spring 1 between 'link' and the ground: its ends are at the same place in every state"
    for hinge in ((0.0, 0.0, 0.0), (0.1, 0.0, 0.2)):
        with pytest.raises(kg.ModelError, match=message):
            kg.generate(system(hinge, hinge), ["forcing"])
    with pytest.raises(kg.ModelError, match=message):
        _ = kg.derive(system((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))).f
    assert kg.generate(system((0.1, 0.0, 0.2), (0.1, 0.0, 0.3)), ["forcing"]).operations


def test_a_pendulum_with_a_torsion_spring_and_a_tangential_load() -> None:
    """The moments about the hinge are -k theta and the load times its arm."""
    elements = JointSpring("body1.theta1", 3.0), PointLoad("tip", (0.0, 0.0, 4.0))
    theta = 0.3
    expected = -3.0 * theta + 4.0 * np.cos(theta)
    assert force(oscillator(*elements, free="theta1"), theta, 0.0) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("seed", slow_except(range(6), 1, 2))
def test_the_energy_changes_by_the_power_of_what_is_not_conservative(seed: int) -> None:
    """d(T + V)/dt is the sum of efforts times speeds, by differences in 60 digits; 0 without dissipation."""
    system = driven(seed, 3)
    conservative = tuple(
        replace(e, damping=0.0) if isinstance(e, JointSpring | Spring) else e
        for e in system.force_elements
        if not isinstance(e, Drive | PointLoad)
    )
    conservative = tuple(e for e in conservative if isinstance(e, Potential) or e.stiffness != 0)
    acting = replace(system, force_elements=tuple(e for e in system.force_elements))
    kept = replace(system, force_elements=conservative)
    states = random_states(acting, 1, seed)
    inputs = first_state(states, acting)
    with mpmath.workdps(60):
        x, y = ([mpmath.mpf(float(v)) for v in inputs[name]] for name in ("x", "y"))
        rest = {name: v for name, v in inputs.items() if name not in ("x", "y")}

        def forces(of: kg.System, share: float) -> np.ndarray:
            loads = {name: share * v for name, v in rest.items() if name.startswith("point_")}
            state = rest | loads | {"x": x, "y": y, "parameters": [p.value for p in of.parameters]}
            return values(of, ("forcing",), state, mpmath.mpf)["f"]

        power = sum((a - b) * v for a, b, v in zip(forces(acting, 1.0), forces(kept, 0.0), y, strict=True))
        state = rest | {"x": x, "y": y, "tau": [0.0] * len(y)}
        ydot = values(acting, ("forward_dynamics",), state, mpmath.mpf)["acceleration"]

        def energy(step: mpmath.mpf) -> mpmath.mpf:
            moved = {
                "x": [a + step * b for a, b in zip(x, y, strict=True)],
                "y": [a + step * b for a, b in zip(y, ydot, strict=True)],
            }
            both = values(acting, ("kinetic_energy", "potential_energy"), rest | moved, mpmath.mpf)
            return mpmath.mpf(both["kinetic_energy"][0]) + mpmath.mpf(both["potential_energy"][0])

        step = mpmath.mpf("1e-15")
        rate = (energy(step) - energy(-step)) / (2 * step)
        # Numbers of the model that are no parameters enter the program as doubles, rounded once.
        assert abs(rate - power) <= 1e-13 * (abs(power) + abs(energy(mpmath.mpf(0))) + 100)


def momentum_rate(system: kg.System, state: dict[str, Any]) -> np.ndarray:
    """Return the rate of momentum along the motion, by differences in 60 digits."""
    with mpmath.workdps(60):
        x, y = ([mpmath.mpf(v) for v in state[name]] for name in ("x", "y"))
        values_by_name = state | {"x": x, "y": y, "tau": [0.0] * len(y)}
        ydot = values(system, ("forward_dynamics",), values_by_name, mpmath.mpf)["acceleration"]
        step = mpmath.mpf("1e-15")
        one, two = (
            values(
                system,
                ("momentum",),
                {
                    "x": [a + h * b for a, b in zip(x, y, strict=True)],
                    "y": [a + h * b for a, b in zip(y, ydot, strict=True)],
                },
                mpmath.mpf,
            )["momentum"]
            for h in (step, -step)
        )
        return np.array((one - two) / (2 * step), dtype=float)


def test_momentum_changes_by_external_forces_alone() -> None:
    """Springs between bodies, drives and potentials leave the momentum of a free tree constant.

    Loads on points change it by their force, and by their moment about the mass centre.
    """
    rng = np.random.default_rng(7)
    free = systems.flags(3, ["theta1", "s2"])
    free[0] = True
    tree = systems.random_system(
        rng, 3, connection=(0, 1, 1), free=free, loads=False, gravity=(0.0, 0.0, 0.0)
    )
    system = pointed(tree, 1).with_force_elements(
        Spring(("p0", "p2"), 30.0, 0.5, 2.0),
        JointSpring("body2.theta1", 4.0, 0.1, 0.3),
        Drive("body3.s2", parse("5*sin(x.body2.s2) - y.body3.s2")),
        Potential(parse("x.body3.theta1**2*x.body2.s2")),
    )
    x, y = rng.normal(size=(2, len(system.freedoms)))
    state: dict[str, Any] = {
        "x": x,
        "y": y,
        "point_force": np.zeros((3, 3)),
        "point_moment": np.zeros((3, 3)),
    }
    assert np.abs(momentum_rate(system, state)).max() <= 1e-12 * 100
    acting, couple = rng.normal(size=(2, 3))
    state["point_force"][2], state["point_moment"][2] = acting, couple
    pushed = system.with_force_elements(PointLoad("p1", (1.0, -2.0, 3.0), (0.5, 0.0, 4.0)))
    places = values(pushed, ("mass_center", "point_positions"), {"x": x})
    arms = places["point_positions"].reshape(3, 3) - places["mass_center"]
    moment = np.cross(arms[2], acting) + couple + np.cross(arms[1], (1.0, -2.0, 3.0)) + (0.5, 0.0, 4.0)
    expected = np.concatenate([acting + np.array([1.0, -2.0, 3.0]), moment])
    assert momentum_rate(pushed, state) == pytest.approx(expected, abs=1e-12 * 100)


def test_derivatives_go_through_force_elements() -> None:
    """Derivatives agree with complex steps through the reference."""
    system = driven(5, 3)
    states = random_states(system, 1, 5)
    x, y, further = states.x[0], states.y[0], {name: one[0] for name, one in states.inputs.items()}
    library = kg.build(system, ("forcing_derivatives",))
    found = library.forcing_derivatives(x, y, **further)
    columns = library.derivative_columns("forcing_derivatives")
    for name, place in (("x", 0), ("y", 1)):
        for i in range(len(x)):
            moved = [x.astype(complex), y.astype(complex)]
            moved[place][i] += 1e-30j
            expected = reference.forcing(system, *moved, **further).imag / 1e-30
            column = found[:, columns[name]][:, i]
            assert np.abs(column - expected).max() <= 1e-12 * (1 + np.abs(expected).max()) * 10


@pytest.mark.parametrize("seed", slow_except(range(4), 1, 2))
def test_specialised_and_general_programs_agree(seed: int) -> None:
    system = driven(seed, 3)
    require_equal(replace(system, bodies=tuple(body.without_loads() for body in system.bodies)), seed)


@pytest.mark.parametrize("seed", slow_except(range(4), 1, 2))
def test_locked_joints_carry_what_acts_on_them(seed: int) -> None:
    """Reactions contain the efforts of elements on locked freedoms."""
    system = driven(seed, 3)
    locked = system.reaction_names[:2]
    system = system.with_force_elements(
        JointSpring(locked[0], 6.0, 0.4, 2.0),
        Drive(locked[1], parse(f"2 + x.{locked[0]}*t")),
        Potential(parse(f"x.{locked[1]}**2*cos(x.{system.freedom_names[0]})")),
    )
    states = random_states(system, 1, seed)
    rows = {"ydot": states.y[0][::-1], "force": np.zeros((3, 3)), "torque": np.zeros((3, 3))}
    state = first_state(states, system) | rows
    every = efforts(system, state)
    expected = np.array([every[row.freedom] for row in system.reaction_rows])
    assert reactions(system, state) == pytest.approx(expected, abs=1e-13 * max(map(abs, every.values())))


@pytest.mark.parametrize("seed", slow_except(range(4), 1, 2))
def test_prescribed_freedoms_are_driven_against_what_acts_on_them(seed: int) -> None:
    """{f} and efforts are right with elements on prescribed freedoms, and so is the literal {f}."""
    system = driven(seed, 3)
    driven_names = system.freedom_names[:2]
    if len(system.freedoms) < 4:
        return
    system = system.with_prescribed(driven_names).with_force_elements(
        JointSpring(driven_names[0], 6.0, 0.4, 2.0),
        Drive(driven_names[1], parse(f"2 + y.{driven_names[0]}*t")),
    )
    states = random_states(system, 1, seed)
    state = first_state(states, system) | {"ydot": states.y[0][::-1]}
    further = {name: rows[0] for name, rows in states.inputs.items()}
    assert "prescribed" in further
    found = values(system, ("forcing", "prescribed_efforts"), state)
    forcing = reference.forcing(system, state["x"], state["y"], **further)
    expected = reference.prescribed_efforts(system, state["x"], state["y"], state["ydot"], **further)
    size = np.abs(expected).max() + np.abs(forcing).max()
    assert np.abs(found["f"] - forcing).max() <= 1e-13 * size
    assert np.abs(found["prescribed_efforts"] - expected).max() <= 1e-13 * size
    literal = derive(system).lambdify().forcing(state["x"], state["y"], **further)
    assert np.abs(literal - forcing).max() <= 1e-12 * size


def test_names_outlive_locking() -> None:
    """Elements keep their meaning when locking a freedom changes names and order of freedoms."""
    system = systems.chain(2)
    bodies = tuple(
        replace(body, joint=replace(body.joint, name=f"hinge{k}")) for k, body in enumerate(system.bodies)
    )
    named = replace(system, bodies=bodies).with_force_elements(
        JointSpring("hinge1", 2.0), Drive("hinge0", parse("x.hinge1 + y.hinge0"))
    )
    assert [e.freedom for e in named.force_elements] == ["body2.theta3", "body1.theta3"]
    assert named.force_elements[1].effort == parse("x.body2.theta3 + y.body1.theta3")
    joint = replace(bodies[1].joint, free=(False,) * 6, locked=(0, 0, 0.5, 0, 0, 0))
    locked = replace(named, bodies=(bodies[0], replace(bodies[1], joint=joint)))
    x, y = np.array([0.3]), np.array([0.2])
    bare = replace(locked, force_elements=())
    found = reference.forcing(locked, x, y) - reference.forcing(bare, x, y)
    assert found == pytest.approx([0.7])
    assert values(locked, ("forcing",), {"x": x, "y": y})["f"] == pytest.approx(
        reference.forcing(locked, x, y)
    )


def test_files_keep_everything(tmp_path: Path) -> None:
    system = driven(6)
    system.save(tmp_path / "tree.toml")
    again = kg.load(tmp_path / "tree.toml")
    assert again.force_elements == system.force_elements
    assert again == system


def test_no_gravity(tmp_path: Path) -> None:
    (tmp_path / "free.toml").write_text('gravity = "none"\n[[body]]\nconnection = 0\nmass = 1\n')
    assert kg.load(tmp_path / "free.toml").gravity == (0.0, 0.0, 0.0)


def test_the_command_line(tmp_path: Path) -> None:
    """A model with every kind of element is generated, checked and described; an error is one line."""
    file = tmp_path / "tree.toml"
    tree = driven(6, 2)
    tree.save(file)
    runner = CliRunner()
    for command in ("info", "explain", "check", "equations"):
        found = runner.invoke(app, [command, str(file)], catch_exceptions=False)
        assert found.exit_code == 0, found.output
        if command != "check":
            assert "potential" in found.output or command == "explain"
    elements = json.loads(runner.invoke(app, ["info", str(file), "--json"]).stdout)["force_elements"]
    assert [one["kind"] for one in elements] == [element.KEY for element in tree.force_elements]
    text = file.read_text().replace("sin(w * t)", "exec(w)")
    file.write_text(text)
    refused = kanegen("check", str(file), status=2)
    assert "there is no function 'exec'" in refused.stderr
    assert "Traceback" not in refused.stderr


def test_c_is_clean(tmp_path: Path) -> None:
    """The C compiles as C and C++ without warnings, and the example runs."""
    left_out = (*DERIVATIVES, *PRODUCTS, *SECOND_DERIVATIVES)
    system = driven(6, 2)
    source = kg.generate(system, [name for name in available(system) if name not in left_out])
    source.write(tmp_path)
    name = source.model.name
    files = (f"{name}.c", f"{name}_batch.c", "main.c")
    run(*C["gcc"], "-std=c99", "-O0", *WARNINGS, *files, "-lm", "-o", "example", folder=tmp_path)
    assert "forward_dynamics" in run("./example", folder=tmp_path)
    run(
        *CPP["g++"], "-x", "c++", "-std=c++11", "-fsyntax-only", "-Wall", "-Werror", files[2], folder=tmp_path
    )


def test_time_is_missing() -> None:
    library = kg.build(oscillator(Drive("body1.s1", parse("2*t"))), ("mass_matrix", "forcing"))
    with pytest.raises(kg.ArrayError, match=r"t: missing, .* Pass t=\.\.\., the time in s"):
        library.forcing([0.0], [0.0])
    assert library.forcing([0.0], [0.0], t=2)[0] == 4.0
    assert np.array_equal(library.forcing(np.zeros((2, 1)), np.zeros((2, 1)), t=[1, 2]), [[2.0], [4.0]])
    assert library.mass_matrix([0.0], t=1.0)[0, 0] == 2.0
    with pytest.raises(kg.ArrayError, match="point_force: no output of system 'system' depends on it"):
        library.forcing([0.0], [0.0], t=2, point_force=np.zeros((1, 3)))
    with pytest.raises(kg.ArrayError, match="s: there is no such argument"):
        library.forcing([0.0], [0.0], s=2)


def test_loads_where_none_are_taken() -> None:
    system = pointed(systems.chain(3), 1)
    library = kg.build(system, ("forcing",))
    x = np.zeros(3)
    acting = np.zeros((3, 3))
    acting[1] = 1.0
    with pytest.raises(
        kg.ArrayError, match=r"point_moment: row 1 is not zero, but point 'p1' takes no loads"
    ):
        library.forcing(x, x, point_moment=acting)


def test_simulations_tell_the_time() -> None:
    """The simulation of m xddot = cos(w t) from rest gives x = (1 - cos(w t)) / (m w^2)."""
    library = kg.build(
        oscillator(Drive("body1.s1", parse("cos(2*t)"))), ("forward_dynamics", "kinetic_energy")
    )
    times = np.linspace(0.0, 1.0, 5)
    motion = simulate(library, [0.0], [0.0], times, "RK4", step=1e-3)
    assert np.abs(motion.x[:, 0] - (1 - np.cos(2 * times)) / 8).max() < 1e-12


WRONG = [
    (JointSpring("body1.s9", 1.0), "joint_spring 1: there is no coordinate 'body1.s9'. Known are 'body1."),
    (Drive("body9.s1", 1.0), "drive 1: there is no speed 'body9.s1'"),
    (Drive("body1.s1", parse("x.body1.q")), "drive 1: there is no coordinate 'body1.q'"),
    (Drive("body1.s1", parse("x.__class__")), "drive 1: there is no coordinate '__class__'"),
    (Drive("body1.s1", Expression(Variable("foo"))), "drive 1: 'foo' is not known. Write x.<coordinate>"),
    (PointLoad("tp"), "point_load 1: there is no point or frame 'tp'. Did you mean 'tip'?"),
    (Spring(("tip", "top"), 1.0), "spring 1: there is no point or frame 'top'"),
    (Spring(((0, 0, 0), (1, 0, 0)), 1.0), "between the ground and the ground: both ends are on one body"),
]


@pytest.mark.parametrize(("element", "message"), WRONG)
def test_names_that_stand_for_nothing(element: kg.ForceElement, message: str) -> None:
    with pytest.raises(kg.ModelError) as raised:
        oscillator(element)
    assert message in str(raised.value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Spring(("tip", "tip"), 1.0), "spring between 'tip' and itself"),
        (lambda: Spring(("a", "b")), "spring without stiffness and damping"),
        (lambda: Spring(("a", "b"), 1.0, -1.0), "spring rest_length: -1.0 m is negative"),
        (lambda: Spring(("a",), 1.0), "spring between: expected 2 entries, got 1"),
        (lambda: Spring(("a", (0, 1)), 1.0), "spring between: expected 3 numbers"),
        (lambda: JointSpring("a", "b"), "joint_spring stiffness: 'b' is not a number"),
        (lambda: JointSpring("a", 1.0, float("inf")), "joint_spring rest: inf is not finite"),
        (lambda: JointSpring(3, 1.0), "joint_spring freedom: 3 is not a name"),
        (lambda: Drive(None, 1.0), "drive freedom: None is not a name"),
        (lambda: PointLoad("a", (1, 2)), "point_load force: expected 3 entries, got 2"),
        (lambda: Potential("y.a.s1**2"), "potential energy 'y.a.s1**2' depends on 'y.a.s1'"),
        (lambda: Potential("t"), "potential energy 't' depends on 't'"),
        (lambda: Drive("a", "1 +"), "expression '1 +': nothing after '+'"),
    ],
)
def test_elements_that_say_nothing(make: Any, message: str) -> None:
    with pytest.raises(kg.ModelError) as raised:
        make()
    assert message in str(raised.value)


def test_messages_count_the_elements_of_a_kind() -> None:
    drives = (Drive("body1.s1", "t"), JointSpring("body1.s1", 1.0), Drive("body1.s1", "x.body1.s2 + t"))
    with pytest.raises(kg.ModelError, match=r"^drive 2: there is no coordinate 'body1\.q'"):
        oscillator(*drives[:2], Drive("body1.s1", "x.body1.q"))
    assert len(oscillator(*drives).force_elements) == 3


def test_coordinates_that_have_no_rate() -> None:
    system = systems.eight_body(loads=False)
    sprung = system.with_force_elements(JointSpring("body2.theta1", 1.0))
    for change in (sprung.with_speeds, sprung.with_coordinates):
        with pytest.raises(kg.ModelError, match=r"'body2'|there is no coordinate"):
            change("angular_velocity" if change == sprung.with_speeds else "quaternion")
    with pytest.raises(
        kg.ModelError, match=r"its angular velocity, so none is the rate of 'x\.body2\.theta1'"
    ):
        system.with_speeds("angular_velocity").with_force_elements(Potential("x.body2.theta1**2"))
    with pytest.raises(kg.ModelError, match="parameter name 't' is the time"):
        oscillator(Drive("body1.s1", parse("2*t")), JointSpring("body1.s1", Parameter("t", 1.0)))


def test_values_that_never_exist() -> None:
    for text in ("1/(2 - 2)", "sqrt(-1)*x.body1.s1", "sqrt(x.body1.s2 - 1)"):
        with pytest.raises(kg.ModelError, match="has no value in any state: it divides by zero or takes"):
            kg.generate(oscillator(Drive("body1.s1", parse(text))))
    with pytest.raises(kg.ModelError, match=r"^potential 1: expression .* derivative of it has no value in"):
        kg.generate(oscillator(Potential("1/x.body1.s2")))


def test_a_part_that_never_has_a_value_is_named_also_where_it_may_not_count() -> None:
    spring = JointSpring("body1.s1", 1.0)
    harmless = Drive("body1.s1", parse("1/x.body1.s1"))
    for text, part in (
        ("1 if x.body1.s1 > 1 or y.body1.s1 >= -0.3 else sqrt(-1)", r"sqrt\(-1.0\)"),
        ("max(x.body1.s1, 2/(3 - 3))", r"2.0 / \(3.0 - 3.0\)"),
    ):
        drive = Drive("body1.s1", parse(text))
        with pytest.raises(kg.ModelError, match=f"^drive 2: .*: the part '{part}' has no value in any state"):
            kg.generate(oscillator(spring, harmless, drive))
    somewhere = Drive("body1.s1", parse("1 if x.body1.s1 > 1 else sqrt(x.body1.s1 - 1)"))
    assert kg.build(oscillator(somewhere)).forcing([2.0], [0.0])[0] == 1.0


def test_what_has_no_exact_results() -> None:
    with pytest.raises(kg.OptionError, match="has force elements, for which there are no exact results"):
        truth(oscillator(JointSpring("body1.s1", 1.0)), [0.0], [0.0])
    with pytest.raises(kg.OptionError, match=r"has loads on points \(p0, p2\), for which there are no exact"):
        truth(pointed(systems.chain(3), 1), np.zeros(3), np.zeros(3))
    with pytest.raises(kg.OptionError, match="a force element names its coordinates"):
        three = systems.chain(1, ("theta1", "theta2", "theta3"))
        kg.reanchored(three.with_force_elements(JointSpring("body1.theta2", 1.0)), [0, 0, 0], [0, 0, 0], [1])


def test_a_quarter_car() -> None:
    """Accelerations and the force on the road agree with the equations of two masses on springs."""
    car = kg.load(MODELS / "quarter_car.toml").with_parameters({"gain": 700.0})
    hub, ride, height = 0.01, -0.03, 0.02
    hub_rate, ride_rate, height_rate = 0.4, -0.2, 0.5
    motion = np.array([[height], [height_rate], [9.0]])
    tyre = 160000.0 * (height - hub) + 50.0 * (height_rate - hub_rate)
    suspension = 16000.0 * (hub - ride) + 1000.0 * (hub_rate - ride_rate)
    skyhook = 700.0 * ride_rate
    wheel = tyre - suspension + skyhook - 40.0 * 9.81
    chassis = suspension - skyhook - 300.0 * 9.81
    outputs = ("forcing", "forward_dynamics", "prescribed_efforts", "potential_energy")
    library = kg.build(car, outputs)
    x, y = np.array([hub, ride]), np.array([hub_rate, ride_rate])
    assert library.forcing(x, y, prescribed=motion) == pytest.approx([wheel, chassis], rel=1e-12)
    ydot = library.forward_dynamics(x, y, prescribed=motion)
    assert ydot == pytest.approx([wheel / 40.0, chassis / 300.0], rel=1e-12)
    assert library.prescribed_efforts(x, y, ydot, prescribed=motion) == pytest.approx([tyre], rel=1e-12)
    stored = 80000.0 * (height - hub) ** 2 + 8000.0 * (hub - ride) ** 2
    energy = stored + 9.81 * (40.0 * (0.3 + hub) + 300.0 * (0.8 + ride))
    assert library.potential_energy(x, prescribed=motion) == pytest.approx(energy, rel=1e-12)


def test_units_that_differ_by_powers_of_two_give_the_same_bits() -> None:
    """Masses, lengths and times scaled by powers of two scale the results of springs and loads exactly."""
    tree = systems.random_system(
        np.random.default_rng(9), 3, loads=False, free=systems.flags(3, ["theta2", "s1"])
    )
    states = random_states(tree, 8, 9)

    def built(mass: float, length: float, time: float) -> kg.Library:
        scaled = systems.from_values(systems.rescaled(tree.values(), mass, length, time))
        force, stiffness, damping = mass * length / time**2, mass / time**2, mass / time
        place = tuple(length * v for v in (0.3, -1.0, 0.7))
        points = {f"p{k}": (k, tuple(length * v for v in (0.1 * k, 0.7, -0.4))) for k in (1, 2, 3)}
        system = scaled.with_points(points).with_force_elements(
            JointSpring("body2.theta2", 3.1 * stiffness * length**2, 0.2, 0.7 * damping * length**2),
            JointSpring("body3.s1", 1.7 * stiffness, 0.3 * length, 0.9 * damping),
            Spring(("p1", "p3"), 2.3 * stiffness, 0.6 * length, 0.4 * damping),
            Spring(("p2", place), 1.3 * stiffness),
            PointLoad("p2", (0.3 * force, 0.0, force), (0.0, 1.1 * force * length, 0.0)),
        )
        return kg.build(system, ("forcing", "forward_dynamics", "potential_energy"))

    one, (mass, length, time) = built(1.0, 1.0, 1.0), (2.0**9, 2.0**-7, 2.0**5)
    other = built(mass, length, time)
    lengths = np.where([freedom.is_angle for freedom in tree.freedoms], 1.0, length)
    x, y = states.x * lengths, states.y * lengths / time
    effort = mass * length**2 / time**2 / lengths
    assert np.array_equal(other.forcing(x, y), one.forcing(states.x, states.y) * effort)
    expected = one.forward_dynamics(states.x, states.y) * lengths / time**2
    assert np.array_equal(other.forward_dynamics(x, y), expected)
    energy = mass * length**2 / time**2
    assert np.array_equal(other.potential_energy(x), one.potential_energy(states.x) * energy)
