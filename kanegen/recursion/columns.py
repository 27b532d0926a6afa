"""Columns of [A] on their way inward: the force and moment that unit speed of one freedom needs.

Both kinds know their moment about a basis vector, can be seen from below a turn, and can be taken about
another origin. An angle needs a force and a moment. A translation needs a mere force through the mass centre
of the composite body, so that its moment never has to be carried: three columns share one point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol, Self

from sympy import Expr

from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import add, cross
from kanegen.symbolic.definitions import Definitions, Vector


class Column(Protocol):
    """Force and moment about the current origin, in its frame, for unit speed of `freedom`."""

    @property
    def freedom(self) -> int:
        """Number of the freedom in {x}."""
        ...

    @property
    def force(self) -> Vector:
        """{F}."""
        ...

    def moment_about(self, axis: int, definitions: Definitions) -> Expr:
        """Component `axis` of {M}."""
        ...

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Self:
        """The same from below a turn."""
        ...

    def shifted(self, offset: Vector, origin: str, definitions: Definitions) -> Self:
        """The same about an origin from which the current one is `offset` away."""
        ...


@dataclass(frozen=True)
class Wrench:
    """A force and a moment.

    Attributes:
        freedom: Number of the freedom in {x}.
        label: For names.
        force: {F}.
        moment: {M}.
        shares: What it takes of the forces of some pushes, if known; see `triads`.
    """

    freedom: int
    label: str
    force: Vector
    moment: Vector
    shares: Mapping[int, Expr] = field(default_factory=dict)

    def moment_about(self, axis: int, definitions: Definitions) -> Expr:
        """Component `axis` of {M}."""
        return self.moment[axis]

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Self:
        """The same from below a turn."""
        force = definitions.vector(f"F_{self.label}_{frame}", turn.down(self.force))
        moment = definitions.vector(f"M_{self.label}_{frame}", turn.down(self.moment))
        return replace(self, force=force, moment=moment)

    def shifted(self, offset: Vector, origin: str, definitions: Definitions) -> Self:
        """The same about an origin from which the current one is `offset` away."""
        moment = add(self.moment, cross(offset, self.force))
        return replace(self, moment=definitions.vector(f"M_{self.label}_{origin}", moment))


@dataclass(frozen=True)
class Push:
    """A force through a point, whose moment is {point} x {force}; `body` is the composite body it moves."""

    freedom: int
    label: str
    body: int
    force: Vector
    point: Vector

    def moment_about(self, axis: int, definitions: Definitions) -> Expr:
        """Component `axis` of {M}."""
        name = f"M_{self.label}_{self.freedom}_{axis}"
        return definitions.define(name, cross(self.point, self.force)[axis])

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Self:
        """The same from below a turn."""
        force = definitions.vector(f"F_{self.label}_{frame}", turn.down(self.force))
        point = definitions.vector(f"c_{self.body}_{frame}", turn.down(self.point))
        return replace(self, force=force, point=point)

    def shifted(self, offset: Vector, origin: str, definitions: Definitions) -> Self:
        """The same about an origin from which the current one is `offset` away."""
        point = definitions.vector(f"c_{self.body}_{origin}", add(self.point, offset))
        return replace(self, point=point)
