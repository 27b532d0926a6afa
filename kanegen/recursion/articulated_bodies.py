"""The solver of [A]{ydot} = {b} by articulated bodies.

Inward, every free component of a joint's acceleration is eliminated; outward, each is solved for. A joint
whose three angles are free is solved in angular acceleration, where it is regular, and only the result is
mapped to the angles by Eq. (9), unless its speeds are the angular velocity itself; so is one whose three
translations are free, in the body's own frame. A joint with all six freedoms passes nothing inward but its
efforts: the body behind it moves as if it were free.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sympy import Expr, S

from kanegen.recursion.articulated_inertia import ArticulatedInertia, Elimination, rigid_body
from kanegen.recursion.coordinate_rates import angle_rates
from kanegen.recursion.force_elements import element_efforts
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import (
    ROTATIONS,
    STILL,
    FrameChange,
    FreeComponent,
    OriginChange,
    PathElement,
    joint_path,
    rotates_freely,
    translates_freely,
)
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import Wrench, column
from kanegen.symbolic.definitions import Vector
from kanegen.symbolic.symbols import generalized_force


class ArticulatedBodies:
    """The eliminations of a tree, which solve [A]{ydot} = {b} for any right side.

    Attributes:
        tree: The tree.
        paths: By body the path through its joint, with the free components that are solved for.
        pivots: By freedom the divisor of its elimination.
    """

    def __init__(self, tree: Tree) -> None:
        """Eliminate every free component, from the outermost body inward."""
        self.tree = tree
        self.paths: Mapping[int, tuple[PathElement, ...]] = {
            joint.body: joint_path(joint, together=True) for joint in tree.joints
        }
        self._eliminations: dict[int, Elimination] = {}
        bodies = [rigid_body(own) for own in tree.inertias]
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "articulated body, Eq. (42)")
            passed = self._eliminate(joint, bodies[k - 1])
            if j:
                bodies[j - 1] = bodies[j - 1].plus(passed, f"{j}", tree.definitions)
        self.pivots: Sequence[Expr] = [self._eliminations[i].pivot for i in range(len(tree.system.freedoms))]

    def _eliminate(self, joint: JointMotion, body: ArticulatedInertia) -> ArticulatedInertia:
        """Return what body K passes to its lower body, about the lower body's origin."""
        definitions = self.tree.definitions
        for element in self.paths[joint.body]:
            match element:
                case FreeComponent(index, freedom):
                    body, found = body.eliminated(index, f"{freedom}", definitions)
                    self._eliminations[freedom] = found
                case FrameChange(turn, name):
                    body = body.down(turn, name, definitions)
                case OriginChange(offset, name):
                    body = body.shifted(offset, name, definitions)
        return body

    def solve(self, needs: Sequence[Wrench], name: str) -> list[Expr]:
        """Return the free components of the accelerations that the efforts cause.

        Args:
            needs: Wrench that each body needs for anything else.
            name: Prefix of the names of the components.
        """
        tree, definitions, efforts = self.tree, self.tree.definitions, self._efforts()
        alone: dict[int, Expr] = {}
        carried = list(needs)
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "forces on the articulated body, Eq. (42)")
            need = carried[k - 1]
            for element in self.paths[k]:
                if isinstance(element, FreeComponent):
                    i = element.freedom
                    need, alone[i] = self._eliminations[i].eliminate(need, efforts[i], definitions)
                else:
                    need = element.inward(need, definitions)
            if j:
                carried[j - 1] = carried[j - 1].plus(need, f"{j}", definitions)
        return self._outward(alone, name)

    def _outward(self, alone: dict[int, Expr], name: str) -> list[Expr]:
        """Return the free components, each from its value where the others are zero."""
        found: dict[int, Expr] = {}
        accelerations = {0: STILL}
        for joint in self.tree.joints:
            self.tree.about(joint.body, "accelerations, Eq. (42)")
            a = accelerations[joint.lower]
            for element in reversed(self.paths[joint.body]):
                if isinstance(element, FreeComponent):
                    i, freedom = element.index, element.freedom
                    solution = self._eliminations[freedom].solve(alone[freedom], a)
                    total = self.tree.definitions.define(f"q_{freedom}", solution)
                    # What the lower body does not carry along is the coordinate's.
                    found[freedom] = self.tree.definitions.define(f"{name}_{freedom}", total - a[i])
                    a = (*a[:i], total, *a[i + 1 :])
                else:
                    a = element.outward(a, self.tree.definitions)
            accelerations[joint.body] = a
        return [found[i] for i in range(len(found))]

    def speed_rates(self, components: Sequence[Expr], name: str) -> list[Expr]:
        """Return the {ydot} that belongs to free components of the accelerations."""
        result, definitions = dict(enumerate(components)), self.tree.definitions
        for joint in self.tree.joints:
            self.tree.about(joint.body, "{ydot} of the joint, Eq. (9)")
            if rotates_freely(joint):
                freedoms = [step.freedom for step in joint.angles]
                one, two, three = (f"{name}_{freedom}" for freedom in freedoms)
                angular = Vector(*(components[freedom] for freedom in freedoms))
                values = angle_rates(joint, definitions).rates(angular, (one, two, three))
                result |= dict(zip(freedoms, values, strict=True))
            if translates_freely(joint):
                linear = Vector(*(components[one.freedom] for one in joint.translations))
                for step in reversed(joint.angles):
                    linear = definitions.vector(f"qs_{step.frame}", step.turn.down(linear))
                result |= {one.freedom: linear[one.axis] for one in joint.translations}
        return [result[i] for i in range(len(components))]

    def _efforts(self) -> list[Expr]:
        """Return {tau} and the efforts of force elements, as forces and torques along the free components."""
        tree, definitions, acting = self.tree, self.tree.definitions, element_efforts(self.tree)
        result: dict[int, Expr] = {}
        for i, f in enumerate(tree.system.freedoms):
            effort = generalized_force(f.body, f.index) + acting.get((f.body, f.index), S.Zero)
            result[i] = definitions.define(f"te_{i}", effort)
        for joint in tree.joints:
            tree.about(joint.body, "efforts in the body, Eq. (9)")
            if translates_freely(joint):
                force = Vector(*(result[one.freedom] for one in joint.translations))
                for step in joint.angles:
                    force = definitions.vector(f"tF_{step.frame}u", step.turn.up(force))
                result |= {one.freedom: force[one.axis] for one in joint.translations}
            if rotates_freely(joint):
                freedoms = [step.freedom for step in joint.angles]
                one, two, three = (result[freedom] for freedom in freedoms)
                torque = angle_rates(joint, definitions).torque((one, two, three))
                result |= dict(zip(freedoms, torque, strict=True))
        return [result[i] for i in range(len(result))]

    @property
    def regular_if_positive(self) -> list[Expr]:
        """Expressions by freedom that are positive where [A] is regular."""
        result = list(self.pivots)
        for joint in self.tree.joints:
            # Where the angles' axes lie in a plane, [A] is singular though the body is not.
            if rotates_freely(joint):
                first, across = joint.angles[0].freedom, angle_rates(joint, self.tree.definitions).across
                weakened = result[first] * across * across
                result[first] = self.tree.definitions.define(f"Dc_{joint.body}", weakened)
        return result

    @property
    def diagonal(self) -> list[Expr]:
        """Inertia of the composite body by freedom: the pivot if everything else stood still."""
        tree, definitions = self.tree, self.tree.definitions
        result: dict[int, Expr] = {}
        bodies = list(tree.inertias)
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "composite body, Eq. (43)")
            composite = bodies[k - 1]
            for element in self.paths[k]:
                match element:
                    case FreeComponent(index, freedom):
                        inertia = column(composite.inertia, index % 3)[index % 3]
                        result[freedom] = inertia if index in ROTATIONS else composite.mass
                    case FrameChange(turn, name):
                        composite = composite.down(turn, name, definitions)
                    case OriginChange(offset, name):
                        composite = composite.shifted(offset, name, definitions)
            if j:
                bodies[j - 1] = bodies[j - 1].plus(composite, str(j), definitions)
        return [result[i] for i in range(len(result))]
