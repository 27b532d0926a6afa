"""Derivatives of outputs, made on the program once that is lowered.

{f} and the generalized forces of inverse dynamics are differentiated as they are computed. Of {ydot}, where
[A]{ydot} = {f} + {tau}, the derivative by anything but {tau} is that of inverse dynamics at this {ydot}, held
fast, with its sign changed and [A]^-1 in front (Carpentier and Mansard 2018, section III); by {tau} it is
[A]^-1. So the solution is not differentiated, and its derivatives are those of the exact one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from kanegen.model.system import System
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.constants import Constants
from kanegen.program.elimination import Column, Elimination
from kanegen.program.ir import Op, Output, Program
from kanegen.program.tangent import Tangent, tangents
from kanegen.recursion.factorisation import carriers
from kanegen.recursion.outputs.derivatives import DERIVATIVES, FORWARD, array, columns_of


def differentiated(
    program: Program,
    system: System,
    outputs: Mapping[str, Output],
    names: Sequence[str],
    constants: Constants,
) -> Program:
    """The program with the outputs `names`, of which some are derivatives.

    Args:
        program: It has all that they need.
        system: The tree.
        outputs: Of the program, by name.
        names: What is wanted, in order.
        constants: How exact numbers are.
    """
    if not DERIVATIVES.keys() & set(names):
        return program
    making = _Making(program, system, outputs, constants)
    return check(making.builder.program([making.output(name) for name in names]))


class _Making:
    """A builder that holds the program, to which derivatives are added."""

    def __init__(
        self, program: Program, system: System, outputs: Mapping[str, Output], constants: Constants
    ) -> None:
        self.builder = Builder(program.inputs)
        self._program, self._system, self._outputs, self._constants = program, system, outputs, constants
        self._moved: dict[int, int] = {}
        for i, instruction in enumerate(program.instructions):
            operands = [self._moved[j] for j in instruction.operands]
            self._moved[i] = self.builder.copy(instruction, operands)
        self._zero = self.builder.constant(constants.number(0, 1))
        self._one = self.builder.constant(constants.number(1, 1))

    def output(self, name: str) -> Output:
        """An output of the program, or a derivative."""
        if name not in DERIVATIVES:
            return self._outputs[name].renumbered(self._moved)
        if name == FORWARD:
            solution = self._outputs["forward_dynamics"].renumbered(self._moved)
            return Output(array(self._system, name), tuple(self._forward(name)), solution.positive)
        (base,) = DERIVATIVES[name].needs
        rows = self._rows(self._outputs[base], self._moved, name)
        return Output(array(self._system, name), tuple(self._filled(rows, name)))

    def _rows(self, output: Output, moved: Mapping[int, int], name: str) -> list[Tangent]:
        """Derivatives of the elements of an output, by column."""
        found = tangents(
            self.builder,
            self._program,
            moved,
            dict(self._directions(name)),
            output.values,
            self._constants,
        )
        return [found[value] for value in output.values]

    def _directions(self, name: str) -> Iterator[tuple[int, int]]:
        """Of the inputs by which is differentiated, the column of each."""
        by = columns_of(self._system, name)
        for i, instruction in enumerate(self._program.instructions):
            if instruction.op is Op.INPUT and instruction.array in by:
                yield i, by[instruction.array].start + instruction.index

    def _filled(self, rows: Sequence[Tangent], name: str) -> Iterator[int]:
        width = array(self._system, name).row
        for row in rows:
            yield from (row.get(column, self._zero) for column in range(width))

    def _forward(self, name: str) -> Iterator[int]:
        """Derivatives of {ydot}, row by row."""
        n = len(self._system.freedoms)
        needs = self._rows(self._outputs["inverse_dynamics"], self._at_solution(), name)
        elimination = self._elimination()
        by = columns_of(self._system, name)
        solved: list[Column] = []
        for column in range(array(self._system, name).row):
            if by["tau"].start <= column < by["tau"].stop:
                solved.append(elimination.solve({column - by["tau"].start: self._one}))
            else:
                right = {row: need[column] for row, need in enumerate(needs) if column in need}
                found = elimination.solve(right)
                solved.append({row: self.builder.negate(value) for row, value in found.items()})
        rows = [{c: values[row] for c, values in enumerate(solved) if row in values} for row in range(n)]
        return self._filled(rows, name)

    def _at_solution(self) -> dict[int, int]:
        """Where the values of the program stand that {ydot} leads to, if it is the solution."""
        solution = [self._moved[value] for value in self._outputs["forward_dynamics"].values]
        moved: dict[int, int] = {}
        for i, instruction in enumerate(self._program.instructions):
            if instruction.op is Op.INPUT and instruction.array == "ydot":
                moved[i] = solution[instruction.index]
            elif all(moved[j] == self._moved[j] for j in instruction.operands):
                moved[i] = self._moved[i]
            else:
                bare = self.builder.copy(
                    replace(instruction, name="", note=""), [moved[j] for j in instruction.operands]
                )
                moved[i] = self.builder.name(bare, f"{instruction.name}_s" if instruction.name else "")
        return moved

    def _elimination(self) -> Elimination:
        n, values = len(self._system.freedoms), self._outputs["mass_matrix"].values
        matrix = {
            (i, j): self._moved[values[n * i + j]]
            for i in range(n)
            for j in range(i + 1)
            if not self._is_zero(values[n * i + j])
        }
        return Elimination(self.builder, matrix, carriers(self._system), self._one)

    def _is_zero(self, value: int) -> bool:
        instruction = self._program.instructions[value]
        return instruction.op is Op.CONSTANT and instruction.number == 0
