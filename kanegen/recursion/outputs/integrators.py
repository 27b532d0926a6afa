"""The table of methods that follow a motion in steps of fixed length, and the names of their functions.

Each method has two functions in C: `step_<method>` makes one step, and `rollout_<method>` makes many and
stores states on the way. `step_<method>_derivatives` makes a step and differentiates it. They are composed of
the functions of outputs, so nothing is derived for them; a user names them among the outputs, which then
include what they are composed of.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from kanegen.errors import OptionError, quoted
from kanegen.model.system import System
from kanegen.program.ir import STATE_RATES, STATE_RATES_DERIVATIVES
from kanegen.recursion.outputs.table import OUTPUTS

STEP = "step_"
"""Beginning of the name of a function that makes one step."""

ROLLOUT = "rollout_"
"""Beginning of the name of a function that makes many steps."""

RATES = ("forward_dynamics", "coordinate_rates")
"""Outputs that give {ydot} and {xdot}; the second is needed where speeds are no rates of coordinates."""


RATES_DERIVATIVES = (*RATES[:1], f"{RATES[0]}_derivatives", *RATES[1:], f"{RATES[1]}_derivatives")
"""Outputs that give rates and their derivatives; the last two where speeds are no rates of coordinates."""


@dataclass(frozen=True)
class Method:
    """A method that follows a motion in steps of fixed length.

    Attributes:
        name: Its name in C and Python, such as "rk4".
        title: Its name in a sentence, such as "the explicit Euler method".
        order: Order of the error of a motion over a fixed time.
        evaluations: Evaluations of {ydot} in a step, in words.
        has_derivatives: Whether there is a function that differentiates a step.
    """

    name: str
    title: str
    order: int
    evaluations: str
    has_derivatives: bool = False

    @property
    def functions(self) -> tuple[str, str]:
        """Names of its functions, that of one step first."""
        return STEP + self.name, ROLLOUT + self.name

    @property
    def derivatives(self) -> str:
        """Name of the function that makes a step and differentiates it."""
        return f"{STEP}{self.name}_derivatives"

    @property
    def every_function(self) -> tuple[str, ...]:
        """Names of all functions that there are."""
        return (*self.functions, self.derivatives) if self.has_derivatives else self.functions


METHODS = {
    method.name: method
    for method in (
        Method("rk4", "the classical Runge-Kutta method", 4, "four evaluations of the rates", True),
    )
}
"""The methods by name, in the order of the generated C."""

INTEGRATORS = {name: method for method in METHODS.values() for name in method.every_function}
"""The method of every function that follows a motion, by the name of the function."""


def differentiates(name: str) -> bool:
    """Return whether a function of `INTEGRATORS` differentiates a step."""
    return name == INTEGRATORS[name].derivatives


def together(system: System, integrators: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Return the outputs that functions which follow a motion need together, by name of their function in C.

    Args:
        system: The tree.
        integrators: Names of `INTEGRATORS`.
    """
    both, kinds = not system.speeds_are_rates, {differentiates(name) for name in integrators}
    found: dict[str, tuple[str, ...]] = {}
    if False in kinds:
        found[STATE_RATES] = RATES if both else RATES[:1]
    if True in kinds:
        found[STATE_RATES_DERIVATIVES] = RATES_DERIVATIVES if both else RATES_DERIVATIVES[:2]
    return {name: tuple(one for one in OUTPUTS if one in group) for name, group in found.items()}


def composed_of(system: System, integrators: Iterable[str]) -> tuple[str, ...]:
    """Return the outputs of which functions that follow a motion are composed, in the order of `OUTPUTS`.

    Args:
        system: The tree.
        integrators: Names of `INTEGRATORS`.
    """
    needed = {name for group in together(system, integrators).values() for name in group}
    return tuple(name for name in OUTPUTS if name in needed)


def require_steps(system: System, integrators: Iterable[str], storage: str) -> None:
    """Make sure that functions can follow the motion of a system.

    Args:
        system: The tree.
        integrators: Names of `INTEGRATORS`.
        storage: Name of the precision of the arrays.

    Raises:
        OptionError: If the system has contacts or prescribed freedoms, or the arrays hold pairs of doubles.
    """
    for name in integrators:
        if storage == "double-double":
            raise OptionError(
                f"output {name!r}: there are no steps of double-double states. Take storage 'double'."
            )
        if system.contacts:
            raise OptionError(
                f"output {name!r}: system {quoted(system.name)} has contacts, which steps do not hold. Leave "
                "them out by System.with_contacts([])."
            )
        if system.prescribed:
            raise OptionError(
                f"output {name!r}: system {quoted(system.name)} has prescribed freedoms, whose motion within "
                "a step is not known. Take kg.simulate, which asks for it."
            )
