"""The solver of [A]{ydot} = {b} by articulated bodies.

Inward, every free component of a joint's acceleration is eliminated; outward, every one is solved for
(Featherstone 2008, section 7.3). A joint whose three angles are free is solved in the components of the
angular acceleration, where [A] is regular; Eq. (9) maps the result to the angles, unless the speeds are the
angular velocity. A joint whose three translations are free is likewise solved in components in the frame of
the body. A joint with six freedoms passes only its efforts inward: the inertia of its body does not load the
lower body. An entry of {y} that moves several freedoms by couplings is eliminated where all of them are
outward; see `shared_rates`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sympy import Add, Expr, S

from kanegen.recursion.articulated_inertia import ArticulatedInertia, Elimination, rigid_body
from kanegen.recursion.attached import Attached
from kanegen.recursion.body_motion import NOT_CARRIED, Carried
from kanegen.recursion.coordinate_rates import angle_rates
from kanegen.recursion.force_elements import element_efforts
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.inverse_dynamics import Requirement
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.joint_path import (
    GROUND_ACCELERATION,
    ROTATIONS,
    FrameChange,
    FreeComponent,
    FreeTranslations,
    OriginChange,
    SharedRate,
    joint_path,
    released,
    shared_rates,
    with_shared_rates,
)
from kanegen.recursion.kinematics import poses
from kanegen.recursion.mass_matrix_inverse import products
from kanegen.recursion.reduced import Reduced
from kanegen.recursion.rotors import spinning_rotors, with_rotors
from kanegen.recursion.shared_rates import SharedElimination, SharedRates
from kanegen.recursion.solved_motion import Paths, solved_motions
from kanegen.recursion.tree import Tree, about_mass_centers
from kanegen.recursion.vectors import Wrench, column, cross, negate, subtract
from kanegen.symbolic.definitions import Vector
from kanegen.symbolic.symbols import generalized_force


@dataclass(frozen=True)
class Passed:
    """A solution, with what passes the joints, inward of each element of the path of each body.

    Attributes:
        components: Free components of the accelerations, by freedom.
        wrenches: Wrenches that articulated bodies need where nothing inward of them accelerates.
        accelerations: Accelerations that the components further inward cause.
    """

    components: list[Expr]
    wrenches: Mapping[int, Sequence[Wrench]]
    accelerations: Mapping[int, Sequence[Sequence[Expr]]]


class ArticulatedBodies:
    """The eliminations of a tree, which solve [A]{ydot} = {b} for any right side.

    Attributes:
        tree: The tree.
        paths: Path through the joint of each body, with the free components that are solved for, by body.
        pivots: Divisor of the elimination of each freedom.
        released: Freedoms of joints with three free translations or rotations.
        inertias: Articulated inertias inward of each element of the path of each body.
        together: True.
    """

    together = True

    def __init__(self, tree: Tree) -> None:
        """Eliminate every free component, from the outermost body inward."""
        self.tree = tree = about_mass_centers(tree)
        self.released = released(tree, together=True)
        rotors = spinning_rotors(tree)
        shared = shared_rates(tree)
        self._at_ground = shared.get(0, [])
        self.paths: Paths = {
            joint.body: with_shared_rates(
                with_rotors(joint_path(joint, together=True), joint, rotors, tree.definitions),
                shared.get(joint.body, []),
            )
            for joint in tree.joints
        }
        self._eliminations: dict[int, Elimination] = {}
        self._shared_gains: dict[int, dict[int, Expr]] = {}
        self._shared_eliminations: dict[int, SharedElimination] = {}
        self.inertias: dict[int, list[ArticulatedInertia]] = {}
        ground = rigid_body(Inertia())
        bodies = [ground, *(rigid_body(own) for own in tree.inertias)]
        unknown = [SharedRates() for _ in bodies]
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "articulated body, Eq. (42)")
            passed, rest = self._eliminate(joint, bodies[k], unknown[k])
            if j:
                bodies[j] = bodies[j].plus(passed, f"{j}", tree.definitions)
            unknown[j] = unknown[j].plus(rest, f"{j}", tree.definitions)
        for place in self._at_ground:
            tree.definitions.about("what moves freedoms in several branches, Eq. (42)")
            unknown[0], _, found = unknown[0].solved(place, ground, tree.definitions)
            self._shared_eliminations[place] = found
        eliminations = self._eliminations | self._shared_eliminations
        self.pivots: Sequence[Expr] = [eliminations[i].pivot for i in range(len(tree.system.freedoms))]

    def _eliminate(
        self, joint: JointMotion, body: ArticulatedInertia, unknown: SharedRates
    ) -> tuple[ArticulatedInertia, SharedRates]:
        """Return what body K passes inward, about the lower body's origin."""
        definitions, passed = self.tree.definitions, list[ArticulatedInertia]()
        self.inertias[joint.body] = passed
        for element in self.paths[joint.body]:
            match element:
                case FreeComponent(index, freedom, shares=shares, armature=armature, is_coupled=True):
                    unknown = unknown.moving(index, shares, armature, body, f"{joint.body}", definitions)
                case FreeComponent(index, freedom, armature=armature, momentum=momentum):
                    motor = armature, momentum
                    body, found = body.eliminated(index, motor, f"{freedom}", definitions)
                    self._eliminations[freedom] = found
                    unknown, gains = unknown.below(found, f"{freedom}", definitions)
                    self._shared_gains[freedom] = gains
                case SharedRate(place):
                    unknown, body, solved = unknown.solved(place, body, definitions)
                    self._shared_eliminations[place] = solved
                case FrameChange(turn, name):
                    body = body.down(turn, name, definitions)
                    unknown = unknown.down(turn, name, definitions)
                case OriginChange(offset, name):
                    body = body.shifted(offset, name, definitions)
                    unknown = unknown.shifted(offset, name, definitions)
                case FreeTranslations():
                    pass  # No mass is left to transmit.
            passed.append(body)
        return body, unknown

    def solve(self, bias: Requirement, name: str) -> list[Expr]:
        """Return the free components of the accelerations.

        Args:
            bias: What is required where all free components are zero.
            name: Prefix of the names of the components.
        """
        return self.passed(bias, name).components

    def passed(self, bias: Requirement, name: str) -> Passed:
        """Return the solution of `solve`, with what passes the joints.

        Args:
            bias: What is required where all free components are zero.
            name: Prefix of the names of the components.
        """
        right_side, wrenches = self._inward(self.joint_efforts(bias), bias.wrenches)
        components, accelerations = self._outward(right_side.over_pivots, name)
        return Passed(components, wrenches, accelerations)

    def elimination(self, freedom: int) -> Elimination:
        """Return the elimination of a freedom."""
        return self._eliminations[freedom]

    def reduced(self, bias: Requirement) -> Reduced:
        """Return the right side under {tau}, where `bias` is required at zero components, eliminated."""
        return self._inward(self.joint_efforts(bias), bias.wrenches)[0]

    def reduced_effort(self, place: int) -> Reduced:
        """Return a unit generalized force at a place in {y}, eliminated."""
        efforts = [S.One if i == place else S.Zero for i in range(len(self.pivots))]
        with self.tree.definitions.marking(f"_u{place}"):
            return self._inward(efforts, [Wrench() for _ in self.tree.joints])[0]

    def reduced_loads(self, one: Attached) -> list[Reduced]:
        """Return unit moments, then unit forces, at a point along the inertial axes, eliminated."""
        directions, arm = poses(self.tree)[one.body].columns, one.arm(self.tree)
        loads = [Wrench(moment=v) for v in directions]
        loads += [Wrench(v, cross(arm, v)) for v in directions]
        return [
            self.reduced_wrenches({one.body: load} if one.body else {}, f"_l{one.number}_{i}")
            for i, load in enumerate(loads, start=1)
        ]

    def reduced_wrenches(self, loads: Mapping[int, Wrench], mark: str) -> Reduced:
        """Return loads on bodies, about their origins and in their frames by number of the body, eliminated.

        Args:
            loads: The loads.
            mark: End of the names of intermediates.
        """
        needed = [Wrench() for _ in self.tree.joints]
        for k, load in loads.items():
            needed[k - 1] = Wrench(negate(load.force), negate(load.moment))
        with self.tree.definitions.marking(mark):
            return self._inward([S.Zero] * len(self.pivots), needed)[0]

    def inverse(self) -> Mapping[tuple[int, int], Expr]:
        """Return the entries of [A]^-1 by row and column."""
        return products(self)

    def _inward(
        self, efforts: Sequence[Expr], wrenches: Sequence[Wrench]
    ) -> tuple[Reduced, dict[int, list[Wrench]]]:
        """Return efforts on freedoms, less wrenches that bodies require, after every elimination.

        Args:
            efforts: Generalized forces by freedom.
            wrenches: Wrenches by body.

        Returns:
            The eliminated efforts, and the wrenches inward of each element of the path of each body.
        """
        tree, definitions = self.tree, self.tree.definitions
        along_components = self._component_efforts(efforts)
        left: dict[int, Expr] = {}
        alone: dict[int, Expr] = {}
        carried = [Wrench(), *wrenches]
        passed: dict[int, list[Wrench]] = {}
        required: list[dict[int, Expr]] = [{} for _ in carried]
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "forces on the articulated body, Eq. (42)")
            wrench, passed[k] = carried[k], []
            for element in self.paths[k]:
                match element:
                    case FreeComponent(is_coupled=True):
                        self._require(required[k], element, wrench)
                    case FreeComponent(index, freedom=i):
                        effort = along_components[i]
                        left[i] = definitions.define(
                            f"e_{i}", effort - [*wrench.moment, *wrench.force][index]
                        )
                        for place, gain in self._shared_gains[i].items():
                            needed = required[k].get(place, S.Zero) + gain * left[i]
                            required[k][place] = definitions.define(f"er_{i}_{place}", needed)
                        wrench, alone[i] = self._eliminations[i].eliminate(wrench, effort, definitions)
                    case SharedRate(place):
                        wrench = self._eliminate_shared(
                            place, wrench, required[k], along_components, left, alone
                        )
                    case FreeTranslations():
                        wrench = element.inward(wrench, efforts)
                    case _:
                        wrench = element.inward(wrench, definitions)
                passed[k].append(wrench)
            if j:
                carried[j] = carried[j].plus(wrench, f"{j}", definitions)
            for place, needed in required[k].items():
                total = required[j].get(place, S.Zero) + needed
                required[j][place] = definitions.define(f"er_{j}_{place}", total)
        for place in self._at_ground:
            self._eliminate_shared(place, Wrench(), required[0], along_components, left, alone)
        return Reduced(left, alone), passed

    def _eliminate_shared(
        self,
        place: int,
        wrench: Wrench,
        required: dict[int, Expr],
        efforts: Sequence[Expr],
        left: dict[int, Expr],
        alone: dict[int, Expr],
    ) -> Wrench:
        """Eliminate an entry of {ydot} that moves several freedoms, and return the rest of the wrench."""
        elimination, definitions = self._shared_eliminations[place], self.tree.definitions
        needed = efforts[place] - required.get(place, S.Zero)
        left[place] = definitions.define(f"e_{place}", needed)
        rest, others, alone[place] = elimination.eliminate(wrench, required, efforts[place], definitions)
        required.clear()
        required.update(others)
        return rest

    def _require(self, required: dict[int, Expr], element: FreeComponent, wrench: Wrench) -> None:
        """Add the wrench along a coupled freedom to the generalized forces of the entries that move it."""
        along = [*wrench.moment, *wrench.force][element.index]
        for place, share in element.shares.items():
            needed = required.get(place, S.Zero) + share * along
            required[place] = self.tree.definitions.define(f"er_{element.freedom}_{place}", needed)

    def components(self, over_pivots: Mapping[int, Expr], name: str) -> list[Expr]:
        """Return the free components of the accelerations, outward.

        Args:
            over_pivots: The eliminated right side over the pivots, by place in {y}: the value of each
                component where all others are zero.
            name: Prefix of the names of the components.
        """
        return self._outward(over_pivots, name)[0]

    def _outward(
        self, over_pivots: Mapping[int, Expr], name: str
    ) -> tuple[list[Expr], dict[int, list[Sequence[Expr]]]]:
        """Return what `components` does, and the accelerations inward of each element of each path."""
        found: dict[int, Expr] = {}
        accelerations: dict[int, tuple[Expr, ...]] = {0: GROUND_ACCELERATION}
        passed: dict[int, list[Sequence[Expr]]] = {}
        for place in reversed(self._at_ground):
            self._solve_shared(place, over_pivots, GROUND_ACCELERATION, found, name)
        for joint in self.tree.joints:
            self.tree.about(joint.body, "accelerations, Eq. (42)")
            a, passed[joint.body] = accelerations[joint.lower], []
            for element in reversed(self.paths[joint.body]):
                passed[joint.body].insert(0, a)
                match element:
                    case FreeComponent(i, freedom, is_coupled=True):
                        moved = a[i] + element.acceleration(found)
                        moved = self.tree.definitions.define(f"q_{freedom}", moved)
                        a = (*a[:i], moved, *a[i + 1 :])
                    case FreeComponent(i, freedom):
                        gains = self._shared_gains[freedom].items()
                        by_others = over_pivots[freedom] - Add(
                            *(gain * found[place] for place, gain in gains)
                        )
                        total, own = self._eliminations[freedom].solve(by_others, a, self.tree.definitions)
                        own = total if element.is_absolute else own
                        found[freedom] = self.tree.definitions.define(f"{name}_{freedom}", own)
                        a = (*a[:i], total, *a[i + 1 :])
                    case SharedRate(place):
                        self._solve_shared(place, over_pivots, a, found, name)
                    case _:
                        a = element.outward(a, self.tree.definitions)
            accelerations[joint.body] = a
        return [found[i] for i in range(len(found))], passed

    def _solve_shared(
        self,
        place: int,
        alone: Mapping[int, Expr],
        acceleration: Sequence[Expr],
        found: dict[int, Expr],
        name: str,
    ) -> None:
        """Add to the entries of {ydot} that are found one that moves several freedoms."""
        value = self._shared_eliminations[place].solve(alone[place], acceleration, found)
        found[place] = self.tree.definitions.define(f"{name}_{place}", value)

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

    def joint_efforts(self, bias: Requirement) -> list[Expr]:
        """Return {tau} plus the efforts of force elements, less those that motors take, by freedom.

        Args:
            bias: What is required where all free components are zero, with the efforts of motors.
        """
        tree, acting = self.tree, element_efforts(self.tree)
        result: list[Expr] = [generalized_force(f.body, f.index) for f in tree.system.freedoms]
        shares = {one.number: one.shares for joint in tree.joints for one in joint.freedoms}
        for freedom, number in tree.system.moving_places.items():
            own = acting.get((freedom.body, freedom.index), S.Zero) - bias.efforts.get(number, S.Zero)
            for i, share in shares.get(number, {}).items():
                result[i] += share * own
        return [tree.definitions.define(f"te_{i}", effort) for i, effort in enumerate(result)]

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
        unknown = [SharedRates(letter="yc") for _ in (0, *bodies)]
        for joint in reversed(tree.joints):
            k, j = joint.body, joint.lower
            tree.about(k, "composite body, Eq. (43)")
            composite, rates = bodies[k - 1], unknown[k]
            for element in self.paths[k]:
                match element:
                    case FreeComponent(index, _, shares, True, armature=armature):
                        body = rigid_body(composite)
                        rates = rates.moving(index, shares, armature, body, f"{k}", definitions)
                    case SharedRate(place):
                        result[place] = rates.products[place, place]
                    case FreeComponent(index, freedom, armature=armature):
                        inertia = column(composite.inertia, index % 3)[index % 3]
                        result[freedom] = armature + (inertia if index in ROTATIONS else composite.mass)
                    case FrameChange(turn, name):
                        composite = composite.down(turn, name, definitions)
                        rates = rates.down(turn, name, definitions)
                    case OriginChange(offset, name):
                        composite = composite.shifted(offset, name, definitions)
                        rates = rates.shifted(offset, name, definitions)
                    case FreeTranslations():
                        pass
            if j:
                bodies[j - 1] = bodies[j - 1].plus(composite, str(j), definitions)
            unknown[j] = unknown[j].plus(rates, f"{j}", definitions)
        result |= {place: unknown[0].products[place, place] for place in self._at_ground}
        return [result[i] for i in range(len(result))]
