"""The statements of a C function; those of a long one in functions of their own, which it calls in turn.

Compilers need more than twice the time for twice the statements, so a long function goes in pieces. What one
piece leaves for later ones is in an array of the caller.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from kanegen.c import usage
from kanegen.c.dialect import Dialect
from kanegen.c.function_body import statements
from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, wrap
from kanegen.c.vector_sincos import waves
from kanegen.program.ir import WORKSPACE, Program


@dataclass(frozen=True)
class Code:
    """What stands between the braces of a C function.

    Attributes:
        body: Its lines.
        pieces: The functions that it calls: the lines of the prototype and of the body of each.
        waves: How many angles it takes side by side, with a function of kanegen_lanes.h.
        has_sines: Whether it takes sines or cosines by functions of kanegen_sincos.h.
    """

    body: list[str]
    pieces: tuple[tuple[list[str], list[str]], ...] = ()
    waves: int = 0
    has_sines: bool = False


def code(
    name: str, function: Function, programs: Sequence[Program], dialect: Dialect, flushes: bool = False
) -> Code:
    """C that evaluates a function.

    Args:
        name: In C; its pieces are called after it.
        function: What it reads and fills.
        programs: What to compute, one after the other.
        dialect: For one state or for several at once.
        flushes: Whether subnormal numbers count as zero meanwhile. What they are in must then be a function
            apart, before and after which a compiler cannot move arithmetic.
    """
    found = [waves(piece) for piece in programs] if dialect.has_waves else []
    has_sines = dialect.own and any(map(usage.has_sines, programs))
    side_by_side = max((wave.stop - wave.start for wave in found if wave), default=0)
    if len(programs) == 1 and not flushes:
        return Code(statements(programs[0], dialect, function.shared), (), side_by_side, has_sines)
    pieces = []
    read = {array.name for piece in programs for array in piece.inputs}
    calls = [f"    (void){array.name};" for array in function.inputs if array.name not in read]
    if function.workspace:
        calls.append(f"    {dialect.number} {WORKSPACE}[{function.workspace}];")
    if flushes:
        calls.append("    const arithmetic_mode before = flush_to_zero();")
    for number, piece in enumerate(programs, start=1):
        is_spoilt = any(output.exists_if_positive for output in piece.outputs)
        is_judged = any(output.accurate_if_positive for output in piece.outputs) and not dialect.is_scalar
        own = f"{name}_{number}"
        head = f"static APART {dialect.status if is_spoilt else 'void'} {own}"
        arguments = _arguments(piece, dialect, function.shared)
        arguments |= {"accurate": "lanes_bits *accurate"} if is_judged else {}
        prototype = wrap(f"{head}({f',{BREAK}'.join(arguments.values())})", indent="", hanging="    ")
        pieces.append((prototype, statements(piece, dialect, function.shared)))
        kept = f"const {dialect.status} result = " if flushes else "return "
        calls += wrap(f"{kept if is_spoilt else ''}{own}({f',{BREAK}'.join(arguments)});")
    if flushes:
        calls.append("    put_back(before);")
        calls += ["    return result;"] if function.spoilt else []
    return Code(calls, tuple(pieces), side_by_side, has_sines)


def _arguments(piece: Program, dialect: Dialect, shared: Collection[str]) -> dict[str, str]:
    """By name how a piece declares what it reads and fills."""
    # Results that do not hold become NaN where the lanes of a batch come apart again, not here.
    filled = [output.array.name for output in piece.outputs if output.values or dialect.is_scalar]
    read = [array.name for array in piece.inputs if array.name not in filled]

    def declared(name: str) -> str:
        alone = dialect.is_scalar or name in shared
        return f"{dialect.formats.of(name).c_type if alone else dialect.number} *{name}"

    return {**{name: f"const {declared(name)}" for name in read}, **{name: declared(name) for name in filled}}
