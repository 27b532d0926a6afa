"""The program of the output `error_bound`: proven bounds on the errors of given accelerations.

With {r} = [A]{ydot} - {f} - {tau}, what the given {ydot} leave of the equations of motion, their error is
[A]^-1 {r}, whatever program computed them. The program computes {r} by inverse dynamics, with the running
errors of its own operations (`program.running_error`). So |{r}| is at most what was computed plus its running
error. A factorisation [A] = [L]^T [D] [L] carries these bounds on: every elimination is linear in the right
side, its coefficients have running errors as well, and magnitudes of coefficients replace coefficients. What
comes out bounds |[A]^-1 {r}| entry by entry, in every state.

Constants are derived with 96 digits and rounded once, so that their rounding is known and counted.
"""

from __future__ import annotations

from kanegen.errors import OptionError
from kanegen.lowering.lower import lower
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program import passes
from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.constants import WIDE_CONSTANTS
from kanegen.program.ir import Op, Output, Program
from kanegen.program.linear_bound import linear_bound
from kanegen.program.passes.prune import prune
from kanegen.program.precision import DOUBLE, FLOAT, precision_named
from kanegen.program.running_error import SLACK, Arithmetic, RunningErrors, slack_holds
from kanegen.program.semantics import CONTRACTED, STRICT
from kanegen.recursion import derive, methods
from kanegen.recursion.outputs import OUTPUTS, ErrorBound

SINE_ERRORS = {"shared": 0.9, "libm": 1.01}
"""Bounds on the error of sine and cosine, in units of u, by `Variant.sincos`.

`kanegen.measure.bounds` proves that of kanegen's functions for angles up to 1e5 rad, 1e4 in single precision.
For larger angles it rests on their promise, 0.81 units in the last place. For libm one unit is assumed,
which is at most u.
"""

SOLVER = "factorisation"
"""The solver whose coefficients carry bounds on; its bounds are closer than those of articulated bodies."""

_PROVABLE = {STRICT, CONTRACTED, "no-traps", "no-errno", "no-signed-zeros"}


def require_provable(variant: Variant) -> None:
    """Require that every operation of a variant is rounded to nearest and known.

    Raises:
        OptionError: If the precision, the semantics or the sine leave errors open.
    """
    if precision_named(variant.precision) not in (DOUBLE, FLOAT):
        raise OptionError(
            f"output 'error_bound': not in precision {variant.precision!r}; take double or float."
        )
    if variant.storage not in ("", variant.precision):
        raise OptionError(
            f"output 'error_bound': not with storage {variant.storage!r}, in which states are rounded; take "
            f"{variant.precision}."
        )
    if variant.sincos not in SINE_ERRORS:
        raise OptionError(
            f"output 'error_bound': not with sincos {variant.sincos!r}; take {' or '.join(SINE_ERRORS)}."
        )
    loose = [name for name in variant.semantics if name not in _PROVABLE]
    if loose:
        raise OptionError(
            f"output 'error_bound': the semantics {', '.join(loose)} allow errors that no analysis knows. "
            "Take strict semantics."
        )


def error_bound(system: System, variant: Variant) -> Program:
    """Return the program of the output `error_bound`, whose instructions no pass may change.

    Args:
        system: The tree.
        variant: The choices between speed and accuracy.

    Raises:
        OptionError: If the variant, or the size of the system in single precision, admits no proof.
    """
    require_provable(variant)
    needs = ErrorBound.needs
    (way,) = methods(system, needs, SOLVER)
    form = derive(system, way, WIDE_CONSTANTS)
    program, _ = passes.run(lower(form, needs, WIDE_CONSTANTS), passes.all_but(variant.without))
    arithmetic = Arithmetic(precision_named(variant.precision), SINE_ERRORS[variant.sincos])
    found = check(prune(_bounded(system, program, arithmetic)))
    if not slack_holds(found, arithmetic):
        raise OptionError(
            f"output 'error_bound': {len(found.instructions)} operations are too many in precision "
            f"{variant.precision!r}; take double."
        )
    return found


def _bounded(system: System, program: Program, arithmetic: Arithmetic) -> Program:
    """Return the program that bounds the errors of {ydot}, from one of inverse and forward dynamics."""
    builder = Builder(program.inputs)
    required, solved = program.outputs
    residual = _with_residual(program, required)
    errors = RunningErrors(builder, residual, arithmetic)
    units = builder.constant(1 / arithmetic.roundoff)
    changed = {}
    for place, i in enumerate(residual.outputs[0].values):
        left = builder.multiply(errors.size(i), units)
        error = errors.error(i)
        bound = left if error is None else builder.add(left, error)
        changed[_forces(program)[place]] = bound
    scale = builder.constant((1 + SLACK) * arithmetic.roundoff)
    least = builder.constant(arithmetic.least)
    bounds = [
        builder.add(builder.multiply(scale, bound), least)
        for bound in linear_bound(errors, builder, residual, changed, list(solved.values))
    ]
    margins = tuple(errors.margin(i) for i in solved.exists_if_positive)
    return builder.program([Output(OUTPUTS["error_bound"].array(system), tuple(bounds), margins)])


def _forces(program: Program) -> dict[int, int]:
    """Return the instructions that read {tau}, by their places in {tau}."""
    return {
        instruction.index: i
        for i, instruction in enumerate(program.instructions)
        if instruction.op is Op.INPUT and instruction.array == "tau"
    }


def _with_residual(program: Program, required: Output) -> Program:
    """Return the program with {r}, the required forces less {tau}, as its only output."""
    builder = Builder(program.inputs)
    for instruction in program.instructions:
        builder.copy(instruction, instruction.operands)
    tau = _forces(program)
    left = tuple(builder.subtract(value, tau[place]) for place, value in enumerate(required.values))
    return builder.program([Output(required.array, left)])
