"""Reflected inertia of motors: against MuJoCo, the reference, certified truth, and by counting operations."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.measure.truth import truth
from kanegen.model.reanchorable import require_free_frame
from kanegen.options import Variant
from kanegen.reference import equations as reference
from kanegen.reference.regularity import require_regular
from kanegen.reference.states import random_states
from kanegen.studies.bench.peers.mujoco_peer import mjcf
from kanegen.symbolic import derive
from tests.support import random_trees, systems
from tests.support.cases import slow_except
from tests.support.programs import values

DYNAMICS = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics", "kinetic_energy")
VARIANTS = [
    Variant(solver=solver, refinement=refinement)
    for solver, refinement in product(("factorisation", "articulated bodies"), (0, 1))
]

TWO_LINKS = """
name = "arm"
[[body]]
name = "a"
connection = "ground"
mass = 2
mass_center = [0, 0, -0.3]
inertia = [0.05, 0.05, 0.01]
joint = {name = "j1", free = ["theta2"], position = [0, 0, 1], armature = {theta2 = 0.7}}
[[body]]
name = "b"
connection = "a"
mass = 1
mass_center = [0, 0, -0.2]
inertia = [0.02, 0.02, 0.005]
joint = {name = "j2", free = ["theta2"], position = [0, 0, -0.6], armature = {theta2 = 0.4}}
"""


def two_links(folder: Path) -> kg.System:
    file = folder / "arm.toml"
    file.write_text(TWO_LINKS)
    return kg.load(file)


def armed(system: kg.System, seed: int) -> kg.System:
    """Return the system with armature at about two thirds of its freedoms."""
    rng = np.random.default_rng([seed, 7])
    arrays = system.values()
    sizes = np.where(rng.random(arrays.free.shape) < 0.7, rng.uniform(0.05, 3.0, arrays.free.shape), 0.0)
    return systems.from_values(replace(arrays, armature=sizes))


@pytest.mark.parametrize("variant", VARIANTS, ids=str)
def test_two_links(tmp_path: Path, variant: Variant) -> None:
    """The accelerations were computed by another program."""
    found = values(
        two_links(tmp_path),
        ("forward_dynamics",),
        {"x": [0.3, -0.5], "y": [1, 2], "tau": [0, 0]},
        variant=variant,
    )
    assert found["acceleration"] == pytest.approx([-2.4713865459, 1.8605760278], abs=1e-10)


def mujoco_results(xml: str, x: Any, y: Any, tau: Any, order: list[int] | None = None) -> dict[str, Any]:
    """Return [A], {f} and {ydot} by MuJoCo; joints called by their places are brought into their order."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    n = model.nv
    order = [int(model.joint(str(i)).dofadr[0]) for i in range(n)] if order is None else order
    data.qpos[order if model.nq == n else slice(None)] = x
    data.qvel[order], data.qfrc_applied[order] = y, tau
    mujoco.mj_forward(model, data)
    matrix = np.zeros((n, n))
    mujoco.mj_fullM(model, data, matrix)
    return {"A": matrix[np.ix_(order, order)], "f": -data.qfrc_bias[order], "acceleration": data.qacc[order]}


def assert_as_mujoco(found: dict[str, Any], theirs: dict[str, Any]) -> None:
    a = theirs["A"]
    assert np.abs(found["A"].reshape(a.shape) - a).max() <= 1e-12 * np.abs(a).max()
    assert np.abs(found["f"] - theirs["f"]).max() <= 1e-12 * np.abs(theirs["f"]).max()
    room = 1e-14 * np.linalg.cond(a) + 1e-12
    assert (
        np.abs(found["acceleration"] - theirs["acceleration"]).max()
        <= room * np.abs(theirs["acceleration"]).max()
    )


