"""Columns of the Coriolis matrix [C], passed inward joint by joint together with those of [A].

A column begins at its freedom, from the composite body that the freedom moves, and keeps force and moment
about the current origin. See `coriolis` for what it is for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from sympy import Expr

from kanegen.recursion.columns import RotationColumn, ShiftedColumns
from kanegen.recursion.inertia import Inertia
from kanegen.recursion.joint_motion import FreedomMotion, Translation
from kanegen.recursion.merged_columns import Parts, rotation_sum
from kanegen.recursion.relative_momentum import HALF, RelativeMomentum
from kanegen.recursion.rotors import SpinningRotor
from kanegen.recursion.turns import Turn
from kanegen.recursion.vectors import ZERO, Rows, Wrench, add, column, cross, dot, multiply, scale, unit
from kanegen.symbolic.definitions import Definitions, Vector


@dataclass(frozen=True)
class FrameMotion:
    """The motion of a frame on the path through the joint of a body K.

    Attributes:
        omega: Angular velocity (rad/s).
        velocity: Velocity of the origin of K past that of the first body of its branch (m/s).
    """

    omega: Vector
    velocity: Vector


@dataclass(frozen=True)
class MovingBody:
    """A composite body as a frame sees it, whose origin is fixed in the body.

    Attributes:
        inertia: Mass, first moment and inertia about the origin.
        momentum: Momentum relative to the frame.
        motion: Motion of the frame.
    """

    inertia: Inertia
    momentum: RelativeMomentum
    motion: FrameMotion


@dataclass(frozen=True)
class Column:
    """What unit rate and unit acceleration along a freedom require of a composite body.

    Attributes:
        inertial: Force and moment for unit acceleration: the column of [A].
        coriolis: Force and moment for unit rate, with the [dv_P,y/dt] of the freedom: the column of [C].
        couple: The sum of {v_P} x m [v_P,y], which the row of [C] needs beside `inertial`; {v_P} is the
            velocity of a particle past the origin of the first body, and the couple is about no origin.
        slope: Derivative by the coordinate of the force and the moment that the motion requires of the
            composite body, as bodies further inward see them; or None where nobody needs it. See
            `inverse_dynamics_derivatives`.
    """

    inertial: RotationColumn
    coriolis: Wrench
    couple: Vector
    slope: Wrench | None = None

    @property
    def places(self) -> Mapping[int, Expr]:
        """Factors by place in {y}: by how much each entry of {y} moves the freedom."""
        return self.inertial.places

    def along(self, axis: int) -> Expr:
        """Return the entry of [C] in this column, in the row of a rotation about a basis vector."""
        return self.coriolis.moment[axis]

    def across(self, axis: int, motion: FrameMotion) -> Expr:
        """Return the entry of [C] in the row of this freedom and the column of a rotation.

        Args:
            axis: The axis of the rotation, a basis vector of a frame in which it does not move.
            motion: Motion of this frame, whose origin is on the axis.
        """
        a = unit(axis)
        turning = dot(cross(motion.omega, a), self.inertial.moment)
        passing = dot(cross(motion.velocity, a), self.inertial.force)
        return self.couple[axis] + turning + passing

    def down(self, turn: Turn, frame: str, definitions: Definitions) -> Column:
        """Return the column in components of the frame below a turn."""
        inertial = self.inertial.down(turn, frame, definitions)
        passed = replace(
            self,
            inertial=inertial,
            coriolis=_down(turn, self.coriolis),
            couple=turn.down(self.couple),
            slope=self.slope and _down(turn, self.slope),
        )
        return _named(passed, f"{inertial.label}_{frame}", definitions)

    def shifted(
        self, offset: Vector, origin: str, shift: ShiftedColumns | None, definitions: Definitions
    ) -> Column:
        """Return the column about another origin, from which `offset` leads to the current one.

        Args:
            offset: The vector from the other origin to this one (m).
            origin: Number of the body whose origin it is.
            shift: Moments of the rotations of the joint about that origin, if the freedom is one of them and
                they are known.
            definitions: Definitions that the intermediates are added to.
        """
        inertial = self.inertial
        inertial = shift.shift(inertial) if shift else inertial.shifted(offset, origin, definitions)
        passed = replace(
            self,
            inertial=inertial,
            coriolis=_about(self.coriolis, offset),
            slope=self.slope and _about(self.slope, offset),
        )
        return _named(passed, f"{inertial.label}_{origin}", definitions)


def _down(turn: Turn, wrench: Wrench) -> Wrench:
    """Return a wrench in components of the frame below a turn."""
    return Wrench(turn.down(wrench.force), turn.down(wrench.moment))


def _about(wrench: Wrench, offset: Vector) -> Wrench:
    """Return a wrench about another origin, from which `offset` leads to the current one."""
    return Wrench(wrench.force, add(wrench.moment, cross(offset, wrench.force)))


def rotation_column(
    one: FreedomMotion, label: str, body: MovingBody, second: Rows, definitions: Definitions
) -> Column:
    """Begin the column of a rotation about a basis vector {a} of a frame in which it does not move.

    Args:
        one: The freedom.
        label: Suffix of the names of intermediates.
        body: The composite body that it turns, about a point of the axis, in this frame.
        second: Second moments [D] of this body.
        definitions: Definitions that the intermediates are added to.
    """
    axis, omega, momentum = unit(one.axis), body.motion.omega, body.momentum
    force, moment = cross(axis, body.inertia.moment), column(body.inertia.inertia, one.axis)
    spread = definitions.vector(f"Dw_{label}", multiply(second, omega))
    rate_force = add(cross(omega, force), cross(axis, momentum.linear))
    rate_moment = add(momentum.column(one.axis), cross(spread, axis))
    couple = add(momentum.row(one.axis), multiply(second, cross(omega, axis)))
    couple = add(couple, cross(body.motion.velocity, force))
    inertial = RotationColumn(one.number, one.shares, label, force, moment)
    return _named(Column(inertial, Wrench(rate_force, rate_moment), couple), label, definitions)


def translation_column(one: Translation, label: str, body: MovingBody, definitions: Definitions) -> Column:
    """Begin the column of a translation along a direction {b} that is fixed in the lower body.

    Args:
        one: The freedom.
        label: Suffix of the names of intermediates.
        body: The composite body that it moves, about the origin of the lower body, in the frame of this.
        definitions: Definitions that the intermediates are added to.
    """
    inertia, omega, direction = body.inertia, body.motion.omega, one.direction
    turning = cross(omega, direction)
    force = definitions.vector(f"F_{label}", scale(inertia.mass, direction))
    moment = definitions.vector(f"M_{label}", cross(inertia.moment, direction))
    wrench = Wrench(scale(inertia.mass, turning), cross(inertia.moment, turning))
    passing = add(body.momentum.linear, cross(omega, inertia.moment))
    passing = definitions.vector(f"pa_{label}", add(passing, scale(inertia.mass, body.motion.velocity)))
    inertial = RotationColumn(one.number, one.shares, label, force, moment)
    return _named(Column(inertial, wrench, cross(passing, direction)), label, definitions)


def rotor_column(rotor: SpinningRotor, omega: Vector, definitions: Definitions) -> Column:
    """Begin the column of the spin of a rotor with the angular momentum {h} y in its carrier.

    The moment {h} of the column of [A] changes by {omega} x {h}. By Christoffel symbols, one half of this is
    in the column of [C] and the other half in its row.

    Args:
        rotor: The rotor.
        omega: Angular velocity of the carrier, in its frame (rad/s).
        definitions: Definitions that the intermediates are added to.
    """
    label = f"{rotor.carrier}r{rotor.motion.number}"
    half = definitions.vector(f"TC_{label}", scale(HALF, cross(omega, rotor.momentum)))
    inertial = RotationColumn(rotor.motion.number, rotor.motion.shares, label, ZERO, rotor.momentum)
    return Column(inertial, Wrench(ZERO, half), half)


def column_sum(place: int, parts: Parts[Column], body: str, definitions: Definitions) -> Column:
    """Return the column of an entry of {y} that moves several freedoms, at body `body`.

    Args:
        place: Place of the entry in {y}.
        parts: The columns of the freedoms, each with the factor of the entry in its rate.
        body: Number of the body at which they have arrived.
        definitions: Definitions that the intermediates are added to.
    """
    columns = [(share, col.inertial) for share, col in parts]
    inertial = rotation_sum(place, columns, body, body, definitions)
    coriolis, slope, couple = Wrench(), Wrench(), ZERO
    for share, col in parts:
        coriolis = _plus(coriolis, share, col.coriolis)
        slope = _plus(slope, share, col.slope or Wrench())
        couple = add(couple, scale(share, col.couple))
    is_sloping = all(col.slope for _, col in parts)
    added = Column(inertial, coriolis, couple, slope if is_sloping else None)
    return _named(added, f"{inertial.label}_{body}", definitions)


def _plus(total: Wrench, share: Expr, wrench: Wrench) -> Wrench:
    """Return a wrench plus `share` times another one."""
    force = add(total.force, scale(share, wrench.force))
    return Wrench(force, add(total.moment, scale(share, wrench.moment)))


def with_slope(column: Column, slope: Wrench, definitions: Definitions) -> Column:
    """Return a column that begins with the derivative `slope` of a force and a moment, with its symbols."""
    return replace(column, slope=_named_slope(slope, column.inertial.label, definitions))


def with_coriolis(column: Column, wrench: Wrench, couple: Vector, definitions: Definitions) -> Column:
    """Return a column with another part of [C], with its symbols.

    Args:
        column: The column, where it begins.
        wrench: Its force and moment for unit rate.
        couple: Its couple.
        definitions: Definitions that the intermediates are added to.
    """
    label = column.inertial.label
    force, moment = (
        definitions.vector(f"{name}_{label}", one)
        for name, one in (("FC", wrench.force), ("MC", wrench.moment))
    )
    return replace(column, coriolis=Wrench(force, moment), couple=definitions.vector(f"TC_{label}", couple))


def _named(column: Column, name: str, definitions: Definitions) -> Column:
    """Return a column with a symbol for every component."""
    force = definitions.vector(f"FC_{name}", column.coriolis.force)
    moment = definitions.vector(f"MC_{name}", column.coriolis.moment)
    couple = definitions.vector(f"TC_{name}", column.couple)
    slope = column.slope and _named_slope(column.slope, name, definitions)
    return replace(column, coriolis=Wrench(force, moment), couple=couple, slope=slope)


def _named_slope(slope: Wrench, name: str, definitions: Definitions) -> Wrench:
    """Return the derivative of a force and a moment with a symbol for every component."""
    force = definitions.vector(f"FX_{name}", slope.force)
    return Wrench(force, definitions.vector(f"MX_{name}", slope.moment))
