"""Forces, actuators, equalities of MJCF models, and the warning of what is left out."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import KanegenWarning
from kanegen.model.coordinates import Freedom
from kanegen.model.coupling import ordered
from tests.support.mujoco_models import MODELS, MujocoModel, assert_same_values, model_file

FORCES = Path(__file__).parent / "data" / "every_force.xml"
EQUALITIES = Path(__file__).parent / "data" / "equalities.xml"

pytestmark = pytest.mark.filterwarnings("ignore:.*the equations leave out:kanegen.errors.KanegenWarning")


def test_springs_dampers_and_actuators_are_those_of_mujoco() -> None:
    assert_same_values(FORCES, states=5)
    names = {parameter.name for parameter in kg.load(FORCES).parameters}
    assert "ctrl_off" not in names
    assert {"ctrl_motor", "act_cylinder", "act_integrator", "ctrl_of_ball", "ctrl_actuator7"} < names
    assert len(names) == 13


def test_dry_friction_is_read_on_request(tmp_path: Path) -> None:
    joint = '<joint name="j" frictionloss="0.25"/><geom size="0.1" contype="0" conaffinity="0"/>'
    path = model_file(tmp_path, f"<mujoco><worldbody><body>{joint}</body></worldbody></mujoco>")
    with pytest.warns(KanegenWarning, match=r"dry friction of 1 joint \(j\), which joint_dynamics=True"):
        assert kg.load(path).force_elements == ()
    (element,) = kg.load(path, joint_dynamics=True).force_elements
    assert element == kg.JointFriction("body1.theta3", 0.25, 0.01)


def test_a_saved_model_has_the_same_forces(tmp_path: Path) -> None:
    system = kg.load(FORCES)
    system.save(tmp_path / "model.toml")
    assert kg.load(tmp_path / "model.toml") == system


def test_linear_equalities_are_couplings() -> None:
    with pytest.warns(KanegenWarning) as caught:
        system = kg.load(EQUALITIES)
    for kind, name in (("nonlinear joint", "square"), ("inactive joint", "sleeping"), ("weld", "weld")):
        assert f"constraints of 1 {kind} equality ({name})" in str(caught[0].message)
    assert set(system.freedom_names) == {"b", "d", "f"}
    full = replace(system, couplings=())
    assert set(full.freedom_names) == {"a", "b", "c", "d", "f"}
    values = {coupling.freedom: coupling for coupling in system.couplings}
    of_a, of_c = (values[f"{full.bodies[0].name}.theta1"], values["body2:c.theta3"])
    assert (dict(of_a.terms), of_a.offset) == ({"body1.theta2": 2.0}, pytest.approx(0.3 + 0.5 + 0.4))
    assert (dict(of_c.terms), of_c.offset) == ({"body2.s3": 2.0}, 0.5)
    (locked,) = [one for one in system.bodies if one.name == "body3"]
    assert locked.joint.locked[2] == 0.25


@pytest.mark.parametrize("name", ["equalities", "quadruped", "manipulator", "stacker"])
def test_couplings_hold_the_equalities_of_mujoco(name: str) -> None:
    path = EQUALITIES if name == "equalities" else MODELS[0].parent / f"{name}.xml"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", KanegenWarning)
        system = kg.load(path)
    full = replace(system, couplings=(), bodies=tuple(map(freed, system.bodies)))
    mujoco, rng = MujocoModel(path, full), np.random.default_rng(3)
    x, jacobian = rng.uniform(-1, 1, len(full.coordinates)), np.eye(len(full.freedoms))
    for k, body in enumerate(system.bodies, start=1):
        for index in range(6):
            if body.joint.locked[index]:
                x[full.coordinate_place(k, index)] = body.joint.locked[index]
                jacobian[full.places[Freedom(k, index)]] = 0
    for one in ordered(system.couplings, system.bodies):
        terms = [(full.coordinate_place(f.body, f.index), full.places[f], factor) for f, factor in one.terms]
        place = full.coordinate_place(one.freedom.body, one.freedom.index)
        x[place] = one.offset + sum(factor * x[at] for at, _, factor in terms)
        jacobian[full.places[one.freedom]] = sum(factor * jacobian[at] for _, at, factor in terms)
    residuals, by_y = mujoco.equalities(x)
    assert len(residuals) == len(full.freedoms) - len(system.freedoms) >= 1
    np.testing.assert_allclose(residuals, 0, atol=1e-14)
    np.testing.assert_allclose(by_y @ jacobian, 0, atol=1e-14)


def freed(body: kg.Body) -> kg.Body:
    """The body with the freedoms free that are locked at a value other than zero."""
    joint = body.joint
    free = tuple(a or bool(value) for a, value in zip(joint.free, joint.locked, strict=True))
    return replace(body, joint=replace(joint, free=free))


def test_what_is_left_out_is_one_warning(tmp_path: Path) -> None:
    text = """<mujoco><compiler angle="radian"/><option density="1.2"/><worldbody><geom size="1"/>
      <body name="one"><joint name="j" range="-1 1" limited="true" frictionloss="0.1"/>
      <joint name="b" type="ball" stiffness="3" pos="1 0 0"/><geom name="g" size="0.1"/>
      <site name="s"/></body>
      <body name="m" mocap="true"/></worldbody>
      <tendon><spatial name="rope"><site site="s"/><site site="s2"/></spatial></tendon>
      <actuator><muscle name="muscle" joint="j"/>
      <motor name="between" site="s" refsite="s2" gear="0 0 1 0 0 0"/>
      <motor name="bounded" joint="j" forcerange="-1 1" forcelimited="true"/></actuator></mujoco>"""
    text = text.replace("<worldbody>", '<worldbody><site name="s2"/>')
    with pytest.warns(KanegenWarning) as caught:
        kg.load(model_file(tmp_path, text))
    assert str(caught[0].message).partition("model.xml: ")[2] == (
        "the equations leave out contacts of 2 geoms (geom0, g); forces at the limits of 1 joint (j), "
        "whose ranges are kept as system.limits; forces of 1 property of the fluid (density); motions of 1 "
        "mocap body (m), which stay where the file has them; springs of 1 ball or free joint (b); forces of "
        "1 spatial tendon (rope); dry friction of 1 joint (j), which joint_dynamics=True or --joint-dynamics "
        "reads; forces of 2 other actuators (muscle, between), which are no linear functions of an input, "
        "lengths and their rates; bounds of the forces of 1 actuator (bounded)."
    )
    assert len(caught) == 1


@pytest.mark.parametrize(
    "path", [FORCES, MODELS[0].parents[1] / "gymnasium" / "half_cheetah.xml"], ids=lambda path: path.stem
)
def test_compiled_accelerations_are_those_of_mujoco(path: Path) -> None:
    system = kg.load(path)
    mujoco = MujocoModel(path, system)
    x, y = mujoco.draw_state(np.random.default_rng(5))
    controls = {name: value for name, value in mujoco.inputs().items() if name in names_of(system)}
    library = kg.build(system, outputs=("forward_dynamics",)).with_parameters(controls)
    expected = mujoco.of_speeds(mujoco.data.qacc_smooth)
    np.testing.assert_allclose(library.forward_dynamics(x, y), expected, atol=1e-12 * abs(expected).max())


def names_of(system: kg.System) -> set[str]:
    """The names of the parameters of a system."""
    return {parameter.name for parameter in system.parameters}
