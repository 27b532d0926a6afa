"""Derivatives of {ydot} by articulated bodies, for long chains of hinges and slides.

The derivatives are made freedom by freedom, instead of solving [A]{z} + {b} = {0} for each column: that costs
the third power of the number of freedoms n, this the second. A coordinate or a speed of freedom j changes
what the bodies outward of j see, and so the wrench that they need of their lower body (`motion_changes`).

Freedoms i that are not outward of j feel this wrench alone. By reciprocity their accelerations change by

    -{a_i} . {change of the wrench},

where {a_i} is the acceleration that a unit effort on i causes of the lower body of j. From the body of i it
is passed outward, and gives the entries of [A]^-1 on the way. The accelerations of the bodies inward of i
follow from their compliance and from the wrench that the unit effort transmits to them.

That wrench, on its way inward from i, is also how the acceleration of i depends on changes further inward:

    {N; F} . {change of accelerations} + {R} . {change of the angular velocity}

for the wrench {N; F} on the body inward of i, and {R} which each elimination on the way changes by the row of
[B] along the freedom. This gives the derivatives by freedoms j that i is outward of, and by its own.

Nothing here is a difference of larger numbers but the eliminations of the solver itself. The method is that
of force propagation (Lilly and Orin 1993; Wensing, Featherstone and Orin 2012), with derivatives.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sympy import Add, Expr, S

from kanegen.recursion.articulated_bodies import ArticulatedBodies, Passed
from kanegen.recursion.articulated_inertia import SIX
from kanegen.recursion.body_motion import BodyMotion
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import FrameChange, FreeComponent, OriginChange, PathElement
from kanegen.recursion.motion_changes import MotionChanges
from kanegen.recursion.vectors import add, cross, dot, negate, scale, subtract
from kanegen.symbolic.definitions import Vector

Entries = dict[tuple[int, int], Expr]
"""Entries of a matrix by row and column; those that are zero by structure are absent."""


class ArticulatedDerivatives:
    """The derivatives of {ydot} by the coordinates, by the speeds, and by efforts on the freedoms.

    Attributes:
        by_coordinate: Derivative of entry i of {ydot} by the coordinate of freedom j.
        by_speed: Derivative by its speed.
        inverse: Derivative by the effort on it, an entry of [A]^-1.
    """

    def __init__(self, solver: ArticulatedBodies, motions: Mapping[int, BodyMotion], passed: Passed) -> None:
        """Derive the derivatives of all entries of {ydot}.

        Args:
            solver: The eliminations; the joints have hinges and slides alone.
            motions: Motions where all free components are zero.
            passed: The solution.
        """
        self._solver, self._tree = solver, solver.tree
        self._changes = MotionChanges(solver, motions, passed)
        self._outward: dict[int, list[JointMotion]] = {k: [] for k in range(len(self._tree.joints) + 1)}
        for joint in self._tree.joints:
            self._outward[joint.lower].append(joint)
        self.by_coordinate: Entries = {}
        self.by_speed: Entries = {}
        self.inverse: Entries = {}
        for joint in self._tree.joints:
            for place, element in enumerate(solver.paths[joint.body]):
                if isinstance(element, FreeComponent):
                    self._derive_row(joint, place, element.freedom)

    def _derive_row(self, joint: JointMotion, place: int, i: int) -> None:
        """Derive the derivatives of an entry of {ydot}.

        Args:
            joint: The joint of its freedom.
            place: Place of the freedom on the path of the joint.
            i: Number of the freedom.
        """
        self._tree.about(joint.body, f"derivatives of entry {i} of {{ydot}}")
        effort, path = self._changes.efforts[i], self._solver.paths[joint.body]
        self.inverse[i, i] = effort.mobility
        self._pass_outward(joint, place - 1, effort.acceleration, i)
        row = _Row(self._solver, self._changes, i)
        self._record_inward(joint.body, place, row)
        for further in range(place + 1, len(path)):
            row.pass_inward(path[further])
            self._record_inward(joint.body, further, row)
        for lower in list(self._tree.inward(joint))[1:]:
            self._pass_to_branches(lower.body, joint.body, row)
            joint = lower
            for further, element in enumerate(self._solver.paths[joint.body]):
                row.pass_inward(element)
                self._record_inward(joint.body, further, row)

    def _pass_to_branches(self, k: int, outward: int, row: _Row) -> None:
        """Pass what a unit effort causes of body `k` to all that it carries but the body `outward`."""
        branches = [joint for joint in self._outward[k] if joint.body != outward]
        if not branches:
            return
        i, caused = row.freedom, self._changes.compliances[k].acceleration(row.load)
        with self._tree.definitions.marking(f"_u{i}"):
            a = tuple(self._tree.definitions.define(f"qk_{k}_{c}", value) for c, value in enumerate(caused))
        for joint in branches:
            self._pass_outward(joint, len(self._solver.paths[joint.body]) - 1, a, i)

    def _pass_outward(self, joint: JointMotion, place: int, a: tuple[Expr, ...], i: int) -> None:
        """Pass the acceleration that a unit effort causes outward, and record the derivatives on the way.

        Args:
            joint: The joint on whose path it begins.
            place: Place of the first element that it passes.
            a: The acceleration inward of this element.
            i: The freedom of the effort.
        """
        definitions, path = self._tree.definitions, self._solver.paths[joint.body]
        for further in range(place, -1, -1):
            element = path[further]
            if one := self._changes.levels.get((joint.body, further)):
                by_coordinate, by_speed = self._changes.changes[one.freedom]
                self._record(
                    i, one.freedom, -_product(a, by_coordinate.wrench), -_product(a, by_speed.wrench)
                )
            if isinstance(element, FreeComponent):
                a = self._pass_freedom(element, a, i)
            else:
                with definitions.marking(f"_u{i}"):
                    a = element.outward(a, definitions)
        for outward in self._outward[joint.body]:
            self._pass_outward(outward, len(self._solver.paths[outward.body]) - 1, a, i)

    def _pass_freedom(self, element: FreeComponent, a: tuple[Expr, ...], i: int) -> tuple[Expr, ...]:
        """Return the acceleration outward of a freedom that no effort acts on; record the entry of [A]^-1."""
        definitions, j, index = self._tree.definitions, element.freedom, element.index
        with definitions.marking(f"_u{i}"):
            total, own = self._solver.elimination(j).solve(S.Zero, a, definitions)
        if (i, j) not in self.inverse:
            entry = definitions.define(f"Ai_{max(i, j)}_{min(i, j)}", own)
            self.inverse[i, j] = self.inverse[j, i] = entry
        return (*a[:index], total, *a[index + 1 :])

    def _record_inward(self, k: int, place: int, row: _Row) -> None:
        """Record the derivatives by the freedom whose changes are seen at a place, if there is one."""
        if one := self._changes.levels.get((k, place)):
            by_coordinate, by_speed = (
                _product(row.load, change.acceleration) + dot(row.rates, change.omega)
                for change in self._changes.changes[one.freedom]
            )
            self._record(row.freedom, one.freedom, by_coordinate, by_speed)

    def _record(self, i: int, j: int, by_coordinate: Expr, by_speed: Expr) -> None:
        """Record the derivatives of an entry by a coordinate and a speed."""
        define = self._tree.definitions.define
        self.by_coordinate[i, j] = define(f"yx_{i}_{j}", by_coordinate)
        self.by_speed[i, j] = define(f"yv_{i}_{j}", by_speed)


class _Row:
    """How the acceleration of a freedom depends on changes of the motion further and further inward.

    Attributes:
        freedom: Number of the freedom.
        load: The wrench that a unit effort on the freedom transmits, moment and force.
        rates: {R}, the dependence on changes of the angular velocity.
    """

    def __init__(self, solver: ArticulatedBodies, changes: MotionChanges, freedom: int) -> None:
        """Begin inward of the freedom itself."""
        self._solver, self._gains = solver, changes.rates.gains
        self.freedom = freedom
        own = solver.elimination(freedom)
        self.load = [-own.gains.get(c, S.Zero) for c in SIX]
        self.load[own.index] = -own.own_gain
        self.rates = negate(self._gains[freedom])

    def pass_inward(self, element: PathElement) -> None:
        """Pass an element of a path inward."""
        definitions = self._solver.tree.definitions
        with definitions.marking(f"_u{self.freedom}"):
            moment, force = Vector(*self.load[:3]), Vector(*self.load[3:])
            match element:
                case FreeComponent(freedom=j):
                    self._eliminate(j)
                case FrameChange(turn, name):
                    self._name(name, turn.down(moment), turn.down(force))
                    self.rates = definitions.vector(f"rw_{name}", turn.down(self.rates))
                case OriginChange(offset, name):
                    self._name(name, add(moment, cross(offset, force)), force)

    def _eliminate(self, j: int) -> None:
        """Let freedom j give way."""
        definitions, found = self._solver.tree.definitions, self._solver.elimination(j)
        along = self.load[found.index]
        left = [one - found.gains.get(c, S.Zero) * along for c, one in enumerate(self.load)]
        left[found.index] = found.kept * along
        self._name(f"{j}", Vector(*left[:3]), Vector(*left[3:]))
        self.rates = definitions.vector(f"rw_{j}", subtract(self.rates, scale(along, self._gains[j])))

    def _name(self, name: str, moment: Vector, force: Vector) -> None:
        """Take a wrench with a symbol for every component."""
        define = self._solver.tree.definitions.vector
        self.load = [*define(f"rN_{name}", moment), *define(f"rF_{name}", force)]


def _product(a: Sequence[Expr], b: Sequence[Expr]) -> Expr:
    """Return the product of two lists of six components."""
    return Add(*(a[c] * b[c] for c in SIX))
