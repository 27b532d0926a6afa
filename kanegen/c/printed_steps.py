"""The functions that follow a motion in steps as text, ready for the templates of a model's files.

Helpers that several of them call stand before the first that needs them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from kanegen.c.declarations import not_finite
from kanegen.c.functions import Code, PrintedFunction, printed_function
from kanegen.c.simd import SIMD
from kanegen.c.steps import Printer, Rollout
from kanegen.c.target import RenderInput
from kanegen.recursion.outputs import INTEGRATORS


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
class _Text:
    """The text of one file so far.

    Attributes:
        render_input: The model and its functions.
        lanes: Whether the text is for several states in SIMD lanes.
        printed: Names of helpers that are printed already.
    """

    render_input: RenderInput
    lanes: bool
    printed: set[str] = field(default_factory=set)

    def printer(self, name: str) -> Printer:
        """Return the printer of a function."""
        rates = self.render_input.rates(name)
        return Printer(self.render_input.model, self.render_input.formats, rates, self.lanes)

    def helpers(self, name: str) -> str:
        """Return the helpers that a function needs and that are not printed yet."""
        printer, method = self.printer(name), INTEGRATORS[name]
        needed = [
            ("shared", printer.shared),
            (printer.rates.name, printer.rates_of_state),
            (f"{method.name} with {printer.rates.name}", lambda: printer.change(method)),
        ]
        if name == method.functions[1]:
            needed.append(("hold", printer.hold))
        new = [(one, text) for one, text in needed if one not in self.printed]
        self.printed.update(one for one, _ in new)
        return "".join(text() for _, text in new).rstrip("\n")


def printed_steps(render_input: RenderInput) -> tuple[list[PrintedFunction], list[PrintedRollout]]:
    """Return the functions that make one step, and those that make many."""
    if not render_input.steps:
        return [], []
    model, formats = render_input.model, render_input.formats
    can = formats.arithmetic in SIMD and not formats.is_mixed
    lanes = {
        name: can and function.fits_simd and render_input.rates(name).fits_simd
        for name, function in render_input.steps.items()
    }
    one, several, scalar = (_Text(render_input, lanes=form) for form in (False, True, False))
    steps = []
    for name, function in render_input.steps.items():
        if function.name == name:
            codes = list(_step_codes(name, [one, several] if lanes[name] else [one]))
            steps.append(printed_function(render_input, function, codes[0], (*codes[1:], None)[0]))
    rollouts = [
        PrintedRollout(
            name=f"{model.name}_{rollout.name}",
            signature=rollout,
            arguments=rollout.argument_list(not_finite(model)),
            prototype=rollout.prototype(model.name, formats),
            batch_prototype=rollout.batch_prototype(model.name, formats),
            code=one.helpers(rollout.name) + _text(one, rollout, "rollout"),
            batch_code=(several.helpers(rollout.name) if lanes[rollout.name] else "")
            + _text(several if lanes[rollout.name] else scalar, rollout, "rollout_batch"),
        )
        for rollout in render_input.rollouts
    ]
    return steps, rollouts


def _step_codes(name: str, texts: list[_Text]) -> Iterator[Code]:
    """Yield the code of the function that makes one step, in each form."""
    for text in texts:
        before = text.helpers(name)
        body = text.printer(name).step(INTEGRATORS[name]).rstrip("\n").splitlines()
        yield Code(body, before=before)


def _text(text: _Text, rollout: Rollout, template: str) -> str:
    """Return the text of a function that makes many steps."""
    return text.printer(rollout.name).rollout(rollout, template).rstrip("\n")
