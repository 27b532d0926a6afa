"""Sines and cosines of many coordinates at once.

Where a function needs those of many elements of one array, it computes them side by side before anything
else. One by one they cost as much as a good part of the equations; few of them are as fast that way.
"""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.c.usage import live
from kanegen.program.ir import WORKSPACE, Op, Program

FEWEST = 6
"""Angles from which it pays."""

FEW = 8
"""Angles up to which vectors of four answer sooner than wider ones."""

NAMES = {Op.SIN: "sines", Op.COS: "cosines"}
"""The arrays that hold them."""


@dataclass(frozen=True, slots=True)
class Waves:
    """Sine and cosine of the elements `start` to before `stop` of `array`."""

    array: str
    start: int
    stop: int

    def lines(self, number: str) -> list[str]:
        """Statements that compute them."""
        count = self.stop - self.start
        angles = f"{self.array} + {self.start}" if self.start else self.array
        sines, cosines = NAMES.values()
        return [
            f"    {number} {sines}[{count}], {cosines}[{count}];",
            f"    lanes_waves({count}, {angles}, {sines}, {cosines});",
        ]

    def element(self, op: Op, array: str, index: int) -> str | None:
        """The sine or cosine of an element, if it is among them."""
        if op not in NAMES or array != self.array or not self.start <= index < self.stop:
            return None
        return f"{NAMES[op]}[{index - self.start}]"

    def only(self, program: Program) -> frozenset[int]:
        """Elements of which nothing but their sine and cosine is used."""
        taken, other = set[int](), set(program.results())
        for i in live(program):
            instruction = program.instructions[i]
            angles = [program.instructions[j] for j in instruction.operands]
            is_wave = any(self.element(instruction.op, angle.array, angle.index) for angle in angles)
            (taken if is_wave else other).update(instruction.operands)
        return frozenset(taken - other)


def waves(program: Program) -> Waves | None:
    """What is worth computing at once, if anything."""
    angles: dict[str, set[int]] = {}
    for i in live(program):
        instruction = program.instructions[i]
        if instruction.op in NAMES:
            angle = program.instructions[instruction.operands[0]]
            if angle.op is Op.INPUT and angle.array != WORKSPACE:
                angles.setdefault(angle.array, set()).add(angle.index)
    for array, indices in angles.items():
        if len(indices) >= FEWEST:
            return Waves(array, min(indices), max(indices) + 1)
    return None
