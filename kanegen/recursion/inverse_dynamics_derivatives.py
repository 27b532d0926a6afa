"""Derivatives of [A]{ydot} - {f} by {x} and {y}, by composite bodies, in one recursion inward.

A system is a set of particles at {r} with the partial velocities [v_P,y]. The generalized force of freedom i
is the sum of m [v_P,i] . {a}, where {a} is the acceleration less gravity. Where speeds are rates of
coordinates, its derivative by speed j is twice the entry of the Coriolis matrix (`coriolis`), and the
derivative of {a} by coordinate j is the second time derivative of [v_P,j]. For a rotation about an axis {b}
through O, which has the rates {b'} and {b''}, and particles outward of it, that is

    {b''} x ({r} - {r_O}) + 2 {b'} x ({v} - {v_O}) + {b} x ({a} - {a_O}),

and for a translation along {b} it is {b''}. Freedoms further outward turn with {b}, so that in their rows all
terms with {a} cancel: the force {F} and the moment {M} about O for unit acceleration, and the couple of the
row of [C], give

    {M} . {b''} + 2 {couple} . {b'} - {F} . (2 {b'} x {v_O} + {b} x {a_O}).

In the rows of freedoms further inward there remains a force and a moment that the composite body requires,
its `slope`, which is passed inward with the column. Loads on bodies turn with them and are part of the force
that a joint transmits. The formulas are those of Singh, Russell and Wensing (2022) for spatial vectors, here
with twelve numbers for the motion outward of a joint instead of a matrix of 36.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sympy import Add, Expr, Integer

from kanegen.model.system import System
from kanegen.recursion.body_motion import FrameAcceleration, body_motions
from kanegen.recursion.coriolis_assembly import Carried, CoriolisAssembly
from kanegen.recursion.coriolis_columns import Column, MovingBody, with_slope
from kanegen.recursion.inverse_dynamics import carried_wrenches, required_by_elements, required_wrenches
from kanegen.recursion.joined_turns import with_joined_turns
from kanegen.recursion.joint_motion import JointMotion, Step, Translation
from kanegen.recursion.relative_momentum import whole_second_moments
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import Rows, Wrench, add, cross, dot, multiply, rows, scale, subtract, unit
from kanegen.symbolic.definitions import Vector

TWO = Integer(2)


def has_structured_derivatives(system: System) -> bool:
    """Return whether all speeds of a system are rates of its coordinates, which the recursion needs."""
    return all(body.joint.speeds_are_rates for body in system.bodies)


def differentiates_solver(system: System) -> bool:
    """Return whether derivatives of {ydot} are those of its solver, not a product with [A]^-1.

    So it is where three angles of a joint can reach gimbal lock, next to which the product loses digits that
    {ydot} has, and where several bodies translate freely and rotate, which the solver never couples.
    """
    joints = [body.joint for body in system.bodies]
    may_lock = any(joint.speeds_are_rates and all(joint.free[:3]) for joint in joints)
    return may_lock or sum(all(joint.free[3:]) and any(joint.free[:3]) for joint in joints) > 1


def inverse_dynamics_by_state(tree: Tree) -> Derived:
    """Derive the derivatives of [A]{ydot} - {f} by {x}, then {y}, but for `inverse_dynamics_of_elements`."""
    return Derived(_by_state(tree, accelerated=True))


def forcing_by_state(tree: Tree) -> Derived:
    """Derive the derivatives of {f} by {x}, then by {y}, without those of `forcing_of_elements`."""
    return Derived([-entry for entry in _by_state(tree, accelerated=False)])


def inverse_dynamics_of_elements(tree: Tree) -> Derived:
    """Derive the part of [A]{ydot} - {f} that force elements, loads on points and rotors cause."""
    return Derived(_of_elements(tree, accelerated=True))


def forcing_of_elements(tree: Tree) -> Derived:
    """Derive the part of {f} that force elements, loads on points and rotors cause."""
    return Derived([-entry for entry in _of_elements(tree, accelerated=False)])


def _of_elements(tree: Tree, *, accelerated: bool) -> list[Expr]:
    """Return the part of the required generalized forces; `accelerated` as for `body_motions`."""
    return required_by_elements(tree, body_motions(tree, accelerated=accelerated), accelerated=accelerated)


def _by_state(tree: Tree, *, accelerated: bool) -> list[Expr]:
    """Return the derivatives of required generalized forces; `accelerated` as for `body_motions`."""
    tree = with_joined_turns(tree)
    assembly = _Assembly(tree, accelerated=accelerated)
    for joint in reversed(tree.joints):
        tree.about(joint.body, "columns and rows of derivatives")
        assembly.pass_inward(joint)
    places = range(len(tree.system.freedoms))
    return [
        entry
        for i in places
        for entry in (
            *(assembly.by_coordinate(i, j) for j in places),
            *(TWO * assembly.entry(i, j) for j in places),
        )
    ]


@dataclass(frozen=True)
class _Axis:
    """The axis {b} of a freedom in a frame, with its rates, as the recursion needs them.

    Attributes:
        direction: {b}.
        rate: {b'} (1/s).
        second: {b''} (1/s^2).
    """

    direction: Vector
    rate: Vector
    second: Vector


class _Assembly(CoriolisAssembly):
    """The assembly of [C], in which columns have slopes and derivatives by coordinates are recorded.

    Args:
        tree: The tree, with joined turns.
        accelerated: Whether the freedoms have accelerations.
    """

    def __init__(self, tree: Tree, *, accelerated: bool) -> None:
        super().__init__(tree, ())
        moved = body_motions(tree, accelerated=accelerated)
        needed = required_wrenches(tree, moved, {})
        self._paths = {k: motion.path for k, motion in moved.items()}
        self._transmitted = {one.joint.body: one.path for one in carried_wrenches(tree, needed)}
        self._slopes: dict[tuple[int, int], list[Expr]] = {}

    def by_coordinate(self, i: int, j: int) -> Expr:
        """Return the derivative of generalized force i by coordinate j, the sum of its terms."""
        return self.tree.definitions.define(f"fx_{i}_{j}", Add(*self._slopes.get((i, j), [])))

    def _record_slope(self, rows: Mapping[int, Expr], columns: Mapping[int, Expr], value: Expr) -> None:
        """Add the value for two freedoms to the derivatives of the entries of {y} that move them."""
        for i, one in rows.items():
            for j, other in columns.items():
                self._slopes.setdefault((i, j), []).append(one * other * value)

    def _axis(self, direction: Vector, frame: FrameAcceleration, label: str) -> _Axis:
        """Return a direction that does not move in a frame, with its rates."""
        define = self.tree.definitions.vector
        rate = define(f"bx_{label}", cross(frame.omega, direction))
        second = add(cross(frame.alpha, direction), cross(frame.omega, rate))
        return _Axis(direction, rate, define(f"bxx_{label}", second))

    def record_angle(self, joint: JointMotion, step: Step, seen: Carried, *, is_below: bool) -> None:
        """Record the entries of an angle and the derivatives by it and by the freedoms further outward."""
        super().record_angle(joint, step, seen, is_below=is_below)
        frame = self._paths[joint.body][joint.steps.index(step) + (not is_below)]
        label = f"{step.frame}{'' if is_below else 'u'}"
        axis = self._axis(unit(step.axis), frame, label)
        passing = scale(TWO, cross(axis.rate, seen.body.motion.velocity))
        passing = add(passing, cross(axis.direction, frame.acceleration))
        passing = self.tree.definitions.vector(f"ux_{label}", passing)
        for col in seen.columns:
            value = dot(col.inertial.moment, axis.second) + TWO * dot(col.couple, axis.rate)
            self._record_slope(col.places, step.shares, value - dot(col.inertial.force, passing))
            self._record_slope(step.shares, col.places, _slope(col).moment[step.axis])

    def begun_rotation(self, joint: JointMotion, step: Step, body: MovingBody, second: Rows) -> Column:
        """Begin the column of an angle below its turn, with its slope; record the derivative by itself."""
        begun, place = super().begun_rotation(joint, step, body, second), joint.steps.index(step)
        frame, load = self._paths[joint.body][place], self._transmitted[joint.body][place]
        axis = self._axis(unit(step.axis), frame, step.frame)
        whole = whole_second_moments(body.inertia, step.axis, second, step.frame, self.tree.definitions)
        slope = self._rotation_slope(axis, frame, load, body, whole, begun.inertial.label)
        begun = with_slope(begun, slope, self.tree.definitions)
        self._record_slope(step.shares, step.shares, _slope(begun).moment[step.axis])
        return begun

    def _rotation_slope(
        self, axis: _Axis, frame: FrameAcceleration, load: Wrench, body: MovingBody, second: Rows, label: str
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
                self._record_slope(one.shares, col.places, dot(one.direction, _slope(col).force))
                self._record_slope(col.places, one.shares, dot(col.inertial.force, axes[one.number].second))
            for other in joint.translations:
                value = mass * dot(one.direction, axes[other.number].second)
                self._record_slope(one.shares, other.shares, value)

    def begun_translation(self, joint: JointMotion, one: Translation, body: MovingBody) -> Column:
        """Begin the column of a translation, with its slope."""
        begun, axis = super().begun_translation(joint, one, body), self._translation_axis(joint, one)
        force = self._transmitted[joint.body][0].force
        moment = add(cross(body.inertia.moment, axis.second), cross(one.direction, force))
        slope = Wrench(scale(body.inertia.mass, axis.second), moment)
        return with_slope(begun, slope, self.tree.definitions)

    def _translation_axis(self, joint: JointMotion, one: Translation) -> _Axis:
        """Return the direction of a translation with its rates, in the frame of the lower body."""
        return self._axis(one.direction, self._paths[joint.body][0], f"{joint.body}t{one.number}")


def _slope(column: Column) -> Wrench:
    """Return the slope of a column that has one."""
    assert column.slope is not None
    return column.slope
