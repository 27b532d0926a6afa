"""Functions that follow a motion in steps of fixed length, in C: their interface, and their text.

A step is composed of the function that computes the rates of a state. A method is a template, which is filled
twice: for one state, and for several in SIMD lanes. What all methods share, such as the addition to the state
and how inputs are held over a step, is printed once a file.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from kanegen.c.declarations import declarator, not_finite
from kanegen.c.description import ModelDescription
from kanegen.c.dialect import finite_test
from kanegen.c.formats import Formats
from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, WIDTH, columns, wrap
from kanegen.c.simd import SIMD
from kanegen.c.templates import fill
from kanegen.program.ir import PREPARED, Array
from kanegen.recursion.outputs import INTEGRATORS, RATES, Method, differentiates

ACCELERATION, COORDINATE_RATES = "acceleration", "xdot"
"""Names of the arrays of {ydot} and {xdot}."""

SLOPES, COORDINATE_SLOPES = (f"{name}_derivatives" for name in RATES)
"""Names of the arrays of the derivatives of {ydot} and {xdot}."""

DERIVATIVES_OF_STEP = "step_derivatives"
"""Name of the array of the derivatives of a step."""

NOT_HELD = ("x", "y", "t", PREPARED)
"""Inputs of the rates that are no inputs from outside, which are held over a step."""

LENGTH = Array("step", (), "s", "length of the step")
"""The array of the length of a step."""


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


def step_function(name: str, rates: Function) -> Function:
    """Return the function that makes one step of a method, and differentiates it where its name says so.

    Args:
        name: Name of a function of the method, one of `INTEGRATORS`.
        rates: The function that computes the rates.
    """
    method = INTEGRATORS[name]
    arrays = {array.name: array for array in (*rates.inputs, *rates.outputs)}
    x, y, acceleration = arrays["x"], arrays["y"], arrays[ACCELERATION]
    following = (
        replace(
            acceleration,
            name="x_next",
            shape=x.shape,
            unit=x.unit,
            doc="{x} after the step",
            of_freedoms=False,
        ),
        replace(acceleration, name="y_next", unit=y.unit, doc="{y} after the step"),
    )
    size = x.size + y.size
    derivatives = _derivatives(arrays[SLOPES], x.size, y.size) if SLOPES in arrays else None
    outputs = (*following, derivatives) if derivatives else following
    doc = f"One step by {method.title} of order {method.order}, in {method.evaluations}"
    return Function(
        name=method.derivatives if derivatives else method.functions[0],
        doc=f"{doc}{', and its derivatives' if derivatives else ''}.",
        inputs=(*rates.inputs, LENGTH),
        outputs=outputs,
        shared=rates.shared,
        may_fail=tuple(array.name for array in outputs) if rates.may_fail else (),
        workspace=rates.numbers
        + 7 * size
        + 3 * sum(array.size for array in held(rates))
        + (4 * derivatives.size if derivatives else 0),
        may_be_inaccurate=tuple(array.name for array in outputs) if rates.may_be_inaccurate else (),
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


def held(rates: Function) -> list[Array]:
    """Return the inputs from outside that are held over a step, such as generalized forces."""
    return [array for array in rates.inputs if array.name not in NOT_HELD]


def has_time(rates: Function) -> bool:
    """Return whether rates depend on the time."""
    return any(array.name == "t" for array in rates.inputs)


@dataclass(frozen=True)
class Rollout:
    """A function that makes many steps and stores states on the way, and its batch form.

    Attributes:
        name: Name without the prefix of the model.
        step: The function that makes one of its steps.
        rates: The function that computes the rates of a state.
    """

    name: str
    step: Function
    rates: Function

    @property
    def method(self) -> Method:
        """The method of its steps."""
        return INTEGRATORS[self.name]

    @property
    def doc(self) -> str:
        """One sentence for the documentation comment."""
        return f"Many steps by {self.method.title} of order {self.method.order}, with states on the way."

    @property
    def has_time(self) -> bool:
        """Whether the time of the start is an argument."""
        return has_time(self.rates)

    @property
    def held(self) -> list[Array]:
        """The inputs from outside, each of which has one row or several for each state."""
        return held(self.rates)

    def _arguments(self, formats: Formats, state: str, made: str) -> Iterator[str]:
        """Yield the declarations of the arguments; `state` declares an array of a state."""
        kind = formats.storage.c_type
        for array in self.rates.inputs:
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
        x, y = (next(array for array in self.rates.inputs if array.name == name) for name in "xy")
        arguments = []
        for array in self.rates.inputs:
            if array.name in self.rates.shared:
                arguments.append(array.name)
            elif array in self.held:
                rows = f"{array.name}_rows"
                arguments.append(f"{array.name} + ({rows} ? {array.size}*{rows}*i : 0)")
                arguments.append(rows)
            else:
                arguments.append(f"{array.name} + {array.size}*i")
        arguments += ["step", "steps", "every", "compensated"]
        arguments += [f"x_path + {x.size}*kept*i", f"y_path + {y.size}*kept*i", "made + i"]
        text = f"{model}_{self.name}({f',{BREAK}'.join(arguments)})"
        return wrap(f"failed += {text} != 0;", indent=" " * 8, hanging=" " * 12)

    def argument_list(self, infinite: str) -> list[str]:
        """Return Doxygen lines for arguments and status.

        Args:
            infinite: Name of the status of a result that is not finite.
        """
        rows: list[tuple[str, str, str, str]] = []
        for array in self.rates.inputs:
            described = f"{array.doc} ({array.unit})"
            if array in self.held:
                rows.append(("@param[in]", array.name, f"[rows * {array.size}]", described))
                rows.append(("@param[in]", f"{array.name}_rows", "", f"number of rows of {array.name}"))
            else:
                rows.append(("@param[in]", array.name, f"[{array.size}]", described))
        x, y = (array for array in self.rates.inputs if array.name in "xy")
        rows += [
            ("@param[in]", "step", "[1]", "length of a step (s)"),
            ("@param[in]", "steps", "", "number of steps"),
            ("@param[in]", "every", "", "number of steps, from 1, from one stored state to the next"),
            ("@param[in]", "compensated", "", "whether to add later what rounding takes from sums (Kahan)"),
            ("@param[out]", "x_path", f"[kept * {x.size}]", "{x} of the stored states, the start first"),
            ("@param[out]", "y_path", f"[kept * {y.size}]", "{y} of the stored states"),
            ("@param[out]", "made", "[1]", "number of steps before that of the status, or `steps`"),
        ]
        returned = (
            f"@return the status of `{self.step.name}` in the first step after which the state is missing or "
            f"not finite ({infinite}), from which on stored states are NaN; else that of the first step that "
            "may be inaccurate; else 0"
        )
        return [
            *textwrap.wrap(_ROWS, WIDTH - len(" * ")),
            "",
            *columns(rows, width=WIDTH - len(" * ")),
            *textwrap.wrap(returned, WIDTH - len(" * "), subsequent_indent="    "),
        ]


@dataclass(frozen=True)
class Printer:
    """The text of functions that follow a motion, for one state or for several in lanes.

    Attributes:
        model: Names and sizes of the model.
        formats: Precisions of arrays and arithmetic.
        rates: The function that computes the rates of a state.
        lanes: Whether the text is for several states in SIMD lanes.
    """

    model: ModelDescription
    formats: Formats
    rates: Function
    lanes: bool
    _variables: dict[str, Any] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Compute the variables of the templates."""
        object.__setattr__(self, "_variables", self._context())

    @property
    def _form(self) -> str:
        return "_simd" if self.lanes else ""

    @property
    def _has_time(self) -> bool:
        return has_time(self.rates)

    @property
    def _prepared(self) -> Array | None:
        return next((array for array in self.rates.inputs if array.name == PREPARED), None)

    @property
    def _slopes(self) -> Array | None:
        return next((array for array in self.rates.outputs if array.name == SLOPES), None)

    @property
    def _ending(self) -> str:
        return "_derivatives" if self._slopes else ""

    @property
    def _number(self) -> str:
        return "simd" if self.lanes else self.formats.storage.c_type

    def shared(self) -> str:
        """Return the functions that all methods need."""
        return fill("c99/steps/shared.c", **self._variables)

    def rates_of_state(self) -> str:
        """Return the function that computes the rates of a state, and their derivatives if it has them."""
        return fill("c99/steps/slopes.c" if self._slopes else "c99/steps/rates.c", **self._variables)

    def change(self, method: Method) -> str:
        """Return the function that computes the change of a state in a step of a method."""
        return fill(f"c99/steps/{method.name}{self._ending}.c", **self._variables)

    def hold(self) -> str:
        """Return the functions by which rollouts hold their inputs and store states."""
        return fill("c99/steps/hold.c", **self._variables)

    def step(self, method: Method) -> str:
        """Return the body of the function that makes one step."""
        return fill(f"c99/steps/step{self._ending}.c", method=method.name, **self._variables)

    def rollout(self, one: Rollout, template: str) -> str:
        """Return a function that makes many steps, from one state or from many.

        Args:
            one: The function.
            template: "rollout" or "rollout_batch".
        """
        model = self.model.name
        return fill(
            f"c99/steps/{template}.c",
            method=one.method.name,
            prototype=one.prototype(model, self.formats),
            batch_prototype=one.batch_prototype(model, self.formats),
            row_call=one.row_call(model),
            **self._variables,
        )

    def _context(self) -> dict[str, Any]:
        """Return the variables of the templates."""
        storage = self.formats.storage
        m, n = len(self.model.coordinate_names), len(self.model.freedom_names)
        simd = SIMD.get(storage)
        inputs, width = [], 0
        for array in held(self.rates):
            inputs.append({"name": array.name, "size": array.size, "offset": width})
            width += array.size
        return {
            "own": self.model.name,
            "form": self._form,
            "lanes": self.lanes,
            "number": self._number,
            "real": storage.c_type,
            "status": "step_status" if self.lanes else "int",
            "rates": self.rates,
            "m": m,
            "n": n,
            "size": m + n,
            "held": inputs,
            "width": width,
            "has_t": self._has_time,
            "prepared": self._prepared,
            "constants": self._prepared.size if self._prepared and not self.rates.shared else 0,
            "parameters": self._parameters(),
            "call": self._call(inputs, m),
            "are_speeds": COORDINATE_RATES not in (array.name for array in self.rates.outputs),
            "quaternions": self.model.homogeneous,
            "root": "simd_sqrt" if self.lanes else storage.c_function("sqrt"),
            "literal": storage.literal,
            "zero": storage.literal(0.0),
            "all_finite": finite_test(storage),
            "not_finite": not_finite(self.model),
            "magnitude": simd.pattern(simd.sign - 1) if simd else "",
            "bits": simd.size if simd else 0,
            "rates_at": self._rates_at(width),
            "constant": (lambda text: f"simd_of({text})") if self.lanes else (lambda text: text),
            **(self._of_slopes(self._slopes, m, n) if self._slopes else {}),
        }

    def _of_slopes(self, slopes: Array, m: int, n: int) -> dict[str, Any]:
        """Return the variables of derivatives: their columns, and the call at a stage of a step."""
        columns = slopes.shape[-1]
        shared = f"{PREPARED}, " if self._prepared else ""

        def text(state: str, time: str) -> str:
            time = f"{time}, " if self._has_time else ""
            return (
                f"{self.model.name}_slopes{self._form}({shared}{state}, inputs, {time}rates, slopes, status);"
            )

        return {
            "columns": columns,
            "rate_columns": columns - n,
            "parameter_columns": columns - m - 2 * n,
            "slopes_at": text,
        }

    def _parameters(self) -> str:
        """Return the declarations of the first parameters of functions that need the rates."""
        number, shared = self._number, []
        if self._prepared:
            is_common = not self.lanes or PREPARED in self.rates.shared
            shared.append(f"const {self.formats.of(PREPARED).c_type if is_common else number} *{PREPARED}")
        time = [f"{number} t"] if self._has_time else []
        return ", ".join([*shared, f"const {number} *state", f"const {number} *inputs", *time])

    def _call(self, inputs: Sequence[dict[str, Any]], m: int) -> list[str]:
        """Return the lines of the call of the function that computes the rates."""
        places = {one["name"]: f"inputs + {one['offset']}" if one["offset"] else "inputs" for one in inputs}
        places |= {"x": "state", "y": f"state + {m}", "t": "&t"}
        places |= {COORDINATE_RATES: "rates", ACCELERATION: f"rates + {m}"}
        places |= {SLOPES: f"slopes + {m * self._slopes.shape[-1]}"} if self._slopes else {}
        arrays = (*self.rates.inputs, *self.rates.outputs)
        arguments = [places.get(array.name, array.name) for array in arrays]
        if self.lanes and self.rates.may_be_inaccurate:
            arguments.append("&accurate")
        text = f"{self.model.name}_{self.rates.name}{self._form}({f',{BREAK}'.join(arguments)});"
        if not self.lanes:
            text = f"const int found = {text}"
        elif self.rates.may_fail:
            text = f"status->exist &= {text}"
        return wrap(text)

    def _rates_at(self, width: int) -> Any:
        """Return the function that prints the call of the rates at a stage of a step."""
        shared = f"{PREPARED}, " if self._prepared else ""

        def text(state: str, place: int, time: str, rates: str) -> str:
            inputs = f"inputs + {width * place}" if place else "inputs"
            time = f"{time}, " if self._has_time else ""
            return f"{self.model.name}_rates{self._form}({shared}{state}, {inputs}, {time}{rates}, status);"

        return text
