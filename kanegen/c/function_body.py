"""From a program to the statements of a C function.

Named inputs are loaded first. Every other value is computed where its instruction stands: a named one, or
one used more than once, into a const local; one used once inside the expression that uses it. An output is
stored as soon as its value is known, so that few values have to be kept.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence

from kanegen.c import usage
from kanegen.c.dialect import SCALAR, Dialect
from kanegen.c.expression import Expression, Level, apply, literal
from kanegen.c.layout import BREAK, WIDTH, comment, wrap
from kanegen.c.vector_sincos import NAMES, waves
from kanegen.program.ir import WORKSPACE, Instruction, Op, Program
from kanegen.program.precision import Precision

LONGEST = 16
"""Operations in one C expression; longer ones are cut by numbered locals."""


def statements(program: Program, dialect: Dialect = SCALAR, shared: Collection[str] = ()) -> list[str]:
    """The lines of a C function that evaluates `program`, without its braces.

    Args:
        program: What to compute.
        dialect: For one state or for several at once.
        shared: Inputs that all states have in common.
    """
    return _Body(program, dialect, shared).lines()


class _Body:
    """The statements so far, and for every value how later ones refer to it."""

    def __init__(self, program: Program, dialect: Dialect, shared: Collection[str]) -> None:
        self._program = program
        self._dialect = dialect
        self._instructions = program.instructions
        self._live = usage.live(program)
        self._uses = Counter(j for i in self._live for j in program.instructions[i].operands)
        self._waves = waves(program) if dialect.has_waves else None
        self._only_waves = self._waves.only(program) if self._waves else frozenset()
        self._zeros = usage.zero_runs(program)
        self._places = usage.places(program, self._zeros)
        self._conditions = usage.conditions(program)
        self._margins = usage.margins(program)
        self._uniform = usage.uniform(program, shared)
        partners = usage.partners(program) if dialect.has_pairs else {}
        self._partners = {i: j for i, j in partners.items() if not self._wave(i)}
        self._arrays = {array.name: array for array in program.inputs}
        reserved = dialect.reserved | {array.name for array in usage.arrays(program)}
        self._names = usage.names(program, reserved)
        self._taken = set(self._names.values()) | reserved
        self._numbered = 0
        self._expressions: dict[int, Expression] = {}
        self._lines: list[str] = []
        self._last_note = ""

    def lines(self) -> list[str]:
        self._mark_unused_inputs()
        spoilt = [output.array for output in self._program.outputs if output.exists_if_positive]
        if spoilt:
            self._lines += self._dialect.opening(bool(self._margins))
        for run in self._zeros:
            self._lines.append(f"    {run.loop(self._dialect.number_in(run.array.name, 0.0))}")
        if self._waves:
            self._lines += self._waves.lines(self._dialect.number)
        # Inputs come first, but for the workspace, which is as near as a local.
        for i in self._live:
            if i in self._names and self._instructions[i].array not in ("", WORKSPACE):
                self._define(i)
        for i in self._live:
            if i not in self._expressions:
                self._define(i)
            self._watch(i)
            self._store(i)
        if spoilt:
            self._lines += self._dialect.closing(spoilt, bool(self._margins))
        return self._lines

    def _mark_unused_inputs(self) -> None:
        read = {self._instructions[i].array for i in self._live}
        self._lines += [f"    (void){name};" for name in self._arrays if name not in read]

    def _define(self, i: int) -> None:
        """Compute value i into a local, or keep its expression for the only place that needs it."""
        self._note(self._instructions[i].note)
        if i in self._partners and i not in self._uniform:
            self._define_pair(i, self._partners[i])
            return
        expression = self._expression(i, self._instructions[i])
        needs = self._uses[i] + (i in self._places) + (i in self._conditions)
        if i in self._names and i not in self._only_waves:
            expression = self._local(i, self._names[i], expression)
        elif needs > 1 and expression.operations:
            expression = self._local(i, self._next_name(), expression)
        self._expressions[i] = expression

    def _define_pair(self, i: int, j: int) -> None:
        """Sine and cosine of an angle in one call."""
        wave = {self._instructions[k].op: self._names.get(k) or self._next_name() for k in (i, j)}
        (angle,) = self._operands(self._instructions[i].operands)
        number = self._dialect.number
        if angle.level is not Level.ATOM or angle.negative or not angle.text.isidentifier():
            angle = self._local(self._instructions[i].operands[0], self._next_name(), angle)
        self._lines += wrap(f"{number} {wave[Op.SIN]}, {wave[Op.COS]};")
        self._lines += wrap(self._dialect.pair(str(angle), wave[Op.SIN], wave[Op.COS]))
        for k in (i, j):
            self._expressions[k] = Expression(wave[self._instructions[k].op])

    def _expression(self, i: int, instruction: Instruction) -> Expression:
        if instruction.op is Op.CONSTANT:
            return literal(instruction.number, self._dialect.arithmetic)
        if instruction.op is Op.INPUT:
            element = usage.element(self._arrays[instruction.array], instruction.index)
            return self._dialect.read(instruction.array, element)
        wave = self._wave(i)
        if wave:
            return Expression(wave)
        function = self._dialect.function(instruction.op, i in self._uniform)
        operands = self._operands(instruction.operands)
        return apply(instruction.op, operands, function, self._dialect.notation)

    def _wave(self, i: int) -> str | None:
        """Value i in the arrays of sines and cosines, if it is there."""
        instruction = self._instructions[i]
        if self._waves is None or instruction.op not in NAMES:
            return None
        angle = self._instructions[instruction.operands[0]]
        return self._waves.element(instruction.op, angle.array, angle.index)

    def _operands(self, values: Sequence[int]) -> tuple[Expression, ...]:
        """Their expressions, cut so that one more operation keeps within `LONGEST`."""
        while sum(self._expressions[j].operations for j in values) >= LONGEST:
            longest = max(values, key=lambda j: self._expressions[j].operations)
            self._expressions[longest] = self._local(longest, self._next_name(), self._expressions[longest])
        return tuple(self._expressions[j] for j in values)

    def _local(self, i: int, name: str, expression: Expression) -> Expression:
        """Value i as a local of this name."""
        number = self._dialect.common if i in self._uniform else self._dialect.number
        self._lines += wrap(f"const {number} {name} = {self._dialect.notation.text(expression)};")
        return Expression(name)

    def _next_name(self) -> str:
        self._numbered += 1
        while f"t{self._numbered}" in self._taken:
            self._numbered += 1
        return f"t{self._numbered}"

    def _note(self, note: str) -> None:
        """A comment line where a group of instructions with the same note begins."""
        if note and note != self._last_note:
            self._lines += ["", *comment(note)] if self._lines else comment(note)
            self._last_note = note

    def _result(self, i: int) -> Expression:
        """Value i as an expression that differs between states, if only by its type."""
        expression = self._expressions[i]
        if i not in self._uniform:
            return expression
        if self._dialect.is_scalar:
            return expression
        return Expression(self._dialect.everywhere(str(expression)))

    def _watch(self, i: int) -> None:
        """Notice where value i must be positive and is not."""
        if i in self._conditions:
            text = self._dialect.notation.text(self._result(i))
            self._lines += wrap(self._dialect.condition(text, self._conditions[i]))
        if i in self._margins:
            if self._expressions[i].level is not Level.ATOM or self._expressions[i].negative:
                self._expressions[i] = self._local(i, self._next_name(), self._expressions[i])
            self._lines += wrap(self._dialect.margin(self._result(i), self._margins[i]))

    def _store(self, i: int) -> None:
        """Fill the outputs that hold value i, several on a line: `A[1] = A[3] = value;`."""
        groups: dict[Precision, list[tuple[str, str]]] = {}
        for place in self._places.get(i, ()):
            groups.setdefault(self._dialect.formats.of(place[0]), []).append(place)
        for group in groups.values():
            (array, _), *_ = group
            self._fill([element for _, element in group], self._stored(i, array))

    def _stored(self, i: int, array: str) -> Expression:
        """Value i as an output array holds it."""
        instruction = self._instructions[i]
        if instruction.op is Op.CONSTANT:
            return Expression(self._dialect.number_in(array, instruction.number))
        return self._dialect.written(array, self._result(i))

    def _fill(self, places: Sequence[str], expression: Expression) -> None:
        chain: list[str] = []
        for place in places:
            width = len(f"    {' = '.join([*chain, place])} = {expression};")
            if chain and width > WIDTH and expression.level is Level.ATOM:
                self._lines += wrap(_assignment(chain, expression))
                chain = []
            chain.append(place)
        self._lines += wrap(_assignment(chain, expression))


def _assignment(chain: Sequence[str], expression: Expression) -> str:
    return "".join(f"{target} ={BREAK}" for target in chain) + f"{expression};"