@pytest.mark.parametrize("seed", slow_except(range(12), 1))
def test_trees_against_mujoco(seed: int) -> None:
    """Hinges, slides and a body with six freedoms; every solver, refined and unrefined."""
    rng = np.random.default_rng(seed)
    free = systems.random_free(rng, 4)
    free[rng.integers(4)] = True
    free[~free.any(axis=1), 2] = True
    system = armed(systems.random_system(rng, 4, free=free, loads=False), seed)
    x, y, tau = rng.uniform(-1, 1, (3, len(system.freedoms)))
    theirs = mujoco_results(mjcf(system), x, y, tau)
    for variant in VARIANTS:
        found = values(system, DYNAMICS, {"x": x, "y": y, "tau": tau, "ydot": x}, variant=variant)
        assert_as_mujoco(found, theirs)
        assert found["kinetic_energy"][0] == pytest.approx(y @ theirs["A"] @ y / 2, rel=1e-12)
        needed = theirs["A"] @ x - theirs["f"]
        assert np.abs(found["generalized_force"] - needed).max() <= 1e-12 * np.abs(needed).max()


BALL = """
<mujoco>
  <option gravity="0.3 -0.2 -9.81"/>
  <worldbody>
    <body>
      <freejoint/>
      <inertial pos="0.1 0.2 -0.1" mass="2" fullinertia="0.3 0.4 0.5 0.02 -0.03 0.01"/>
      <body pos="0.3 -0.1 0.2">
        <joint type="ball" armature="0.7"/>
        <inertial pos="-0.1 0.05 0.3" mass="1.5" fullinertia="0.2 0.25 0.3 0.01 0.02 -0.02"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("solver", ["factorisation", "articulated bodies"])
@pytest.mark.parametrize("coordinates", ["quaternion", "angles"])
def test_a_ball_joint_and_a_floating_base_against_mujoco(solver: str, coordinates: str) -> None:
    """Armature of a ball or of a free joint is that of components of velocities, in MuJoCo as here.

    The base stands at the identity, where the linear velocities of both programs have equal components.
    """
    inertias = [[[0.3, 0.02, -0.03], [0.02, 0.4, 0.01], [-0.03, 0.01, 0.5]]]
    inertias += [[[0.2, 0.01, 0.02], [0.01, 0.25, -0.02], [0.02, -0.02, 0.3]]]
    free = np.array([[True] * 6, [True] * 3 + [False] * 3])
    armature = np.array([[0.6] * 3 + [0.9] * 3, [0.7] * 3 + [0.0] * 3])
    system = kg.System.from_arrays(
        [0, 1],
        [2.0, 1.5],
        inertias,
        [[0.1, 0.2, -0.1], [-0.1, 0.05, 0.3]],
        [[0, 0, 0], [0.3, -0.1, 0.2]],
        free=free,
        gravity=(0.3, -0.2, -9.81),
        speeds="angular_velocity",
        coordinates=coordinates,
        armature=armature,
    )
    rng = np.random.default_rng(1)
    y, tau = rng.uniform(-1, 1, (2, 9))
    angle, place = 0.4, [0.1, -0.2, 0.3]
    quaternion = [np.cos(angle / 2), 0, np.sin(angle / 2), 0]
    orientation = [1, 0, 0, 0, *quaternion] if coordinates == "quaternion" else [0, 0, 0, 0, angle, 0]
    xml = BALL.replace("<freejoint/>", '<joint type="free" armature="0.6"/>')
    # MuJoCo has one armature for the six speeds of a free joint; that of translations is added here.
    theirs = mujoco_results(xml, [*place, 1, 0, 0, 0, *quaternion], y, tau, [3, 4, 5, 6, 7, 8, 0, 1, 2])
    a = theirs["A"] + np.diag([0.0] * 6 + [0.3] * 3)
    found = values(
        system,
        DYNAMICS,
        {"x": [*orientation, *place], "y": y, "tau": tau, "ydot": y},
        variant=Variant(solver=solver),
    )
    expected = np.linalg.solve(a, theirs["f"] + tau)
    assert_as_mujoco(found, theirs | {"A": a, "acceleration": expected})


@pytest.mark.parametrize("seed", slow_except(range(12), 0, 1))
def test_certified_truth(seed: int) -> None:
    """Partial velocities and Newton-Euler equations in ball arithmetic share nothing with the reference."""
    system = armed(systems.random_system(np.random.default_rng(seed), 3), seed)
    state = random_states(system, 1, seed)
    x, y = state.x[0], state.y[0]
    exact = truth(system, x, y, ydot=x, outputs=("mass_matrix", "forcing", "inverse_dynamics"))
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    assert np.abs(exact["mass_matrix"].value - a).max() <= 1e-14 * np.abs(a).max()
    assert np.abs(exact["forcing"].value - f).max() <= 1e-13 * np.abs(f).max()
    needed = a @ x - f
    assert np.abs(exact["inverse_dynamics"].value - needed).max() <= 1e-13 * np.abs(needed).max()


@pytest.mark.parametrize("seed", range(4))
def test_efforts_of_prescribed_freedoms(seed: int) -> None:
    """A motor that follows a prescribed motion must also accelerate its own armature."""
    system = armed(systems.chain(3, ["theta3", "s1"], seed), seed)
    system = system.with_prescribed(["body2.theta3", "body3.s1"])
    state = random_states(system, 1, seed)
    x, y, prescribed = state.x[0], state.y[0], state.inputs["prescribed"][0]
    ydot = np.random.default_rng(seed).normal(size=len(y))
    inputs = {"x": x, "y": y, "ydot": ydot, "prescribed": prescribed}
    found = values(system, ("prescribed_efforts", "forcing"), inputs)
    expected = reference.prescribed_efforts(system, x, y, ydot, prescribed)
    bare = reference.prescribed_efforts(_bare(system), x, y, ydot, prescribed)
    armature = [system.bodies[f.body - 1].joint.armature[f.index] for f in system.prescribed]
    assert expected - bare == pytest.approx(
        np.array(armature) * prescribed[2], abs=1e-12 * np.abs(expected).max()
    )
    assert np.abs(found["prescribed_efforts"] - expected).max() <= 1e-12 * np.abs(expected).max()
    forcing = reference.forcing(_bare(system), x, y, prescribed=prescribed)
    assert np.abs(found["f"] - forcing).max() <= 1e-12 * np.abs(forcing).max()


def _bare(system: kg.System) -> kg.System:
    """Return the system without motors."""
    bodies = (replace(body, joint=replace(body.joint, armature=(0.0,) * 6)) for body in system.bodies)
    return replace(system, bodies=tuple(bodies))


def test_it_costs_one_addition_a_freedom_in_the_mass_matrix() -> None:
    bare = systems.chain(5, ["theta3"])
    free = np.full((5, 6), 0.25)
    with_motors = systems.from_values(replace(bare.values(), armature=free))
    ours, without = (compile_module(s, ("mass_matrix",)).operations for s in (with_motors, bare))
    # The entry of the outermost freedom is a number, and stays one.
    assert ours == without | {"add": without["add"] + 4}
    ours, without = (compile_module(s, ("forcing",)).operations for s in (with_motors, bare))
    assert ours == without
    ours, without = (compile_module(s, ("inverse_dynamics",)).operations for s in (with_motors, bare))
    assert ours == without | {"add": without["add"] + 5, "multiply": without["multiply"] + 5}


def test_it_keeps_the_equations_regular_at_gimbal_lock() -> None:
    """Three motors in gimbals accelerate their own rings in every position."""
    free = [[True, True, True, False, False, False]]
    arrays = systems.random_system(np.random.default_rng(1), 1, free=np.array(free), loads=False).values()
    system = systems.from_values(replace(arrays, armature=np.array([[0.5, 0.2, 0.3, 0, 0, 0]])))
    assert system.bodies[0].joint.mass_matrix_singularity is None
    x, y, tau = [0.3, np.pi / 2, -0.2], [0.5, 0.1, -0.7], [1.0, 0.5, -0.5]
    a, f = reference.mass_matrix(system, x), reference.forcing(system, x, y)
    for solver in ("factorisation", "articulated bodies"):
        found = values(
            system, ("forward_dynamics",), {"x": x, "y": y, "tau": tau}, variant=Variant(solver=solver)
        )
        assert found["acceleration"] == pytest.approx(np.linalg.solve(a, f + tau), rel=1e-12)


def test_a_motor_moves_a_body_without_mass() -> None:
    """[A] is regular where a freedom moves nothing but its motor."""
    arrays = systems.chain(2, ["theta3"]).values()
    arrays.mass[1], arrays.inertia[1] = 0.0, 0.0
    with pytest.raises(kg.SingularError):
        require_regular(systems.from_values(arrays))
    system = systems.from_values(replace(arrays, armature=np.array([[0] * 6, [0, 0, 0.5, 0, 0, 0]])))
    require_regular(system)
    found = values(system, ("forward_dynamics",), {"x": [0.1, 0.2], "y": [0, 0], "tau": [0, 2]})
    assert found["acceleration"][1] == pytest.approx(4, rel=1e-14)


@pytest.mark.parametrize("seed", slow_except(range(3), 1))
def test_literal_equations_and_their_closed_form(seed: int) -> None:
    system = armed(systems.chain(2, ["theta3"], seed), seed)
    x = np.array([0.4, -0.7])
    expected = reference.mass_matrix(system, x)
    equations = derive(system)
    assert np.abs(equations.lambdify().mass_matrix(x) - expected).max() <= 1e-14 * np.abs(expected).max()
    closed = equations.closed_form().A.subs(dict(zip(equations.x, x, strict=True)))
    assert np.abs(np.array(closed, dtype=float) - expected).max() <= 1e-13 * np.abs(expected).max()


def test_it_is_saved_and_read(tmp_path: Path) -> None:
    system = random_trees.everything(3)
    assert any(any(body.joint.armature) for body in system.bodies)
    system.save(tmp_path / "again.toml")
    assert kg.load(tmp_path / "again.toml") == system
    assert (
        systems.from_values(system.values()).values().armature.tolist() == system.values().armature.tolist()
    )


def one_joint(**choices: Any) -> kg.System:
    body = kg.Body("b", 0, 1.0, np.eye(3).tolist(), joint=kg.Joint(**choices))
    return kg.System("one", (body,))


def test_what_is_refused() -> None:
    motors = (0.5, 0.2, 0.3, 1.0, 1.0, 2.0)
    with pytest.raises(
        kg.ModelError, match=r"armature: that of s2 is -1\.0\. A reflected inertia is not neg"
    ):
        kg.Joint(armature=(0, 0, 0, 0, -1, 0))
    with pytest.raises(kg.ModelError, match="body 'b': the speeds of its angles cannot be changed"):
        one_joint(armature=motors).with_speeds("angular_velocity")
    with pytest.raises(kg.ModelError, match="body 'b': the speeds of its angles cannot be changed"):
        one_joint(armature=motors).with_coordinates("quaternion")
    assert one_joint(armature=motors).with_speeds("angle_rates").bodies[0].joint.armature == motors
    with pytest.raises(kg.OptionError, match="its angles have armature, which would belong to others"):
        require_free_frame(one_joint(armature=motors), 1)
    with pytest.raises(kg.OptionError, match="its translations have different armatures"):
        require_free_frame(one_joint(armature=motors, speeds="angular_velocity"), 1)
    require_free_frame(one_joint(armature=(0.5, 0.2, 0.3, 1, 1, 1), speeds="angular_velocity"), 1)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("0.7", r"armature: write a table such as \{theta3 = 0\.7\}"),
        ("{theta4 = 1}", "armature: unknown key 'theta4'. Known are 'theta1'"),
        ('{theta2 = "rotor"}', "armature theta2: a string stands for a parameter, but there is no 'rotor'"),
        ("{theta2 = -1}", "armature: that of theta2 is -1.0"),
    ],
)
def test_what_a_file_may_not_say(tmp_path: Path, written: str, message: str) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(TWO_LINKS.replace("{theta2 = 0.7}", written))
    with pytest.raises(kg.ReadError, match=f"arm.toml(:[0-9]+)?: body 'a': .*{message}"):
        kg.load(file)
