"""Springs, dampers, dry friction and compensated gravity of a compiled MJCF model as force elements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.elements import Drive, JointFriction, JointSpring, PointLoad, Potential
from kanegen.model.grammar import parse
from kanegen.model.rotations import Triple
from kanegen.readers.mjcf_compiled import JOINT_TYPES, Compiled, triple
from kanegen.readers.mjcf_left_out import LeftOut
from kanegen.readers.mjcf_lengths import Length, sum_of, tendon_length
from kanegen.readers.mjcf_tree import MjcfTree
from kanegen.readers.reader import FRICTION_SMOOTHING


@dataclass(frozen=True)
class Along:
    """A spring and a damper along a length l, with a polynomial of up to three powers each.

    The force is -(k1 (l - rest) + k2 (l - rest)^2 + k3 (l - rest)^3 + d1 v + d2 v |v| + d3 v^3), v = ldot.

    Attributes:
        length: The length.
        stiffness: (3,) k1, k2, k3; zeros where there is no spring.
        rest: Length at which the spring exerts no force.
        damping: (3,) d1, d2, d3; zeros where there is no damper.
    """

    length: Length
    stiffness: Sequence[float]
    rest: float
    damping: Sequence[float]

    def elements(self) -> Iterator[ForceElement]:
        """Yield the force elements of the spring and the damper."""
        stiffness, damping = list(self.stiffness), list(self.damping)
        if len(self.length.coordinates) == 1 and self.length.coordinates[0][0] == 1:
            name = self.length.coordinates[0][1]
            if stiffness[0] or damping[0]:
                yield JointSpring(name, stiffness[0], self.rest if stiffness[0] else 0.0, damping[0])
            stiffness[0] = damping[0] = 0.0
        if any(stiffness):
            stretch = f"({sum_of([*self.length.value, (-self.rest, '')])})"
            powers = [(factor / i, f"{stretch}**{i}") for i, factor in enumerate(stiffness, start=2)]
            yield Potential(parse(sum_of(powers)))
        if any(damping):
            v = f"({sum_of(self.length.rate)})"
            terms = list(zip(damping, (v, f"{v}*abs({v})", f"{v}**3"), strict=True))
            for factor, name in self.length.speeds:
                effort = sum_of((-factor * coefficient, power) for coefficient, power in terms)
                yield Drive(name, parse(effort))


def springs_and_dampers(model: Compiled, tree: MjcfTree) -> Iterator[ForceElement | LeftOut]:
    """Yield the springs and dampers of joints and fixed tendons, and those that are left out."""
    yield from _of_joints(model, tree)
    yield from _of_tendons(model, tree)


def _of_joints(model: Compiled, tree: MjcfTree) -> Iterator[ForceElement | LeftOut]:
    """Yield the springs and dampers of joints."""
    compiled = model.model
    balls, yielding = [], []
    for joint in range(int(compiled.njnt)):
        kind = JOINT_TYPES[int(compiled.jnt_type[joint])]
        place, first = int(compiled.jnt_qposadr[joint]), int(compiled.jnt_dofadr[joint])
        stiffness = _polynomial(model, "SPRING", compiled.jnt_stiffness, compiled.jnt_stiffnesspoly, joint)
        if kind in ("free", "ball") and any(stiffness):
            balls.append(joint)
            stiffness = (0.0, 0.0, 0.0)
        if compiled.jnt_springyield[joint]:
            yielding.append(joint)
        for dof in range(first, first + {"free": 6, "ball": 3}.get(kind, 1)):
            speed = tree.speeds[dof]
            coordinates = ((1.0, speed),) if speed in tree.coordinates else ()
            own = _polynomial(model, "DAMPER", compiled.dof_damping, compiled.dof_dampingpoly, dof)
            damping = _with_actuator(model, own, int(compiled.jnt_actuatorid[joint]))
            rest = float(compiled.qpos_spring[place])
            yield from Along(Length(coordinates, ((1.0, speed),)), stiffness, rest, damping).elements()
    yield LeftOut("springs", "ball or free joint", model.names("joint", balls))
    yield LeftOut("yielding", "joint spring", model.names("joint", yielding))


def _of_tendons(model: Compiled, tree: MjcfTree) -> Iterator[ForceElement | LeftOut]:
    """Yield the springs and dampers of fixed tendons, and the tendons that are left out."""
    compiled = model.model
    spatial, slack = [], []
    for tendon in range(int(compiled.ntendon)):
        length = tendon_length(model, tree, tendon)
        stiffness = _polynomial(
            model, "SPRING", compiled.tendon_stiffness, compiled.tendon_stiffnesspoly, tendon
        )
        damping = _polynomial(model, "DAMPER", compiled.tendon_damping, compiled.tendon_dampingpoly, tendon)
        lower, upper = (float(value) for value in compiled.tendon_lengthspring[tendon])
        if length is None:
            spatial.append(tendon)
            continue
        if any(stiffness) and (lower != upper or compiled.tendon_springyield[tendon]):
            slack.append(tendon)
            stiffness = (0.0, 0.0, 0.0)
        damping = _with_actuator(model, damping, int(compiled.tendon_actuatorid[tendon]))
        yield from Along(length, stiffness, lower, damping).elements()
    yield LeftOut("forces", "spatial tendon", model.names("tendon", spatial))
    yield LeftOut("springs", "slack or yielding tendon", model.names("tendon", slack))


def dry_friction(model: Compiled, tree: MjcfTree, smoothed: bool) -> Iterator[ForceElement | LeftOut]:
    """Yield the dry friction of joints as smoothed friction, or as what is left out.

    MuJoCo holds dry friction as a constraint, by which a joint under load sticks.

    Args:
        model: The compiled model.
        tree: Its tree.
        smoothed: Whether the friction is kept.
    """
    compiled = model.model
    if model.disables("FRICTIONLOSS"):
        return
    dofs = [dof for dof in range(int(compiled.nv)) if compiled.dof_frictionloss[dof]]
    if smoothed:
        for dof in dofs:
            friction = float(compiled.dof_frictionloss[dof])
            yield JointFriction(tree.speeds[dof], friction, FRICTION_SMOOTHING)
    else:
        joints = dict.fromkeys(int(compiled.dof_jntid[dof]) for dof in dofs)
        reason = "which joint_dynamics=True or --joint-dynamics reads"
        yield LeftOut("dry friction", "joint", model.names("joint", joints), reason)


def compensated_gravity(model: Compiled, tree: MjcfTree) -> Iterator[tuple[str, Triple, PointLoad]]:
    """Yield the force on each body with `gravcomp`, after its frame and its mass centre in this frame.

    The force acts at the origin of a frame of its own name, which is to be made at the mass centre.
    """
    compiled = model.model
    gravity = [float(component) for component in compiled.opt.gravity]
    for body, frame in tree.moving.items():
        factor = float(compiled.body_gravcomp[body]) * float(compiled.body_mass[body])
        if factor and not model.disables("GRAVITY"):
            force = [parse(-factor * component) for component in gravity]
            name = f"{frame}_gravcomp"
            yield frame, triple(compiled.body_ipos[body]), PointLoad(name, (force[0], force[1], force[2]))


def _polynomial(model: Compiled, flag: str, linear: Any, higher: Any, number: int) -> Sequence[float]:
    """Return the coefficients of a spring or a damper, zeros where the file switches such forces off."""
    if model.disables(flag):
        return 0.0, 0.0, 0.0
    return float(linear[number]), *(float(value) for value in higher[number])


def _with_actuator(model: Compiled, damping: Sequence[float], actuator: int) -> Sequence[float]:
    """Return coefficients of a damper with those of the actuator that drives it; none for the number -1."""
    if actuator < 0 or model.disables("DAMPER"):
        return damping
    higher = model.model.actuator_dampingpoly
    own = (model.model.actuator_damping, *(higher[:, i] for i in range(higher.shape[1])))
    return [one + model.of_actuator(more, actuator) for one, more in zip(damping, own, strict=True)]
