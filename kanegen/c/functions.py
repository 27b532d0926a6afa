"""The functions of a model as lines of text: documentation, prototypes and bodies, ready for the templates.

A compiler needs more than twice the time for twice the statements, so a long function consists of parts,
separate functions that it calls one after the other. Parts leave values for later parts in a workspace array
of the caller.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from kanegen.c import usage
from kanegen.c.columns import printed_columns
from kanegen.c.declarations import (
    argument_list,
    batch_notes,
    batch_prototype,
    not_finite,
    prototype,
    row_call,
    simd_call,
    simd_failures,
    simd_prototype,
)
from kanegen.c.dialect import ELEMENTARY, Dialect, simd
from kanegen.c.function_body import body, sines_at_once
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import BREAK, wrap
from kanegen.c.pieces import Part
from kanegen.c.simd import SIMD
from kanegen.c.target import BatchFunction, RenderInput, Target
from kanegen.program.ir import Array, Op, Program
from kanegen.program.precision import DOUBLE_DOUBLE, Precision

LONGEST_JOINED = 8000
"""Instructions of a function in SIMD lanes up to which a compiler joins its parts where there are 32 vector
registers, which hold more of the values between the parts; longer ones gain nothing and compile too long."""


@dataclass(frozen=True)
class Code:
    """The body of a function.

    Attributes:
        body: Lines between its braces.
        parts: Lines of prototype and body of each function that it calls in turn; those that solve for
            columns in loops come last.
        vector_sincos: Most angles whose sines and cosines one part computes by one call.
        has_sines: Whether it calls functions of kanegen_sincos.h.
        locals: Names of the locals that hold values, in all parts.
        part_locals: Number of numbers that the locals of each part hold.
        has_columns_in_lanes: Whether it solves for columns in SIMD lanes.
        takes_sines: Whether it computes a sine or a cosine by any function.
        elementary: Precision of the functions of a header `kanegen_elementary` that it calls, None without.
        before: Text of static functions that it calls, which stand before it.
    """

    body: list[str]
    parts: tuple[Part, ...] = ()
    vector_sincos: int = 0
    has_sines: bool = False
    locals: frozenset[str] = frozenset()
    takes_sines: bool = False
    elementary: Precision | None = None
    before: str = ""
    part_locals: tuple[int, ...] = ()
    has_columns_in_lanes: bool = False


@dataclass(frozen=True)
class Tile:
    """The vectors that the SIMD form of a function fills for one output, and how they become rows.

    Attributes:
        array: The output.
        size: Number of vectors.
        places: Lines of a table with the vector of each element, [] where each element has its own.
    """

    array: Array
    size: int
    places: list[str]


@dataclass(frozen=True)
class PrintedFunction:
    """One function of a model, its batch form and its SIMD form, as lines of C.

    Attributes:
        name: Name with the prefix of the model.
        signature: Arguments and conditions.
        arguments: Documentation of the arguments.
        prototype: Prototype of the form for one state.
        code: Body of the form for one state.
        batch_prototype: Prototype of the batch form.
        batch_notes: Documentation of the differences of the batch form.
        simd_prototype: Prototype of the SIMD form, which the batch form calls.
        simd_code: Body of the SIMD form; empty without one.
        simd_call: Call of the SIMD form.
        simd_failures: Statement that counts the states of a SIMD vector whose status is not 0.
        row_call: Call of the form for one state, in a batch without SIMD.
        has_simd: Whether there is a SIMD form.
        tiles: For every output, the vectors that the SIMD form fills.
    """

    name: str
    signature: Function
    arguments: list[str]
    prototype: list[str]
    code: Code
    batch_prototype: list[str]
    batch_notes: list[str]
    simd_prototype: list[str]
    simd_code: Code
    simd_call: list[str]
    simd_failures: list[str]
    row_call: list[str]
    has_simd: bool
    tiles: list[Tile]


def printed_functions(render_input: RenderInput, target: Target) -> list[PrintedFunction]:
    """Return every function of outputs in C, its form for one state in the dialect of `target`."""
    found = []
    for function, parts in render_input.programs.items():
        name = f"{render_input.model.name}_{function.name}"
        formats = render_input.formats
        # `prepare` computes at least in double; its results are never rounded to the precision of storage.
        is_uniform = function.name != PREPARE or formats.every == (formats.preparing,)
        batch = render_input.batch_programs[function.name]
        has_simd = render_input.batches and batch.fits_simd and formats.arithmetic in SIMD and is_uniform
        one = scalar_code(render_input, target, function, parts)
        several = _simd_code(render_input, name, batch) if has_simd else None
        found.append(printed_function(render_input, function, one, several, batch if has_simd else None))
    return found


def printed_function(
    render_input: RenderInput,
    function: Function,
    one: Code,
    several: Code | None,
    batch: BatchFunction | None = None,
) -> PrintedFunction:
    """Return a function with its documentation and its batch form.

    Args:
        render_input: Model and precisions.
        function: Arrays and status of the function.
        one: Body of the form for one state.
        several: Body of the SIMD form, None where there is none.
        batch: The function as SIMD lanes compute it, if its matrices differ.
    """
    model, formats = render_input.model.name, render_input.formats
    return PrintedFunction(
        name=f"{model}_{function.name}",
        signature=function,
        arguments=argument_list(function, render_input.model),
        prototype=prototype(model, function, formats),
        code=one,
        batch_prototype=batch_prototype(model, function, formats),
        batch_notes=batch_notes(function),
        simd_prototype=simd_prototype(model, function, formats),
        simd_code=several or Code([]),
        simd_call=simd_call(model, function),
        simd_failures=simd_failures(function),
        row_call=row_call(model, function),
        has_simd=several is not None,
        tiles=_tiles(function, batch),
    )


def scalar_code(
    render_input: RenderInput, target: Target, function: Function, parts: Sequence[Program]
) -> Code:
    """Return the body of the form for one state, or of `prepare`."""
    flushes = render_input.variant.flushes and function.name != PREPARE
    dialect = target.dialect(render_input, function)
    name = f"{render_input.model.name}_{function.name}"
    return code(name, function, parts, dialect, not_finite(render_input.model), flushes)


def _tiles(function: Function, batch: BatchFunction | None) -> list[Tile]:
    """Return the vectors of every output of a function.

    Args:
        function: The function.
        batch: The function as SIMD lanes compute it, None where its outputs are the same.
    """
    sizes = {array.name: array.size for array in (batch.function.outputs if batch else function.outputs)}
    places = batch.places if batch else {}
    return [Tile(array, sizes[array.name], _table(places.get(array.name, ()))) for array in function.outputs]


def _table(numbers: Sequence[int]) -> list[str]:
    """Return the lines of numbers between the braces of a table."""
    return wrap(f",{BREAK}".join(map(str, numbers)), indent=" " * 8) if numbers else []


def _simd_code(render_input: RenderInput, name: str, batch: BatchFunction) -> Code:
    """Return the body of the SIMD form."""
    in_pieces, flushes = render_input.pieces > 0, render_input.variant.flushes
    length = sum(len(part.instructions) for part in batch.parts)
    dialect = simd(
        render_input.formats.arithmetic,
        render_input.sincos is not None,
        render_input.places,
        in_pieces,
        joins_parts=length <= LONGEST_JOINED and not in_pieces and not flushes,
    )
    return code(f"{name}_simd", batch.function, batch.parts, dialect, flushes=flushes)


def code(
    name: str,
    function: Function,
    programs: Sequence[Program],
    dialect: Dialect,
    infinite: str = "",
    flushes: bool = False,
) -> Code:
    """Return the body of a function.

    Args:
        name: Name of the function, prefix of the names of its parts.
        function: Arrays and status of the function.
        programs: The program of the function, or several parts in order.
        dialect: Notation of the statements.
        infinite: Name of the status of a result that is not finite; unused in SIMD, where the caller tests.
        flushes: Whether subnormal numbers count as zero in the function. All arithmetic is then in parts, so
            that a compiler cannot move it across the changes of mode.
    """
    found = [sines_at_once(part, dialect, function.shared) for part in programs]
    takes_sines = any(map(usage.has_sines, programs))
    has_sines = dialect.kanegen_sincos and takes_sines
    most = max((sincos.count for sincos in found if sincos), default=0)
    bodies = [body(program, dialect, function.shared) for program in programs]
    names = frozenset(name for one in bodies for name in one.locals)
    held = tuple(
        len(one.locals) + (2 * vector.count if vector else 0)
        for one, vector in zip(bodies, found, strict=True)
    )
    called = (*ELEMENTARY, Op.ABS) if dialect.arithmetic is DOUBLE_DOUBLE else ELEMENTARY
    elementary = any(usage.has_operations(part, called) for part in programs)
    precision = dialect.arithmetic if elementary else None
    status = bodies[-1].status
    if len(programs) == 1 and not flushes and not function.loops:
        lines = [*bodies[0].lines, *ending(function, programs, dialect, status, infinite)]
        return Code(lines, (), most, has_sines, names, takes_sines, precision, part_locals=held)
    calls = _beginning(function, programs, dialect, flushes)
    parts = []
    for number, (program, one) in enumerate(zip(programs, bodies, strict=True), start=1):
        part = _Part(f"{name}_{number}", program, dialect, function.shared)
        parts.append((part.prototype, [*one.lines, *_returned(one.status)]))
        calls += part.call()
    for number, loops in enumerate(function.loops, start=1):
        for columns in printed_columns(f"{name}_columns_{number}", loops, dialect):
            parts.append((columns.prototype, columns.body))
            held = (*held, columns.numbers)
            calls += _where_possible(columns.call, status if dialect.is_scalar else "")
    if flushes:
        calls.append("    restore_mode(before);")
    calls += ending(function, programs, dialect, status and "status", infinite)
    return Code(
        calls,
        tuple(parts),
        most,
        has_sines,
        names,
        takes_sines,
        precision,
        part_locals=held,
        has_columns_in_lanes=bool(function.loops) and dialect.has_columns_in_lanes,
    )


def _where_possible(call: Sequence[str], status: str) -> list[str]:
    """Return the lines of a call that is left out where a result does not exist, and is NaN already."""
    if not status:
        return list(call)
    return ["    if (status <= 0) {", *(f"    {line}" for line in call), "    }"]


def _beginning(function: Function, programs: Sequence[Program], dialect: Dialect, flushes: bool) -> list[str]:
    """Return the lines before the calls of the parts."""
    read = {array.name for part in programs for array in part.inputs}
    lines = [f"    {dialect.ignored(array.name)}" for array in function.inputs if array.name not in read]
    if function.workspace:
        lines += dialect.workspace(function.workspace)
    if flushes:
        lines.append("    const arithmetic_mode before = flush_to_zero();")
    return lines


def _returned(status: str) -> list[str]:
    """Return the statement that returns a status; nothing where there is none."""
    return [f"    return {status};"] if status else []


def ending(
    function: Function, programs: Sequence[Program], dialect: Dialect, status: str, infinite: str
) -> list[str]:
    """Return the lines that return the status of a function.

    Args:
        function: The function, all of whose outputs are filled.
        programs: The parts of the function.
        dialect: Notation of the statements.
        status: Expression of what the tests of conditions gave, "" where there are none.
        infinite: Name of the status of a result that is not finite.
    """
    if not dialect.is_scalar:
        return _returned(status)
    runs = [
        run for array in function.outputs for run in usage.variable_runs(programs, array, function.looped)
    ]
    if not runs:
        return _returned(status or "0")
    finite = f" &&{BREAK}".join(map(dialect.all_finite, runs))
    if not status:
        return wrap(f"return {finite} ? 0 : {infinite};")
    lines = [] if status.isidentifier() else [f"    const int status = {status};"]
    status = status if status.isidentifier() else "status"
    finite = f"({finite})" if len(runs) > 1 else finite
    return [*lines, *wrap(f"return {status} > 0 ||{BREAK}{finite} ? {status} : {infinite};")]


@dataclass(frozen=True)
class _Part:
    """One part of a long function.

    Attributes:
        name: Name of the part.
        program: Program of the part.
        dialect: Notation of the statements.
        shared: Names of inputs that all states have in common.
    """

    name: str
    program: Program
    dialect: Dialect
    shared: Collection[str]

    @property
    def _may_fail(self) -> bool:
        return any(output.exists_if_positive for output in self.program.outputs)

    @property
    def _arguments(self) -> dict[str, str]:
        """Declarations of the arrays that the part reads or fills, by name."""
        # Results that do not exist become NaN where the lanes of a batch are stored as rows, not here.
        outputs = self.program.outputs
        filled = [output.array.name for output in outputs if output.values or self.dialect.is_scalar]
        read = [array.name for array in self.program.inputs if array.name not in filled]
        arguments = {name: self._declared(name, is_read=True) for name in read}
        arguments |= {name: self._declared(name, is_read=False) for name in filled}
        if any(output.accurate_if_positive for output in outputs) and not self.dialect.is_scalar:
            arguments["accurate"] = "simd_bits *accurate"
        return arguments

    def _declared(self, name: str, *, is_read: bool) -> str:
        return self.dialect.argument(name, name in self.shared, is_read)

    @property
    def prototype(self) -> list[str]:
        """The lines of the prototype."""
        arguments = self._arguments
        head = self.dialect.part(self.name, self._may_fail, [*arguments])
        return wrap(f"{head}({f',{BREAK}'.join(arguments.values())})", indent="", hanging="    ")

    def call(self) -> list[str]:
        """Return the lines of the call; the status of the last part is kept."""
        kept = f"const {self.dialect.status} status = " if self._may_fail else ""
        return wrap(f"{kept}{self.name}({f',{BREAK}'.join(self._arguments)});")
