"""The output [A] by composite bodies: Eq. (43) regrouped so that nothing is computed twice.

With every joint outward of a freedom locked, all bodies that the freedom carries move as one composite body.
Unit acceleration along the freedom then requires a force {F} and a moment {M} about the origin, and their
component along every freedom further inward is an entry of [A] (Featherstone 2008, section 6.2). The turns of
a joint are passed one at a time, so that the entry of an angle is a component of {M}, that of a translation a
component of {F}.

Three refinements save operations: shifted columns begin about the lower origin, force combinations replace
turned forces, and fixed-frame columns stay in one frame on long paths; see `columns` and
`fixed_frame_columns`. Where freedoms are coupled, the entries of the freedoms that follow add to those of the
freedoms that they follow, times their factors, and columns are added on their way inward.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from sympy import Add, Expr, S

from kanegen.recursion.columns import (
    Column,
    ForceBasis,
    RotationColumn,
    TranslationColumn,
    combine_forces,
    force_basis,
    shifted_columns,
)
from kanegen.recursion.fixed_frame_columns import FixedFrameJoint, fixed_frame_joints
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.joint_motion import NO_FREEDOM, FreedomMotion, JointMotion, Step
from kanegen.recursion.merged_columns import merged, rotation_sum
from kanegen.recursion.rotors import SpinningRotor, spinning_rotors
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import ZERO, column, cross, dot, scale, unit


def mass_matrix(tree: Tree) -> Derived:
    """Derive the entries of [A], row-major; both halves hold the same symbols."""
    moving: list[list[Column]] = [[] for _ in tree.joints]
    fixed: list[list[RotationColumn]] = [[] for _ in tree.joints]
    kept: list[list[RotationColumn]] = [[] for _ in tree.joints]
    assembly = _Assembly(tree, list(tree.inertias), moving, fixed, kept, fixed_frame_joints(tree))
    rotors = spinning_rotors(tree)
    for joint in reversed(tree.joints):
        tree.about(joint.body, "composite body and its columns of [A], Eq. (43)")
        for rotor in rotors:
            if rotor.carrier == joint.body and rotor.motion.shares:
                assembly.add_rotor(rotor)
        assembly.merge_columns(joint.body)
        assembly.pass_fixed_columns(joint)
        assembly.pass_moving_columns(joint)
    n = len(tree.system.freedoms)
    return Derived([assembly.entry(i, j) for i in range(n) for j in range(n)])


@dataclass(frozen=True)
class _Assembly:
    """The assembly of [A], joint by joint inward.

    Attributes:
        tree: The tree.
        bodies: Composite body by body, as far as its outward bodies have been added.
        moving: Columns by body that have arrived in its frame.
        fixed: Columns by body that are about its point O_K, in the fixed frame.
        kept: Columns by body that stay about the point O of a body further outward, in the fixed frame.
        seen: Joints by body where columns change to the fixed frame.
        bases: Force basis by body: the translation columns that began along the basis vectors of its frame.
        entries: Terms of the entries of [A] by pair of places in {y}, the larger first.
        shares: Factors by place in {y}, by number of the freedom.
    """

    tree: Tree
    bodies: list[Inertia]
    moving: list[list[Column]]
    fixed: list[list[RotationColumn]]
    kept: list[list[RotationColumn]]
    seen: dict[int, FixedFrameJoint]
    bases: dict[int, ForceBasis] = field(default_factory=dict)
    entries: dict[tuple[int, int], list[Expr]] = field(default_factory=dict)
    shares: dict[int, Mapping[int, Expr]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for joint in self.tree.joints:
            self.shares.update((one.number, one.shares) for one in joint.freedoms)

    def record(self, col: Column, number: int, value: Expr) -> None:
        """Store the component of a column along another freedom: both halves of [A] have it."""
        for i, factor in col.places.items():
            for j, share in self.shares[number].items():
                twice = 2 if i == j else 1
                self._add(i, j, twice * factor * share * value)

    def record_own(self, one: FreedomMotion, value: Expr) -> None:
        """Store the inertia that a freedom itself moves."""
        for i, share in one.shares.items():
            for j, other in one.shares.items():
                if j <= i:
                    self._add(i, j, share * other * value)

    def _add(self, i: int, j: int, value: Expr) -> None:
        """Add a term to the entries (i, j) and (j, i), which are the same."""
        self.entries.setdefault((max(i, j), min(i, j)), []).append(value)

    def entry(self, i: int, j: int) -> Expr:
        """Return an entry of [A], the sum of its terms."""
        terms = self.entries.get((max(i, j), min(i, j)), [])
        if len(terms) < 2:
            return terms[0] if terms else S.Zero
        return self.tree.definitions.define(f"A_{max(i, j)}_{min(i, j)}", Add(*terms))

    def add_rotor(self, rotor: SpinningRotor) -> None:
        """Begin the column of the spin of a rotor in its carrier, which it passes inward with the others."""
        motion, label = rotor.motion, f"{rotor.carrier}r{rotor.motion.number}"
        col = RotationColumn(motion.number, motion.shares, label, ZERO, rotor.momentum)
        self.moving[rotor.carrier - 1].append(col)

    def merge_columns(self, k: int) -> None:
        """Add the columns that have arrived at body `k` where the same entries of {y} cause them."""
        body, definitions = f"{k}", self.tree.definitions
        self.moving[k - 1] = merged(
            self.moving[k - 1], lambda place, parts: rotation_sum(place, parts, body, body, definitions)
        )
        self.fixed[k - 1] = merged(
            self.fixed[k - 1], lambda place, parts: rotation_sum(place, parts, body, f"{k}h", definitions)
        )

    def pass_fixed_columns(self, joint: JointMotion) -> None:
        """Record the entries of fixed-frame columns with a joint, and pass them inward with new ones."""
        seen, definitions = self.seen.get(joint.body), self.tree.definitions
        if seen is None:
            return
        fixed, kept = self.fixed[joint.body - 1], self.kept[joint.body - 1]
        for col in fixed:
            self._record_all(col, seen.entries(col, definitions))
        for col in kept:
            self._record_all(col, seen.entries_of_kept(col, definitions))
        if joint.lower:
            arriving = [col for col in self.moving[joint.body - 1] if isinstance(col, RotationColumn)]
            fixed = fixed + [seen.to_fixed(col, definitions) for col in arriving]
            self._pass_fixed_to(joint.lower, fixed, joint.body)
            self._pass_fixed_to(joint.lower, kept, seen.kept)

    def _pass_fixed_to(self, j: int, columns: list[RotationColumn], about: int) -> None:
        """Pass fixed-frame columns about the point O of a body to body `j`, where they may stay about it."""
        seen, definitions = self.seen[j], self.tree.definitions
        if about == seen.kept:
            self.kept[j - 1].extend(columns)
        else:
            self.fixed[j - 1].extend(col.shifted(seen.points[about], f"{j}h", definitions) for col in columns)

    def _record_all(self, col: RotationColumn, values: Mapping[int, Expr]) -> None:
        """Store the components of a column along other freedoms, by their numbers."""
        for number, value in values.items():
            self.record(col, number, value)

    def pass_moving_columns(self, joint: JointMotion) -> None:
        """Pass columns through the turns and translations of a joint; begin the columns of its freedoms."""
        definitions, composite = self.tree.definitions, self.bodies[joint.body - 1]
        arriving, own = self._arriving(joint), self._angular_speed_columns(joint, composite)
        for step in reversed(joint.steps):
            above, composite = composite, composite.down(step.turn, step.frame, definitions)
            self._record_angle([*arriving, *own], step)
            arriving = [col.down(step.turn, step.frame, definitions) for col in arriving]
            own = [col.down(step.turn, step.frame, definitions) for col in own]
            if step.shares:
                own.append(self._angle_column(step, joint, above, composite))
        arriving = combine_forces(arriving, joint, definitions)
        self._record_translations([*arriving, *own], composite, joint)
        if joint.lower:
            if joint.body in self.seen:
                arriving = [col for col in arriving if isinstance(col, TranslationColumn)]
            self._pass_to_lower_body(arriving, own, composite, joint)

    def _angular_speed_columns(self, joint: JointMotion, composite: Inertia) -> list[RotationColumn]:
        """Begin the columns of relative angular velocities in the body's own frame; record their entries."""
        begun: list[RotationColumn] = []
        for speed in joint.angular_speeds:
            for col in (*self.moving[joint.body - 1], *begun):
                self.record(col, speed.number, col.moment_about(speed.axis, self.tree.definitions))
            moment = column(composite.inertia, speed.axis)
            self.record_own(speed, moment[speed.axis] + speed.armature)
            label = f"{joint.body}w{speed.axis + 1}"
            force = cross(unit(speed.axis), composite.moment)
            begun.append(RotationColumn(speed.number, speed.shares, label, force, moment))
        return begun

    def _arriving(self, joint: JointMotion) -> list[Column]:
        """Return the columns in a body's frame, with their shares in the force basis of that frame."""
        columns, basis = self.moving[joint.body - 1], self.bases.get(joint.body)
        if basis is None:
            return columns
        path = list(self.tree.inward(joint))
        return [
            basis.with_shares(col, col.force, path, self.tree.definitions)
            if isinstance(col, RotationColumn)
            else col
            for col in columns
        ]

    def _record_angle(self, columns: Iterable[Column], step: Step) -> None:
        """Record the entries of an angle with columns in components above or below its turn."""
        if step.shares:
            for col in columns:
                self.record(col, step.number, col.moment_about(step.axis, self.tree.definitions))

    def _angle_column(self, step: Step, joint: JointMotion, above: Inertia, below: Inertia) -> RotationColumn:
        """Begin the column of an angle below its turn, where the composite body is `below`."""
        axis = unit(step.axis)
        moment = column(below.inertia, step.axis)
        self.record_own(step, moment[step.axis] + step.armature)
        col = RotationColumn(step.number, step.shares, step.frame, cross(axis, below.moment), moment)
        basis = self.bases.get(joint.body)
        if basis is None or step is not joint.steps[-1]:
            return col
        _, *path = self.tree.inward(joint)
        return basis.with_shares(col, cross(axis, above.moment), path, self.tree.definitions)

    def _record_translations(self, columns: list[Column], composite: Inertia, joint: JointMotion) -> None:
        """Record the entries of the joint's translations."""
        for translation in joint.translations:
            for col in columns:
                name = f"A{'c' * translation.is_coupled}_{col.freedom}_{translation.number}"
                value = self.tree.definitions.define(name, dot(translation.direction, col.force))
                self.record(col, translation.number, value)
            self.record_own(translation, composite.mass + translation.armature)

    def _pass_to_lower_body(
        self, arriving: list[Column], own: list[RotationColumn], composite: Inertia, joint: JointMotion
    ) -> None:
        """Pass the composite body and its columns to the lower body."""
        k, j, definitions = joint.body, joint.lower, self.tree.definitions
        shift = shifted_columns(composite, joint, definitions)
        moving = self.moving[j - 1]
        moving += [col.shifted(joint.offset, str(j), definitions) for col in arriving]
        moving += [
            shift.shift(col) if shift else col.shifted(joint.offset, str(j), definitions) for col in own
        ]
        matrix = shift.moment_matrix if shift else None
        shifted = composite.shifted(joint.offset, f"{k}j", definitions, matrix)
        moving += self._translation_columns(shifted, joint)
        self.bodies[j - 1] = self.bodies[j - 1].plus(shifted, str(j), definitions)

    def _translation_columns(self, composite: Inertia, joint: JointMotion) -> list[TranslationColumn]:
        """Begin the columns of the joint's translations, about the origin of the lower body.

        A translation moves the whole composite body along a direction that is fixed in the lower body.
        """
        if not joint.translations or composite.mass == 0:
            return []
        definitions = self.tree.definitions
        center = scale(1 / composite.mass, composite.moment)
        center = definitions.vector(f"c_{joint.body}", center)
        columns: list[TranslationColumn] = []
        for translation in joint.translations:
            number, shares = translation.number, translation.shares
            is_free = translation.freedom != NO_FREEDOM
            label = f"{joint.body}s{number}" if is_free else f"{joint.body}t{translation.axis + 1}"
            force = definitions.vector(f"F_{label}", scale(composite.mass, translation.direction))
            columns.append(TranslationColumn(number, shares, label, joint.body, force, center))
        if basis := force_basis(joint, composite.mass):
            self.bases.setdefault(joint.lower, basis)
        return columns
