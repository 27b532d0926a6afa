"""Forces, actuators, equalities of MJCF models, and the warning of what is left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.errors import KanegenWarning
from tests.support.mujoco_models import assert_same_values, model_file

pytestmark = pytest.mark.filterwarnings("ignore:.*the equations leave out:kanegen.errors.KanegenWarning")

FORCES = """
<mujoco model="forces">
  <compiler angle="radian"/>
  <worldbody>
    <body name="ball" gravcomp="0.5" pos="0 0 1">
      <joint name="j" type="ball" pos="0.1 0 0" damping="0.3 0.2 0.1" armature="0.2"/>
      <inertial pos="0.1 0 0" mass="2" diaginertia="1 1.1 1.2"/>
      <body name="arm">
        <joint name="h" axis="1 0 0" damping="0.1 0.2" ref="0.3" springref="0.7" stiffness="7 1 2"/>
        <joint name="s" type="slide" axis="0 1 0" stiffness="3" springref="0.2"/>
        <inertial pos="0.1 0.3 0" mass="2" diaginertia="1 1.5 2"/>
        <body name="welded" pos="0.4 0 0" quat="1 2 3 4" gravcomp="1.5">
          <inertial pos="0.1 0.3 0" mass="2" diaginertia="1 1.5 2"/>
        </body>
        <body name="tip" pos="0.4 0 0"><joint name="t" axis="0 1 1"/><geom size="0.1"/></body>
      </body>
    </body>
    <body name="flying" gravcomp="2">
      <joint name="f" type="free" damping="0.5" armature="0.1"/><geom type="box" size="0.1 0.2 0.3"/>
    </body>
  </worldbody>
  <tendon>
    <fixed name="fixed" stiffness="3 1 2" damping="0.5 0.1">
      <joint joint="h" coef="2"/><joint joint="s" coef="-1"/>
    </fixed>
  </tendon>
  <actuator>
    <motor name="motor" joint="h" gear="-3" armature="0.3" damping="0.5 0.25 0.125"/>
    <position name="servo" joint="h" kp="4" gear="3" kv="2" ctrlrange="-1 1"/>
    <velocity name="drive" joint="s" kv="2"/>
    <damper name="damper" joint="s" kv="3" ctrlrange="0 1"/>
    <intvelocity name="integrator" joint="t" kp="2"/>
    <cylinder name="cylinder" joint="t" bias="1 2 3"/>
    <motor name="of ball" joint="j" gear="1 2 3 0 0 0"/>
    <motor joint="f" gear="1 2 3 4 5 6"/>
    <position name="of tendon" tendon="fixed" gear="2" kp="3"/>
    <general name="affine" joint="h" gaintype="affine" gainprm="1 2 3" biastype="affine" biasprm="4 5 6"/>
  </actuator>
</mujoco>"""


def test_springs_dampers_and_actuators_are_those_of_mujoco(tmp_path: Path) -> None:
    path = model_file(tmp_path, FORCES)
    assert_same_values(path, states=5)
    names = {parameter.name for parameter in kg.load(path).parameters}
    assert {"ctrl_motor", "act_cylinder", "act_integrator", "ctrl_of_ball", "ctrl_actuator7"} < names
    assert len(names) == 10


def test_a_saved_model_has_the_same_forces(tmp_path: Path) -> None:
    system = kg.load(model_file(tmp_path, FORCES))
    system.save(tmp_path / "model.toml")
    assert kg.load(tmp_path / "model.toml") == system


EQUALITIES = """
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body><joint name="a" axis="1 0 0" ref="0.3"/><joint name="b" axis="0 1 0" ref="-0.2"/><geom size="0.1"/>
      <body><joint name="c" axis="0 0 1" pos="1 0 0"/><joint name="d" type="slide"/><geom size="0.1"/></body>
    </body>
    <body><joint name="e"/><geom size="0.1"/></body><body name="g"><joint name="f"/><geom size="0.1"/></body>
  </worldbody>
  <tendon><fixed name="t"><joint joint="c" coef="2"/><joint joint="d" coef="-4"/></fixed></tendon>
  <equality>
    <joint joint1="a" joint2="b" polycoef="0.5 2 0 0 0"/>
    <joint joint1="e" polycoef="0.25 0 0 0 0"/>
    <tendon tendon1="t" polycoef="1 0 0 0 0"/>
    <joint name="square" joint1="f" joint2="b" polycoef="0 0 1 0 0"/>
    <joint name="sleeping" joint1="f" joint2="b" active="false"/>
    <weld name="weld" body1="g"/>
  </equality>
</mujoco>"""


def test_linear_equalities_are_couplings(tmp_path: Path) -> None:
    path = model_file(tmp_path, EQUALITIES)
    with pytest.warns(KanegenWarning) as caught:
        system = kg.load(path)
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


def test_what_is_left_out_is_one_warning(tmp_path: Path) -> None:
    text = """<mujoco><compiler angle="radian"/><option density="1.2"/><worldbody><geom size="1"/>
      <body name="one"><joint name="j" range="-1 1" limited="true" frictionloss="0.1"/>
      <joint name="b" type="ball" stiffness="3" pos="1 0 0"/><geom name="g" size="0.1"/>
      <site name="s"/></body>
      <body name="m" mocap="true"/></worldbody>
      <tendon><spatial name="rope"><site site="s"/><site site="s2"/></spatial></tendon>
      <actuator><muscle name="muscle" joint="j"/><motor name="at site" site="s" gear="0 0 1 0 0 0"/>
      <motor name="bounded" joint="j" forcerange="-1 1" forcelimited="true"/></actuator></mujoco>"""
    text = text.replace("<worldbody>", '<worldbody><site name="s2"/>')
    with pytest.warns(KanegenWarning) as caught:
        kg.load(model_file(tmp_path, text))
    assert str(caught[0].message).partition("model.xml: ")[2] == (
        "the equations leave out contacts of 2 geoms (geom0, g); forces at the limits of 1 joint (j), "
        "whose ranges are kept as system.limits; dry friction of 1 joint (j); forces of 1 property "
        "(density), of the fluid around the bodies; motions of 1 mocap body (m), which stay where the file "
        "has them; springs of 1 ball or free joint (b); forces of 1 tendon (rope), through points in space; "
        "forces of 2 actuators (muscle, at site), which are no linear functions of an input, a coordinate "
        "and a speed; bounds of the forces of 1 actuator (bounded)."
    )
    assert len(caught) == 1
