"""The literal equations in 3 x 3 blocks, as the notes print their eight-body example.

    Blocks(system).partial_angular_velocity(3).text()
    # [[^2R_3][^1R_2][P̂_1], [^2R_3][P̂_2], [P̂_3], [0], ...]

A block of which no freedom is free is [0]. Where a joint frame is turned, [s̃'_K] is made of the J
components [C_K]^T {s'_K}, and [C_K]^T stands in the place of [I].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.model.joint import IDENTITY
from kanegen.model.system import System
from kanegen.symbolic.printing.block_terms import Factor, Kind, Product, Row, Sum, Term, product, times, total

GROUND = 0
FIRST_TRANSLATION = 3
NOTHING = Sum(())


@dataclass(frozen=True)
class Blocks:
    """Rows of blocks and block sums of the bodies of a system; bodies count from 1.

    Attributes:
        system: The tree.
    """

    system: System

    def position_of_origin(self, k: int) -> Sum:
        """{p'_OK} in K, Eq. (22)."""
        j = self._lower(k)
        below = NOTHING if j == GROUND else self.position_of_origin(j)
        return total(product(self._rotation(k), total(below, self._offset(k))))

    def position_of_center(self, k: int) -> Sum:
        """{p'_GK} in K, Eq. (23)."""
        return total(self.position_of_origin(k), self._factor(Kind.CENTER, k))

    def velocity_of_origin(self, k: int) -> Sum:
        """{v'_OK} in J, Eq. (25)."""
        j = self._lower(k)
        rate = total(self._turned_back(k, Kind.TRANSLATION_DOT)) if self._slides(k) else NOTHING
        if j == GROUND:
            return rate
        return total(self._carried(j), rate, self._swung(j, self._offset(k)))

    def velocity_of_center(self, k: int) -> Sum:
        """{v'_GK} in K, Eq. (27)."""
        return total(self._carried(k), self._swung(k, self._factor(Kind.CENTER, k)))

    def partial_angular_velocity(self, k: int) -> Row:
        """[omega'_K,y1], N blocks, Eq. (15)."""
        blocks: list[Term | None] = [None] * self.system.number_of_bodies
        prefix: tuple[Factor, ...] = ()
        for body in self._path(k):
            if self._turns_freely(body):
                blocks[body - 1] = self._turned_rates(prefix, body)
            prefix = (*prefix, self._rotation(body))
        return Row(tuple(blocks), len(blocks))

    def partial_angular_velocity_rate(self, k: int) -> Sum:
        """Time derivative of [omega'_K,y1], Eq. (20)."""
        changes = self._turns_freely(k) and not self._spins(k)
        own = self._unit_row(self._factor(Kind.RATE_DOT, k), k, half=0) if changes else NOTHING
        j = self._lower(k)
        if j == GROUND:
            return total(own)
        carried = times((self._rotation(k),), self.partial_angular_velocity_rate(j))
        return total(carried, self._turning(k, self._spin_row(j)), own)

    def partial_velocity_of_origin(self, k: int) -> Sum:
        """[v'_OK,y] in J, 2N blocks, Eqs. (28)-(30)."""
        unit = self._turned_back(k, Kind.IDENTITY)
        own = self._unit_row(unit, k, half=1) if self._slides_freely(k) else NOTHING
        j = self._lower(k)
        if j == GROUND:
            return _both_halves(total(own))
        carried = times((self._rotation(j),), self.partial_velocity_of_origin(j))
        swung = times((self._factor(Kind.OFFSET_TILDE, k),), self._spin_row(j), sign=-1)
        return _both_halves(total(carried, swung, own))

    def partial_velocity_of_center(self, k: int) -> Sum:
        """[v'_GK,y] in K, 2N blocks, Eq. (32)."""
        carried = times((self._rotation(k),), self.partial_velocity_of_origin(k))
        swung = times((self._factor(Kind.CENTER_TILDE, k),), self._spin_row(k), sign=-1)
        return _both_halves(total(carried, swung))

    def partial_velocity_of_origin_rate(self, k: int) -> Sum:
        """Time derivative of [v'_OK,y] in J, Eq. (35)."""
        j = self._lower(k)
        if j == GROUND:
            return NOTHING
        carried = times((self._rotation(j),), self.partial_velocity_of_origin_rate(j))
        turned = self._turning(j, self.partial_velocity_of_origin(j))
        sliding = NOTHING
        if self._slides(k):
            sliding = times((self._factor(Kind.OFFSET_DOT_TILDE, k),), self._spin_row(j), sign=-1)
        rate = self.partial_angular_velocity_rate(j)
        swung = times((self._factor(Kind.OFFSET_TILDE, k),), rate, sign=-1)
        return _both_halves(total(carried, turned, sliding, swung))

    def partial_velocity_of_center_rate(self, k: int) -> Sum:
        """Time derivative of [v'_GK,y] in K, Eq. (34)."""
        carried = times((self._rotation(k),), self.partial_velocity_of_origin_rate(k))
        turned = self._turning(k, self.partial_velocity_of_origin(k))
        rate = self.partial_angular_velocity_rate(k)
        swung = times((self._factor(Kind.CENTER_TILDE, k),), rate, sign=-1)
        return _both_halves(total(carried, turned, swung))

    def _factor(self, kind: Kind, k: int) -> Factor:
        return Factor(kind, k, self._lower(k))

    def _rotation(self, k: int) -> Factor:
        return self._factor(Kind.FIRST_ROTATION if self._lower(k) == GROUND else Kind.ROTATION, k)

    def _turning(self, k: int, terms: Sum) -> Sum:
        """The derivative of [^J R_K], Eq. (7), in front of `terms`."""
        if not self._turns(k):
            return NOTHING
        spin = Kind.FIRST_SPIN if self._lower(k) == GROUND else Kind.RELATIVE_SPIN
        return times((self._factor(spin, k), self._rotation(k)), terms)

    def _turned_rates(self, prefix: tuple[Factor, ...], k: int) -> Term:
        """[P_K] behind rotations; speeds that are components of an angular velocity need none."""
        if self._spins(k):
            return product(*prefix) if prefix else self._factor(Kind.IDENTITY, k)
        return product(*prefix, self._factor(Kind.RATE, k))

    def _turned_back(self, k: int, kind: Kind) -> Term:
        if self.system.bodies[k - 1].joint.orientation == IDENTITY:
            return self._factor(kind, k)
        back = self._factor(Kind.TURNED_BACK, k)
        return back if kind is Kind.IDENTITY else product(back, self._factor(kind, k))

    def _offset(self, k: int) -> Sum:
        """{q'_K} + {s'_K}; q'_1 = 0 by definition, so a zero {q'_K} on the ground is left out."""
        joint = self.system.bodies[k - 1].joint
        translation = total(self._turned_back(k, Kind.TRANSLATION))
        if self._lower(k) == GROUND and not any(joint.position):
            return translation
        return total(self._factor(Kind.POSITION, k), translation)

    def _carried(self, k: int) -> Sum:
        velocity = self.velocity_of_origin(k)
        return total(product(self._rotation(k), velocity)) if velocity.terms else NOTHING

    def _swung(self, k: int, arm: Term) -> Sum:
        if not any(self._turns(body) for body in self._path(k)):
            return NOTHING
        return total(product(self._factor(Kind.SPIN, k), arm))

    def _spin_row(self, k: int) -> Sum:
        row = self.partial_angular_velocity(k)
        return total(row) if any(row.blocks) else NOTHING

    def _unit_row(self, block: Term, k: int, half: int) -> Sum:
        count = self.system.number_of_bodies
        blocks: list[Term | None] = [None] * (count * (half + 1))
        blocks[count * half + k - 1] = block
        return total(Row(tuple(blocks), count))

    def _lower(self, k: int) -> int:
        return self.system.connection[k - 1]

    def _path(self, k: int) -> Iterator[int]:
        """k, its lower body, and so on to the ground."""
        while k != GROUND:
            yield k
            k = self._lower(k)

    def _turns(self, k: int) -> bool:
        """Whether any angle moves, free or prescribed."""
        return any(self.system.bodies[k - 1].joint.moving[:FIRST_TRANSLATION])

    def _turns_freely(self, k: int) -> bool:
        """Whether it has columns of angles."""
        return any(self.system.bodies[k - 1].joint.free[:FIRST_TRANSLATION])

    def _spins(self, k: int) -> bool:
        return self.system.bodies[k - 1].joint.spins

    def _slides(self, k: int) -> bool:
        """Whether any translation moves, free or prescribed."""
        return any(self.system.bodies[k - 1].joint.moving[FIRST_TRANSLATION:])

    def _slides_freely(self, k: int) -> bool:
        """Whether it has columns of translations."""
        return any(self.system.bodies[k - 1].joint.free[FIRST_TRANSLATION:])


def _both_halves(terms: Sum) -> Sum:
    """Every row with N blocks for {y_1} continued by N zeros for {y_2}."""
    return Sum(tuple((sign, _continued(term)) for sign, term in terms.terms))


def _continued(term: Term) -> Term:
    factors = term.factors if isinstance(term, Product) else (term,)
    row = factors[-1]
    if not isinstance(row, Row) or len(row.blocks) > row.bodies:
        return term
    return product(*factors[:-1], Row(row.blocks + (None,) * row.bodies, row.bodies))
