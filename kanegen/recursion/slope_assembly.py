"""The assembly of [C] in which columns also hold derivatives by coordinates.

The formulas are those of `inverse_dynamics_derivatives`. For an angle the axis {b} is that of the turn. For
the components of an angular velocity the derivatives are those by rotations about the basis vectors of K, as
axes that move with J: such a rotation leaves the components in K of the angular velocity and of its rate as
they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from sympy import Add, Expr, Integer

from kanegen.recursion.body_motion import FrameAcceleration, body_motions
from kanegen.recursion.coriolis_assembly import Carried, CoriolisAssembly
from kanegen.recursion.coriolis_columns import Column, MovingBody, with_coriolis, with_slope
from kanegen.recursion.inverse_dynamics import carried_wrenches, required_wrenches
from kanegen.recursion.joint_motion import AngularSpeed, FreedomMotion, JointMotion, Step, Translation
from kanegen.recursion.relative_momentum import whole_second_moments
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import Rows, Wrench, add, cross, dot, multiply, rows, scale, subtract, unit
from kanegen.symbolic.definitions import Vector

TWO = Integer(2)


@dataclass(frozen=True)
class Axis:
    """The axis {b} of a freedom in a frame, with its rates, as the recursion needs them.

    Attributes:
        label: Suffix of the names of intermediates.
        direction: {b}.
        rate: {b'} (1/s).
        second: {b''} (1/s^2).
    """

    label: str
    direction: Vector
    rate: Vector
    second: Vector


class SlopeAssembly(CoriolisAssembly):
    """The assembly of [C], in which columns have slopes; [A] and derivatives by coordinates come with it.

    The pose of a floating body (`free_components`) changes nothing, and its columns have no slopes.

    Args:
        tree: The tree, with joined turns.
        accelerated: Whether the freedoms have accelerations.
    """

    def __init__(self, tree: Tree, *, accelerated: bool) -> None:
        super().__init__(tree, (), TWO)
        moved = body_motions(tree, accelerated=accelerated)
        needed = required_wrenches(tree, moved, {})
        self._paths = {k: motion.path for k, motion in moved.items()}
        self._transmitted = {one.joint.body: one.path for one in carried_wrenches(tree, needed)}
        self._slopes: dict[tuple[int, int], list[Expr]] = {}
        self._inertias: dict[tuple[int, int], list[Expr]] = {}

    def by_rotation(self, i: int, j: int) -> Expr:
        """Return the derivative of generalized force i by a motion along freedom j, the sum of its terms.

        For a component of an angular velocity this motion is a rotation about its axis.
        """
        return self.tree.definitions.define(f"fx_{i}_{j}", Add(*self._slopes.get((i, j), [])))

    def inertia(self, i: int, j: int) -> Expr:
        """Return an entry of [A] without armature, the sum of its terms."""
        terms = self._inertias.get((max(i, j), min(i, j)), [])
        return self.tree.definitions.define(f"A_{max(i, j)}_{min(i, j)}", Add(*terms))

    def by_speed(self, i: int, j: int) -> Expr:
        """Return the derivative of generalized force i by speed j, twice the entry of [C]."""
        return self.entry(i, j)

    def _record_slope(self, rows: Mapping[int, Expr], columns: Mapping[int, Expr], value: Expr) -> None:
        """Add the value for two freedoms to the derivatives of the entries of {y} that move them."""
        for i, one in rows.items():
            for j, other in columns.items():
                self._slopes.setdefault((i, j), []).append(one * other * value)

    def _record_inertia(self, one: FreedomMotion, places: Mapping[int, Expr], value: Expr) -> None:
        """Add the inertia of two freedoms to the entries of [A] of the entries of {y} that move them."""
        same = places is one.shares
        for i, share in one.shares.items():
            for j, other in places.items():
                pair, term = (max(i, j), min(i, j)), share * other * value
                if not same or j <= i:
                    self._inertias.setdefault(pair, []).append(2 * term if i == j and not same else term)

    def _axis(self, direction: Vector, frame: FrameAcceleration, label: str) -> Axis:
        """Return a direction that does not move in a frame, with its rates."""
        define = self.tree.definitions.vector
        rate = define(f"bx_{label}", cross(frame.omega, direction))
        second = add(cross(frame.alpha, direction), cross(frame.omega, rate))
        return Axis(label, direction, rate, define(f"bxx_{label}", second))

    def record_angle(self, joint: JointMotion, step: Step, seen: Carried, *, is_below: bool) -> None:
        """Record the entries of an angle and the derivatives by it and by the freedoms further outward."""
        super().record_angle(joint, step, seen, is_below=is_below)
        frame = self._paths[joint.body][joint.steps.index(step) + (not is_below)]
        axis = self._axis(unit(step.axis), frame, f"{step.frame}{'' if is_below else 'u'}")
        self._record_rotation(step, axis, frame, seen, seen.columns)
        for col in seen.columns:
            self._record_inertia(step, col.places, col.inertial.moment[step.axis])
            self._record_slope(step.shares, col.places, _slope(col).moment[step.axis])

    def _record_rotation(
        self,
        one: FreedomMotion,
        axis: Axis,
        frame: FrameAcceleration,
        seen: Carried,
        columns: Iterable[Column],
    ) -> None:
        """Record the derivatives by a rotation in the rows of freedoms that turn with it.

        Args:
            one: The freedom that rotates.
            axis: Its axis.
            frame: Motion of a frame in which the axis does not move.
            seen: What the body carries, as this frame sees it.
            columns: The columns of these freedoms.
        """
        passing = cross(axis.rate, self.multiplied_motion(seen.body.motion, axis.label).velocity)
        passing = add(passing, cross(axis.direction, frame.acceleration))
        passing = self.tree.definitions.vector(f"ux_{axis.label}", passing)
        for col in columns:
            value = dot(col.inertial.moment, axis.second) + dot(col.couple, axis.rate)
            self._record_slope(col.places, one.shares, value - dot(col.inertial.force, passing))

    def with_angular_speeds(self, carried: Carried, joint: JointMotion) -> Carried:
        """Record entries of components of an angular velocity and derivatives by rotations about them."""
        seen = super().with_angular_speeds(carried, joint)
        frame = self._paths[joint.body][-2]
        for place, one in enumerate(joint.angular_speeds):
            for col in (*seen.arriving, *seen.own[: place + 1]):
                places = one.shares if col is seen.own[place] else col.places
                self._record_inertia(one, places, col.inertial.moment[one.axis])
            for col in seen.arriving:
                self._record_slope(one.shares, col.places, _slope(col).moment[one.axis])
            if not joint.is_weightless:
                axis = self._axis(unit(one.axis), frame, f"{joint.body}w{one.axis + 1}")
                self._record_rotation(one, axis, frame, seen, seen.columns)
        return seen

    def begun_angular(
        self, joint: JointMotion, one: AngularSpeed, body: MovingBody, below: MovingBody, second: Rows
    ) -> Column:
        """Begin the column of a component of a relative angular velocity {w}, with its slope.

        Accelerations depend on {w} through the rates of the partial velocities, twice, and through {a} x {w}
        for the basis vector {a} of the component, because K turns with {w}. The slope is that of a rotation
        about {a} as an axis of J.
        """
        begun = super().begun_angular(joint, one, body, below, second)
        definitions, turned = self.tree.definitions, cross(unit(one.axis), joint.relative_omega)
        force = add(begun.coriolis.force, cross(turned, body.inertia.moment))
        moment = add(begun.coriolis.moment, multiply(rows(body.inertia.inertia), turned))
        begun = with_coriolis(begun, Wrench(force, moment), begun.couple, definitions)
        if joint.is_weightless:
            return begun
        frame, load = self._paths[joint.body][-2], self._transmitted[joint.body][-1]
        axis = self._axis(unit(one.axis), frame, begun.inertial.label)
        slope = self._rotation_slope(axis, frame, load, below, second, begun.inertial.label)
        return with_slope(begun, slope, definitions)

    def across_angular(self, col: Column, joint: JointMotion, one: AngularSpeed, body: MovingBody) -> Expr:
        """Return the derivative by a component of {w} in the row of a freedom outward."""
        across = super().across_angular(col, joint, one, body)
        return across + dot(col.inertial.moment, cross(unit(one.axis), joint.relative_omega))

    def begun_rotation(self, joint: JointMotion, step: Step, body: MovingBody, second: Rows) -> Column:
        """Begin the column of an angle below its turn, with its slope; record the derivative by itself."""
        begun, place = super().begun_rotation(joint, step, body, second), joint.steps.index(step)
        frame, load = self._paths[joint.body][place], self._transmitted[joint.body][place]
        axis = self._axis(unit(step.axis), frame, step.frame)
        whole = whole_second_moments(body.inertia, step.axis, second, step.frame, self.tree.definitions)
        slope = self._rotation_slope(axis, frame, load, body, whole, begun.inertial.label)
        begun = with_slope(begun, slope, self.tree.definitions)
        self._record_inertia(step, step.shares, begun.inertial.moment[step.axis])
        self._record_slope(step.shares, step.shares, _slope(begun).moment[step.axis])
        return begun

    def _rotation_slope(
        self, axis: Axis, frame: FrameAcceleration, load: Wrench, body: MovingBody, second: Rows, label: str
    ) -> Wrench:
        """Return the derivatives by an angle of the force and the moment that its composite body requires.

        Args:
            axis: The axis of the angle.
            frame: Motion of the frame below the turn.
            load: Force and moment that the joint transmits, in this frame.
            body: The composite body, in this frame.
            second: Second moments [D] of the body.
            label: Suffix of the names of intermediates.
        """
        define, inertia, b = self.tree.definitions.vector, body.inertia, axis.direction
        momentum = define(f"px_{label}", add(cross(frame.omega, inertia.moment), body.momentum.linear))
        rest = define(f"Fx_{label}", subtract(load.force, scale(inertia.mass, frame.acceleration)))
        force = add(cross(axis.second, inertia.moment), scale(TWO, cross(axis.rate, momentum)))
        spread = define(f"Dx_{label}", multiply(second, axis.rate))
        turning = subtract(multiply(body.momentum.rate, axis.rate), cross(frame.omega, spread))
        moment = add(multiply(rows(inertia.inertia), axis.second), scale(TWO, turning))
        carried = define(f"ax_{label}", cross(b, frame.acceleration))
        moment = add(moment, subtract(cross(b, load.moment), cross(inertia.moment, carried)))
        return Wrench(add(force, cross(b, rest)), moment)

    def record_translations(self, carried: Carried, joint: JointMotion) -> None:
        """Record the entries of translations and the derivatives by them and the freedoms further outward."""
        super().record_translations(carried, joint)
        mass = carried.body.inertia.mass
        axes = {one.number: self._translation_axis(joint, one) for one in joint.translations}
        for one in joint.translations:
            for col in carried.columns:
                self._record_inertia(one, col.places, dot(one.direction, col.inertial.force))
                if col.slope:
                    self._record_slope(one.shares, col.places, dot(one.direction, col.slope.force))
                self._record_slope(col.places, one.shares, dot(col.inertial.force, axes[one.number].second))
            for other in joint.translations:
                if other.number <= one.number:
                    places = one.shares if other is one else other.shares
                    self._record_inertia(one, places, mass * dot(one.direction, other.direction))
                value = mass * dot(one.direction, axes[other.number].second)
                self._record_slope(one.shares, other.shares, value)

    def begun_translation(self, joint: JointMotion, one: Translation, body: MovingBody) -> Column:
        """Begin the column of a translation, with its slope."""
        begun, axis = super().begun_translation(joint, one, body), self._translation_axis(joint, one)
        force = self._transmitted[joint.body][0].force
        moment = add(cross(body.inertia.moment, axis.second), cross(one.direction, force))
        slope = Wrench(scale(body.inertia.mass, axis.second), moment)
        return with_slope(begun, slope, self.tree.definitions)

    def _translation_axis(self, joint: JointMotion, one: Translation) -> Axis:
        """Return the direction of a translation with its rates, in the frame of the lower body."""
        return self._axis(one.direction, self._paths[joint.body][0], f"{joint.body}t{one.number}")


def _slope(column: Column) -> Wrench:
    """Return the slope of a column that has one."""
    assert column.slope is not None
    return column.slope
