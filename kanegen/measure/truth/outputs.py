"""Which outputs have exact results."""

from __future__ import annotations

from collections.abc import Iterable

from kanegen.errors import ArrayError, OptionError
from kanegen.recursion.outputs import chosen

EXACT = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
"""[A], {f}, and what follows from both."""


def exact_outputs(outputs: Iterable[str], has_ydot: bool) -> tuple[str, ...]:
    """`outputs` checked, each once.

    Args:
        outputs: Names.
        has_ydot: Whether there are accelerations, which inverse dynamics needs.

    Raises:
        ArrayError: If it has none.
        OptionError: If a name is unknown, or has no exact result.
    """
    names = chosen(outputs)
    for name in names:
        if name not in EXACT:
            raise OptionError(f"there is no exact result for {name!r}, only for {', '.join(EXACT)}.")
    if "inverse_dynamics" in names and not has_ydot:
        raise ArrayError("inverse_dynamics needs ydot, the accelerations.")
    return names


def measurable_outputs(
    available: tuple[str, ...], outputs: Iterable[str] | None, has_ydot: bool
) -> tuple[str, ...]:
    """`outputs` checked as `exact_outputs` does; by default all of `available` that can be measured.

    Raises:
        ArrayError: If inverse dynamics is asked for by name, but there are no accelerations.
        OptionError: If one is not available, or there is nothing to measure.
    """
    if outputs is None:
        usable = [name for name in available if name in EXACT and (has_ydot or name != "inverse_dynamics")]
        if not usable:
            raise OptionError(f"nothing to measure: of {', '.join(available)} no exact result is known.")
        return tuple(usable)
    names = exact_outputs(outputs, has_ydot)
    for name in names:
        if name not in available:
            raise OptionError(f"the library has no {name!r}. It has {', '.join(available)}.")
    return names
