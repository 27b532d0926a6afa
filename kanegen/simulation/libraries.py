"""Libraries for simulations of a system, with the outputs and in the precisions that they need."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kanegen.compiler import build
from kanegen.errors import OptionError
from kanegen.library import Library
from kanegen.linear.names import names_of
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, Variant, quiet
from kanegen.recursion.outputs import OUTPUTS, available
from kanegen.recursion.outputs.integrators import ROLLOUT, available_methods
from kanegen.simulation.arguments import OF_DRIFTS
from kanegen.simulation.compiled_steps import IN_C
from kanegen.simulation.events import Event, conditions
from kanegen.simulation.signals import outputs_in

MANY, LOOSE = 8, 1e-5
"""Number of states from which on single precision may pay, and the error from which on it may do."""


def library_for(
    system: System,
    events: Sequence[Event | str] = (),
    outputs: Iterable[str] | str | None = None,
    method: str | None = None,
    tier: Variant | str = STRICT,
    progress: Progress = quiet,
) -> Library:
    """Build a library with all outputs that a simulation of a system needs.

    Args:
        system: The tree.
        events: Events, whose conditions may name outputs.
        outputs: Outputs that are wanted over the time, beside energies and momentum.
        method: Name of a method, whose steps then run in C if there are such.
        tier: Variant of the code, as for `kg.build`.
        progress: Function that is called with the name of each stage.

    Raises:
        OptionError: If there is no system, or no output of a name.
        SingularError: If [A] is singular in every state.
        BuildError: As `kg.build`.

    Example:
        library = library_for(system, ["kinetic_energy > 1"])
    """
    if not isinstance(system, System):
        raise OptionError(
            f'{system!r} is no system and no library. Make one with kg.build(system, ("forward_dynamics",)).'
        )
    can = available(system)
    asked = () if outputs is None else names_of("outputs", outputs)
    rates = () if system.speeds_are_rates else ("coordinate_rates",)
    efforts = [name for name in ("prescribed_efforts",) if name in can]
    named = outputs_in(conditions(events), tuple(OUTPUTS))
    can_step = available_methods(system)
    steps = [f"{ROLLOUT}{one}" for name, one in IN_C.items() if name == method and one in can_step]
    wanted = dict.fromkeys(("forward_dynamics", *rates, *efforts, *OF_DRIFTS, *asked, *named, *steps))
    return build(system, tuple(wanted), tier=tier, progress=progress)


class Precisions:
    """Libraries of a system in several precisions, each built when it is first needed."""

    def __init__(
        self,
        library: Library,
        system: System | None,
        events: Sequence[Event | str],
        outputs: Iterable[str] | str | None,
    ) -> None:
        """Begin with the library at hand, which is the only one where the system is not given."""
        self._known = {library.storage: library}
        self._system, self._events, self._outputs = system, events, outputs

    def names(self, states: int, error: float) -> tuple[str, ...]:
        """Return the precisions that can be had, the cheapest first.

        Single precision pays where an instruction of C holds several states.
        """
        if self._system is None:
            return tuple(self._known)
        pays = states >= MANY and error >= LOOSE
        return (*(("float",) if pays else ()), "double", "long double")

    def __getitem__(self, precision: str) -> Library:
        """Return the library in a precision."""
        if precision not in self._known and self._system is not None:
            tier = Variant(precision=precision)
            self._known[precision] = library_for(self._system, self._events, self._outputs, "RK4", tier)
        return self._known[precision]
