"""The statements of a function body, printed from a program.

Named inputs are loaded first, those of long arrays where they are first used. Every other value is computed
at the place of its instruction: a named value, or a value used more than once, into a const local; a value
used once, inside the expression that uses it. An output is stored as soon as its value is known, so that few
values are live at a time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from kanegen.c import usage
from kanegen.c.dialect import ELEMENTARY, SCALAR, Dialect
from kanegen.c.expression import Expression, Level, apply, literal
from kanegen.c.layout import BREAK, WIDTH, comment, wrap
from kanegen.c.vector_sincos import NAMES, VectorSincos, vector_sincos
from kanegen.program.ir import PREPARED, WORKSPACE, Array, Instruction, Op, Program
from kanegen.program.precision import Precision

NEAR = (WORKSPACE, PREPARED)
"""Arrays of many elements, which are read where they are used: compilers load what is read early, and leave
it in memory once more until it is used."""

MOST_IN_LANES = 24
"""Most angles of which a batch computes sines and cosines at once; with more, reaching them takes longer than
the single call saves."""

LONGEST = 16
"""Most operations in one expression; longer expressions are cut by numbered locals."""


@dataclass(frozen=True)
class Body:
    """The body of a function.

    Attributes:
        lines: Lines between its braces, without the statement that returns a status.
        locals: Names of the locals that hold values.
        status: Expression of the status, "" where nothing is tested.
    """

    lines: list[str]
    locals: frozenset[str]
    status: str


def statements(program: Program, dialect: Dialect = SCALAR, shared: Collection[str] = ()) -> list[str]:
    """Return the lines of `body`."""
    return body(program, dialect, shared).lines


def body(program: Program, dialect: Dialect = SCALAR, shared: Collection[str] = ()) -> Body:
    """Return the body of a function that evaluates `program`.

    Args:
        program: The program to print.
        dialect: Notation of the statements.
        shared: Names of inputs that all states have in common.
    """
    printer = _Printer(program, dialect, shared)
    return Body(printer.lines(), frozenset(printer.locals), printer.status)


def sines_at_once(program: Program, dialect: Dialect, shared: Collection[str]) -> VectorSincos | None:
    """Return the sines and cosines that one call computes first, None without such a call.

    Args:
        program: The program to print.
        dialect: Notation of the statements.
        shared: Names of inputs that all states have in common; a batch takes their sines by themselves.
    """
    if not dialect.vector_sincos:
        return None
    found = vector_sincos(program, dialect.spread, () if dialect.is_scalar else shared)
    return None if found and not dialect.is_scalar and found.count > MOST_IN_LANES else found


class _Printer:
    """The statements so far, and for every value the expression by which later statements refer to it."""

    def __init__(self, program: Program, dialect: Dialect, shared: Collection[str]) -> None:
        self._program = program
        self._dialect = dialect
        self._instructions = program.instructions
        self._live = usage.live(program)
        self._uses = Counter(j for i in self._live for j in program.instructions[i].operands)
        self._sincos = sines_at_once(program, dialect, shared)
        self._only_sincos = self._sincos.only(program) if self._sincos else frozenset()
        self._zeros = usage.zero_runs(program)
        self._places = usage.places(program, self._zeros, dialect.places)
        self._conditions = usage.conditions(program)
        self._margins = usage.margins(program)
        self._uniform = usage.uniform(program, shared)
        partners = usage.partners(program) if dialect.has_sincos else {}
        self._partners = {i: j for i, j in partners.items() if not self._vector_element(i)}
        self._arrays = {array.name: array for array in program.inputs}
        reserved = dialect.reserved | {array.name for array in usage.arrays(program)}
        self._names = usage.names(program, reserved)
        self._taken = set(self._names.values()) | reserved
        self._numbered = 0
        self._expressions: dict[int, Expression] = {}
        self._lines: list[str] = []
        self.locals: set[str] = set()
        self._last_note = ""

    @property
    def status(self) -> str:
        """Expression of the status after the last statement, "" where nothing is tested."""
        return self._dialect.tested(bool(self._margins)) if self._may_fail else ""

    @property
    def _may_fail(self) -> list[Array]:
        return [output.array for output in self._program.outputs if output.exists_if_positive]

    def lines(self) -> list[str]:
        self._mark_unused_inputs()
        if self._may_fail:
            self._lines += self._dialect.opening(bool(self._margins))
        for run in self._zeros:
            self._lines.append(f"    {run.loop(self._dialect.number_in(run.array.name, 0.0))}")
        if self._sincos:
            self._lines += self._sincos.lines(self._dialect.number, self._dialect.vector_sincos)
        for i in self._live:
            if self._is_read_first(i):
                self._define(i)
                self._test(i)
        next_ = 0
        for i in self._live:
            self._lines += self._dialect.before(next_, i)
            next_ = i + 1
            if i not in self._expressions:
                self._define(i)
            if not self._is_read_first(i):
                self._test(i)
            self._store(i)
        self._lines += self._dialect.before(next_, len(self._instructions))
        if self._may_fail:
            self._lines += self._dialect.closing(self._may_fail, bool(self._margins))
        return self._lines

    def _is_read_first(self, i: int) -> bool:
        """Return whether value i is read before all others: a named input, of long arrays one that is tested.

        A constant that is not positive spoils all that is divided by it. Its test comes before those of other
        values, so that the status names the freedom where this begins.
        """
        array = self._instructions[i].array
        is_tested = array == PREPARED and i in self._conditions
        return i in self._names and (array not in ("", *NEAR) or is_tested)

    def _mark_unused_inputs(self) -> None:
        read = {self._instructions[i].array for i in self._live}
        self._lines += [f"    {self._dialect.ignored(name)}" for name in self._arrays if name not in read]

    def _define(self, i: int) -> None:
        """Compute value i into a local, or keep its expression for the one place that needs it."""
        self._note(self._instructions[i].note)
        if i in self._partners and i not in self._uniform:
            self._define_sincos(i, self._partners[i])
            return
        expression = self._expression(i, self._instructions[i])
        needs = self._uses[i] + (i in self._places) + (i in self._conditions)
        if i in self._names and i not in self._only_sincos:
            expression = self._local(i, self._names[i], expression)
        elif needs > 1 and expression.operations:
            expression = self._local(i, self._next_name(), expression)
        self._expressions[i] = expression

    def _define_sincos(self, i: int, j: int) -> None:
        """Compute sine and cosine of an angle, values i and j, in one call."""
        local = {self._instructions[k].op: self._names.get(k) or self._next_name() for k in (i, j)}
        (angle,) = self._operands(self._instructions[i].operands)
        number = self._dialect.number
        if angle.level is not Level.ATOM or angle.negative or not angle.text.isidentifier():
            angle = self._local(self._instructions[i].operands[0], self._next_name(), angle)
        self.locals.update(local.values())
        self._lines += wrap(f"{number} {local[Op.SIN]}, {local[Op.COS]};")
        self._lines += wrap(self._dialect.sincos(str(angle), local[Op.SIN], local[Op.COS]))
        for k in (i, j):
            self._expressions[k] = Expression(local[self._instructions[k].op])

    def _expression(self, i: int, instruction: Instruction) -> Expression:
        if instruction.op is Op.CONSTANT:
            return literal(instruction.number, self._dialect.arithmetic)
        if instruction.op is Op.INPUT:
            element = self._dialect.element(self._arrays[instruction.array], instruction.index)
            return self._dialect.read(instruction.array, element)
        if place := self._vector_element(i):
            return Expression(place)
        function = self._dialect.function(instruction.op, i in self._uniform)
        operands = self._operands(instruction.operands)
        if instruction.op in ELEMENTARY and i not in self._uniform:
            operands = tuple(map(self._result, instruction.operands))
        return apply(instruction.op, operands, function, self._dialect.notation)

    def _vector_element(self, i: int) -> str | None:
        """Return the place of value i in the arrays of sines and cosines, None if it is not there."""
        instruction = self._instructions[i]
        if self._sincos is None or instruction.op not in NAMES:
            return None
        angle = self._instructions[instruction.operands[0]]
        return self._sincos.element(instruction.op, angle.array, angle.index)

    def _operands(self, values: Sequence[int]) -> tuple[Expression, ...]:
        """Return the expressions of `values`, cut so that one more operation stays within `LONGEST`."""
        while sum(self._expressions[j].operations for j in values) >= LONGEST:
            longest = max(values, key=lambda j: self._expressions[j].operations)
            self._expressions[longest] = self._local(longest, self._next_name(), self._expressions[longest])
        return tuple(self._expressions[j] for j in values)

    def _local(self, i: int, name: str, expression: Expression) -> Expression:
        """Define a local of this name for value i."""
        number = self._dialect.common if i in self._uniform else self._dialect.number
        self.locals.add(name)
        self._lines += wrap(self._dialect.local(number, name, self._dialect.notation.text(expression)))
        return Expression(name)

    def _next_name(self) -> str:
        self._numbered += 1
        while f"t{self._numbered}" in self._taken:
            self._numbered += 1
        return f"t{self._numbered}"

    def _note(self, note: str) -> None:
        """Add a comment where a group of instructions with the same note begins."""
        if note and note != self._last_note:
            self._lines += ["", *comment(note)] if self._lines else comment(note)
            self._last_note = note

    def _result(self, i: int) -> Expression:
        """Return value i as an expression of the type of values that differ between states."""
        expression = self._expressions[i]
        if i not in self._uniform:
            return expression
        if self._dialect.is_scalar:
            return expression
        return Expression(self._dialect.everywhere(str(expression)))

    def _test(self, i: int) -> None:
        """Test value i if results exist, or are accurate, only where it is positive."""
        if i in self._conditions:
            text = self._dialect.notation.text(self._result(i))
            self._lines += wrap(self._dialect.condition(text, self._conditions[i]))
        if i in self._margins:
            if self._expressions[i].level is not Level.ATOM or self._expressions[i].negative:
                self._expressions[i] = self._local(i, self._next_name(), self._expressions[i])
            self._lines += wrap(self._dialect.margin(self._result(i), self._margins[i]))

    def _store(self, i: int) -> None:
        """Store value i in the outputs that hold it, several on a line: `A[1] = A[3] = value;`."""
        groups: dict[Precision, list[tuple[str, str]]] = {}
        for place in self._places.get(i, ()):
            groups.setdefault(self._dialect.formats.of(place[0]), []).append(place)
        for group in groups.values():
            (array, _), *_ = group
            self._fill([element for _, element in group], self._stored(i, array))

    def _stored(self, i: int, array: str) -> Expression:
        """Return value i as the output array of this name holds it."""
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
