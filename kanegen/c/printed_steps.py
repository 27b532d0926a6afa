"""The functions that follow a motion in steps as text, ready for the templates of a model's files.

Helpers that several of them call stand before the first that needs them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from kanegen.c.functions import Code, PrintedFunction, printed_function
from kanegen.c.interface import Function
from kanegen.c.simd import SIMD
from kanegen.c.step_printer import StepPrinter, change_name
from kanegen.c.steps import Rollout, composed
from kanegen.c.target import RenderInput


@dataclass(frozen=True)
class PrintedRollout:
    """A function that makes many steps, and its batch form, as text.

    Attributes:
        name: Name with the prefix of the model.
        signature: The function.
        arguments: Documentation of the arguments.
        prototype: Prototype of the form for one state.
        batch_prototype: Prototype of the batch form.
        code: The form for one state, behind helpers that it is the first to need.
        batch_code: The same of the batch form.
    """

    name: str
    signature: Rollout
    arguments: list[str]
    prototype: list[str]
    batch_prototype: list[str]
    code: str
    batch_code: str


@dataclass
class _File:
    """The steps in one file of a model.

    Attributes:
        printer: Printer of the form for one state, or of that in lanes.
        printed: Names of helpers and methods that are printed already.
    """

    printer: StepPrinter
    printed: set[str] = field(default_factory=set)

    def before(self, name: str, text: str) -> str:
        """Return the helpers that the text of a function calls and that are not printed yet.

        Args:
            name: Name of the function, one of `INTEGRATORS`.
            text: The text.
        """
        change = self.printer.change(name)
        helpers = {one: self.printer.helper(one) for one in self.printer.helpers(text + change)}
        parts = {**helpers, change_name(name): change}
        if "hold" in parts:
            parts["hold"] = parts.pop("hold")
        new = [one for one in parts if one not in self.printed]
        self.printed.update(new)
        return "".join(parts[one] for one in new).rstrip("\n")


def printed_steps(render_input: RenderInput) -> tuple[list[PrintedFunction], list[PrintedRollout]]:
    """Return the functions that make one step, and those that make many."""
    if not render_input.steps:
        return [], []
    functions = {function.name: function for function in render_input.programs}
    formats, model = render_input.formats, render_input.model
    can = render_input.batches and formats.arithmetic in SIMD and not formats.is_mixed
    in_lanes = [one.function for one in render_input.batch_programs.values()]
    lanes = {
        name: can and all(one.fits_simd for one in (step, *composed(name, in_lanes, model.speeds_are_rates)))
        for name, step in render_input.steps.items()
    }
    single, batch, scalar = (
        _File(StepPrinter(model, formats, functions, has_lanes)) for has_lanes in (False, can, False)
    )
    steps = []
    for name, function in render_input.steps.items():
        if function.name == name:
            one, several = _step(single, function), _step(batch, function) if lanes[name] else None
            steps.append(printed_function(render_input, function, one, several))
    rollouts = [
        PrintedRollout(
            name=f"{model.name}_{rollout.name}",
            signature=rollout,
            arguments=rollout.argument_list(model),
            prototype=rollout.prototype(model.name, formats),
            batch_prototype=rollout.batch_prototype(model.name, formats),
            code=_rollout(single, rollout, "rollout"),
            batch_code=_rollout(batch if lanes[rollout.name] else scalar, rollout, "rollout_batch"),
        )
        for rollout in render_input.rollouts
    ]
    return steps, rollouts


def _step(file: _File, function: Function) -> Code:
    """Return the code of the function that makes one step."""
    body = file.printer.step(function)
    return Code(body.rstrip("\n").splitlines(), before=file.before(function.name, body))


def _rollout(file: _File, rollout: Rollout, template: str) -> str:
    """Return the text of a function that makes many steps, behind helpers that it is the first to need."""
    text = file.printer.rollout(rollout, template).rstrip("\n")
    needs_helpers = template == "rollout" or file.printer.lanes
    return (file.before(rollout.name, text) if needs_helpers else "") + "\n" + text.lstrip("\n")
