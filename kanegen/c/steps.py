"""Functions that follow a motion in steps of fixed length, in C: their interface as plain data.

A step has the arguments of forward dynamics and its own length; a rollout has rows of those that it holds
over steps. `step_printer` has their text.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from kanegen.c.declarations import declarator, not_converged, not_finite
from kanegen.c.description import ModelDescription
from kanegen.c.formats import Formats
from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, WIDTH, columns, wrap
from kanegen.program.ir import PREPARED, Array, Condition
from kanegen.recursion.outputs import INTEGRATORS, RATES, Method, differentiates

ACCELERATION, COORDINATE_RATES = "acceleration", "xdot"
"""Names of the arrays of {ydot} and {xdot}."""

SLOPES, COORDINATE_SLOPES = (f"{name}_derivatives" for name in RATES)
"""Names of the arrays of the derivatives of {ydot} and {xdot}."""

DERIVATIVES_OF_STEP = "step_derivatives"
"""Name of the array of the derivatives of a step."""


LENGTH = Array("step", (), "s", "length of the step")
"""The array of the length of a step."""

NOT_HELD = ("x", "y", "t", PREPARED, LENGTH.name)
"""Inputs of steps that are no inputs from outside, which are held over a step."""


_ROWS = (
    "`steps/every + 1` states are stored. An input has no row where it is zero, and is not read then; one "
    "row where it is constant; `steps` rows where it is constant over each step; `steps + 1` where it "
    "follows straight lines between the ends of the steps; `2*steps + 1` for its values at the start, the "
    "middle and the end of each step."
)
"""What the rows of an input of a rollout mean."""


def arrays_of_rates(name: str, speeds_are_rates: bool) -> frozenset[str]:
    """Return the names of the arrays that a function computes of a state in every stage of a step.

    They are {ydot}, {xdot} where it is not {y}, and their derivatives where a step is differentiated.

    Args:
        name: Name of a function that follows a motion, one of `INTEGRATORS`.
        speeds_are_rates: Whether {xdot} is {y}.
    """
    rates = (ACCELERATION,) if speeds_are_rates else (ACCELERATION, COORDINATE_RATES)
    if not differentiates(name):
        return frozenset(rates)
    return frozenset((*rates, *(f"{output}_derivatives" for output in RATES[: len(rates)])))


def rates_function(name: str, functions: Iterable[Function], speeds_are_rates: bool) -> Function:
    """Return the function that computes the rates of a state for a function that follows a motion.

    Args:
        name: Name of the function that follows a motion, one of `INTEGRATORS`.
        functions: The functions of outputs.
        speeds_are_rates: Whether {xdot} is {y}.
    """
    needed = arrays_of_rates(name, speeds_are_rates)
    return next(one for one in functions if needed == {array.name for array in one.outputs})


def composed(name: str, functions: Iterable[Function], speeds_are_rates: bool) -> tuple[Function, ...]:
    """Return the functions that a function which follows a motion calls; the first computes rates.

    Args:
        name: Name of the function that follows a motion, one of `INTEGRATORS`.
        functions: The functions of outputs.
        speeds_are_rates: Whether {xdot} is {y}.
    """
    every = tuple(functions)
    called = () if differentiates(name) else INTEGRATORS[name].called
    return (rates_function(name, every, speeds_are_rates), *(one for one in every if one.name in called))


def step_function(name: str, functions: Iterable[Function], speeds_are_rates: bool) -> Function:
    """Return the function that makes one step of a method, and differentiates it where its name says so.

    Args:
        name: Name of a function of the method, one of `INTEGRATORS`.
        functions: The functions of outputs.
        speeds_are_rates: Whether {xdot} is {y}.
    """
    method, called = INTEGRATORS[name], composed(name, functions, speeds_are_rates)
    rates = called[0]
    arrays = {array.name: array for array in (*rates.inputs, *rates.outputs)}
    x, y = arrays["x"], arrays["y"]
    condition = _condition(method, arrays[ACCELERATION].condition)
    outputs = tuple(
        replace(
            one,
            name=f"{one.name}_next",
            doc=f"{{{one.name}}} after the step",
            condition=condition,
            of_freedoms=one is y,
        )
        for one in (x, y)
    )
    derivatives = _derivatives(arrays[SLOPES], x.size, y.size) if SLOPES in arrays else None
    outputs = (*outputs, derivatives) if derivatives else outputs
    names = tuple(array.name for array in outputs)
    may_fail = bool(method.condition[0]) or any(function.may_fail for function in called)
    further = ", and its derivatives" if derivatives else ""
    cost = method.cost_with_derivatives if derivatives else method.cost
    return Function(
        name=method.derivatives if derivatives else method.functions[0],
        doc=f"One step by {method.title} of order {method.order}{further}: {cost}.",
        inputs=(*rates.inputs, LENGTH),
        outputs=outputs,
        shared=rates.shared,
        may_fail=names if may_fail else (),
        workspace=sum(one.numbers for one in called)
        + 8 * (x.size + y.size)
        + 3 * sum(array.size for array in held(rates))
        + (y.size**2 if method.needs else 0)
        + (4 * derivatives.size if derivatives else 0),
        may_be_inaccurate=names if any(function.may_be_inaccurate for function in called) else (),
        may_not_converge=method.is_iterative,
    )


def _derivatives(slopes: Array, m: int, n: int) -> Array:
    """Return the array of the derivatives of a step.

    Args:
        slopes: The array of the derivatives of {ydot}, which has the same columns.
        m: Number of coordinates.
        n: Number of freedoms.
    """
    ends = {"{x}": m, "{y}": m + n, "{tau}": m + 2 * n, "the run-time parameters": slopes.shape[-1]}
    first, columns = 0, []
    for of, end in ends.items():
        if end > first:
            columns.append(f"{of} (columns {first} to {end - 1})")
        first = end
    return replace(
        slopes,
        name=DERIVATIVES_OF_STEP,
        shape=(m + n, slopes.shape[-1]),
        unit="units of x and y over those of the columns",
        doc=f"derivatives of {{x}} and {{y}} after the step by {', then '.join(columns)}",
        of_freedoms=False,
    )


def _condition(method: Method, condition: Condition) -> Condition:
    """Return the condition under which the state after a step exists: that of {ydot}, and of the method."""
    quantity, failure = method.condition
    if not quantity:
        return condition
    return replace(
        condition,
        quantity=f"{condition.quantity} or {quantity}",
        failure=f"{condition.failure}, or {failure},",
    )


def held(function: Function) -> list[Array]:
    """Return the inputs from outside that are held over a step, such as generalized forces."""
    return [array for array in function.inputs if array.name not in NOT_HELD]


@dataclass(frozen=True)
class Rollout:
    """A function that makes many steps and stores states on the way, and its batch form.

    Attributes:
        name: Name without the prefix of the model.
        step: The function that makes one of its steps.
    """

    name: str
    step: Function

    @property
    def method(self) -> Method:
        """The method of its steps."""
        return INTEGRATORS[self.name]

    @property
    def has_batch(self) -> bool:
        """Whether it has a batch form."""
        return self.step.has_batch

    @property
    def doc(self) -> str:
        """One sentence for the documentation comment."""
        return f"Many steps by {self.method.title} of order {self.method.order}, with states on the way."

    @property
    def inputs(self) -> tuple[Array, ...]:
        """Arrays that it reads, without the length of a step."""
        return self.step.inputs[:-1]

    @property
    def held(self) -> list[Array]:
        """The inputs from outside, each of which has one row or several for each state."""
        return held(self.step)

    def _arguments(self, formats: Formats, state: str, made: str) -> Iterator[str]:
        """Yield the declarations of the arguments; `state` declares an array of a state."""
        kind = formats.storage.c_type
        for array in self.inputs:
            if array in self.held:
                yield f"const {kind} *{array.name}"
                yield f"size_t {array.name}_rows"
            else:
                yield f"const {formats.of(array.name).c_type} " + state.format(array.name, declarator(array))
        yield f"const {kind} " + state.format("step", declarator(LENGTH))
        yield from ("size_t steps", "size_t every", "int compensated")
        yield from (f"{kind} *x_path", f"{kind} *y_path", f"size_t {made}")

    def prototype(self, model: str, formats: Formats) -> list[str]:
        """Return the lines of the prototype of the form for one state."""
        arguments = f",{BREAK}".join(self._arguments(formats, "{1}", "made[1]"))
        return wrap(f"int {model}_{self.name}({arguments})", indent="", hanging="    ")

    def batch_prototype(self, model: str, formats: Formats) -> list[str]:
        """Return the lines of the prototype of the batch form."""
        arguments = f",{BREAK}".join(("size_t count", *self._arguments(formats, "*{0}", "*made")))
        return wrap(f"size_t {model}_{self.name}_batch({arguments})", indent="", hanging="    ")

    def row_call(self, model: str) -> list[str]:
        """Return the call of the form for one state with state `i` of a batch, indented for its loop."""
        x, y = (next(array for array in self.inputs if array.name == name) for name in "xy")
        arguments = []
        for array in self.inputs:
            if array.name in self.step.shared:
                arguments.append(array.name)
            elif array in self.held:
                rows = f"{array.name}_rows"
                arguments.append(f"{rows} ? {array.name} + {array.size}*{rows}*i : {array.name}")
                arguments.append(rows)
            else:
                arguments.append(f"{array.name} + {array.size}*i")
        arguments += ["step", "steps", "every", "compensated"]
        arguments += [f"x_path + {x.size}*kept*i", f"y_path + {y.size}*kept*i", "made + i"]
        text = f"{model}_{self.name}({f',{BREAK}'.join(arguments)})"
        return wrap(f"failed += {text} != 0;", indent=" " * 8, hanging=" " * 12)

    def argument_list(self, model: ModelDescription) -> list[str]:
        """Return Doxygen lines for arguments and status.

        Args:
            model: Names of the model.
        """
        rows: list[tuple[str, str, str, str]] = []
        for array in self.inputs:
            described = f"{array.doc} ({array.unit})"
            if array in self.held:
                rows.append(("@param[in]", array.name, f"[rows * {array.size}]", described))
                rows.append(("@param[in]", f"{array.name}_rows", "", f"number of rows of {array.name}"))
            else:
                rows.append(("@param[in]", array.name, f"[{array.size}]", described))
        x, y = (array for array in self.inputs if array.name in "xy")
        rows += [
            ("@param[in]", "step", "[1]", "length of a step (s)"),
            ("@param[in]", "steps", "", "number of steps"),
            ("@param[in]", "every", "", "number of steps, from 1, from one stored state to the next"),
            ("@param[in]", "compensated", "", "whether to add later what rounding takes from sums (Kahan)"),
            ("@param[out]", "x_path", f"[kept * {x.size}]", "{x} of the stored states, the start first"),
            ("@param[out]", "y_path", f"[kept * {y.size}]", "{y} of the stored states"),
            ("@param[out]", "made", "[1]", "number of steps before that of the status, or `steps`"),
        ]
        reasons = not_finite(model)
        if self.step.may_not_converge:
            reasons += f"; {not_converged(model)} where the iteration for the step does not converge"
        returned = (
            f"@return the status of `{self.step.name}` in the first step after which the state is missing or "
            f"not finite ({reasons}), from which on stored states are NaN; else that of the first step that "
            "may be inaccurate; else 0"
        )
        return [
            *textwrap.wrap(_ROWS, WIDTH - len(" * ")),
            "",
            *columns(rows, width=WIDTH - len(" * ")),
            *textwrap.wrap(returned, WIDTH - len(" * "), subsequent_indent="    "),
        ]
