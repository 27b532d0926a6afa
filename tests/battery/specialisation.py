"""Code made for numbers against code that reads them: X29."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kanegen.measure.truth import truth
from kanegen.reference.states import random_states
from kanegen.studies.explain.general_form import with_numbers_as_parameters
from tests.battery import scenes
from tests.battery.measuring import PRECISIONS, built, promise, rounded, worst
from tests.battery.rows import Point, Row, Size, subject


@subject("X29", "Zeros that the code knows, and zeros that it reads")
def specialisation(size: Size) -> Iterator[Row]:
    """What is left out because a number is zero must be what the general code adds as nothing."""
    straight, crooked = scenes.planar([1.0, 2.0, 0.5]), scenes.mixed(3)
    for precision in PRECISIONS:
        for name, system in (("many zeros", straight), ("no zeros", crooked)):
            states = random_states(system, size.pick(4, 64), 29).rounded(precision)
            special = built(system, precision).forward_dynamics(states.x, states.y)
            general = built(with_numbers_as_parameters(system), precision).forward_dynamics(
                states.x, states.y
            )
            found: list[Point] = []
            for x, y, one, other in zip(states.x, states.y, special, general, strict=True):
                exact = truth(system, x, y, unit_roundoff=precision.roundoff)
                scale = exact.units.of("forward_dynamics")
                difference = np.linalg.norm((rounded(one, precision) - other) * scale)
                whole = np.linalg.norm(exact["forward_dynamics"].value * scale)
                found.append(Point(0.0, float(difference / whole), 2 * promise(exact, precision)))
            yield worst(f"{name}, {precision.name}", found, "2 T(u)", f"{len(found)} states; 3 bodies")
