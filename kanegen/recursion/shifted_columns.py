"""The columns of a joint's angles about the lower body's origin, straight from the composite body.

Turning every column through the joint and shifting it to the lower origin costs more than multiplying the
angles' axes by one matrix, [I] - [d~][h~], on which the shifted inertia then builds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from kanegen.recursion.bodies import Inertia, Rows
from kanegen.recursion.columns import Wrench
from kanegen.recursion.joint_motion import NO_FREEDOM, JointMotion
from kanegen.recursion.vectors import multiply, present, unit
from kanegen.symbolic.definitions import Definitions, Vector

PRODUCT = (0, 0, 9, 20)
"""Operations for an axis of so many components: its moment, and for three the axis and an entry."""


@dataclass(frozen=True)
class Lever:
    """Moments about the lower origin.

    Attributes:
        matrix: Moment by angular velocity of the composite body about its origin, in the lower body's frame.
        axes: Of the angles and spins by freedom, in that frame.
        lower: The lower body.
        definitions: Take the intermediates.
    """

    matrix: Rows
    axes: dict[int, Vector]
    lower: int
    definitions: Definitions

    def begun(self, col: Wrench) -> Wrench:
        """The column of one of the angles, about the lower origin."""
        moment = multiply(self.matrix, self.axes[col.freedom])
        return replace(col, moment=self.definitions.vector(f"M_{col.label}_{self.lower}", moment))


def lever(composite: Inertia, motion: JointMotion, definitions: Definitions) -> Lever | None:
    """The lever of a joint, where it saves operations.

    Args:
        composite: The composite body about its origin, in the lower body's frame.
        motion: The joint.
        definitions: Take the intermediates.
    """
    axes = {
        step.freedom: definitions.vector(f"Z_{step.frame}", motion.below(step, unit(step.axis)))
        for step in motion.angles
        if step.freedom != NO_FREEDOM
    }
    for spin in motion.spins:
        axes[spin.freedom] = definitions.vector(f"Z_{motion.body}_{spin.axis}", motion.down(unit(spin.axis)))
    if (motion.constant and not motion.spins) or not _saves(axes, composite, motion):
        return None
    matrix = composite.levered(motion.offset, f"{motion.body}j", definitions)
    return Lever(matrix, axes, motion.lower, definitions)


def _saves(axes: dict[int, Vector], composite: Inertia, motion: JointMotion) -> bool:
    """Whether the matrix and its products cost less than turns and shifts of the moments."""
    arms = present(motion.offset)
    by_lever = 1 + (1 if composite.mass == 0 else 4) * arms
    by_turns = inner = 0
    for step in motion.angles:
        if step.freedom in axes:
            components = present(axes[step.freedom])
            by_lever += PRODUCT[components]
            by_turns += inner + (2 if components == 1 else 4) * arms
        inner += step.turn.cost
    for spin in motion.spins:
        by_lever += PRODUCT[present(axes[spin.freedom])]
        by_turns += motion.turning + 4 * arms
    return by_lever < by_turns
