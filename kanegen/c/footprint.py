"""The memory that a generated function takes on a microcontroller: stack and code.

The compiler decides both, so these are figures of the program, the same for every compiler. The stack from
above gives each value a place of its own, in the function and in all that it calls one below the other; that
is what compilers do without optimisation, and more than they need with it. The stack with optimisation counts
the values that are needed at the same time. Tests compare both with what gcc and clang report.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil

from kanegen.c import usage
from kanegen.c.functions import Code, PrintedFunction
from kanegen.c.interface import PREPARE, Footprint, Function, Loops
from kanegen.c.steps import Rollout, composed
from kanegen.c.target import RenderInput
from kanegen.program.ir import Op, Program
from kanegen.program.precision import DOUBLE_DOUBLE, Precision

_FRAME = 128
"""Bytes of a frame beside its values: saved registers, the return address, a status and counters."""

_ARGUMENT = 16
"""Bytes of a frame for each argument: without optimisation it is kept, and some are passed on the stack."""

_TEMPORARIES = 1 / 8
"""Further places for parts of expressions, per value: processors without floating-point unit need some."""

_STRUCT_TEMPORARIES = 1
"""The same of double-double arithmetic, whose functions return structures."""

_OPTIMISED_FRAME = 64
"""Bytes of a frame beside its values with optimisation."""

_SINES = (1024, 160)
"""Bytes of stack of sine and cosine, from above and with optimisation."""

_SINES_IN_LANES = (512, 96)
"""Bytes of stack that sines and cosines of several angles at once take beside."""

_LIBRARY = (256, 96)
"""Bytes of stack of square roots, copies and arithmetic in software, from above and with optimisation."""

_DOUBLE_DOUBLE = (4096, 512)
"""Bytes of stack of double-double arithmetic with its functions, from above and with optimisation."""

_ELEMENTARY = (1024, 192)
"""Bytes of stack of exp, log, tanh, atan2 and comparisons, from above and with optimisation."""

_STATEMENT = 2
"""Bytes of code for each operation, element read or stored, and constant, beside those of a number."""

_STEP_CODE, _ROLLOUT_CODE = 900, 300
"""Bytes of code of a function that makes a step, with its helpers, and of what makes many of it."""

_CODE = 48
"""Bytes of code of a function beside its statements."""


def footprints(render_input: RenderInput, functions: Iterable[PrintedFunction]) -> tuple[Footprint, ...]:
    """Return the memory of every function for one state.

    Args:
        render_input: The programs.
        functions: The printed functions of outputs.
    """
    found = {one.signature.name: _of_outputs(render_input, one) for one in functions}
    model, signatures = render_input.model, tuple(render_input.programs)
    for name, step in render_input.steps.items():
        called = composed(name, signatures, model.speeds_are_rates)
        below = [found[one.name] for one in called]
        rollout = next((one for one in render_input.rollouts if one.name == name), None)
        found[name] = _of_steps(render_input, step, below, rollout)
    names = [*(one.name for one in render_input.functions), *(one.name for one in render_input.rollouts)]
    return tuple(found[name] for name in names)


def _of_outputs(render_input: RenderInput, printed: PrintedFunction) -> Footprint:
    """Return the memory of a function that fills outputs."""
    function, code = printed.signature, printed.code
    formats, parts = render_input.formats, render_input.programs[function]
    arithmetic = formats.preparing if function.name == PREPARE else formats.arithmetic
    size = arithmetic.bytes
    arguments = len(function.inputs) + len(function.outputs)
    temporaries = _STRUCT_TEMPORARIES if arithmetic is DOUBLE_DOUBLE else _TEMPORARIES
    values = max(code.part_locals) * (1 + temporaries)
    frames = 1 if len(parts) == 1 else 2
    below, optimised_below = _called(code, arithmetic)
    columns = max(code.part_locals[len(parts) :], default=0) * size
    below, optimised_below = max(below, columns), max(optimised_below, columns)
    return Footprint(
        printed.name,
        _rounded(size * (values + function.workspace) + frames * (_FRAME + _ARGUMENT * arguments) + below),
        _rounded(
            size * (max(map(_most_at_once, parts)) + function.workspace)
            + frames * _OPTIMISED_FRAME
            + optimised_below
        ),
        _rounded(
            (sum(map(_statements, parts)) + _looped_statements(function.loops)) * (_STATEMENT + size) + _CODE
        ),
    )


def _looped_statements(every: Sequence[Loops]) -> int:
    """Return the number of operations, and of elements that are read or stored, in the text of loops."""
    return sum(3 * loops.solution.terms for loops in every)


def _of_steps(
    render_input: RenderInput, step: Function, called: Sequence[Footprint], rollout: Rollout | None
) -> Footprint:
    """Return the memory of a function that follows a motion.

    Args:
        render_input: Model and precisions.
        step: The function of one step; its workspace holds the states and rates of the method.
        called: The memory of the functions that it calls, one after the other.
        rollout: The function of many steps, None for one step.
    """
    name = (rollout or step).name
    size = max(precision.bytes for precision in render_input.formats.every)
    state = sum(array.size for array in step.inputs if array.name in "xy")
    arguments = len(step.inputs) + len(step.outputs)
    numbers = step.workspace + 3 * state * bool(rollout)
    frames = 3 + bool(rollout)
    return Footprint(
        f"{render_input.model.name}_{name}",
        _rounded(size * numbers + frames * (_FRAME + _ARGUMENT * arguments) + max(o.stack for o in called)),
        _rounded(size * numbers + 2 * _OPTIMISED_FRAME + max(one.optimised_stack for one in called)),
        _rounded(_STEP_CODE + _ROLLOUT_CODE * bool(rollout)),
    )


def _called(code: Code, arithmetic: Precision) -> tuple[int, int]:
    """Return bytes of stack of the functions that a function calls, from above and with optimisation."""
    taken = [_LIBRARY]
    if code.takes_sines:
        taken.append(_SINES)
    if code.vector_sincos:
        taken.append(_SINES_IN_LANES)
    if code.elementary is not None:
        taken.append(_ELEMENTARY)
    if arithmetic is DOUBLE_DOUBLE:
        taken.append(_DOUBLE_DOUBLE)
    above, optimised = zip(*taken, strict=True)
    return sum(above), sum(optimised)


def _most_at_once(program: Program) -> int:
    """Return how many values, constants left out, are needed at the same time in the order of the program."""
    live = usage.live(program)
    last = {operand: i for i in live for operand in program.instructions[i].operands}
    now = most = 0
    released: dict[int, int] = {}
    for value, user in last.items():
        if program.instructions[value].op is not Op.CONSTANT:
            released[user] = released.get(user, 0) + 1
    for i in live:
        now -= released.get(i, 0)
        now += program.instructions[i].op is not Op.CONSTANT and i in last
        most = max(most, now + 1)
    return most


def _statements(program: Program) -> int:
    """Return the number of operations, of elements that are read or stored, and of different constants."""
    live = [program.instructions[i] for i in usage.live(program)]
    constants = {one.number for one in live if one.op is Op.CONSTANT}
    stored = sum(len(list(output.elements())) for output in program.outputs)
    return sum(one.op is not Op.CONSTANT for one in live) + len(constants) + stored


def _rounded(number: float) -> int:
    """Return a number of bytes as a multiple of 8, rounded up."""
    return 8 * ceil(number / 8)
