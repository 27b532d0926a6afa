"""The literal equations in 3 x 3 blocks, as the notes print their eight-body example.

    Blocks(system).partial_angular_velocity(3).text()
    # [[^2R_3][^1R_2][P̂_1], [^2R_3][P̂_2], [P̂_3], [0], ...]

A block without a free freedom is [0]. Coupled freedoms have blocks as if they were free; their columns, times
their factors, add to those of the freedoms that they follow. For a joint frame that is turned, [s̃'_K] is made
of the J components [C_K]^T {s'_K}, and [C_K]^T replaces [I].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from kanegen.model.joint import IDENTITY
from kanegen.model.system import System
from kanegen.symbolic import notation, notebook
from kanegen.symbolic.printing.block_terms import Factor, Kind, Product, Row, Sum, Term, product, times, total

GROUND = 0
"""Number of the ground among the lower bodies."""

FIRST_TRANSLATION = 3
"""Index of the first translation in `FREEDOMS`."""

NOTHING = Sum(())
"""A sum of no terms."""


@dataclass(frozen=True)
class Blocks:
    """The equations of the bodies of a system in blocks; bodies count from 1.

    Example:
        blocks = Blocks(kg.load("models/eight_body.toml"))
        print(blocks.position_of_center(2).text())

    Attributes:
        system: The tree.
    """

    system: System

    def _repr_latex_(self) -> str:
        """Velocities and partial velocities of all bodies, for a notebook; many are cut, with a hint."""
        lines = [line for k in range(1, self.system.number_of_bodies + 1) for line in self._summary(k)]
        most = notebook.MOST_LINES
        if len(lines) > most:
            hint = 'print(render(equations, only="blocks"))'
            lines[most:] = [notebook.cut(len(lines) - most, "lines", hint)]
        return notebook.display(lines)

    def _summary(self, k: int) -> Iterator[str]:
        """Yield lines of LaTeX with the position, the velocities and the partial velocities of body k."""
        rows: dict[str, Sum | Row] = {
            f"{{ω'_{k}}}": self.angular_velocity(k),
            f"[ω'_{k},y1]": self.partial_angular_velocity(k),
            f"{{p'_G{k}}}": self.position_of_center(k),
            f"{{v'_G{k}}}": self.velocity_of_center(k),
            f"[v'_G{k},y]": self.partial_velocity_of_center(k),
        }
        for name, row in rows.items():
            first, *others = notation.lines(row.text())
            yield f"{notation.latex(name)} &= {notation.latex(first)}"
            yield from (rf"&\quad {notation.latex(line)}" for line in others)

    def angular_velocity(self, k: int) -> Sum:
        """Return {omega'_K}, the angular velocity of K in K components, Eq. (11)."""
        j = self.lower(k)
        own = self._factor(Kind.RELATIVE_OMEGA, k) if self.turns(k) else NOTHING
        below = NOTHING if j == GROUND else self.angular_velocity(j)
        return total(product(self._rotation(k), below), own) if below.terms else total(own)

    def relative_partial_angular_velocity(self, k: int, kind: Kind = Kind.ANGLE_RATE_MATRIX) -> Sum:
        """Return [omega_hat'_K,y1], which is zero but for block K, Eq. (16), or its time derivative."""
        if not self.turns_freely(k):
            return NOTHING
        if self.has_angular_velocity_speeds(k):
            kind = Kind.IDENTITY
        return self._unit_row(self._factor(kind, k), k, half=0)

    def relative_partial_velocity(self, k: int) -> Sum:
        """Return [^Jv'_OK,y], the partial velocities of O_K in J, Eqs. (29), (30)."""
        unit = self._in_lower_components(k, Kind.IDENTITY)
        return self._unit_row(unit, k, half=1) if self.slides_freely(k) else NOTHING

    def position_of_origin(self, k: int) -> Sum:
        """Return {p'_OK}, the position of O_K in K components, Eq. (22)."""
        j = self.lower(k)
        below = NOTHING if j == GROUND else self.position_of_origin(j)
        return total(product(self._rotation(k), total(below, self.offset(k))))

    def position_of_center(self, k: int) -> Sum:
        """Return {p'_GK}, the position of G_K in K components, Eq. (23)."""
        return total(self.position_of_origin(k), self._factor(Kind.MASS_CENTER, k))

    def velocity_of_origin(self, k: int) -> Sum:
        """Return {v'_OK}, the velocity of O_K in J components, Eq. (25)."""
        j = self.lower(k)
        rate = self.translation_rate(k) if self.slides(k) else NOTHING
        if j == GROUND:
            return rate
        return total(self._carried(j), rate, self._swung(j, self.offset(k)))

    def velocity_of_center(self, k: int) -> Sum:
        """Return {v'_GK}, the velocity of G_K in K components, Eq. (27)."""
        return total(self._carried(k), self._swung(k, self._factor(Kind.MASS_CENTER, k)))

    def partial_angular_velocity(self, k: int) -> Row:
        """Return [omega'_K,y1], the partial angular velocities in N blocks, Eq. (15)."""
        blocks: list[Term | None] = [None] * self.system.number_of_bodies
        prefix: tuple[Factor, ...] = ()
        for body in self.path(k):
            if self.turns_freely(body):
                blocks[body - 1] = self._turned_rates(prefix, body)
            prefix = (*prefix, self._rotation(body))
        return Row(tuple(blocks), len(blocks))

    def partial_angular_velocity_rate(self, k: int) -> Sum:
        """Return the time derivative of [omega'_K,y1], Eq. (20)."""
        own = NOTHING
        if not self.has_angular_velocity_speeds(k):
            own = self.relative_partial_angular_velocity(k, Kind.ANGLE_RATE_MATRIX_RATE)
        j = self.lower(k)
        if j == GROUND:
            return total(own)
        carried = times((self._rotation(k),), self.partial_angular_velocity_rate(j))
        return total(carried, self._turning(k, self._angular_row(j)), own)

    def partial_velocity_of_origin(self, k: int) -> Sum:
        """Return [v'_OK,y], the partial velocities of O_K in J components, in 2N blocks, Eqs. (28)-(30)."""
        own = self.relative_partial_velocity(k)
        j = self.lower(k)
        if j == GROUND:
            return _both_halves(total(own))
        carried = times((self._rotation(j),), self.partial_velocity_of_origin(j))
        swung = times((self._factor(Kind.OFFSET_TILDE, k),), self._angular_row(j), sign=-1)
        return _both_halves(total(carried, swung, own))

    def partial_velocity_of_center(self, k: int) -> Sum:
        """Return [v'_GK,y], the partial velocities of G_K in K components, in 2N blocks, Eq. (32)."""
        carried = times((self._rotation(k),), self.partial_velocity_of_origin(k))
        swung = times((self._factor(Kind.MASS_CENTER_TILDE, k),), self._angular_row(k), sign=-1)
        return _both_halves(total(carried, swung))

    def partial_velocity_of_origin_rate(self, k: int) -> Sum:
        """Return the time derivative of [v'_OK,y] in J components, Eq. (35)."""
        j = self.lower(k)
        if j == GROUND:
            return NOTHING
        carried = times((self._rotation(j),), self.partial_velocity_of_origin_rate(j))
        turned = self._turning(j, self.partial_velocity_of_origin(j))
        sliding = NOTHING
        if self.slides(k):
            sliding = times((self._factor(Kind.OFFSET_RATE_TILDE, k),), self._angular_row(j), sign=-1)
        rate = self.partial_angular_velocity_rate(j)
        swung = times((self._factor(Kind.OFFSET_TILDE, k),), rate, sign=-1)
        return _both_halves(total(carried, turned, sliding, swung))

    def partial_velocity_of_center_rate(self, k: int) -> Sum:
        """Return the time derivative of [v'_GK,y] in K components, Eq. (34)."""
        carried = times((self._rotation(k),), self.partial_velocity_of_origin_rate(k))
        turned = self._turning(k, self.partial_velocity_of_origin(k))
        rate = self.partial_angular_velocity_rate(k)
        swung = times((self._factor(Kind.MASS_CENTER_TILDE, k),), rate, sign=-1)
        return _both_halves(total(carried, turned, swung))

    def _factor(self, kind: Kind, k: int) -> Factor:
        """Return the factor of a kind for body k."""
        return Factor(kind, k, self.lower(k))

    def _rotation(self, k: int) -> Factor:
        """Return [^J R_K], or [R_K] for a body on the ground."""
        return self._factor(Kind.ROTATION_FROM_GROUND if self.lower(k) == GROUND else Kind.ROTATION, k)

    def _turning(self, k: int, terms: Sum) -> Sum:
        """Return the product of the time derivative of [^J R_K], Eq. (7), and `terms`."""
        if not self.turns(k):
            return NOTHING
        omega = Kind.OMEGA_TILDE_T if self.lower(k) == GROUND else Kind.RELATIVE_OMEGA_TILDE_T
        return times((self._factor(omega, k), self._rotation(k)), terms)

    def _turned_rates(self, prefix: tuple[Factor, ...], k: int) -> Term:
        """Return rotations times [P_K], which is the identity for speeds of an angular velocity."""
        if self.has_angular_velocity_speeds(k):
            return product(*prefix) if prefix else self._factor(Kind.IDENTITY, k)
        return product(*prefix, self._factor(Kind.ANGLE_RATE_MATRIX, k))

    def _in_lower_components(self, k: int, kind: Kind) -> Term:
        """Return a factor in J components: behind [C_K]^T if the joint frame is turned."""
        if self.system.bodies[k - 1].joint.orientation == IDENTITY:
            return self._factor(kind, k)
        back = self._factor(Kind.JOINT_ORIENTATION_T, k)
        return back if kind is Kind.IDENTITY else product(back, self._factor(kind, k))

    def translation_rate(self, k: int) -> Sum:
        """Return {sdot'_K} in J components, the second term of Eq. (25)."""
        return total(self._in_lower_components(k, Kind.TRANSLATION_RATE))

    def offset(self, k: int) -> Sum:
        """Return {q'_K} + {s'_K}, without a zero {q'_K} on the ground: the notes define q'_1 = 0."""
        joint = self.system.bodies[k - 1].joint
        translation = total(self._in_lower_components(k, Kind.TRANSLATION))
        if self.lower(k) == GROUND and not any(joint.position):
            return translation
        return total(self._factor(Kind.JOINT_POSITION, k), translation)

    def _carried(self, k: int) -> Sum:
        """Return the velocity of O_K in K components."""
        velocity = self.velocity_of_origin(k)
        return total(product(self._rotation(k), velocity)) if velocity.terms else NOTHING

    def _swung(self, k: int, arm: Term) -> Sum:
        """Return the cross product of the angular velocity of K and an arm, no term if K never turns."""
        if not any(self.turns(body) for body in self.path(k)):
            return NOTHING
        return total(product(self._factor(Kind.OMEGA_TILDE, k), arm))

    def _angular_row(self, k: int) -> Sum:
        """Return [omega'_K,y1] as a sum, without a term if all its blocks are zero."""
        row = self.partial_angular_velocity(k)
        return total(row) if any(row.blocks) else NOTHING

    def _unit_row(self, block: Term, k: int, half: int) -> Sum:
        """Return a row of zeros but for `block` at body k of {y_1} (`half` 0) or {y_2} (`half` 1)."""
        count = self.system.number_of_bodies
        blocks: list[Term | None] = [None] * (count * (half + 1))
        blocks[count * half + k - 1] = block
        return total(Row(tuple(blocks), count))

    def lower(self, k: int) -> int:
        """Return the number of the lower body of body k, 0 for the ground."""
        return self.system.connection[k - 1]

    def path(self, k: int) -> Iterator[int]:
        """Yield body k, its lower body, and so on to the ground."""
        while k != GROUND:
            yield k
            k = self.lower(k)

    def turns(self, k: int) -> bool:
        """Return whether any angle of body k moves, free or prescribed."""
        return any(self.system.bodies[k - 1].joint.moving[:FIRST_TRANSLATION])

    def turns_freely(self, k: int) -> bool:
        """Return whether any angle of body k is free or coupled."""
        return any(self._with_columns(k)[:FIRST_TRANSLATION])

    def has_angular_velocity_speeds(self, k: int) -> bool:
        """Return whether the speeds of body k are its relative angular velocity."""
        return not self.system.bodies[k - 1].joint.speeds_are_rates

    def slides(self, k: int) -> bool:
        """Return whether any translation of body k moves, free or prescribed."""
        return any(self.system.bodies[k - 1].joint.moving[FIRST_TRANSLATION:])

    def slides_freely(self, k: int) -> bool:
        """Return whether any translation of body k is free or coupled."""
        return any(self._with_columns(k)[FIRST_TRANSLATION:])

    def _with_columns(self, k: int) -> list[bool]:
        """Return which freedoms of body k have columns: free ones, and coupled ones, which add to others."""
        joint = self.system.bodies[k - 1].joint
        return [*map(any, zip(joint.free, joint.coupled, strict=True))]


def _both_halves(terms: Sum) -> Sum:
    """Return the same terms with every row of N blocks for {y_1} continued by N zeros for {y_2}."""
    return Sum(tuple((sign, _continued(term)) for sign, term in terms.terms))


def _continued(term: Term) -> Term:
    """Return a term whose last factor, if it is a row of N blocks, has N zeros more."""
    factors = term.factors if isinstance(term, Product) else (term,)
    row = factors[-1]
    if not isinstance(row, Row) or len(row.blocks) > row.bodies:
        return term
    return product(*factors[:-1], Row(row.blocks + (None,) * row.bodies, row.bodies))
