"""The columns of the Coriolis matrix, assembled joint by joint inward; `coriolis` says what they are.

Composite bodies, their momentum relative to a frame, and the columns of the freedoms outward are passed
through the turns of every joint and about the origin of the lower body. Where they pass a freedom, entries of
[C] are recorded.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from sympy import Add, Expr, S

from kanegen.recursion.columns import shifted_columns
from kanegen.recursion.coriolis_columns import (
    Column,
    FrameMotion,
    MovingBody,
    column_sum,
    rotation_column,
    rotor_column,
    translation_column,
    with_coriolis,
)
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.joint_motion import AngularSpeed, JointMotion, Step, Translation
from kanegen.recursion.merged_columns import merged
from kanegen.recursion.relative_momentum import HALF, RelativeMomentum, second_moments
from kanegen.recursion.rotors import SpinningRotor
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import ZERO, Rows, Wrench, add, cross, dot, scale, unit
from kanegen.symbolic.definitions import Vector


@dataclass(frozen=True)
class Carried:
    """What a body carries, as a frame on the path through its joint sees it.

    Attributes:
        body: The composite body.
        arriving: The columns of freedoms further outward.
        own: The columns of the freedoms of the joint that have been passed.
    """

    body: MovingBody
    arriving: tuple[Column, ...]
    own: tuple[Column, ...] = ()

    @property
    def columns(self) -> tuple[Column, ...]:
        """All columns."""
        return self.arriving + self.own


class CoriolisAssembly:
    """The assembly of [C], joint by joint inward. Lists are by body, 0 for the ground.

    Args:
        tree: The tree.
        rotors: Rotors whose spin takes part.
        multiple: By how much the entries and the columns of [C] are multiplied, those of [A] not.
    """

    def __init__(self, tree: Tree, rotors: Iterable[SpinningRotor], multiple: Expr = S.One) -> None:
        self.tree, self.multiple = tree, multiple
        self.motions = frame_motions(tree)
        self._bodies = [Inertia(), *tree.inertias]
        self._momenta = [RelativeMomentum() for _ in self._bodies]
        self._columns: list[list[Column]] = [[] for _ in self._bodies]
        self._entries: dict[tuple[int, int], list[Expr]] = {}
        for rotor in rotors:
            if rotor.carrier:
                self._add_rotor(rotor)

    def entry(self, i: int, j: int) -> Expr:
        """Return the multiple of an entry of [C], the sum of its terms."""
        terms = self._entries.get((i, j), [])
        return self.tree.definitions.define(f"Cm_{i}_{j}", Add(*terms))

    def pass_inward(self, joint: JointMotion) -> None:
        """Record the entries of the freedoms of a joint, and pass what its body carries to the lower body."""
        k = joint.body
        body = MovingBody(self._bodies[k], self._momenta[k], self.motions[k][-1])
        carried = Carried(body, tuple(self._merged(self._columns[k], f"{k}")))
        if joint.angular_speeds:
            carried = self.with_angular_speeds(carried, joint)
        for step, motion in reversed(list(zip(joint.steps, self.motions[k][:-1], strict=True))):
            carried = self._below_turn(carried, joint, step, motion)
        self.record_translations(carried, joint)
        if joint.lower:
            self._pass_to_lower_body(carried, joint)

    def _record(self, rows: Mapping[int, Expr], columns: Mapping[int, Expr], value: Expr) -> None:
        """Add the value for two freedoms to the entries of the speeds that move them."""
        for i, one in rows.items():
            for j, other in columns.items():
                self._entries.setdefault((i, j), []).append(one * other * value)

    def _add_rotor(self, rotor: SpinningRotor) -> None:
        """Add the spin of a rotor to the relative momentum of its carrier, and begin its column."""
        k, definitions = rotor.carrier, self.tree.definitions
        self.tree.about(k, "spin of a rotor")
        half = definitions.define(f"yh_{rotor.motion.number}", HALF * rotor.motion.rate)
        x, y, z = (cross(scale(half, rotor.momentum), unit(i)) for i in range(3))
        spin = RelativeMomentum(ZERO, (x, y, z))
        self._momenta[k] = self._momenta[k].plus(spin, f"{k}", definitions)
        if rotor.motion.shares:
            self._columns[k].append(rotor_column(rotor, self.motions[k][-1].omega, definitions))

    def _merged(self, columns: Sequence[Column], body: str) -> list[Column]:
        """Return columns at a body, with those of the same entries of {y} added where this leaves fewer."""
        definitions = self.tree.definitions
        return merged(columns, lambda place, parts: column_sum(place, parts, body, definitions))

    def with_angular_speeds(self, carried: Carried, joint: JointMotion) -> Carried:
        """Record the entries of the components of a relative angular velocity, and begin their columns.

        Returns:
            What the body carries, as a frame sees it that turns with J, in components of K.
        """
        k, body, definitions = joint.body, carried.body, self.tree.definitions
        second = second_moments(body.inertia, None, f"{k}", definitions)
        momentum = body.momentum.turning(joint.relative_omega, body.inertia, second, f"{k}", definitions)
        below = replace(body, momentum=momentum)
        own = tuple(self.begun_angular(joint, one, body, below, second) for one in joint.angular_speeds)
        for one in joint.angular_speeds:
            for col in carried.arriving:
                self._record(one.shares, col.places, col.along(one.axis))
                self._record(col.places, one.shares, self.across_angular(col, joint, one, body))
            for col in own:
                self._record(one.shares, col.places, col.along(one.axis))
        return Carried(below, carried.arriving, own)

    def begun_angular(
        self, joint: JointMotion, one: AngularSpeed, body: MovingBody, below: MovingBody, second: Rows
    ) -> Column:
        """Begin the column of a component of a relative angular velocity.

        Args:
            joint: The joint.
            one: The component.
            body: The composite body that it turns, in its own frame.
            below: The same, as a frame sees it that turns with J, in components of K.
            second: Second moments [D] of the body.
        """
        label = f"{joint.body}w{one.axis + 1}"
        return self._multiplied(rotation_column(one, label, body, second, self.tree.definitions))

    def across_angular(self, col: Column, joint: JointMotion, one: AngularSpeed, body: MovingBody) -> Expr:
        """Return the entry of a component of a relative angular velocity in the row of a freedom outward.

        Args:
            col: The column of the freedom outward.
            joint: The joint of the component.
            one: The component.
            body: The composite body that it turns, in its own frame.
        """
        return col.across(one.axis, self.multiplied_motion(body.motion, f"{joint.body}"))

    def _below_turn(self, carried: Carried, joint: JointMotion, step: Step, motion: FrameMotion) -> Carried:
        """Record the entries of an angle, begin its column, and pass everything through its turn.

        Args:
            carried: What the body carries, above the turn.
            joint: The joint.
            step: The turn.
            motion: Motion of the frame below the turn.
        """
        frame, definitions = step.frame, self.tree.definitions
        inertia = carried.body.inertia.down(step.turn, frame, definitions)
        momentum = carried.body.momentum.down(step.turn, frame, definitions)
        arriving, own = (
            tuple(col.down(step.turn, frame, definitions) for col in columns)
            for columns in (carried.arriving, carried.own)
        )
        if not step.moves:
            return Carried(MovingBody(inertia, momentum, motion), arriving, own)
        second = second_moments(inertia, step.axis, frame, definitions)
        turning = scale(step.rate, unit(step.axis))
        momentum = momentum.turning(turning, inertia, second, frame, definitions)
        below = Carried(MovingBody(inertia, momentum, motion), arriving, own)
        if not step.shares:
            return below
        # The entries are the same in the frames below and above. On the ground columns are turned no further.
        self.record_angle(joint, step, below if joint.lower else carried, is_below=bool(joint.lower))
        begun = self.begun_rotation(joint, step, below.body, second)
        self._record(step.shares, step.shares, begun.along(step.axis))
        return replace(below, own=(*own, begun))

    def record_angle(self, joint: JointMotion, step: Step, seen: Carried, *, is_below: bool) -> None:
        """Record the entries of an angle with the freedoms further outward.

        Args:
            joint: The joint.
            step: The turn of the angle.
            seen: What the body carries, as a frame in which the axis does not move sees it.
            is_below: Whether this is the frame below the turn, or that above it.
        """
        for col in seen.columns:
            self._record(step.shares, col.places, col.along(step.axis))
            label = f"{step.frame}{'' if is_below else 'u'}"
            across = col.across(step.axis, self.multiplied_motion(seen.body.motion, label))
            self._record(col.places, step.shares, across)

    def begun_rotation(self, joint: JointMotion, step: Step, body: MovingBody, second: Rows) -> Column:
        """Begin the column of an angle below its turn.

        Args:
            joint: The joint.
            step: The turn.
            body: The composite body that it turns, in the frame below the turn.
            second: Second moments [D] of this body.
        """
        label = f"{joint.body}a{step.angle + 1}"
        return self._multiplied(rotation_column(step, label, body, second, self.tree.definitions))

    def record_translations(self, carried: Carried, joint: JointMotion) -> None:
        """Record the entries of the translations of a joint, with each other and those further outward."""
        omega, mass = self.motions[joint.lower][-1].omega, carried.body.inertia.mass
        for one in joint.translations:
            turning = scale(self.multiple, cross(omega, one.direction))
            for col in carried.columns:
                self._record(one.shares, col.places, dot(one.direction, col.coriolis.force))
                self._record(col.places, one.shares, dot(turning, col.inertial.force))
            for other in joint.translations:
                value = self.multiple * mass * dot(one.direction, cross(omega, other.direction))
                self._record(one.shares, other.shares, value)

    def _pass_to_lower_body(self, carried: Carried, joint: JointMotion) -> None:
        """Pass the composite body and its columns to the lower body; begin the columns of translations."""
        k, j, offset, definitions = joint.body, joint.lower, joint.offset, self.tree.definitions
        shift = shifted_columns(carried.body.inertia, joint, definitions)
        matrix = shift.moment_matrix if shift else None
        inertia = carried.body.inertia.shifted(offset, f"{k}j", definitions, matrix)
        momentum = carried.body.momentum.shifted(offset, sliding(joint), inertia, f"{k}j", definitions)
        body = MovingBody(inertia, momentum, self.motions[j][-1])
        columns = [col.shifted(offset, f"{j}", None, definitions) for col in carried.arriving]
        columns += [col.shifted(offset, f"{j}", shift, definitions) for col in carried.own]
        columns += [self.begun_translation(joint, one, body) for one in joint.translations]
        self._columns[j] += columns
        self._bodies[j] = self._bodies[j].plus(inertia, f"{j}", definitions)
        self._momenta[j] = self._momenta[j].plus(momentum, f"{j}", definitions)

    def begun_translation(self, joint: JointMotion, one: Translation, body: MovingBody) -> Column:
        """Begin the column of a translation.

        Args:
            joint: The joint.
            one: The translation.
            body: The composite body that it moves, about the origin of the lower body, in the frame of this.
        """
        label = f"{joint.body}t{one.axis + 1}" if one.is_coupled else f"{joint.body}s{one.number}"
        return self._multiplied(translation_column(one, label, body, self.tree.definitions))

    def multiplied_motion(self, motion: FrameMotion, frame: str) -> FrameMotion:
        """Return the motion of a frame, multiplied as [C] is.

        Args:
            motion: The motion.
            frame: Suffix of the names of quantities in the frame.
        """
        omega, velocity = (
            self.tree.definitions.vector(f"{name}m_{frame}", scale(self.multiple, vector))
            for name, vector in (("w", motion.omega), ("v", motion.velocity))
        )
        return FrameMotion(omega, velocity)

    def _multiplied(self, column: Column) -> Column:
        """Return a column of [A] and [C] that begins, with its part of [C] multiplied."""
        coriolis = Wrench(*(scale(self.multiple, v) for v in (column.coriolis.force, column.coriolis.moment)))
        couple = scale(self.multiple, column.couple)
        return with_coriolis(column, coriolis, couple, self.tree.definitions)


def sliding(joint: JointMotion) -> Vector:
    """Return the velocity that the translations of a joint cause, in J (m/s)."""
    total = ZERO
    for one in joint.moving_translations:
        total = add(total, scale(one.rate, one.direction))
    return total


def frame_motions(tree: Tree) -> list[tuple[FrameMotion, ...]]:
    """Return by body the motion of the frame below each turn of its joint, then of its own; 0 is the ground.

    Velocities are past the first body of a branch: [C] is the same for all observers without acceleration.
    """
    still = (FrameMotion(ZERO, ZERO),)
    found: list[tuple[FrameMotion, ...]] = [still]
    for joint in tree.joints:
        k, define = joint.body, tree.definitions.vector
        tree.about(k, "angular velocity, and velocity past the first body, Eqs. (11), (25)")
        omega, velocity = found[joint.lower][-1].omega, found[joint.lower][-1].velocity
        if joint.lower:
            velocity = add(velocity, add(cross(omega, joint.offset), sliding(joint)))
            velocity = define(f"vb_{k}j", velocity)
        frames = [FrameMotion(omega, velocity)]
        for step in joint.steps:
            omega = add(step.turn.up(omega), scale(step.rate, unit(step.axis)))
            omega = define(f"omega_{joint.above(step)}", omega)
            velocity = define(f"vb_{joint.above(step)}", step.turn.up(velocity))
            frames.append(FrameMotion(omega, velocity))
        if joint.angular_speeds:
            omega = define(f"omega_{k}", add(omega, joint.relative_omega))
            frames[-1] = FrameMotion(omega, velocity)
        found.append(tuple(frames))
    return found
