"""What depends on what in an FMU: read off the programs, so exactly the elements that occur in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from kanegen.artifacts.fmi.layout import Layout
from kanegen.artifacts.fmi.variables import Variable
from kanegen.program.ir import PREPARED, Module, Op, Program

Masks = Mapping[str, Sequence[int]]
"""For each element of arrays the set of numbers on which it depends, as an integer with a bit for each."""


@dataclass(frozen=True)
class Structure:
    """Which numbers of an instance depend on which.

    Attributes:
        layout: The numbers of the instance.
        module: The programs of the C.
    """

    layout: Layout
    module: Module

    @cached_property
    def masks(self) -> tuple[int, ...]:
        """For each number of an instance those on which it depends, among those that are set from outside."""
        inputs = {name: [1 << place for place in block.places] for name, block in self.layout.inputs.items()}
        if self.module.prepare is not None:
            inputs[PREPARED] = dependencies(self.module.prepare, inputs)[PREPARED]
        found = [mask for name in self.layout.inputs for mask in inputs[name]]
        for name, block in self.layout.computed.items():
            program = self.module.functions.get(block.output)
            masks = inputs["y"] if program is None else dependencies(program, inputs)[name]
            if name == "acceleration":
                inputs["ydot"] = masks
            found += masks
        return tuple(found)

    def knowns(self, unknown: Variable, among: Iterable[Variable]) -> list[Variable]:
        """Return those of some variables on which a variable depends."""
        mask = 0
        for place in unknown.places:
            mask |= self.masks[place]
        return [known for known in among if any(mask >> place & 1 for place in known.places)]

    def read(self, name: str) -> list[str]:
        """Return the arrays set from outside on which some element of a computed array depends."""
        mask = 0
        for place in self.layout.computed[name].places:
            mask |= self.masks[place]
        return [
            array
            for array, block in self.layout.inputs.items()
            if any(mask >> place & 1 for place in block.places)
        ]


def dependencies(program: Program, inputs: Masks) -> dict[str, list[int]]:
    """Return for each element of the outputs of a program the union of those sets that its inputs have.

    Args:
        program: The program.
        inputs: The set of each element of the input arrays.
    """
    masks: list[int] = []
    for instruction in program.instructions:
        mask = inputs[instruction.array][instruction.index] if instruction.op is Op.INPUT else 0
        for operand in instruction.operands:
            mask |= masks[operand]
        masks.append(mask)
    found: dict[str, list[int]] = {}
    for output in program.outputs:
        elements = [0] * output.array.size
        for place, value in output.elements():
            elements[place] = masks[value]
        found[output.array.name] = elements
    return found
