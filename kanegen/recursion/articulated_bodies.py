"""The solver of [A]{ydot} = {b} by articulated bodies.

Inward, every free component of a joint's acceleration is eliminated; outward, every one is solved for
(Featherstone 2008, section 7.3). A joint whose three angles are free is solved in the components of the
angular acceleration, where [A] is regular; Eq. (9) maps the result to the angles, unless the speeds are the
angular velocity. A joint whose three translations are free is likewise solved in components in the frame of
the body. A joint with six freedoms passes only its efforts inward: the inertia of its body does not load the
lower body.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sympy import Expr, S

from kanegen.recursion.articulated_inertia import ArticulatedInertia, Elimination, rigid_body
from kanegen.recursion.coordinate_rates import angle_rates
from kanegen.recursion.force_elements import element_efforts
from kanegen.recursion.inverse_dynamics import NOT_CARRIED, Carried, Requirement
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import (
    GROUND_ACCELERATION,
    ROTATIONS,
    FrameChange,
    FreeComponent,
    FreeTranslations,
    OriginChange,
    joint_path,
    released,
)
from kanegen.recursion.rotors import spinning_rotors, with_rotors
from kanegen.recursion.solved_motion import Paths, solved_motions
from kanegen.recursion.tree import Tree, about_mass_centers
from kanegen.recursion.vectors import column, subtract
from kanegen.symbolic.definitions import Vector
from kanegen.symbolic.symbols import generalized_force


class ArticulatedBodies:
    """The eliminations of a tree, which solve [A]{ydot} = {b} for any right side.

    Attributes:
        tree: The tree.
        paths: Path through the joint of each body, with the free components that are solved for, by body.
        pivots: Divisor of the elimination of each freedom.
        released: Freedoms of joints with three free translations or rotations.
        together: True.
    """

    together = True

    def __init__(self, tree: Tree) -> None:
        """Eliminate every free component, from the outermost body inward."""
        self.tree = tree = about_mass_centers(tree)
        self.released = released(tree, together=True)
        rotors = spinning_rotors(tree)
        self.paths: Paths = {
            joint.body: with_rotors(joint_path(joint, together=True), joint, rotors, tree.definitions)
            for joint in tree.joints
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
        """Return the articulated inertia that body K passes inward, about the lower body's origin."""
        definitions = self.tree.definitions
        for element in self.paths[joint.body]:
            match element:
                case FreeComponent(index, freedom, armature=armature, momentum=momentum):
                    motor = armature, momentum
                    body, found = body.eliminated(index, motor, f"{freedom}", definitions)
                    self._eliminations[freedom] = found
                case FrameChange(turn, name):
                    body = body.down(turn, name, definitions)
                case OriginChange(offset, name):
                    body = body.shifted(offset, name, definitions)
                case FreeTranslations():
                    pass  # No mass is left to transmit.
        return body

    def solve(self, bias: Requirement, name: str) -> list[Expr]:
        """Return the free components of the accelerations.

        Args:
            bias: What is required where all free components are zero.
            name: Prefix of the names of the components.
        """
        tree, definitions, efforts = self.tree, self.tree.definitions, self._joint_efforts(bias)
        along_components = self._component_efforts(efforts)
        alone: dict[int, Expr] = {}
        carried = list(bias.wrenches)
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "forces on the articulated body, Eq. (42)")
            wrench = carried[k - 1]
            for element in self.paths[k]:
                match element:
                    case FreeComponent(freedom=i):
                        effort = along_components[i]
                        wrench, alone[i] = self._eliminations[i].eliminate(wrench, effort, definitions)
                    case FreeTranslations():
                        wrench = element.inward(wrench, efforts)
                    case _:
                        wrench = element.inward(wrench, definitions)
            if j:
                carried[j - 1] = carried[j - 1].plus(wrench, f"{j}", definitions)
        return self._outward(alone, name)

    def _outward(self, alone: dict[int, Expr], name: str) -> list[Expr]:
        """Return the free components, from the value of each component where the others are zero."""
        found: dict[int, Expr] = {}
        accelerations = {0: GROUND_ACCELERATION}
        for joint in self.tree.joints:
            self.tree.about(joint.body, "accelerations, Eq. (42)")
            a = accelerations[joint.lower]
            for element in reversed(self.paths[joint.body]):
                if isinstance(element, FreeComponent):
                    i, freedom = element.index, element.freedom
                    total, own = self._eliminations[freedom].solve(alone[freedom], a, self.tree.definitions)
                    own = total if element.is_absolute else own
                    found[freedom] = self.tree.definitions.define(f"{name}_{freedom}", own)
                    a = (*a[:i], total, *a[i + 1 :])
                else:
                    a = element.outward(a, self.tree.definitions)
            accelerations[joint.body] = a
        return [found[i] for i in range(len(found))]

    def speed_rates(
        self, components: Sequence[Expr], name: str, carried: Mapping[int, Carried]
    ) -> list[Expr]:
        """Return {ydot} from the free components, less the accelerations that the bias left out, Eq. (9)."""
        if not self.released:
            return list(components)
        result = dict(enumerate(components))
        solved = solved_motions(self.tree, self.paths, components)
        for joint in self.tree.joints:
            along = carried.get(joint.body, NOT_CARRIED).plus(solved[joint.body].carried)
            self.tree.about(joint.body, "{ydot} of the joint, Eq. (9)")
            if joint.rotates_freely or joint.turns_freely:
                result |= self._rotation_rates(joint, components, along, name)
            if joint.translates_freely:
                result |= self._translation_rates(joint, components, along, name)
        return [result[i] for i in range(len(components))]

    def _rotation_rates(
        self, joint: JointMotion, components: Sequence[Expr], along: Carried, name: str
    ) -> dict[int, Expr]:
        """Return the entries of {ydot} of three free rotations, by freedom."""
        definitions, freedoms = self.tree.definitions, joint.rotations
        one, two, three = (f"{name}_{freedom}" for freedom in freedoms)
        solved = Vector(*(components[freedom] for freedom in freedoms))
        angular = definitions.vector(f"qr_{joint.body}", subtract(solved, along.alpha))
        if joint.angular_speeds:
            return dict(zip(freedoms, angular, strict=True))
        values = angle_rates(joint, definitions).rates(angular, (one, two, three))
        return dict(zip(freedoms, values, strict=True))

    def _translation_rates(
        self, joint: JointMotion, components: Sequence[Expr], along: Carried, name: str
    ) -> dict[int, Expr]:
        """Return the entries of {ydot} of three free translations, by freedom."""
        definitions = self.tree.definitions
        solved = Vector(*(components[one.freedom] for one in joint.translations))
        linear = definitions.vector(f"qs_{joint.body}", subtract(solved, along.to_center))
        for step in reversed(joint.angles):
            linear = definitions.vector(f"qs_{step.frame}", step.turn.down(linear))
        return {
            one.freedom: definitions.define(
                f"{name}_{one.freedom}", linear[one.axis] - along.acceleration[one.axis]
            )
            for one in joint.translations
        }

    def _joint_efforts(self, bias: Requirement) -> list[Expr]:
        """Return {tau} plus the efforts of force elements, less those that motors take, by freedom."""
        tree, acting = self.tree, element_efforts(self.tree)
        result: list[Expr] = []
        for i, f in enumerate(tree.system.freedoms):
            effort = generalized_force(f.body, f.index) + acting.get((f.body, f.index), S.Zero)
            result.append(tree.definitions.define(f"te_{i}", effort - bias.efforts.get(i, S.Zero)))
        return result

    def _component_efforts(self, efforts: Sequence[Expr]) -> list[Expr]:
        """Return the generalized forces on the free components for the efforts on the freedoms."""
        tree, definitions, result = self.tree, self.tree.definitions, dict(enumerate(efforts))
        for joint in tree.joints:
            tree.about(joint.body, "efforts in the body, Eq. (9)")
            if joint.translates_freely:
                force = Vector(*(result[one.freedom] for one in joint.translations))
                for step in joint.angles:
                    force = definitions.vector(f"tF_{step.frame}u", step.turn.up(force))
                result |= {one.freedom: force[one.axis] for one in joint.translations}
            if joint.rotates_freely:
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
            # At gimbal lock [A] is singular, although the articulated inertia is not.
            if joint.rotates_freely:
                first, across = joint.angles[0].freedom, angle_rates(joint, self.tree.definitions).across
                weakened = result[first] * across * across
                result[first] = self.tree.definitions.define(f"Dc_{joint.body}", weakened)
        return result

    @property
    def diagonal(self) -> list[Expr]:
        """Inertia of the composite body by freedom: the pivot with every other freedom locked."""
        tree, definitions = self.tree, self.tree.definitions
        result: dict[int, Expr] = {}
        bodies = list(tree.inertias)
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "composite body, Eq. (43)")
            composite = bodies[k - 1]
            for element in self.paths[k]:
                match element:
                    case FreeComponent(index, freedom, armature=armature):
                        inertia = column(composite.inertia, index % 3)[index % 3]
                        result[freedom] = armature + (inertia if index in ROTATIONS else composite.mass)
                    case FrameChange(turn, name):
                        composite = composite.down(turn, name, definitions)
                    case OriginChange(offset, name):
                        composite = composite.shifted(offset, name, definitions)
                    case FreeTranslations():
                        pass
            if j:
                bodies[j - 1] = bodies[j - 1].plus(composite, str(j), definitions)
        return [result[i] for i in range(len(result))]
