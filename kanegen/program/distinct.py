"""Programs whose matrices hold every value once.

A mass matrix is symmetric, and zero for two freedoms neither of which moves the body of the other; so are
derivatives by efforts. A function that computes several states side by side fills such a matrix for each of
them, which is more memory than a processor keeps at hand. It fills only the values that differ, and a table
has the place of the value of each element.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from kanegen.program.ir import Output, Program

REPEATED = 1 / 8
"""Least share of the elements of a matrix that hold values of others where they are stored once."""

SMALL = 128
"""Number of elements of a matrix below which a table of places costs as much as it saves."""


@dataclass(frozen=True)
class DistinctValues:
    """A program with matrices that hold every value once, and the place of each element's value in them.

    Attributes:
        program: The program; such a matrix is an array with one axis.
        places: For the name of each such matrix, place of the value of each of its elements, row-major; 0 for
            elements that are not filled.
    """

    program: Program
    places: dict[str, tuple[int, ...]]


def distinct_values(program: Program) -> DistinctValues:
    """Return a program that computes the same, and fills every matrix with many equal elements once a value.

    Matrices that loops compute stay as they are.
    """
    places: dict[str, tuple[int, ...]] = {}
    outputs = []
    for output in program.outputs:
        values = tuple(dict.fromkeys(output.values))
        if _is_worth_while(output, len(values)):
            outputs.append(_filled_once(output, values))
            places[output.array.name] = _places(output, values)
        else:
            outputs.append(output)
    return DistinctValues(replace(program, outputs=tuple(outputs)), places)


def _is_worth_while(output: Output, different: int) -> bool:
    """Return whether many elements of an output hold values of others.

    Args:
        output: The output.
        different: Number of its values that differ.
    """
    is_matrix = len(output.array.shape) == 2 and output.solution is None
    repeated = len(output.values) - different
    return is_matrix and len(output.values) >= SMALL and repeated >= REPEATED * len(output.values)


def _filled_once(output: Output, values: tuple[int, ...]) -> Output:
    """Return an output that holds each of `values` once."""
    array = replace(output.array, shape=(len(values),), pattern=())
    return replace(output, array=array, values=values, places=None)


def _places(output: Output, values: Iterable[int]) -> tuple[int, ...]:
    """Return the place among `values` of the value of every element of an output."""
    place = {value: k for k, value in enumerate(values)}
    held = {element: place[value] for element, value in output.elements()}
    return tuple(held.get(element, 0) for element in range(output.array.size))
