"""Columns of [A], passed inward joint by joint, and two ways to pass them in fewer operations.

A column is the force {F} and the moment {M} about the current origin that give the composite body unit
acceleration along one freedom. A column of a rotation holds both. A column of a translation is a force
through the mass centre of the composite body, so that no moment is passed on: the three translations of a
joint share this point.

`shifted_columns` begins the columns of a joint's rotations about the lower body's origin, straight from the
composite body: multiplying the axes by one matrix, [I] - [d~][h~], on which the shifted inertia then builds,
can cost less than turning every column through the joint and shifting it.

`force_basis` and `combine_forces` spare forces some of their turns. The columns of a body with three free
translations begin as equal forces along the basis vectors of its lower body's frame. On their way inward they
carry that frame along, so that another force which began in it need not be turned again: it stays the same
combination of the three, and of only two for the column of an angle about a basis vector.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

from sympy import Expr

from kanegen.recursion.inertia import Inertia
from kanegen.recursion.joint_motion import JointMotion
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, add, count_nonzero, cross, multiply, scale, unit
from kanegen.symbolic.definitions import AXES, Definitions, Vector

MOMENT_COST = (0, 0, 9, 20)
"""Operations for the moment about an axis, by number of nonzero components of the axis; with three, the axis
itself and the entry of [A] are included."""


class Column(Protocol):
    """A column of [A]: force and moment about the current origin for unit acceleration along a freedom."""

    @property
    def freedom(self) -> int:
        """Number of the freedom among those that move, or place in {y} of a column that was merged."""
        ...

    @property
    def places(self) -> Mapping[int, Expr]:
        """Factors by place in {y}: by how much each entry of {ydot} accelerates along the freedom."""
        ...

    @property
    def force(self) -> Vector:
        """The force {F} in the current frame."""
        ...

    def moment_about(self, axis: int, definitions: Definitions) -> Expr:
        """Return component `axis` of the moment {M}."""
        ...

    def whole_moment(self, definitions: Definitions) -> Vector:
        """Return the moment {M} about the current origin."""
        ...

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Self:
        """Return the column in components of the frame below a turn."""
        ...

    def shifted(self, offset: Vector, origin: str, definitions: Definitions) -> Self:
        """Return the column about another origin, from which `offset` leads to the current one."""
        ...


@dataclass(frozen=True)
class RotationColumn:
    """The column of an angle, or of a component of a relative angular velocity.

    Attributes:
        freedom: Number of the freedom among those that move.
        places: Factors by place in {y}.
        label: Suffix of the names of intermediates.
        force: The force {F}.
        moment: The moment {M}.
        shares: Factors by freedom where the force is a known combination of forces of translations; or empty.
    """

    freedom: int
    places: Mapping[int, Expr]
    label: str
    force: Vector
    moment: Vector
    shares: Mapping[int, Expr] = field(default_factory=dict)

    def moment_about(self, axis: int, definitions: Definitions) -> Expr:
        """Return component `axis` of the moment {M}."""
        return self.moment[axis]

    def whole_moment(self, definitions: Definitions) -> Vector:
        """Return the moment {M} about the current origin."""
        return self.moment

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Self:
        """Return the column in components of the frame below a turn."""
        force = definitions.vector(f"F_{self.label}_{frame}", turn.down(self.force))
        moment = definitions.vector(f"M_{self.label}_{frame}", turn.down(self.moment))
        return replace(self, force=force, moment=moment)

    def shifted(self, offset: Vector, origin: str, definitions: Definitions) -> Self:
        """Return the column about another origin, from which `offset` leads to the current one."""
        moment = add(self.moment, cross(offset, self.force))
        return replace(self, moment=definitions.vector(f"M_{self.label}_{origin}", moment))


@dataclass(frozen=True)
class TranslationColumn:
    """The column of a translation: a force through a point, whose moment is {point} x {force}.

    Attributes:
        freedom: Number of the freedom among those that move.
        places: Factors by place in {y}.
        label: Suffix of the names of intermediates.
        body: Number of the composite body that the translation moves.
        force: The force {F}.
        point: Mass centre of the composite body from the current origin (m).
    """

    freedom: int
    places: Mapping[int, Expr]
    label: str
    body: int
    force: Vector
    point: Vector

    def moment_about(self, axis: int, definitions: Definitions) -> Expr:
        """Return component `axis` of the moment {M}."""
        name = f"M_{self.label}_{self.freedom}_{axis}"
        return definitions.define(name, cross(self.point, self.force)[axis])

    def whole_moment(self, definitions: Definitions) -> Vector:
        """Return the moment {M} about the current origin."""
        return Vector(*(self.moment_about(axis, definitions) for axis in range(3)))

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Self:
        """Return the column in components of the frame below a turn."""
        force = definitions.vector(f"F_{self.label}_{frame}", turn.down(self.force))
        point = definitions.vector(f"c_{self.body}_{frame}", turn.down(self.point))
        return replace(self, force=force, point=point)

    def shifted(self, offset: Vector, origin: str, definitions: Definitions) -> Self:
        """Return the column about another origin, from which `offset` leads to the current one."""
        point = definitions.vector(f"c_{self.body}_{origin}", add(self.point, offset))
        return replace(self, point=point)


@dataclass(frozen=True)
class ShiftedColumns:
    """The moments of a joint's rotations about the origin of the lower body.

    Attributes:
        moment_matrix: Moment about the lower origin by angular velocity of the composite body about its own,
            in the lower body's frame.
        axes: Axes of the rotations in that frame, by number of the freedom.
        lower: Number of the lower body.
        definitions: Definitions that the intermediates are added to.
    """

    moment_matrix: Rows
    axes: dict[int, Vector]
    lower: int
    definitions: Definitions

    def shift(self, column: RotationColumn) -> RotationColumn:
        """Return a column of one of the rotations, with its moment about the origin of the lower body."""
        moment = multiply(self.moment_matrix, self.axes[column.freedom])
        return replace(column, moment=self.definitions.vector(f"M_{column.label}_{self.lower}", moment))


def shifted_columns(
    composite: Inertia, joint: JointMotion, definitions: Definitions
) -> ShiftedColumns | None:
    """Return the moments of a joint's rotations about the lower origin, where this saves operations.

    Args:
        composite: The composite body about its origin, in the lower body's frame.
        joint: The joint.
        definitions: Definitions that the intermediates are added to.
    """
    axes = {
        step.number: definitions.vector(f"Z_{step.frame}", joint.down_from(step, unit(step.axis)))
        for step in joint.angles
        if step.shares
    }
    for speed in joint.angular_speeds:
        axes[speed.freedom] = definitions.vector(f"Z_{joint.body}_{speed.axis}", joint.down(unit(speed.axis)))
    if (joint.constant and not joint.angular_speeds) or not _shift_saves(axes, composite, joint):
        return None
    matrix = composite.moment_matrix(joint.offset, f"{joint.body}j", definitions)
    return ShiftedColumns(matrix, axes, joint.lower, definitions)


def _shift_saves(axes: dict[int, Vector], composite: Inertia, joint: JointMotion) -> bool:
    """Return whether the matrix and its products cost less than turns and shifts of the moments."""
    arms = count_nonzero(joint.offset)
    by_matrix = 1 + (1 if composite.mass == 0 else 4) * arms
    by_turns = inner = 0
    for step in joint.angles:
        if step.number in axes:
            components = count_nonzero(axes[step.number])
            by_matrix += MOMENT_COST[components]
            by_turns += inner + (2 if components == 1 else 4) * arms
        inner += step.turn.cost
    for speed in joint.angular_speeds:
        by_matrix += MOMENT_COST[count_nonzero(axes[speed.freedom])]
        by_turns += joint.turn_cost + 4 * arms
    return by_matrix < by_turns


@dataclass(frozen=True)
class ForceBasis:
    """The forces of three translation columns, which begin along the basis vectors of a frame.

    Attributes:
        freedoms: Places of the three freedoms in {y}, by axis.
        mass: Force for unit acceleration (kg).
    """

    freedoms: tuple[int, int, int]
    mass: Expr

    def with_shares(
        self, column: RotationColumn, force: Vector, path: Iterable[JointMotion], definitions: Definitions
    ) -> RotationColumn:
        """Return the column with its force as a combination of the three forces, where this saves operations.

        Args:
            column: Column whose force is known in the frame of the basis.
            force: The force in that frame.
            path: The joints that the column has yet to pass.
            definitions: Definitions that the intermediates are added to.
        """
        if column.shares:
            return column
        taken = [i for i in range(3) if force[i] != 0]
        cost = _combination_cost(len(taken))
        needing = (joint for joint in path if joint.lower or joint.translations)
        if sum(max(joint.turn_cost - cost, 0) for joint in needing) <= len(taken):
            return column
        shares = scale(1 / self.mass, force)
        names = [f"Q_{column.label}_{axis}" for axis in AXES]
        named = {self.freedoms[i]: definitions.define(names[i], shares[i]) for i in taken}
        return replace(column, shares=named)


def force_basis(joint: JointMotion, mass: Expr) -> ForceBasis | None:
    """Return the force basis of a joint with three translations along basis vectors of the lower frame."""
    if not joint.translates_freely or joint.constant:
        return None
    one, two, three = (translation.freedom for translation in joint.translations)
    return ForceBasis((one, two, three), mass)


def combine_forces(columns: Sequence[Column], joint: JointMotion, definitions: Definitions) -> list[Column]:
    """Return columns that have passed the turns of a joint, their forces combined where this is cheaper."""
    forces = {column.freedom: column.force for column in columns if isinstance(column, TranslationColumn)}
    return [_combine_force(column, forces, joint, definitions) for column in columns]


def _combine_force(
    column: Column, forces: Mapping[int, Vector], joint: JointMotion, definitions: Definitions
) -> Column:
    """Return a column with its force combined from those of translations, if this is cheaper."""
    if not isinstance(column, RotationColumn) or not column.shares:
        return column
    if _combination_cost(len(column.shares)) >= joint.turn_cost:
        return column
    force = ZERO
    for freedom, share in column.shares.items():
        force = add(force, scale(share, forces[freedom]))
    return replace(column, force=definitions.vector(f"F_{column.label}_{joint.body}q", force))


def _combination_cost(shares: int) -> int:
    """Return the number of operations that combine a force from `shares` others."""
    return 3 * (2 * shares - 1)
