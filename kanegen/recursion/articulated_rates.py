"""The derivatives of the wrench that an articulated body needs, by the angular velocity of its lower body.

The bodies outward of a joint move as their lower body makes them: by its angular velocity {w}, its angular
acceleration and the acceleration of an origin O. Let these change by {dw}, {dalpha} and {da}, where the
speeds outward stay as they are. A particle at {r}, which moves relative to the body, then changes its
acceleration by

    {da} + {dalpha} x {r} + {dw} x ({w} x {r}) + {w} x ({dw} x {r}) + 2 {dw} x {r'}
        = {da} + 2 {v_O} x {dw} + ({dalpha} + {w} x {dw}) x {r} + 2 {dw} x {v},

where {v_O} and {v} are the velocities of O and of the particle past any point that moves uniformly. So, with
the changes {dalpha} + {w} x {dw} and {da} + 2 {v_O} x {dw} in the places of {dalpha} and {da}, accelerations
change as those of a body at rest, and each particle needs the force 2 m {dw} x {v} besides:

    {dN; dF} = [S] {dalpha + w x dw; da + 2 v_O x dw} + [B] {dw}.

[B] is summed over particles, so that it is passed inward as a wrench is, whatever the motion of the frames.
For a rigid body, with the second moments [D] = sum m {r}{r}^T, it is

    {dN} = (tr[K] [1] - [K]) {dw},   {dF} = -2 {p} x {dw},   [K] = 2 [w~][D] + 2 {v_O}{h}^T.

Where a freedom is eliminated, the acceleration that it takes changes by the row of [B] along it, over the
pivot. Velocities are those past the origin of the outermost body: so they are as small as the bodies outward
of a joint allow, on which [B] depends, and it does not matter how fast what carries these moves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sympy import Expr, S

from kanegen.recursion.articulated_inertia import Elimination
from kanegen.recursion.body_motion import BodyMotion
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import FrameChange, FreeComponent, OriginChange, PathElement
from kanegen.recursion.relative_momentum import second_moments
from kanegen.recursion.solved_motion import Paths
from kanegen.recursion.tree import Tree
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, add, cross, dot, scale, subtract
from kanegen.symbolic.definitions import AXES, Definitions, Vector

TWO = S(2)


@dataclass(frozen=True)
class ArticulatedRates:
    """The matrix [B] of an articulated body, in blocks.

    Attributes:
        moment: Moment by angular velocity, row by row (kg m^2/s).
        force: Force by angular velocity, row by row (kg m/s).
    """

    moment: Rows = (ZERO, ZERO, ZERO)
    force: Rows = (ZERO, ZERO, ZERO)

    @property
    def rows(self) -> tuple[Vector, ...]:
        """All six rows, those of the moment first."""
        return self.moment + self.force

    def plus(self, other: ArticulatedRates, name: str, definitions: Definitions) -> ArticulatedRates:
        """Return the sum of this matrix and another, with a symbol for every entry."""
        rows = [add(a, b) for a, b in zip(self.rows, other.rows, strict=True)]
        return _named(rows, name, definitions)

    def eliminated(self, found: Elimination, definitions: Definitions) -> ArticulatedRates:
        """Return the matrix after the elimination of a freedom."""
        own = self.rows[found.index]
        rows = [subtract(row, scale(found.gains.get(i, S.Zero), own)) for i, row in enumerate(self.rows)]
        rows[found.index] = scale(found.kept, own)
        return _named(rows, found.name, definitions)

    def down(self, turn: Turn, name: str, definitions: Definitions) -> ArticulatedRates:
        """Return the matrix in components of the frame below a turn."""
        moment = turn.down_matrix(definitions, f"BN_{name}", self.moment)
        return ArticulatedRates(moment, turn.down_matrix(definitions, f"BF_{name}", self.force))

    def shifted(self, d: Vector, name: str, definitions: Definitions) -> ArticulatedRates:
        """Return the matrix about another origin, from which {d} leads to the current one."""
        columns = [cross(d, Vector(*(row[j] for row in self.force))) for j in range(3)]
        moment = [add(row, Vector(*(one[i] for one in columns))) for i, row in enumerate(self.moment)]
        return _named([*moment, *self.force], name, definitions)

    def wrench(self, change: Vector) -> list[Expr]:
        """Return the moment and the force for a change of the angular velocity."""
        return [dot(row, change) for row in self.rows]


def rigid_body_rates(
    inertia: Inertia, omega: Vector, velocity: Vector, name: str, definitions: Definitions
) -> ArticulatedRates:
    """Return the matrix of a rigid body alone.

    Args:
        inertia: Its inertia.
        omega: Twice its angular velocity (rad/s).
        velocity: Twice the velocity of its origin (m/s).
        name: Suffix of the names of intermediates.
        definitions: Definitions that the intermediates are added to.
    """
    h, second = inertia.moment, second_moments(inertia, None, name, definitions)
    spread = [cross(omega, column) for column in second]  # [w~][D] has no trace
    products = definitions.vector(f"hb_{name}", Vector(*(velocity[i] * h[i] for i in range(3))))
    moment = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        row = [-(spread[column][i] + velocity[i] * h[column]) for column in range(3)]
        row[i] = products[j] + products[k] - spread[i][i]
        moment.append(Vector(*row))
    p = definitions.vector(f"pb_{name}", add(cross(omega, h), scale(inertia.mass, velocity)))
    force = [Vector(S.Zero, p.z, -p.y), Vector(-p.z, S.Zero, p.x), Vector(p.y, -p.x, S.Zero)]
    return _named([*moment, *force], f"{name}own", definitions)


class DoubledVelocities:
    """Twice the velocity of every origin past that of the outermost body of its tree on the ground.

    Attributes:
        along: Components in the frame below each turn of the joint, then in the frame of the body (m/s), by
        body. omega: Twice the angular velocity, in the frame of the body (rad/s).
    """

    def __init__(self, tree: Tree, motions: Mapping[int, BodyMotion]) -> None:
        """Derive the velocities of all bodies, whose motions are given."""
        self._definitions = tree.definitions
        define = tree.definitions.vector
        self.omega = {k: define(f"w_{k}", scale(TWO, one.omega)) for k, one in motions.items()}
        self.along: dict[int, list[Vector]] = {}
        self._origins: dict[int, Vector] = {}
        for joint in _outermost(tree):
            velocity = ZERO
            for inward in tree.inward(joint):
                tree.about(inward.body, "velocity of the origin")
                velocity = self._pass_inward(inward, velocity)
        for joint in tree.joints:
            if joint.body not in self.along:
                tree.about(joint.body, "velocity of the origin")
                self._pass_outward(joint)

    def _pass_inward(self, joint: JointMotion, velocity: Vector) -> Vector:
        """Return the velocity of the lower body's origin, from that of the origin of a joint's body."""
        self._origins[joint.body], found = velocity, [velocity]
        for step in reversed(joint.steps):
            found.insert(0, self._definitions.vector(f"vm_{step.frame}", step.turn.down(found[0])))
        self.along[joint.body] = found
        across = subtract(found[0], self._across(joint))
        return self._definitions.vector(f"vm_{joint.lower}", across)

    def _pass_outward(self, joint: JointMotion) -> None:
        """Record the velocity of the origin of a body from that of its lower body."""
        velocity = add(self._origins.get(joint.lower, ZERO), self._across(joint))
        found = [self._definitions.vector(f"vm_{joint.body}j", velocity)]
        for step in joint.steps:
            turned = self._definitions.vector(f"vm_{joint.above(step)}", step.turn.up(found[-1]))
            found.append(turned)
        self.along[joint.body], self._origins[joint.body] = found, found[-1]

    def _across(self, joint: JointMotion) -> Vector:
        """Return twice the velocity of the origin of a body past that of its lower body, in its frame."""
        velocity = cross(self.omega[joint.lower], joint.offset)
        for one in joint.moving_translations:
            velocity = add(velocity, scale(TWO * one.rate, one.direction))
        return velocity


def _outermost(tree: Tree) -> list[JointMotion]:
    """Return the joint that is farthest from the ground, in each tree on the ground."""
    found: dict[int, tuple[int, JointMotion]] = {}
    for joint in tree.joints:
        path = list(tree.inward(joint))
        root = path[-1].body
        if root not in found or len(path) > found[root][0]:
            found[root] = len(path), joint
    return [joint for _, joint in found.values()]


class PassedRates:
    """The matrices [B] of a tree, inward of each element of the path of each body.

    Attributes:
        matrices: [B] by body, inward of each element.
        gains: By freedom, the row of [B] along it, over the pivot.
    """

    def __init__(
        self, tree: Tree, paths: Paths, eliminations: Sequence[Elimination], velocities: DoubledVelocities
    ) -> None:
        """Pass the matrices inward, joint by joint.

        Args:
            tree: The tree.
            paths: Path through the joint of each body, with hinges and slides alone.
            eliminations: Elimination of each freedom.
            velocities: Velocities of the bodies.
        """
        self.matrices: dict[int, list[ArticulatedRates]] = {}
        self.gains: dict[int, Vector] = {}
        self._definitions, self._eliminations = tree.definitions, eliminations
        carried = [ArticulatedRates() for _ in range(len(tree.joints) + 1)]
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "wrench by angular velocity")
            moving = velocities.omega[k], velocities.along[k][-1]
            own = rigid_body_rates(tree.inertias[k - 1], *moving, f"{k}", tree.definitions)
            body = own.plus(carried[k], f"{k}", tree.definitions)
            self.matrices[k] = []
            for element in paths[k]:
                body = self._inward(body, element)
                self.matrices[k].append(body)
            if j:
                carried[j] = carried[j].plus(body, f"{j}", tree.definitions)

    def _inward(self, body: ArticulatedRates, element: PathElement) -> ArticulatedRates:
        """Return a matrix inward of an element of a path, and record the gains of a freedom."""
        match element:
            case FreeComponent(freedom=freedom):
                found = self._eliminations[freedom]
                gains = scale(found.inverse, body.rows[found.index])
                self.gains[freedom] = self._definitions.vector(f"gw_{freedom}", gains)
                return body.eliminated(found, self._definitions)
            case FrameChange(turn, name):
                return body.down(turn, name, self._definitions)
            case OriginChange(offset, name):
                return body.shifted(offset, name, self._definitions)
        raise TypeError(element)


def _named(rows: Sequence[Vector], name: str, definitions: Definitions) -> ArticulatedRates:
    """Return the matrix of six rows with a symbol for every entry."""
    letters = [f"BN_{name}_{axis}" for axis in AXES] + [f"BF_{name}_{axis}" for axis in AXES]
    x, y, z, u, v, w = (definitions.vector(one, row) for one, row in zip(letters, rows, strict=True))
    return ArticulatedRates((x, y, z), (u, v, w))
