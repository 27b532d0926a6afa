"""Forces of columns as combinations of pushes.

The pushes of a body that slides freely begin as equal forces along the basis vectors of its lower body's
frame. On their way inward they carry that frame along, so that another force which began in it need not be
turned again: it stays the same combination of the three, and of only two where its column is that of an angle
about a basis vector.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from sympy import Expr

from kanegen.recursion.columns import Column, Push, Wrench
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.vectors import ZERO, add, scale
from kanegen.symbolic.definitions import AXES, Definitions, Vector


@dataclass(frozen=True)
class Triad:
    """Three pushes along the basis vectors of a frame.

    Attributes:
        freedoms: Theirs, by axis.
        mass: The size of their forces.
    """

    freedoms: tuple[int, int, int]
    mass: Expr

    def joined(
        self, col: Wrench, force: Vector, path: Iterable[JointMotion], definitions: Definitions
    ) -> Wrench:
        """The column, with its shares where they save operations.

        Args:
            col: A column.
            force: Its force in the frame of the triad.
            path: The joints that it has yet to pass.
            definitions: Take the intermediates.
        """
        if col.shares:
            return col
        taken = [i for i in range(3) if force[i] != 0]
        cost = _combining(len(taken))
        needing = (motion for motion in path if motion.lower or motion.slides)
        if sum(max(motion.turning - cost, 0) for motion in needing) <= len(taken):
            return col
        shares = scale(1 / self.mass, force)
        names = [f"Q_{col.label}_{axis}" for axis in AXES]
        return replace(col, shares={self.freedoms[i]: definitions.define(names[i], shares[i]) for i in taken})


def triad(motion: JointMotion, mass: Expr) -> Triad | None:
    """The pushes of a joint, if they are three along the basis vectors of the lower body's frame."""
    if len(motion.slides) < 3 or motion.constant:
        return None
    one, two, three = (slide.freedom for slide in motion.slides)
    return Triad((one, two, three), mass)


def combined(columns: Sequence[Column], motion: JointMotion, definitions: Definitions) -> list[Column]:
    """Columns that have passed the turns of a joint, their forces combined where this is cheaper."""
    pushes = {col.freedom: col.force for col in columns if isinstance(col, Push)}
    return [_combined(col, pushes, motion, definitions) for col in columns]


def _combined(
    col: Column, pushes: Mapping[int, Vector], motion: JointMotion, definitions: Definitions
) -> Column:
    if not isinstance(col, Wrench) or not col.shares or _combining(len(col.shares)) >= motion.turning:
        return col
    force = ZERO
    for freedom, share in col.shares.items():
        force = add(force, scale(share, pushes[freedom]))
    return replace(col, force=definitions.vector(f"F_{col.label}_{motion.body}q", force))


def _combining(shares: int) -> int:
    """Operations that it takes to combine a force."""
    return 3 * (2 * shares - 1)
