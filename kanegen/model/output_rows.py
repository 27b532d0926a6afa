"""The selection of output rows by a system: frames of `body_poses`, locked directions of `reaction_loads`.

Names have the order of the rows in results; None selects all rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from kanegen import choices
from kanegen.choices import did_you_mean, is_among
from kanegen.errors import ModelError, quoted
from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, FREEDOMS, TRANSLATIONS
from kanegen.model.frame import Frame

POSES, REACTIONS = "body poses", "reaction loads"


def locked_directions(bodies: Sequence[Body]) -> dict[str, tuple[int, int]]:
    """Return every locked direction in the order of Eq. (1): angles of all bodies, then translations.

    Returns:
        Number of the body, from 1, and index in `FREEDOMS`, by name such as `<body>.theta2` or `<body>.s1`.
    """
    return {
        f"{body.name}.{FREEDOMS[index]}": (k, index)
        for indices in (ANGLES, TRANSLATIONS)
        for k, body in enumerate(bodies, start=1)
        for index in indices
        if not body.joint.moving[index]
    }


def poses(frame: Callable[[Any, str], Frame], chosen: Any) -> tuple[str, ...] | None:
    """Return the names of the frames that are chosen; None if all bodies are.

    Args:
        frame: Function that returns the frame of a name or number, with a label for its error.
        chosen: Names of frames and bodies, or numbers of bodies; None for all bodies.

    Raises:
        ModelError: If a chosen frame does not exist or is named twice, or none is chosen.
    """
    if chosen is None:
        return None
    names = [frame(one, POSES).name for one in _listed(chosen, POSES)]
    _require_once(names, POSES)
    return tuple(names)


def reactions(bodies: Sequence[Body], chosen: Any) -> tuple[str, ...] | None:
    """Return the names of the locked directions that are chosen; None if all are.

    Raises:
        ModelError: If a chosen direction is free, does not exist or is named twice, or none is chosen.
    """
    if chosen is None:
        return None
    known, names = locked_directions(bodies), _listed(chosen, REACTIONS)
    for name in names:
        if not isinstance(name, str) or name not in known:
            raise ModelError(f"{REACTIONS}: {_reason(bodies, name, known)}")
    _require_once(names, REACTIONS)
    return names


def _reason(bodies: Sequence[Body], name: object, known: Iterable[str]) -> str:
    """Return the reason why a name is no locked direction, and the remedy."""
    for body in bodies:
        for index, freedom in enumerate(FREEDOMS):
            if is_among(name, [f"{body.name}.{freedom}"]):
                if body.joint.coupled[index]:
                    return (
                        f"{quoted(name)} is coupled to other freedoms, so its effort is part of theirs. "
                        "Leave it out."
                    )
                is_free = body.joint.free[index]
                moves, output = (
                    ("free", "inverse_dynamics") if is_free else ("prescribed", "prescribed_efforts")
                )
                return (
                    f"{quoted(name)} is {moves}; its effort is what {output} gives. Lock it, or leave it out."
                )
    if not known:
        return "no direction of a joint is locked. Lock one, or take inverse_dynamics."
    return f"there is no locked direction {quoted(name)}. {did_you_mean(name, known)}"


def _require_once(names: Sequence[str], label: str) -> None:
    """Raise a `ModelError` if a name occurs twice."""
    for i, name in enumerate(names):
        if is_among(name, names[:i]):
            raise ModelError(f"{label}: {quoted(name)} is named twice. Name it once.")


def _listed(chosen: Any, label: str) -> tuple[Any, ...]:
    """Return one or several chosen items as a tuple."""
    items = choices.chosen(chosen)
    items = (chosen,) if items is None else items
    if not items:
        raise ModelError(f"{label}: none is chosen. Name one, or leave the choice out for all.")
    return items
