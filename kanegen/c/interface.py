"""The interface of generated functions as plain data: arrays, conditions and batch form of each function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from kanegen.program.columns import ColumnSolution
from kanegen.program.cut import LONGEST_PART, cut, workspace_size
from kanegen.program.ir import (
    EVALUATE,
    STATE_RATES,
    STATE_RATES_DERIVATIVES,
    Array,
    Condition,
    Module,
    Program,
    RowCondition,
)

PREPARE = "prepare"
"""Name of the function that turns parameters into prepared constants."""

_TOGETHER = (EVALUATE, STATE_RATES, STATE_RATES_DERIVATIVES)
"""Names of functions that compute several outputs together."""

LARGEST_BATCH_ROW = 16384
"""Numbers of one state that a batch function keeps on the stack for every SIMD lane,
128 KiB a lane. A function with more evaluates its batch state by state."""


def fit_simd(numbers: int) -> bool:
    """Return whether so many numbers of a state leave room for several states side by side on the stack."""
    return numbers <= LARGEST_BATCH_ROW


@dataclass(frozen=True)
class Loops:
    """An output that loops compute from values in the workspace.

    Attributes:
        array: The output.
        solution: What they compute.
        start: Place of the first value in the workspace.
    """

    array: Array
    solution: ColumnSolution
    start: int


@dataclass(frozen=True)
class Function:
    """A generated function, `<model>_<name>`, and its batch form.

    Attributes:
        name: Name without the prefix.
        doc: One sentence for the documentation comment.
        inputs: Arrays that it reads, in the order of the arguments.
        outputs: Arrays that it fills, the last arguments.
        shared: Names of inputs that all states of a batch have in common.
        may_fail: Names of outputs that exist only where some values are positive; such a function returns a
            status.
        workspace: Numbers that one part of the function leaves for later parts, 0 if it has one part.
        may_be_inaccurate: Names of outputs that may exist without being accurate; the status reports this.
        has_batch: Whether it has a batch form; `prepare` has one only where parameters differ by state, and
            code for one state alone has none.
        may_not_converge: Whether an iteration finds the results, with a status where it does not converge.
        loops: What loops compute after the last part.
    """

    name: str
    doc: str
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    shared: tuple[str, ...] = ()
    may_fail: tuple[str, ...] = ()
    workspace: int = 0
    may_be_inaccurate: tuple[str, ...] = ()
    has_batch: bool = True
    may_not_converge: bool = False
    loops: tuple[Loops, ...] = ()

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """The conditions under which the outputs in `may_fail` exist, each once."""
        return tuple(dict.fromkeys(array.condition for array in self.outputs if array.name in self.may_fail))

    @property
    def quantity(self) -> str:
        """Name of the quantity that is positive where the outputs in `may_fail` exist."""
        return " or ".join(dict.fromkeys(condition.quantity for condition in self.conditions))

    @property
    def failure(self) -> str:
        """Clause on the state where the quantity is not positive."""
        return " or ".join(dict.fromkeys(condition.failure for condition in self.conditions))

    @property
    def row_conditions(self) -> tuple[RowCondition, ...]:
        """The conditions for rows of the outputs, each once."""
        return tuple(dict.fromkeys(one for array in self.outputs if (one := array.row_condition)))

    @property
    def fits_simd(self) -> bool:
        """Whether the arrays of a state are small enough to evaluate several states side by side."""
        return fit_simd(self.numbers)

    @property
    def looped(self) -> tuple[Array, ...]:
        """The outputs that loops compute after the last part."""
        return tuple(one.array for one in self.loops)

    @property
    def numbers(self) -> int:
        """Number of numbers that the function reads, fills and stores between its parts for one state."""
        arrays = (*self.inputs, *self.outputs)
        return self.workspace + sum(array.size for array in arrays if array.name not in self.shared)


@dataclass(frozen=True)
class Footprint:
    """The memory of a function for one state, without the arrays of its caller.

    Attributes:
        name: Name of the function, with the prefix of the model.
        stack: Bytes of stack of the function and all that it calls, from above.
        optimised_stack: Bytes of stack with optimisation, about.
        code: Bytes of code, about, optimised for size and without functions that it calls.

    Example:
        kg.generate(system).footprints[0].stack
    """

    name: str
    stack: int
    optimised_stack: int
    code: int


def signatures(
    module: Module,
    longest: int = LONGEST_PART,
    parameters_by_state: bool = False,
    batches: bool = True,
) -> dict[Function, tuple[Program, ...]]:
    """Return every function of a module with its parts: `prepare` first, then the others in their order.

    Args:
        module: The programs.
        longest: Instructions of a function from which it is cut into parts; `prepare` is never cut.
        parameters_by_state: Whether each state of a batch has its own prepared constants.
        batches: Whether the functions have batch forms.
    """
    found: dict[Function, tuple[Program, ...]] = {}
    shared: tuple[str, ...] = ()
    if module.prepare is not None:
        arrays = _outputs(module.prepare)
        shared = () if parameters_by_state else tuple(array.name for array in arrays)
        doc = "Everything that depends on parameters alone. Call it again whenever a parameter changes."
        may_fail = _may_fail(module.prepare)
        prepare = Function(
            PREPARE, doc, module.prepare.inputs, arrays, may_fail=may_fail, has_batch=parameters_by_state
        )
        found[prepare] = (module.prepare,)
    for name, program in module.functions.items():
        arrays = _outputs(program)
        doc = f"{arrays[0].doc}."
        if len(arrays) > 1:
            doc = f"{_listed([array.name for array in arrays])} together, every intermediate shared."
        parts = cut(program, longest)
        status = _may_fail(program), workspace_size(parts), _may_be_inaccurate(program)
        function = Function(
            name, doc, program.inputs, arrays, shared, *status, batches, loops=_loops(program)
        )
        found[function] = parts
    return found


def _loops(program: Program) -> tuple[Loops, ...]:
    """Return what loops compute after the parts of a program, which `cut` made."""
    found: list[Loops] = []
    start = 0
    for output in program.outputs:
        if output.solution is not None:
            found.append(Loops(output.array, output.solution, start))
            start += output.solution.number_of_values
    return tuple(found)


def prepared_names(functions: Mapping[Function, Sequence[Program]]) -> tuple[str, ...]:
    """Return the name of every prepared constant, by its place: that of its quantity, or `c_<place>`.

    Args:
        functions: Every function with its parts.
    """
    found: list[str] = []
    for function, (program, *_) in functions.items():
        if function.name == PREPARE:
            for place, value in enumerate(program.results(), start=1):
                name = program.instructions[value].name or f"c_{place}"
                found.append(name if name not in found else f"c_{place}")
    return tuple(found)


def requested(module: Module) -> tuple[str, ...]:
    """Return the names of the requested outputs, each of which has a function."""
    return tuple(name for name in module.functions if name not in _TOGETHER)


def _outputs(program: Program) -> tuple[Array, ...]:
    return tuple(output.array for output in program.outputs)


def _may_fail(program: Program) -> tuple[str, ...]:
    return tuple(output.array.name for output in program.outputs if output.exists_if_positive)


def _may_be_inaccurate(program: Program) -> tuple[str, ...]:
    return tuple(output.array.name for output in program.outputs if output.accurate_if_positive)


def _listed(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
