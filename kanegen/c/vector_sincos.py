"""Sines and cosines of several coordinates, computed by one call.

Where a function needs sine and cosine of several elements of one array, it computes them before the rest. The
lanes of a vector hold several angles of one state; in a batch they hold one angle of several states, and a
call for all angles tests once whether an angle is large. Computed one by one they are a large part of the
cost of the equations.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from kanegen.c.usage import live
from kanegen.program.ir import WORKSPACE, Op, Program

FEWEST = 2
"""Number of angles from which one call is faster."""

NAMES = {Op.SIN: "sines", Op.COS: "cosines"}
"""The local arrays that hold the results."""


@dataclass(frozen=True, slots=True)
class VectorSincos:
    """Sine and cosine of the elements `start` to before `stop` of an input array.

    Attributes:
        array: Name of the input array.
        start: First element.
        stop: Element after the last.
    """

    array: str
    start: int
    stop: int

    @property
    def count(self) -> int:
        """Number of angles."""
        return self.stop - self.start

    def lines(self, number: str, function: str) -> list[str]:
        """Return the statements that compute all sines and cosines.

        Args:
            number: Type of each.
            function: Name of the function that computes them.
        """
        angles = f"{self.array} + {self.start}" if self.start else self.array
        sines, cosines = NAMES.values()
        return [
            f"    {number} {sines}[{self.count}], {cosines}[{self.count}];",
            f"    {function}({self.count}, {angles}, {sines}, {cosines});",
        ]

    def element(self, op: Op, array: str, index: int) -> str | None:
        """Return the place of the sine or cosine of an element, None if it is not among them."""
        if op not in NAMES or array != self.array or not self.start <= index < self.stop:
            return None
        return f"{NAMES[op]}[{index - self.start}]"

    def only(self, program: Program) -> frozenset[int]:
        """Return the elements of which nothing but sine and cosine is used."""
        taken, other = set[int](), set(program.results())
        for i in live(program):
            instruction = program.instructions[i]
            angles = [program.instructions[j] for j in instruction.operands]
            is_taken = any(self.element(instruction.op, angle.array, angle.index) for angle in angles)
            (taken if is_taken else other).update(instruction.operands)
        return frozenset(taken - other)


def vector_sincos(program: Program, spread: int, shared: Collection[str]) -> VectorSincos | None:
    """Return the sines and cosines to compute at once; None if there are too few near each other.

    Args:
        program: The program.
        spread: Most elements of the array, whatever lies between, for each angle.
        shared: Arrays whose elements are not taken.
    """
    angles: dict[str, set[int]] = {}
    for i in live(program):
        instruction = program.instructions[i]
        if instruction.op in NAMES:
            angle = program.instructions[instruction.operands[0]]
            if angle.op is Op.INPUT and angle.array not in (WORKSPACE, *shared):
                angles.setdefault(angle.array, set()).add(angle.index)
    for array, indices in angles.items():
        found = VectorSincos(array, min(indices), max(indices) + 1)
        if len(indices) >= FEWEST and found.count <= spread * len(indices):
            return found
    return None
