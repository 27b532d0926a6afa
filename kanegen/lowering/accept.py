"""Acceptance: the checks that a system has the outputs, and that those which solve its equations exist."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from kanegen.choices import require_one
from kanegen.errors import OptionError
from kanegen.lowering.compilation import Request
from kanegen.model.coordinates import ORIENTATIONS, SPEEDS
from kanegen.model.description import require_system
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program.precision import storage_precision
from kanegen.program.triangle import FORMS, FULL
from kanegen.recursion.outputs import (
    INTEGRATORS,
    OUTPUTS,
    available,
    chosen,
    composed_of,
    holding,
    require_available,
    require_steps,
    solving,
)
from kanegen.reference.independence import require_independent
from kanegen.reference.range import require_range
from kanegen.reference.regularity import require_regular


def accept(
    system: System,
    outputs: Iterable[str],
    variant: Variant,
    *,
    regular: bool = True,
    mass_matrix: str = FULL,
) -> Request:
    """Return the checked request for `outputs` of a system.

    Args:
        system: The tree of bodies.
        outputs: Names among `OUTPUTS` and `INTEGRATORS`.
        variant: The choices between speed and accuracy.
        regular: Whether to refuse outputs that solve with [A], if [A] is singular in every state.
        mass_matrix: Form in which functions fill [A], one of `triangle.FORMS`.

    Raises:
        OptionError: If `system` is no `System`, an output is unknown or requires parts that the system
            lacks, or there is no such form, or no output that could have it.
        ModelError: If numbers of the model leave the range of doubles; the message names the body.
        SingularError: If an output solves with [A], and [A] is singular in every state, or one needs loads of
            contacts that depend on each other in every state; the message names the
            bodies, the freedoms and the outputs that remain.
    """
    asked = chosen(outputs, INTEGRATORS)
    require_system(system)
    integrators = tuple(name for name in asked if name in INTEGRATORS)
    require_steps(system, integrators, storage_precision(variant.precision, variant.storage).name)
    needed = (*asked, *composed_of(system, integrators))
    names = tuple(name for name in OUTPUTS if name in needed)
    _require_form(mass_matrix, names, integrators)
    require_range(system)
    require_available(system, names)
    if undefined := solving(names) if regular else ():
        every = available(system)
        require_regular(system, undefined, [name for name in every if not solving([name])])
    if loaded := holding(names) if regular else ():
        require_independent(system, loaded)
    return Request(system, names, variant, integrators, mass_matrix)


def _require_form(form: str, names: Collection[str], integrators: Iterable[str]) -> None:
    """Check that there is such a form of [A], and that the functions which are asked for allow it."""
    require_one("mass_matrix", form, FORMS)
    if form == FULL:
        return
    if "mass_matrix" not in names:
        raise OptionError(
            f'mass_matrix: the form "{form}" is for the output mass_matrix, which is not among the outputs. '
            "Add it, or leave out the form."
        )
    for name in integrators:
        if "mass_matrix" in INTEGRATORS[name].called:
            raise OptionError(
                f'mass_matrix: {name} reads the whole matrix, so the form "{form}" is not possible beside '
                "it. Generate it by itself, or leave out the form."
            )


def reformulated(system: System, speeds: str | None = None, coordinates: str | None = None) -> System:
    """Return the same tree with other generalized speeds and coordinates, where they are not None.

    Args:
        system: The tree of bodies.
        speeds: Name of generalized speeds, as for `System.with_speeds`.
        coordinates: Name of coordinates of orientations, as for `System.with_coordinates`.

    Raises:
        OptionError: If the speeds or coordinates are unknown, or do not go together.
    """
    require_system(system)
    for label, asked, known in (("speeds", speeds, SPEEDS), ("coordinates", coordinates, ORIENTATIONS)):
        if asked is not None:
            require_one(label, asked, known)
    if speeds == SPEEDS[0] and coordinates in ORIENTATIONS[1:]:
        raise OptionError(
            f'speeds "{speeds}" are for angles, and coordinates "{coordinates}" leave none. Leave out one.'
        )
    if coordinates is not None:
        system = system.with_coordinates(coordinates)
    return system if speeds is None else system.with_speeds(speeds)
