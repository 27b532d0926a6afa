"""Errors of products with derivatives of {ydot} next to gimbal lock, against their programs in 60 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.lowering.products import Making
from kanegen.model.coordinates import FREEDOMS
from kanegen.program.evaluate import evaluate
from kanegen.program.precision import DOUBLE
from kanegen.recursion.outputs import PRODUCTS
from kanegen.reference.states import random_states
from tests.support import systems
from tests.support.cases import slow_except

DISTANCE = 1e-3
"""Distance of the middle angle from gimbal lock (rad), where a product with [A]^-1 loses three digits."""

LARGEST = 32.0
"""Largest error over the largest element, in roundoffs. In two arms, of 5 and 8 freedoms, the largest was 8,
and 116 to 6 819 by [A]^-1 of rates of angles."""

ANGLES = FREEDOMS[:3]

ARMS = {
    "on a hinge": [["theta1"], ANGLES, ["theta2"]],
    "floating": [[*ANGLES, "s1", "s2", "s3"], ["theta1"], ["theta2"]],
}


def arm(kind: str) -> kg.System:
    """Return a random chain with the freedoms of a kind."""
    rows = ARMS[kind]
    free = np.array([[name in row for name in FREEDOMS] for row in rows])
    rng = np.random.default_rng(3)
    return systems.random_system(rng, len(rows), connection=range(len(rows)), free=free)


def error(system: kg.System, name: str) -> float:
    """Return the error of a product in a state next to gimbal lock, in roundoffs."""
    program = compile_module(system, (name,)).module.functions[name]
    rng, state = np.random.default_rng(0), random_states(system, 1, 1)
    for place, one in enumerate(system.coordinates):
        if one.index == 1 and all(system.bodies[one.body - 1].joint.free[:3]):
            state.x[:, place] = np.pi / 2 - DISTANCE
    width = PRODUCTS[name].width(system)
    sizes = {"tau": len(system.freedoms), "weights": len(system.freedoms), "direction": width}
    values = {"x": state.x[0], "y": state.y[0], **{one: rng.normal(size=n) for one, n in sizes.items()}}
    given = {array.name: values.get(array.name, np.zeros(array.size)) for array in program.inputs}
    digits = mpmath.MPContext()
    digits.dps = 60
    numbers = {one: [digits.mpf(float(v)) for v in row] for one, row in given.items()}
    (found,) = evaluate(program, {one: list(row) for one, row in given.items()}, np).values()
    (exact,) = evaluate(program, numbers, digits, digits.mpf).values()
    wrong = max(abs(one - other) for one, other in zip(found, exact, strict=True))
    return float(wrong / max(map(abs, exact))) / DOUBLE.roundoff


CASES = [(kind, ending) for kind in ARMS for ending in ("jvp", "vjp", "hvp")]


@pytest.mark.parametrize("case", slow_except(CASES, ("on a hinge", "vjp")))
def test_products_keep_the_digits_of_accelerations(
    case: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In components of the angular velocity; by rates of angles the same products lose digits."""
    kind, ending = case
    system, name = arm(kind), f"forward_dynamics_{ending}"
    kept = error(system, name)
    assert kept <= LARGEST
    monkeypatch.setattr(Making, "_ways", lambda self: ["solved"])
    assert error(system, name) > kept
