"""The output [A] by composite bodies: Eq. (43) regrouped so that nothing is computed twice.

With every joint outward of a freedom locked, all bodies that the freedom carries move as one composite body.
Unit acceleration along the freedom then requires a force {F} and a moment {M} about the origin, and their
component along every freedom further inward is an entry of [A] (Featherstone 2008, section 6.2). The turns of
a joint are passed one at a time, so that the entry of an angle is a component of {M}, that of a translation a
component of {F}.

Three refinements save operations: shifted columns begin about the lower origin, force combinations replace
turned forces, and fixed-frame columns stay in one frame on long paths; see `columns` and
`fixed_frame_columns`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from sympy import Expr, S

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
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion, Step
from kanegen.recursion.tree import Derived, Tree
from kanegen.recursion.vectors import column, cross, dot, scale, unit


def mass_matrix(tree: Tree) -> Derived:
    """Derive the entries of [A], row-major; both halves hold the same symbols."""
    moving: list[list[Column]] = [[] for _ in tree.joints]
    fixed: list[list[RotationColumn]] = [[] for _ in tree.joints]
    assembly = _Assembly(tree, list(tree.inertias), moving, fixed, fixed_frame_joints(tree))
    for joint in reversed(tree.joints):
        tree.about(joint.body, "composite body and its columns of [A], Eq. (43)")
        assembly.pass_fixed_columns(joint)
        assembly.pass_moving_columns(joint)
    n = len(tree.system.freedoms)
    pairs = ((max(r, c), min(r, c)) for r in range(n) for c in range(n))
    return Derived([assembly.entries.get(pair, S.Zero) for pair in pairs])


@dataclass(frozen=True)
class _Assembly:
    """The assembly of [A], joint by joint inward.

    Attributes:
        tree: The tree.
        bodies: Composite body by body, as far as its outward bodies have been added.
        moving: Columns by body that have arrived in its frame.
        fixed: Columns by body that are about its origin, in the fixed frame.
        seen: Joints by body where columns change to the fixed frame.
        bases: Force basis by body: the translation columns that began along the basis vectors of its frame.
        entries: Entries of [A] by pair of freedoms, the larger first.
    """

    tree: Tree
    bodies: list[Inertia]
    moving: list[list[Column]]
    fixed: list[list[RotationColumn]]
    seen: dict[int, FixedFrameJoint]
    bases: dict[int, ForceBasis] = field(default_factory=dict)
    entries: dict[tuple[int, int], Expr] = field(default_factory=dict)

    def record(self, a: int, b: int, value: Expr) -> None:
        """Store the entries (a, b) and (b, a), which are the same."""
        self.entries[max(a, b), min(a, b)] = value

    def pass_fixed_columns(self, joint: JointMotion) -> None:
        """Record the entries of fixed-frame columns with a joint, and pass them inward with new ones."""
        seen, definitions = self.seen.get(joint.body), self.tree.definitions
        if seen is None:
            return
        fixed = self.fixed[joint.body - 1]
        for col in fixed:
            for freedom, value in seen.entries(col, definitions).items():
                self.record(col.freedom, freedom, value)
        if joint.lower:
            arriving = [col for col in self.moving[joint.body - 1] if isinstance(col, RotationColumn)]
            fixed = fixed + [seen.to_fixed(col, definitions) for col in arriving]
            origin = f"{joint.lower}h"
            self.fixed[joint.lower - 1] += [col.shifted(seen.offset, origin, definitions) for col in fixed]

    def pass_moving_columns(self, joint: JointMotion) -> None:
        """Pass columns through the turns and translations of a joint; begin the columns of its freedoms."""
        definitions, composite = self.tree.definitions, self.bodies[joint.body - 1]
        arriving, own = self._arriving(joint), self._angular_speed_columns(joint, composite)
        for step in reversed(joint.steps):
            above, composite = composite, composite.down(step.turn, step.frame, definitions)
            self._record_angle([*arriving, *own], step)
            arriving = [col.down(step.turn, step.frame, definitions) for col in arriving]
            own = [col.down(step.turn, step.frame, definitions) for col in own]
            if step.freedom != NO_FREEDOM:
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
                self.record(col.freedom, speed.freedom, col.moment_about(speed.axis, self.tree.definitions))
            moment = column(composite.inertia, speed.axis)
            self.record(speed.freedom, speed.freedom, moment[speed.axis] + speed.armature)
            label = f"{joint.body}w{speed.axis + 1}"
            force = cross(unit(speed.axis), composite.moment)
            begun.append(RotationColumn(speed.freedom, label, force, moment))
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
        if step.freedom != NO_FREEDOM:
            for col in columns:
                self.record(col.freedom, step.freedom, col.moment_about(step.axis, self.tree.definitions))

    def _angle_column(self, step: Step, joint: JointMotion, above: Inertia, below: Inertia) -> RotationColumn:
        """Begin the column of an angle below its turn, where the composite body is `below`."""
        axis = unit(step.axis)
        moment = column(below.inertia, step.axis)
        self.record(step.freedom, step.freedom, moment[step.axis] + step.armature)
        col = RotationColumn(step.freedom, step.frame, cross(axis, below.moment), moment)
        basis = self.bases.get(joint.body)
        if basis is None or step is not joint.steps[-1]:
            return col
        _, *path = self.tree.inward(joint)
        return basis.with_shares(col, cross(axis, above.moment), path, self.tree.definitions)

    def _record_translations(self, columns: list[Column], composite: Inertia, joint: JointMotion) -> None:
        """Record the entries of the joint's translations."""
        for translation in joint.translations:
            for col in columns:
                name = f"A_{col.freedom}_{translation.freedom}"
                value = self.tree.definitions.define(name, dot(translation.direction, col.force))
                self.record(col.freedom, translation.freedom, value)
            self.record(translation.freedom, translation.freedom, composite.mass + translation.armature)

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
            label = f"{joint.body}s{translation.freedom}"
            force = definitions.vector(f"F_{label}", scale(composite.mass, translation.direction))
            columns.append(TranslationColumn(translation.freedom, label, joint.body, force, center))
        if basis := force_basis(joint, composite.mass):
            self.bases.setdefault(joint.lower, basis)
        return columns
