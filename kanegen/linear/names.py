"""Names of the states and inputs of linear models."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kanegen.choices import chosen, did_you_mean
from kanegen.errors import OptionError, quoted


def state_names(coordinates: Iterable[str], speeds: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the states of a linear model: "x.<coordinate>", then "y.<speed>"."""
    return (*(f"x.{name}" for name in coordinates), *(f"y.{name}" for name in speeds))


def inputs_of(freedoms: Sequence[str], asked: Iterable[str] | str | None) -> list[int]:
    """Return the places of the freedoms on which a control acts.

    Raises:
        OptionError: If there is no freedom of a name, or one is named twice.
    """
    if asked is None:
        return list(range(len(freedoms)))
    places = []
    for name in names_of("inputs", asked):
        if name not in freedoms:
            raise OptionError(f"inputs: there is no freedom {quoted(name)}. {did_you_mean(name, freedoms)}")
        places.append(freedoms.index(name))
    if len(set(places)) < len(places):
        raise OptionError("inputs: a freedom is named twice. Name each once.")
    return places


def names_of(option: str, asked: Iterable[str] | str) -> tuple[str, ...]:
    """Return one or several names as a tuple.

    Args:
        option: Name of the option, for the message.
        asked: The names, or a single one.

    Raises:
        OptionError: If `asked` is neither a name nor a collection of names.
    """
    names = chosen(asked)
    if names is None or not all(isinstance(name, str) for name in names):
        raise OptionError(f"{option}: expected names, got {quoted(asked)}.")
    return names
