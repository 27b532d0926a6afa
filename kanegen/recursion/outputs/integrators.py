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
        cost: What a step costs, in words.
        needs: Outputs that its steps call by themselves, beside the function of all rates of a state.
        needs_further: Outputs that they call beside these where speeds are no rates of coordinates; None if
            the method is for speeds that are rates.
        condition: Quantity whose sign and size the method tests beside those of its outputs, and what it
            means that it is not positive; "" where there is none.
        cost_with_derivatives: What a step costs that is differentiated, in words; "" where there is none.
        is_iterative: Whether a step is found by an iteration, which need not converge where the step is long.
    """

    name: str
    title: str
    order: int
    cost: str
    needs: tuple[str, ...] = ()
    needs_further: tuple[str, ...] | None = ()
    condition: tuple[str, str] = ("", "")
    cost_with_derivatives: str = ""
    is_iterative: bool = False

    @property
    def takes_prescribed(self) -> bool:
        """Whether freedoms may be prescribed; the momenta of the variational rule do not contain theirs."""
        return "mass_matrix_inverse" not in self.needs

    @property
    def functions(self) -> tuple[str, str]:
        """Names of its functions, that of one step first."""
        return STEP + self.name, ROLLOUT + self.name

    @property
    def has_derivatives(self) -> bool:
        """Whether there is a function that differentiates a step."""
        return bool(self.cost_with_derivatives)

    @property
    def derivatives(self) -> str:
        """Name of the function that makes a step and differentiates it."""
        return f"{STEP}{self.name}_derivatives"

    @property
    def every_function(self) -> tuple[str, ...]:
        """Names of all functions that there are."""
        return (*self.functions, self.derivatives) if self.has_derivatives else self.functions

    @property
    def called(self) -> tuple[str, ...]:
        """Outputs that its steps may call by themselves, in any system."""
        return (*self.needs, *(self.needs_further or ()))


METHODS = {
    method.name: method
    for method in (
        Method(
            "euler",
            "the explicit Euler method",
            1,
            "one evaluation of the rates",
            cost_with_derivatives="one evaluation of rates and derivatives",
        ),
        Method(
            "semi_implicit_euler",
            "the semi-implicit Euler method, speeds first,",
            1,
            "one evaluation of {ydot} and one of {xdot}",
            RATES[:1],
            RATES[1:],
            cost_with_derivatives="one evaluation of rates and derivatives, two if {xdot} is not {y}",
        ),
        Method(
            "rk4",
            "the classical Runge-Kutta method",
            4,
            "four evaluations of the rates",
            cost_with_derivatives="four evaluations of rates and derivatives",
        ),
        Method(
            "implicit_midpoint",
            "the implicit midpoint rule",
            2,
            "as many evaluations of the rates as a fixed-point iteration takes, about seven",
            cost_with_derivatives="about five evaluations of rates and derivatives, by Newton's method",
            is_iterative=True,
        ),
        Method(
            "variational_midpoint",
            "the variational midpoint rule, which is symplectic and keeps momenta,",
            2,
            "an iteration as long as that of the implicit midpoint rule, with [C], {f} and [A]^-1",
            ("mass_matrix", "forcing", "coriolis_matrix", "forward_dynamics", "mass_matrix_inverse"),
            None,
            is_iterative=True,
        ),
        Method(
            "linearly_implicit",
            "the Rosenbrock method ROS2, which is L-stable,",
            2,
            "two evaluations of {ydot} and one of the derivatives of {f}",
            ("mass_matrix", "inverse_dynamics_derivatives"),
            ("coordinate_rates_derivatives",),
            ("pivot of the matrix of the step", "the step is too long for the method"),
        ),
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
    names = tuple(integrators)
    needed = {name for group in together(system, names).values() for name in group}
    for method in (INTEGRATORS[name] for name in names if not differentiates(name)):
        needed.update(method.needs if system.speeds_are_rates else method.called)
    return tuple(name for name in OUTPUTS if name in needed)


def available_methods(system: System) -> tuple[str, ...]:
    """Return the names of the methods that a system has, unless its [A] is singular."""
    if system.contacts:
        return ()
    every = [one for one in METHODS.values() if one.takes_prescribed or not system.prescribed]
    return tuple(one.name for one in every if system.speeds_are_rates or one.needs_further is not None)


def require_steps(system: System, integrators: Iterable[str], storage: str) -> None:
    """Make sure that functions can follow the motion of a system.

    Args:
        system: The tree.
        integrators: Names of `INTEGRATORS`.
        storage: Name of the precision of the arrays.

    Raises:
        OptionError: If the system has contacts, or prescribed freedoms or speeds that the function does not
            take, or the arrays hold pairs of doubles.
    """
    for name in integrators:
        if storage == "double-double":
            raise OptionError(
                f"output {name!r}: there are no steps of double-double states. Take storage 'double'."
            )
        if system.contacts:
            raise OptionError(
                f"output {name!r}: system {quoted(system.name)} has contacts, which steps do not hold: "
                "contact_dynamics holds accelerations, and states that follow from them drift off. Integrate "
                "contact_dynamics and correct the states, or leave contacts out by System.with_contacts([])."
            )
        if INTEGRATORS[name].needs_further is None and not system.speeds_are_rates:
            raise OptionError(
                f"output {name!r}: its method is for speeds that are rates of coordinates, and system "
                f"{quoted(system.name)} has others. Take implicit_midpoint, or angles with their rates by "
                'coordinates="angles" and speeds="angle_rates".'
            )
        if system.prescribed and not name.startswith(ROLLOUT):
            raise OptionError(
                f"output {name!r}: system {quoted(system.name)} has prescribed freedoms, whose motion within "
                f"a step is not known. Take {INTEGRATORS[name].functions[1]}, which has rows for it."
            )
        if system.prescribed and not INTEGRATORS[name].takes_prescribed:
            raise OptionError(
                f"output {name!r}: system {quoted(system.name)} has prescribed freedoms, whose momenta its "
                "method does not know. Take rollout_implicit_midpoint."
            )
