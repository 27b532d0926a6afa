"""The outputs of a symbolic linear model: names and expressions, in the terms of the derivation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from sympy import Expr, ImmutableMatrix

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.linear.names import names_of
from kanegen.model.components import AXES, vector_components

Quantity = Callable[[], Mapping[str, Expr] | Expr | ImmutableMatrix]
"""Function that derives an output: a number, a column, or numbers by the rest of their names."""


def outputs_of(
    asked: Iterable[str] | str, quantities: Mapping[str, Quantity], states: Mapping[str, Expr]
) -> list[tuple[str, Expr]]:
    """Return name and expression of every element of the outputs of a linear model.

    Args:
        asked: Names of outputs, or of single states.
        quantities: The outputs that there are.
        states: Symbols of the states by name.

    Raises:
        OptionError: If there is neither an output nor a state of a name, or the system has no points for an
            output of points.
    """
    found: list[tuple[str, Expr]] = []
    for name in names_of("outputs", asked):
        if name in states:
            found.append((name, states[name]))
        elif name in quantities:
            elements = list(_elements(name, quantities[name]()))
            if not elements:
                raise OptionError(
                    f"outputs: {quoted(name)} needs a point, and the system has none. Give a body points in "
                    "the model file, or use System.with_points, on the command line --points."
                )
            found += elements
        else:
            known = (*quantities, *states)
            raise OptionError(
                f"outputs: a symbolic linear model has no output {quoted(name)}. {did_you_mean(name, known)}"
            )
    return found


def _elements(name: str, value: Mapping[str, Expr] | Expr | ImmutableMatrix) -> Iterator[tuple[str, Expr]]:
    """Yield name and expression of each element of an output."""
    if isinstance(value, Mapping):
        yield from ((f"{name}.{rest}", one) for rest, one in value.items())
    elif isinstance(value, ImmutableMatrix):
        components = vector_components(len(value))
        yield from ((f"{name}.{k}", one) for k, one in zip(components, value.flat(), strict=True))
    else:
        yield name, value


def of_points(names: Sequence[str], vector: Callable[[str], ImmutableMatrix]) -> dict[str, Expr]:
    """Return the components of a vector of every point, by names of the point and of the component."""
    return {f"{name}.{k}": one for name in names for k, one in zip(AXES, vector(name).flat(), strict=True)}
