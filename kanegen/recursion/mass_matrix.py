"""[A] by composite bodies: Eq. (43) regrouped so that nothing is computed twice.

Hold every joint outward of a freedom still: all bodies that the freedom carries move as one composite body.
Its unit speed then needs a force {F} and a moment {M} about the origin, and the work of that pair on every
freedom further inward is an entry of [A] (Featherstone 2008, section 6.2). The joint's turns are passed one
at a time, so that an angle's entry is simply a component of {M}, a translation's a component of {F}.

Three ways spare columns some of this: a lever begins them about the lower origin, a triad combines their
forces from others, and a station lets them stay in one frame from there on.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from sympy import Expr, S

from kanegen.recursion.bodies import Inertia
from kanegen.recursion.columns import Column, Push, Wrench
from kanegen.recursion.derived import Derived
from kanegen.recursion.fixed_frame_columns import Station, stations
from kanegen.recursion.force_combinations import Triad, combined, triad
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion, Step
from kanegen.recursion.shifted_columns import lever
from kanegen.recursion.tree import Tree
from kanegen.recursion.vectors import column, cross, dot, scale, unit


def mass_matrix(tree: Tree) -> Derived:
    """The entries of [A], row-major; both halves hold the same symbols."""
    empty: list[list[Column]] = [[] for _ in tree.motions]
    far: list[list[Wrench]] = [[] for _ in tree.motions]
    assembly = _Assembly(tree, list(tree.inertias), empty, far, stations(tree))
    for motion in reversed(tree.motions):
        tree.about(motion.body, "composite body and its columns of [A], Eq. (43)")
        assembly.pass_far(motion)
        assembly.pass_near(motion)
    n = len(tree.system.freedoms)
    pairs = ((max(r, c), min(r, c)) for r in range(n) for c in range(n))
    return Derived([assembly.entries.get(pair, S.Zero) for pair in pairs])


@dataclass(frozen=True)
class _Assembly:
    """[A] in the making.

    Attributes:
        tree: The tree; its definitions take the intermediates.
        bodies: By body, with what is outward of it as far as it has been passed.
        near: By body, the columns that have arrived in its frame.
        far: By body, the columns about its origin that stay in the frame at home.
        stations: By body, where columns go home.
        triads: By body, pushes that began along the basis vectors of its frame.
        entries: By pair of freedoms, the larger first.
    """

    tree: Tree
    bodies: list[Inertia]
    near: list[list[Column]]
    far: list[list[Wrench]]
    stations: dict[int, Station]
    triads: dict[int, Triad] = field(default_factory=dict)
    entries: dict[tuple[int, int], Expr] = field(default_factory=dict)

    def record(self, a: int, b: int, value: Expr) -> None:
        """Store an entry; its mirror image is the same."""
        self.entries[max(a, b), min(a, b)] = value

    def pass_far(self, motion: JointMotion) -> None:
        """Columns at home take their entries with a joint and pass to the lower origin; others join them."""
        station, definitions = self.stations.get(motion.body), self.tree.definitions
        if station is None:
            return
        far = self.far[motion.body - 1]
        for col in far:
            for freedom, value in station.entries(col, definitions).items():
                self.record(col.freedom, freedom, value)
        if motion.lower:
            arriving = [col for col in self.near[motion.body - 1] if isinstance(col, Wrench)]
            far = far + [station.taken(col, definitions) for col in arriving]
            origin = f"{motion.lower}h"
            self.far[motion.lower - 1] += [col.shifted(station.offset, origin, definitions) for col in far]

    def pass_near(self, motion: JointMotion) -> None:
        """Columns pass the turns of a joint, then its translations; those of its freedoms begin."""
        definitions, composite = self.tree.definitions, self.bodies[motion.body - 1]
        arriving, own = self._joined(motion), self._spun(motion, composite)
        for step in reversed(motion.steps):
            above, composite = composite, composite.down(step.turn, step.frame, definitions)
            self._read([*arriving, *own], step)
            arriving = [col.down(step.turn, step.frame, definitions) for col in arriving]
            own = [col.down(step.turn, step.frame, definitions) for col in own]
            if step.freedom != NO_FREEDOM:
                own.append(self._begun(step, motion, above, composite))
        arriving = combined(arriving, motion, definitions)
        self._slide([*arriving, *own], composite, motion)
        if motion.lower:
            if motion.body in self.stations:
                arriving = [col for col in arriving if isinstance(col, Push)]
            self._shift(arriving, own, composite, motion)

    def _spun(self, motion: JointMotion, composite: Inertia) -> list[Wrench]:
        """The columns of the joint's spins, which begin in the body's own frame, and their entries there."""
        begun: list[Wrench] = []
        for spin in motion.spins:
            for col in (*self.near[motion.body - 1], *begun):
                self.record(col.freedom, spin.freedom, col.moment_about(spin.axis, self.tree.definitions))
            moment = column(composite.inertia, spin.axis)
            self.record(spin.freedom, spin.freedom, moment[spin.axis])
            label = f"{motion.body}w{spin.axis + 1}"
            begun.append(Wrench(spin.freedom, label, cross(unit(spin.axis), composite.moment), moment))
        return begun

    def _joined(self, motion: JointMotion) -> list[Column]:
        """The columns in a body's frame, with their shares in its triad."""
        columns, found = self.near[motion.body - 1], self.triads.get(motion.body)
        if found is None:
            return columns
        path = list(self.tree.inward(motion))
        return [
            found.joined(col, col.force, path, self.tree.definitions) if isinstance(col, Wrench) else col
            for col in columns
        ]

    def _read(self, columns: Iterable[Column], step: Step) -> None:
        """The entries of a turn's angle with columns above or below it."""
        if step.freedom != NO_FREEDOM:
            for col in columns:
                self.record(col.freedom, step.freedom, col.moment_about(step.axis, self.tree.definitions))

    def _begun(self, step: Step, motion: JointMotion, above: Inertia, below: Inertia) -> Wrench:
        """The column of a turn's angle, seen from below, where the body is `below`."""
        axis = unit(step.axis)
        moment = column(below.inertia, step.axis)
        self.record(step.freedom, step.freedom, moment[step.axis])
        col = Wrench(step.freedom, step.frame, cross(axis, below.moment), moment)
        found = self.triads.get(motion.body)
        if found is None or step is not motion.steps[-1]:
            return col
        _, *path = self.tree.inward(motion)
        return found.joined(col, cross(axis, above.moment), path, self.tree.definitions)

    def _slide(self, columns: list[Column], composite: Inertia, motion: JointMotion) -> None:
        """The entries of the joint's translations."""
        for slide in motion.slides:
            for col in columns:
                name = f"A_{col.freedom}_{slide.freedom}"
                value = self.tree.definitions.define(name, dot(slide.direction, col.force))
                self.record(col.freedom, slide.freedom, value)
            self.record(slide.freedom, slide.freedom, composite.mass)

    def _shift(
        self, arriving: list[Column], own: list[Wrench], composite: Inertia, motion: JointMotion
    ) -> None:
        """The composite body and its columns pass to the lower body."""
        k, j, definitions = motion.body, motion.lower, self.tree.definitions
        arm = lever(composite, motion, definitions)
        near = self.near[j - 1]
        near += [col.shifted(motion.offset, str(j), definitions) for col in arriving]
        near += [arm.begun(col) if arm else col.shifted(motion.offset, str(j), definitions) for col in own]
        shifted = composite.shifted(motion.offset, f"{k}j", definitions, arm.matrix if arm else None)
        near += self._pushes(shifted, motion)
        self.bodies[j - 1] = self.bodies[j - 1].plus(shifted, str(j), definitions)

    def _pushes(self, composite: Inertia, motion: JointMotion) -> list[Push]:
        """The columns of the joint's translations, about O_J.

        A translation moves the whole composite body along a direction fixed in J, so its column begins there.
        """
        if not motion.slides or composite.mass == 0:
            return []
        definitions = self.tree.definitions
        center = scale(1 / composite.mass, composite.moment)
        center = definitions.vector(f"c_{motion.body}", center)
        pushes: list[Push] = []
        for slide in motion.slides:
            label = f"{motion.body}s{slide.freedom}"
            force = definitions.vector(f"F_{label}", scale(composite.mass, slide.direction))
            pushes.append(Push(slide.freedom, label, motion.body, force, center))
        if found := triad(motion, composite.mass):
            self.triads.setdefault(motion.lower, found)
        return pushes
