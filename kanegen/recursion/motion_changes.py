"""What a change of a coordinate or a speed does to the motion of the bodies outward of a freedom.

Seen from a hinge with the axis {e}, a change of its angle turns the motion of the lower body, and its speed
adds to it. With the changes of `articulated_rates`, the rates {e'} = {w} x {e} and {e''} of an axis that
stands still in the lower body give

    by the angle:   {dw} = {e'},  {dalpha + w x dw} = {e''},  {da + 2 v_O x dw} = {a} x {e} + 2 {v_O} x {e'},
    by the speed:   {dw} = {e},   {dalpha + w x dw} = 2 {e'},  {da + 2 v_O x dw} = 2 {v_O} x {e};

and for a slide along {e}

    by the translation:  {da} = {e''},    by the speed:  {da} = 2 {e'}.

The bodies outward need a wrench that changes by [S] and [B] times this; a body that carries nothing needs by
its speed what is left where these cancel. For an angle, the wrench that the
hinge transmits turns besides, by {e} x {N} and {e} x {F}; for a translation its arm grows, by {e} x {F} in
the moment. The lower body gives way to this wrench, by its compliance.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sympy import Add, Expr

from kanegen.recursion.articulated_bodies import ArticulatedBodies, Passed
from kanegen.recursion.articulated_inertia import SIX
from kanegen.recursion.articulated_rates import TWO, DoubledVelocities, PassedRates
from kanegen.recursion.body_motion import BodyMotion
from kanegen.recursion.compliance import RIGID, Compliance, UnitEffort
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import ROTATIONS, FrameChange, FreeComponent, OriginChange, PathElement
from kanegen.recursion.relative_momentum import second_moments
from kanegen.recursion.vectors import ZERO, Wrench, add, cross, multiply, scale, unit
from kanegen.symbolic.definitions import Vector

NOTHING = Wrench()
"""The wrench of what turns or displaces no load."""

COORDINATE, SPEED = "x", "v"
"""What changes, as in the names of intermediates."""


@dataclass(frozen=True)
class Change:
    """A change inward of a freedom by its coordinate or its speed, as the bodies outward see it.

    Attributes:
        omega: Change {dw} of the angular velocity.
        acceleration: Changes {dalpha + w x dw; da + 2 v_O x dw}, where the lower body has given way.
        wrench: Change of the moment and the force that the bodies outward need before it gives way.
    """

    omega: Vector
    acceleration: tuple[Expr, ...]
    wrench: tuple[Expr, ...]


@dataclass(frozen=True)
class _Seen:
    """The motion of the lower body as a freedom sees it, in its frame and about its origin.

    Attributes:
        axis: The axis {e} of the freedom.
        omega: Angular velocity {w}.
        velocity: Twice the velocity {v_O}.
        alpha: Angular acceleration.
        acceleration: Acceleration of the origin less gravity.
        transmitted: Moment and force that the bodies outward need, about the origin.
    """

    axis: Vector
    omega: Vector
    velocity: Vector
    alpha: Vector
    acceleration: Vector
    transmitted: Wrench

    @property
    def rate(self) -> Vector:
        """The rate {e'} of the axis."""
        return cross(self.omega, self.axis)

    @property
    def second(self) -> Vector:
        """The second derivative {e''} of the axis."""
        return add(cross(self.alpha, self.axis), cross(self.omega, self.rate))


@dataclass(frozen=True)
class _Move:
    """What a coordinate or a speed does to the motion that the bodies outward see, before anything gives way.

    Attributes:
        omega: {dw}.
        angular: {dalpha + w x dw}.
        linear: {da + 2 v_O x dw}.
        wrench: Force and moment beside those of [S] and [B].
    """

    omega: Vector = ZERO
    angular: Vector = ZERO
    linear: Vector = ZERO
    wrench: Wrench = NOTHING


class MotionChanges:
    """The changes by the coordinates and the speeds of all freedoms, from the ground outward.

    Attributes:
        rates: The matrices [B].
        levels: The freedom whose changes are seen inward of an element, by body and place on its path: of a
            hinge this is below its turn.
        changes: Changes by freedom, that by the coordinate, then that by the speed.
        efforts: What a unit effort causes, by freedom.
        compliances: Compliance by body.
    """

    def __init__(self, solver: ArticulatedBodies, motions: Mapping[int, BodyMotion], passed: Passed) -> None:
        """Derive the changes of all freedoms, from the ground outward.

        Args:
            solver: The eliminations; the joints have hinges and slides alone.
            motions: Motions where all free components are zero.
            passed: The solution.
        """
        self._solver, self._motions, self._passed = solver, motions, passed
        self._velocities = DoubledVelocities(solver.tree, motions)
        eliminations = [solver.elimination(i) for i in range(len(solver.pivots))]
        self.rates = PassedRates(solver.tree, solver.paths, eliminations, self._velocities)
        self.levels: dict[tuple[int, int], FreeComponent] = {}
        self.changes: dict[int, tuple[Change, Change]] = {}
        self.efforts: dict[int, UnitEffort] = {}
        self.compliances: dict[int, Compliance] = {0: RIGID}
        self._moving_outward: set[int] = set()
        for joint in reversed(solver.tree.joints):
            if joint.elements or joint.body in self._moving_outward:
                self._moving_outward.add(joint.lower)
        for joint in solver.tree.joints:
            self._pass_outward(joint)

    def _pass_outward(self, joint: JointMotion) -> None:
        """Derive the changes of the freedoms of a joint, and the compliance of its body."""
        k, path = joint.body, self._solver.paths[joint.body]
        for place, element in enumerate(path):
            if isinstance(element, FreeComponent):
                self.levels[k, place + (element.index in ROTATIONS)] = element
        self._solver.tree.about(k, "what coordinates and speeds change")
        found = self.compliances[joint.lower]
        for place, element in reversed(list(enumerate(path))):
            if one := self.levels.get((k, place)):
                seen = self._seen(joint, one, place)
                by_coordinate, by_speed = self._moves(joint, one, seen)
                self.changes[one.freedom] = (
                    self._change((k, place), one, by_coordinate, found, COORDINATE),
                    self._change((k, place), one, by_speed, found, SPEED),
                )
            found = self._compliance(found, element)
        self.compliances[k] = found

    def _compliance(self, inward: Compliance, element: PathElement) -> Compliance:
        """Return the compliance outward of an element of a path, and record the unit effort on a freedom."""
        definitions = self._solver.tree.definitions
        match element:
            case FreeComponent(freedom=freedom):
                eliminated = self._solver.elimination(freedom)
                inward, self.efforts[freedom] = inward.with_freedom(eliminated, definitions)
            case FrameChange(turn, name):
                inward = inward.up(turn, f"{name}u", definitions)
            case OriginChange(offset, name):
                inward = inward.shifted(offset, name, definitions)
        return inward

    def _seen(self, joint: JointMotion, one: FreeComponent, place: int) -> _Seen:
        """Return the motion of the lower body, inward of an element of the path, as a freedom sees it."""
        k, i, define = joint.body, one.freedom, self._solver.tree.definitions.vector
        numbers = [step.number for step in joint.steps]
        step = numbers.index(i) if one.index in ROTATIONS else len(joint.constant)
        frame, added = self._motions[k].path[step], self._passed.accelerations[k][place]
        needed = self._passed.wrenches[k][place]
        by_solution = [
            Add(*(entry * a for entry, a in zip(row, added, strict=True)))
            for row in self._solver.inertias[k][place].matrix()
        ]
        moment, force = (
            add(needed.moment, Vector(*by_solution[:3])),
            add(needed.force, Vector(*by_solution[3:])),
        )
        return _Seen(
            unit(one.index % 3),
            frame.omega,
            self._velocities.along[k][step],
            define(f"qt_{i}", add(frame.alpha, Vector(*added[:3]))),
            define(f"at_{i}", add(frame.acceleration, Vector(*added[3:]))),
            Wrench(define(f"ft_{i}", force), define(f"nt_{i}", moment)),
        )

    def _moves(self, joint: JointMotion, one: FreeComponent, seen: _Seen) -> tuple[_Move, _Move]:
        """Return what the coordinate and the speed of a freedom of a joint do before anything gives way."""
        e, needed = seen.axis, seen.transmitted
        if one.index not in ROTATIONS:
            turned = Wrench(moment=cross(e, needed.force))
            return _Move(linear=seen.second, wrench=turned), _Move(linear=scale(TWO, seen.rate))
        linear = add(cross(seen.acceleration, e), cross(seen.velocity, seen.rate))
        turned = Wrench(cross(e, needed.force), cross(e, needed.moment))
        by_angle = _Move(seen.rate, seen.second, linear, turned)
        if joint.steps[-1].number == one.freedom and joint.body not in self._moving_outward:
            return by_angle, _Move(wrench=self._of_rigid_body(joint, e))
        return by_angle, _Move(e, scale(TWO, seen.rate), cross(seen.velocity, e))

    def _of_rigid_body(self, joint: JointMotion, e: Vector) -> Wrench:
        """Return the derivative by the speed of its hinge of the wrench that an outermost body needs.

        With its second moments [D] it is 2 [D]{w} x {e} and 2 {w} x ({e} x {h}), without a moment about the
        hinge.
        """
        definitions = self._solver.tree.definitions
        body, omega = self._solver.tree.inertias[joint.body - 1], self._velocities.omega[joint.body]
        spread = multiply(second_moments(body, None, f"{joint.body}", definitions), omega)
        force, moment = cross(omega, cross(e, body.moment)), cross(spread, e)
        turn = joint.steps[-1].turn
        return Wrench(turn.down(force), turn.down(moment))

    def _change(
        self, at: tuple[int, int], one: FreeComponent, move: _Move, inward: Compliance, by: str
    ) -> Change:
        """Return the change by a coordinate or a speed.

        Args:
            at: Number of the body, and place on its path.
            one: The freedom.
            move: What the coordinate or the speed does before anything gives way.
            inward: Compliance of the lower body there.
            by: `COORDINATE` or `SPEED`.
        """
        (k, place), define, i = at, self._solver.tree.definitions.define, one.freedom
        moved = [define(f"m{by}_{i}_{c}", value) for c, value in enumerate((*move.angular, *move.linear))]
        matrix, own = self._solver.inertias[k][place].matrix(), (*move.wrench.moment, *move.wrench.force)
        by_omega = self.rates.matrices[k][place].wrench(move.omega)
        wrench = [
            define(f"n{by}_{i}_{c}", own[c] + by_omega[c] + Add(*(matrix[c][d] * moved[d] for d in SIX)))
            for c in SIX
        ]
        given = inward.acceleration(wrench)
        left = (define(f"l{by}_{i}_{c}", moved[c] - given[c]) for c in SIX)
        return Change(move.omega, tuple(left), tuple(wrench))
