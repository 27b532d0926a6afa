"""Functions whose states are each computed by a team, a thread of each of several warps of a block.

All threads of a warp compute the same part of 32 states, so that none waits for another branch of the code.
Each has the values of its part in its own registers; what another warp needs goes through the memory that a
block shares. It is the form of functions whose values do not fit in the registers of one thread, where the
work can be shared.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from kanegen.c.cuda.dialect import CudaDialect, template
from kanegen.c.declarations import not_finite
from kanegen.c.function_body import body
from kanegen.c.functions import ending
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import BREAK, wrap
from kanegen.c.target import RenderInput
from kanegen.program.ir import WORKSPACE, Array
from kanegen.program.precision import Precision
from kanegen.program.share import Shared, most_live, share

WARP = 32
"""Threads of a warp, and states of a block."""

WARPS = 2
"""Warps that compute a state together: more need many more barriers."""

REGISTER_BYTES = 4 * 370
"""Bytes of live values, counted in the order of the program, that a thread holds in its 255 registers of 4
bytes: the compiler orders statements so that about a third fewer are live."""

SHARED_MEMORY = 48 * 1024
"""Bytes that a block shares at most without asking for more."""

LONGEST = 3000
"""Most instructions of a worker: the compiler's time for one function grows faster than its length."""

GAIN = 0.7
"""Largest share of the work in the time of the busiest worker for which a team is worth its barriers."""


@dataclass(frozen=True)
class Worker:
    """The part of a function that one warp computes.

    Attributes:
        prototype: Lines of its prototype.
        body: Lines between its braces.
        call: Lines of its call in the kernel.
        locals: Names of the locals that hold values.
    """

    prototype: list[str]
    body: list[str]
    call: list[str]
    locals: frozenset[str]


@dataclass(frozen=True)
class Team:
    """A function that several warps compute together.

    Attributes:
        workers: What each warp computes; the last returns the status.
        type: Type of the numbers that warps leave for others.
        size: How many of these there are for a state.
        barriers: How often the warps wait for each other.
    """

    workers: tuple[Worker, ...]
    type: str
    size: int
    barriers: int


def team(render_input: RenderInput, function: Function, dialect: CudaDialect) -> Team | None:
    """Return the form of a function for teams; None where a thread holds a state, or sharing does not pay.

    Args:
        render_input: The programs and precisions.
        function: The function.
        dialect: Notation of its statements.
    """
    if function.name == PREPARE:
        return None
    program = render_input.selected.functions[function.name]
    if most_live(program) * dialect.arithmetic.bytes <= REGISTER_BYTES:
        return None
    found = share(program, WARPS)
    if not _pays(found, dialect.arithmetic):
        return None
    name = f"{render_input.model.name}_{function.name}"
    workers = [
        _worker(render_input, function, found, k, replace(dialect, barriers=found.barriers[k]), name)
        for k in range(WARPS)
    ]
    return Team(tuple(workers), dialect.arithmetic.c_type, found.workspace, len(found.barriers[0]))


def _pays(found: Shared, arithmetic: Precision) -> bool:
    """Return whether a team computes a program in less time, and its memory and code have room."""
    longest = max(len(program.instructions) for program in found.programs)
    fits = found.workspace * WARP * arithmetic.bytes <= SHARED_MEMORY and longest <= LONGEST
    return fits and found.time <= GAIN * found.work


def _worker(
    render_input: RenderInput, function: Function, found: Shared, k: int, dialect: CudaDialect, name: str
) -> Worker:
    """Return what warp `k` computes."""
    printed = body(found.programs[k], dialect, function.shared)
    lines, kind = printed.lines, "void"
    if k == len(found.programs) - 1:
        kind = "int"
        lines = [
            *lines,
            *ending(function, found.programs, dialect, printed.status, not_finite(render_input.model)),
        ]
    text = re.sub(r"/\*.*?\*/", "", "\n".join(lines), flags=re.DOTALL)
    arrays = {array.name: state(array) for array in (*function.inputs, *function.outputs)}
    arrays |= {WORKSPACE: WORKSPACE, **{name: name for name in function.shared}}
    used = [one for one in arrays if re.search(rf"\b{one}\b", text)]
    arguments = f",{BREAK}".join(f"{one}_type {one}" for one in used)
    head = f"{template(used)}{BREAK}static __device__ __noinline__ {kind} {name}_warp_{k + 1}({arguments})"
    return Worker(
        prototype=wrap(head, indent="", hanging="    "),
        body=lines,
        call=_call(
            f"{name}_warp_{k + 1}", [arrays[one] for one in used], "const int found = " * (kind == "int")
        ),
        locals=printed.locals,
    )


def state(array: Array) -> str:
    """Return the argument of a function for one state: state `i` of an array with all states."""
    return f"kanegen_state({array.name}, i, stride, {array.size})"


def _call(name: str, arguments: Sequence[str], result: str) -> list[str]:
    text = f"{result}{name}({f',{BREAK}'.join(arguments)});"
    return wrap(text, indent=" " * 12, hanging=" " * 16)
