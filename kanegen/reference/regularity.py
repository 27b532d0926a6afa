"""Systems whose [A] is singular in every state, found before any code is written.

[A] = [P]^T [M] [P], where [P] holds the partial velocities of the mass centres, the partial angular
velocities, and a row for each motor and each rotor; [M] holds the masses, inertias without those of rotors
about their axes, armatures, and inertias of rotors. Whether [A] is singular depends only on the rows of [P]
where [M] is not zero, not on how large it is there, so mass ratios cannot blur the answer. Scaling rows and
columns does not change it either.

[A] is singular where some motion moves neither mass nor inertia, that is where the columns of these rows
depend on each other. They are orthogonalised from the outermost freedom inward, so the first column that
vanishes belongs to a freedom whose motion can be undone by freedoms further out. A column vanishes if its
remainder is below the rounding error of the velocities that were subtracted; the largest part of this
error comes from the model's own rotations, which are accepted when they are orthogonal to `ORTHOGONALITY`.
One random state decides, because almost all states have the same rank.

Only solutions of [A]{ydot} = {b} are undefined in such a system. [A] itself, {f}, inverse dynamics, energies
and all kinematics are not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.errors import SingularError, counted, quoted
from kanegen.model.arrays import Floats, RotorArrays, SystemArrays
from kanegen.model.system import System
from kanegen.model.validation import INERTIA_ROUNDING, ORTHOGONALITY
from kanegen.reference.freedoms import UNPRESCRIBED, free_columns, gathered
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.reference.magnitudes import PathMaxima, path_maxima
from kanegen.reference.motors import armature_in_order, spin_of
from kanegen.reference.states import random_states

STATES = 3
"""Number of random states to try: one regular state proves regularity, and exceptional states are rare."""

NEGLIGIBLE = 1e-6
"""Largest share in a massless motion of a freedom that the error message does not name."""

MOST_NAMED = 12
"""Largest number of further massless motions that the error message names."""

Motion = tuple[int, ...]
"""Places in {y} of the freedoms of a motion that moves neither mass nor inertia, the innermost first."""


def massless_motions(system: System) -> tuple[Motion, ...]:
    """Return the motions that move neither mass nor inertia in any state; parameters stand at their defaults.

    [A] is singular in every state if there is one. The first freedoms of the motions are different, and if
    these are locked, [A] is regular.

    Example:
        names = [system.speed_names[motion[0]] for motion in massless_motions(system)]
    """
    arrays = system.values()
    order = _freedoms_inward(system)
    states = random_states(arrays, STATES)
    rows = [
        velocity_rows(arrays, x, order, prescribed)
        for x, prescribed in zip(states.x, states.prescribed, strict=True)
    ]
    motions: list[Motion] = []
    columns = list(range(len(order)))
    while all(motion := dependent_column(each.of(columns)) for each in rows):
        motions.append(tuple(order[columns[i]] for i in motion))
        del columns[motion[0]]
    return tuple(motions)


def require_regular(
    system: System, undefined: Sequence[str] = ("forward_dynamics",), remaining: Sequence[str] = ()
) -> None:
    """Make sure that [A] is regular in almost every state; parameters stand at their defaults.

    Args:
        system: The tree.
        undefined: Names of the outputs that are solutions of [A]{ydot} = {b}, for the message.
        remaining: Names of the outputs that exist nevertheless, for the message.

    Raises:
        SingularError: If [A] is singular in every state; the message names bodies, freedoms and outputs.
    """
    motions = massless_motions(system)
    if motions:
        raise SingularError(_message(system, motions, undefined, remaining))


def _freedoms_inward(system: System) -> list[int]:
    """Return the indices of the freedoms from the outermost inward; angles lie outside translations."""
    keys = [(freedom.body, freedom.is_angle, freedom.axis) for freedom in system.freedoms]
    return sorted(range(len(keys)), key=keys.__getitem__, reverse=True)


def dependent_column(rows: VelocityRows) -> list[int]:
    """Return the indices of the first column that depends on columns before it, and of these; empty if none.

    The combination of earlier columns that comes closest to column j is R[:j,:j]^-1 R[:j,j], where R is the
    triangular factor of the rows; its inverse grows by a column at every step.
    """
    r: Floats = np.asarray(np.linalg.qr(rows.velocities, mode="r"))
    inverse = np.zeros_like(r)
    for j in range(len(r)):
        combination = inverse[:j, :j] @ r[:j, j]
        rounding = ORTHOGONALITY * (rows.magnitudes[j] + np.abs(combination) @ rows.magnitudes[:j])
        if abs(r[j, j]) <= rounding:
            return [j, *(int(i) for i in np.flatnonzero(np.abs(combination) > NEGLIGIBLE))]
        inverse[:j, j] = -combination / r[j, j]
        inverse[j, j] = 1 / r[j, j]
    return []


def _message(
    system: System, motions: Sequence[Motion], undefined: Sequence[str], remaining: Sequence[str]
) -> str:
    """Return the error message for massless motions, of which the first is described in full."""
    first, *others = [[quoted(system.speed_names[i]) for i in motion] for motion in motions]
    body = quoted(system.bodies[system.freedoms[motions[0][0]].body - 1].name)
    together = f" together with {', '.join(first[1:])}" if first[1:] else ""
    message = (
        f"body {body}: freedom {first[0]}{together} moves neither mass nor inertia, so [A] is singular in "
        f"every state and has no inverse, which {' and '.join(undefined)} would need."
    )
    if others:
        left_out = len(others) - MOST_NAMED
        more = f" and {counted(left_out, 'further freedom')}" if left_out > 0 else ""
        message += f" The same holds for {', '.join(motion[0] for motion in others[:MOST_NAMED])}{more}."
        message += " Give their bodies mass or inertia that moves with them, or lock these freedoms."
    else:
        message += f" Give {body} mass or inertia that moves with it, or lock the freedom."
    return f"{message} Outputs that do not need it: {', '.join(remaining)}." if remaining else message


SWEEPS = 5
"""Number of times that rows and columns are scaled in turn, until their largest entries are close to 1."""


@dataclass(frozen=True)
class VelocityRows:
    """Rows of [P] that carry mass or inertia, without units.

    Attributes:
        velocities: (r, n) rows, about 1 in size, with one column for each freedom; r >= n.
        magnitudes: (n,) norms of the terms of the columns, to which rounding errors are relative.
    """

    velocities: Floats
    magnitudes: Floats

    def of(self, columns: Sequence[int]) -> VelocityRows:
        """Return the rows of some of the freedoms, by the numbers of their columns."""
        return VelocityRows(self.velocities[:, columns], self.magnitudes[columns])


def velocity_rows(
    arrays: SystemArrays, x: Floats, order: Sequence[int], prescribed: Floats = UNPRESCRIBED
) -> VelocityRows:
    """Return the rows of [P] that carry mass, inertia or armature in one state.

    Args:
        arrays: The numbers of the tree.
        x: (m,) coordinates.
        order: Indices of the freedoms in the order of the columns.
        prescribed: (3, p) motion of the prescribed freedoms.
    """
    free, places = free_columns(arrays), list(order)
    still = np.zeros(len(places))
    bodies = kinematics(arrays, x, still, prescribed)
    blocks, sizes = [], []
    inertias, every = list(arrays.inertia), path_maxima(arrays, bodies, still, prescribed)
    for rotor in arrays.rotors:
        row, size = _rotor_row(arrays, rotor, bodies, every)
        if row.any():
            blocks.append(gathered(arrays, row, free)[None, places])
            sizes.append(gathered(arrays, size, free, sizes=True)[places])
        if rotor.body:
            inertias[rotor.body - 1] = inertias[rotor.body - 1] - rotor.inertia * np.outer(
                rotor.axis, rotor.axis
            )
    for k, maxima in enumerate(every):
        if arrays.mass[k] > 0:
            blocks.append(gathered(arrays, bodies[k].center_y, free)[:, places])
            sizes.append(gathered(arrays, maxima.center_y, free, sizes=True)[places])
        axes = inertia_axes(inertias[k])
        if len(axes):
            blocks.append(axes @ gathered(arrays, bodies[k].omega_y, free)[:, places])
            sizes.append(gathered(arrays, maxima.omega_y, free, sizes=True)[places])
    rates = gathered(arrays, np.eye(arrays.free.size), free)[:, places]
    for row in rates[np.flatnonzero(armature_in_order(arrays))]:
        blocks.append(row[None])
        sizes.append(np.abs(row))
    table = np.reshape(sizes, (-1, len(places)))
    row_scale, column_scale = equilibration(table)
    scaled = [scale * block * column_scale for scale, block in zip(row_scale, blocks, strict=True)]
    magnitudes = np.linalg.norm(table * row_scale[:, None] * column_scale, axis=0)
    return VelocityRows(np.vstack([np.zeros((len(places), len(places))), *scaled]), magnitudes)


def _rotor_row(
    arrays: SystemArrays, rotor: RotorArrays, bodies: Sequence[BodyKinematics], maxima: Sequence[PathMaxima]
) -> tuple[Floats, Floats]:
    """Return the (6N,) partial angular velocities of a rotor about its axis, and the sizes of their terms."""
    place, _, _ = spin_of(arrays, rotor)
    row, size = np.zeros(arrays.free.size), np.zeros(arrays.free.size)
    if rotor.inertia:
        row[place] = size[place] = rotor.ratio
        if rotor.body:
            row += rotor.axis @ bodies[rotor.body - 1].omega_y
            size = np.abs(size) + maxima[rotor.body - 1].omega_y
    return row, np.abs(size)


def inertia_axes(inertia: Floats) -> Floats:
    """Return the (r, 3) principal axes about which a (3, 3) inertia has a moment.

    A moment counts as zero within the rounding of a rotated inertia, relative to the entries that the
    rotation has mixed. Exact zeros show which entries were not mixed: each block between them has a scale
    of its own.
    """
    linked = np.linalg.matrix_power((inertia != 0) | np.eye(3, dtype=np.bool_), 2)
    found = []
    for block in sorted({tuple(np.flatnonzero(row)) for row in linked}):
        moments, axes = np.linalg.eigh(inertia[np.ix_(block, block)])
        for axis in axes.T[moments > INERTIA_ROUNDING * moments[-1]]:
            found.append(axis @ np.eye(3)[list(block)])
    return np.reshape(found, (-1, 3))


def equilibration(table: Floats) -> tuple[Floats, Floats]:
    """Return factors of rows and of columns after which the largest entry of each is about 1."""
    rows, columns = np.ones(table.shape[0]), np.ones(table.shape[1])
    for _ in range(SWEEPS):
        rows = 1 / _largest(table * columns, axis=1)
        columns = 1 / _largest(table * rows[:, None], axis=0)
    return rows, columns


def _largest(table: Floats, axis: int) -> Floats:
    """Return the largest entries along an axis, or 1 where all are zero."""
    largest: Floats = table.max(axis=axis, initial=0.0)
    return np.where(largest > 0, largest, 1.0)
