"""The text of functions that follow a motion in steps, in C.

A method is a template of a function that computes the change of a state; it is filled twice, for one state
and for several in SIMD lanes. What methods share, such as the addition to the state, is a template, too, and
stands in a file where something calls it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kanegen.c.declarations import not_converged, not_finite
from kanegen.c.description import ModelDescription
from kanegen.c.dialect import finite_test
from kanegen.c.formats import Formats
from kanegen.c.interface import Function
from kanegen.c.layout import BREAK, wrap
from kanegen.c.simd import SIMD
from kanegen.c.steps import COORDINATE_SLOPES, SLOPES, Rollout, arrays_of_rates, held
from kanegen.c.templates import fill
from kanegen.program.ir import PREPARED, Array
from kanegen.recursion.outputs import INTEGRATORS, METHODS, differentiates

HELPERS = {
    "note": ("{}_note(", "step_status"),
    "rates": ("{}_rates",),
    "slopes": ("{}_slopes", "{}_moved", "{}_chain"),
    "elimination": ("{}_eliminate", "{}_substitute"),
    "larger": ("{}_larger", "{}_select"),
    "advance": ("{}_advance",),
    "hold": ("{}_hold", "{}_store"),
}
"""Templates of functions that steps and rollouts call, each behind those that it calls, and what is in a text
that needs them; {} is the name of the model."""


def change_name(name: str) -> str:
    """Return the name of the template that computes the change of a state, for one of `INTEGRATORS`."""
    return f"{INTEGRATORS[name].name}{'_derivatives' if differentiates(name) else ''}"


@dataclass(frozen=True)
class StepPrinter:
    """The text of functions that follow a motion, for one state or for several in lanes.

    Attributes:
        model: Names and sizes of the model.
        formats: Precisions of arrays and arithmetic.
        functions: The functions of which steps are composed, and others, by name.
        lanes: Whether the text is for several states in SIMD lanes.
    """

    model: ModelDescription
    formats: Formats
    functions: Mapping[str, Function]
    lanes: bool
    _variables: dict[str, Any] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Compute the variables of the templates."""
        object.__setattr__(self, "_variables", self._context())

    def helpers(self, text: str) -> list[str]:
        """Return the names of the helpers that a text calls, also by way of other helpers, in order."""
        needed: list[str] = []
        for name, marks in reversed(HELPERS.items()):
            if any(mark.format(self.model.name) in text for mark in marks):
                needed.insert(0, name)
                text += self.helper(name)
        return needed

    def helper(self, name: str) -> str:
        """Return the text of a helper."""
        return fill(f"c99/steps/{name}.c", **self._variables)

    def change(self, name: str) -> str:
        """Return the function that computes the change of a state in a step, for one of `INTEGRATORS`."""
        return fill(f"c99/steps/{change_name(name)}.c", **self._variables)

    def step(self, function: Function) -> str:
        """Return the body of the function that makes one step."""
        template = "step_derivatives" if differentiates(function.name) else "step"
        method = INTEGRATORS[function.name].name
        return fill(f"c99/steps/{template}.c", method=method, step=function, **self._variables)

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

    @property
    def _form(self) -> str:
        return "_simd" if self.lanes else ""

    @property
    def _number(self) -> str:
        return "simd" if self.lanes else self.formats.storage.c_type

    @property
    def _rates(self) -> Function:
        """The function that computes the rates of a state, or one that computes their derivatives, too."""
        found = self._with_arrays(METHODS["rk4"].functions[0]) or self._slopes
        if found is None:
            raise LookupError("no function computes the rates of a state")
        return found

    @property
    def _slopes(self) -> Function | None:
        return self._with_arrays(METHODS["rk4"].derivatives)

    def _with_arrays(self, name: str) -> Function | None:
        """Return the function of rates for one of `INTEGRATORS`, None if it is not printed."""
        needed = arrays_of_rates(name, self.model.speeds_are_rates)
        every = self.functions.values()
        return next((one for one in every if needed == {array.name for array in one.outputs}), None)

    @property
    def _has_time(self) -> bool:
        return any(array.name == "t" for array in self._rates.inputs)

    @property
    def _prepared(self) -> Array | None:
        return next((array for array in self._rates.inputs if array.name == PREPARED), None)

    def _context(self) -> dict[str, Any]:
        """Return the variables of the templates."""
        storage, simd = self.formats.storage, SIMD.get(self.formats.storage)
        m, n = len(self.model.coordinate_names), len(self.model.freedom_names)
        places = self._places()
        variables = {
            "own": self.model.name,
            "form": self._form,
            "lanes": self.lanes,
            "number": self._number,
            "real": storage.c_type,
            "status": "step_status" if self.lanes else "int",
            "rates": self._rates,
            "m": m,
            "n": n,
            "size": m + n,
            "held": [
                {"name": name, "size": size, "offset": offset} for name, (offset, size) in places.items()
            ],
            "width": sum(size for _, size in places.values()),
            "has_t": self._has_time,
            "prepared": self._prepared,
            "constants": self._prepared.size if self._prepared and not self._rates.shared else 0,
            "parameters": self._parameters(),
            "are_speeds": self.model.speeds_are_rates,
            "quaternions": self.model.homogeneous,
            "slopes": self._row("inverse_dynamics_derivatives"),
            "turns": self._row("coordinate_rates_derivatives"),
            "root": "simd_sqrt" if self.lanes else storage.c_function("sqrt"),
            "absolute": "simd_fabs" if self.lanes else storage.c_function("fabs"),
            "literal": storage.literal,
            "broadcast": self._broadcast,
            "zero": storage.literal(0.0),
            "root_u": storage.literal(math.sqrt(2.0 * storage.roundoff)),
            "all_finite": finite_test(storage),
            "not_finite": not_finite(self.model),
            "not_converged": not_converged(self.model),
            "magnitude": simd.pattern(simd.sign - 1) if simd else "",
            "bits": simd.size if simd else 0,
            "call": self._call,
            "rates_at": self._rates_at,
            **self._of_slopes(m, n),
        }
        return {**variables, "v": variables}

    def _of_slopes(self, m: int, n: int) -> dict[str, Any]:
        """Return the variables of derivatives: their columns, and the call at a stage of a step."""
        if self._slopes is None:
            return {}
        columns = next(array.row for array in self._slopes.outputs if array.name == SLOPES)
        return {
            "sloping": self._slopes,
            "columns": columns,
            "rate_columns": columns - n,
            "parameter_columns": columns - m - 2 * n,
            "arrays_of_slopes": {
                "x": "state",
                "y": f"state + {m}",
                "t": "&t",
                "xdot": "rates",
                "acceleration": f"rates + {m}",
                SLOPES: f"slopes + {m * columns}",
                COORDINATE_SLOPES: COORDINATE_SLOPES,
            },
            "slopes_at": self._slopes_at,
        }

    def _slopes_at(self, state: str, time: str, rates: str = "rates", status: str = "status") -> str:
        """Return the call of the rates of a state and their derivatives, which are filled into `slopes`.

        Args:
            state: The state.
            time: Expression of the time.
            rates: The array to fill with rates.
            status: Pointer to the status.
        """
        arguments = [PREPARED] * bool(self._prepared) + [state, "inputs"] + [time] * self._has_time
        arguments += [rates, "slopes", status]
        return f"{self.model.name}_slopes{self._form}({', '.join(arguments)});"

    def _places(self) -> dict[str, tuple[int, int]]:
        """Return offset and size of each input that is held, among all of them in one row."""
        found, width = {}, 0
        for array in held(self._rates):
            found[array.name] = width, array.size
            width += array.size
        return found

    def _row(self, name: str) -> int:
        """Return the length of a row of an output that is a matrix; 0 if it is not there."""
        return self.functions[name].outputs[0].row if name in self.functions else 0

    def _broadcast(self, number: float) -> str:
        """Return a number as one of the type of a state."""
        text = self.formats.storage.literal(number)
        return f"simd_of({text})" if self.lanes else text

    def _parameters(self) -> str:
        """Return the declarations of the first parameters of functions that compute changes."""
        number, shared = self._number, []
        if self._prepared:
            is_common = not self.lanes or PREPARED in self._rates.shared
            shared.append(f"const {self.formats.of(PREPARED).c_type if is_common else number} *{PREPARED}")
        time = [f"{number} t"] if self._has_time else []
        return ", ".join([*shared, f"const {number} *state", f"const {number} *inputs", *time])

    def _call(
        self, name: str, inputs: str = "inputs", status: str = "status", indent: int = 4, **arrays: str
    ) -> str:
        """Return the statement that calls a function and keeps its status.

        Args:
            name: Name of the function.
            inputs: Row of the inputs from outside.
            status: Name of the pointer to the status, or of a status in lanes that is no pointer.
            indent: Columns before the statement.
            arrays: Expressions of the other arrays by name.
        """
        function, offsets = self.functions[name], self._places()
        arguments = []
        for array in (*function.inputs, *function.outputs):
            offset = offsets.get(array.name, (0, 0))[0]
            inside = f"{inputs} + {offset}" if offset else inputs
            arguments.append(inside if array.name in offsets else arrays.get(array.name, array.name))
        is_uncertain = self.lanes and bool(function.may_be_inaccurate)
        arguments += ["&accurate"] if is_uncertain else []
        text = f"{self.model.name}_{name}{self._form}({f',{BREAK}'.join(arguments)})"
        before = f"{status}->" if status == "status" else f"{status}."
        if not self.lanes:
            text = f"{self.model.name}_note({text}, {status});"
        else:
            text = f"{before}exist &= {text};" if function.may_fail else f"{text};"
        if not is_uncertain:
            return "\n".join(wrap(text, " " * indent, " " * (indent + 4)))
        deeper = " " * (indent + 4)
        lines = [f"{deeper}simd_bits accurate;", *wrap(text, deeper, deeper + "    ")]
        lines.append(f"{deeper}{before}accurate &= accurate;")
        return "\n".join([f"{' ' * indent}{{", *lines, f"{' ' * indent}}}"])

    def _rates_at(self, state: str, place: int, time: str, rates: str, status: str = "status") -> str:
        """Return the call of the rates of a state.

        Args:
            state: The state.
            place: The place of the inputs: 0 at the start of the step, 1 in its middle, 2 at its end.
            time: Expression of the time.
            rates: The array to fill.
            status: Pointer to the status.
        """
        width = sum(size for _, size in self._places().values())
        inputs = f"inputs + {width * place}" if place else "inputs"
        arguments = [PREPARED] * bool(self._prepared) + [state, inputs] + [time] * self._has_time
        return f"{self.model.name}_rates{self._form}({', '.join([*arguments, rates, status])});"
