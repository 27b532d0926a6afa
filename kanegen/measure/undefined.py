"""States in which force elements are undefined: which elements, and which limits would avoid them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from kanegen.errors import LONGEST_MESSAGE, excerpt
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.system import System
from kanegen.reference.special_states import defined, place_of_variable
from kanegen.reference.states import States


def undefined_words(system: System, states: States, random: int) -> str:
    """Return sentences on states in which {f} is undefined; "" for none.

    Args:
        system: The tree.
        states: The random states in which both the reference and a library have no finite {f}.
        random: Number of all random states.
    """
    if not len(states):
        return ""
    parts = [
        f"{{f}} is undefined in {len(states)} of {random} random states, in the reference and in the "
        "library; it is not compared there"
    ]
    found = undefined_elements(system, states)
    if found:
        parts.append(f"Undefined there: {'; '.join(element.summary for element in found)}")
    names = _without_limits(system, found)
    if names:
        parts.append(f"Limits on {', '.join(names)} in the model would keep random states away from there")
    return excerpt(". ".join(parts), LONGEST_MESSAGE) + "."


def undefined_elements(system: System, states: States) -> Sequence[ForceElement]:
    """Return the force elements whose generalized forces are not finite in some of the states."""

    def is_undefined(element: ForceElement) -> bool:
        alone = replace(system, force_elements=(element,))
        needed = {name: values for name, values in states.inputs.items() if name != "t"}
        if alone.depends_on_time:
            needed["t"] = states.inputs["t"]
        return not defined(alone.values(), replace(states, inputs=needed)).all()

    return [one for one in system.force_elements if one.may_be_undefined and is_undefined(one)]


def _without_limits(system: System, elements: Sequence[ForceElement]) -> Sequence[str]:
    """Return names of coordinates and speeds in the expressions of some elements that have no limits."""
    limits = system.limits
    free = {
        "x": ~np.isfinite(limits.lower) & ~np.isfinite(limits.upper),
        "y": ~np.isfinite(limits.speed),
    }
    names = {"x": system.coordinate_names, "y": system.freedom_names}

    def found() -> Iterator[str]:
        for element in elements:
            for expression in element.expressions():
                for variable in expression.variables:
                    place = place_of_variable(system, variable)
                    if place and free[place[0]][place[1]]:
                        yield f"{place[0]}.{names[place[0]][place[1]]}"

    return list(dict.fromkeys(found()))
