"""Held directions of contacts that depend on each other in every state, found before any code is written.

Rows of the Jacobian of the held directions are orthogonalised in their order, as the columns of partial
velocities are in `regularity`: a row depends on the rows before it if its remainder is below the rounding
error of what was subtracted. A row that no freedom moves is such a row, too. One random state in which all
rows are independent decides, because almost all states have the same rank.

A row with damping yields, whatever other rows hold, so that it counts as independent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kanegen.errors import SingularError, quoted
from kanegen.model.arrays import Floats
from kanegen.model.contact import ContactRow
from kanegen.model.system import System
from kanegen.reference.contacts import constraint_rows, held_frame
from kanegen.reference.freedoms import free_columns, gathered
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import path_maxima
from kanegen.reference.regularity import STATES, VelocityRows, dependent_column, equilibration
from kanegen.reference.states import random_states

MOST_NAMED = 6
"""Largest number of rows that the error message names in one place."""


def require_independent(system: System, outputs: Sequence[str]) -> None:
    """Make sure that the held directions without damping are independent in almost every state.

    Args:
        system: The tree with its contacts; parameters stand at their defaults.
        outputs: Names of the outputs that need the loads of the contacts, for the message.

    Raises:
        SingularError: If one depends on others in every state; the message names them.
    """
    if found := dependent_rows(system):
        raise SingularError(_message(found, outputs))


def dependent_rows(system: System) -> tuple[tuple[ContactRow, ...], ...]:
    """Return each held direction that depends on others in every state, together with those.

    Without the first direction of every group, all are independent.

    Example:
        names = [group[0].name for group in dependent_rows(system)]
    """
    left = [i for i, row in enumerate(system.contact_rows) if row.contact.damping == 0]
    if not left:
        return ()
    states = random_states(system, STATES)
    pairs = zip(states.x, states.prescribed, strict=True)
    held = [_directions(system, x, prescribed) for x, prescribed in pairs]
    found: list[tuple[ContactRow, ...]] = []
    while left and all(group := dependent_column(each.of(left)) for each in held):
        found.append(tuple(system.contact_rows[left[i]] for i in group))
        del left[group[0]]
    return tuple(found)


def _directions(system: System, x: Floats, prescribed: Floats) -> VelocityRows:
    """Return the held directions as columns, in which each freedom has a row.

    Args:
        system: The tree with its contacts.
        x: (m,) coordinates.
        prescribed: (3, p) motion of the prescribed freedoms.
    """
    arrays, free = system.values(), free_columns(system.values())
    still = np.zeros(len(system.freedoms))
    jacobian, _ = constraint_rows(system, x, still, prescribed)
    maxima = path_maxima(arrays, kinematics(arrays, x, still, prescribed), still, prescribed)
    sizes = []
    for row in system.contact_rows:
        frame = held_frame(system, arrays, row.contact)
        own = maxima[frame.body - 1]
        size = own.omega_y
        if not row.is_moment:
            size = own.origin_y + float(np.linalg.norm(frame.position)) * own.omega_y
        sizes.append(gathered(arrays, size, free, sizes=True))
    table = np.array(sizes)
    row_scale, column_scale = equilibration(table)
    scales = row_scale[:, None] * column_scale
    columns = (scales * jacobian).T
    padding = np.zeros((len(table), len(table)))
    return VelocityRows(np.vstack([padding, columns]), np.linalg.norm(scales * table, axis=1))


def _message(groups: Sequence[Sequence[ContactRow]], outputs: Sequence[str]) -> str:
    """Return the error message for held directions, each with those on which it depends."""
    (first, *holding), *rest = groups
    contact, dropped = first.contact, [group[0] for group in groups]
    hold = "holds" if len(holding) == 1 else "hold"
    reason = (
        f"{_named(holding)} {hold} it already"
        if holding
        else f"no freedom moves {quoted(contact.place)} that way"
    )
    same = f" The same is true of {_named([group[0] for group in rest])}." if rest else ""
    without = {row.name for row in dropped}
    left = [direction for direction in contact.held if f"{contact.name}.{direction}" not in without]
    name = quoted(contact.name)
    remedy = f"directions = {left} of contact {name}, or {contact.name}:{'+'.join(left)} in --contacts"
    if not left:
        remedy = f"leave out contact {name}"
    return (
        f"contacts: {quoted(first.name)} cannot be held, because in every state, but for rounding errors, "
        f"{reason}; {' and '.join(outputs)} would need loads that are not unique.{same} "
        f"Leave such directions out ({remedy}), or give the contacts a damping."
    )


def _named(rows: Sequence[ContactRow]) -> str:
    """Return the names of rows, of many the first ones with the number of the others."""
    names = ", ".join(quoted(row.name) for row in rows[:MOST_NAMED])
    return f"{names} and {len(rows) - MOST_NAMED} more" if len(rows) > MOST_NAMED else names
