"""The selection of output rows by a system: frames, in the order of the rows of outputs about them.

Names have the order of the rows in results; None selects the bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from kanegen import choices
from kanegen.choices import is_among
from kanegen.errors import ModelError, quoted
from kanegen.model.frame import Frame

FRAMES = "frames"
"""Beginning of error messages on the choice of frames."""


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
    names = [frame(one, FRAMES).name for one in listed_choices(chosen, FRAMES)]
    require_once(names, FRAMES)
    return tuple(names)


def require_once(names: Sequence[str], label: str) -> None:
    """Raise a `ModelError` if a name occurs twice."""
    for i, name in enumerate(names):
        if is_among(name, names[:i]):
            raise ModelError(f"{label}: {quoted(name)} is named twice. Name it once.")


def listed_choices(chosen: Any, label: str, otherwise: str = "for all") -> tuple[Any, ...]:
    """Return one or several chosen items as a tuple.

    Args:
        chosen: The items, or a single one.
        label: What is chosen, with which the message begins.
        otherwise: What leaving the choice out means, for the message.

    Raises:
        ModelError: If there is no item.
    """
    items = choices.chosen(chosen)
    items = (chosen,) if items is None else items
    if not items:
        raise ModelError(f"{label}: none is chosen. Name one, or leave the choice out {otherwise}.")
    return items
