"""Comparison of the specialised program of a system with the general program of its tree."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.numbers import map_numbers, value_of
from kanegen.program.evaluate import evaluate
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import (
    element_magnitude,
    forcing_magnitude,
    mass_matrix_magnitude,
    path_maxima,
    rounding_bound,
)
from kanegen.reference.states import random_states
from kanegen.studies.explain.general_form import steps

Results = tuple[np.ndarray, np.ndarray]
"""[A] (n, n) and {f} (n,)."""


def compiled(system: kg.System) -> Callable[[dict[str, np.ndarray]], Results]:
    """Return a function of the inputs that evaluates [A] and {f} by the program that becomes C."""
    module = compile_module(system).module
    function, n = module.functions["evaluate"], len(system.freedoms)
    known = {name: np.zeros(3 * system.number_of_bodies) for name in ("force", "torque")}
    if module.prepare is not None:
        parameters = [parameter.value for parameter in system.parameters]
        known["prepared"] = evaluate(module.prepare, {"parameters": parameters}, np)["prepared"]

    def run(inputs: dict[str, np.ndarray]) -> Results:
        values = known | {name: np.ravel(value) for name, value in inputs.items()}
        found = evaluate(function, {array.name: values[array.name] for array in function.inputs}, np)
        return np.array(found["A"], float).reshape(n, n), np.array(found["f"], float)

    return run


def require_equal(system: kg.System, *seeds: int) -> None:
    """Compare both programs at the locked state, up to rounding; loads act on the bodies that take them."""
    (_, general), *_ = steps(system)
    general_results, special_results = compiled(general), compiled(system)
    for seed in seeds:
        sample = random_states(system, 1, seed)
        inputs = {"x": sample.x[0], "y": sample.y[0]}
        if sample.force is not None and sample.torque is not None:
            inputs |= {"force": sample.force[0], "torque": sample.torque[0]}
        further = {name: rows[0] for name, rows in sample.inputs.items()}
        inputs |= further
        free = [general.places[freedom] for freedom in system.freedoms]
        matrix, forcing = general_results(inputs | at_locked_state(system, general, inputs))
        expected = matrix[np.ix_(free, free)], forcing[free]
        bounds = limits(system, inputs, further)
        for value, other, limit in zip(special_results(inputs), expected, bounds, strict=True):
            assert (np.abs(value - other) <= limit).all()


def at_locked_state(
    system: kg.System, general: kg.System, inputs: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return the general system's state with the locked values at the freedoms that `system` locks."""
    x, y = np.zeros(len(general.coordinates)), np.zeros(len(general.freedoms))
    for coordinate, place in general.coordinate_places.items():
        locked = map_numbers(system.bodies[coordinate.body - 1].joint.locked, value_of)
        known = system.coordinate_places.get(coordinate)
        x[place] = locked[coordinate.index] if known is None else inputs["x"][known]
    y[[general.places[freedom] for freedom in system.freedoms]] = inputs["y"]
    return {"x": x, "y": y}


def limits(system: kg.System, inputs: dict[str, np.ndarray], further: dict[str, np.ndarray]) -> Results:
    """Return the largest difference that rounding allows between two programs for [A] and {f}."""
    arrays, prescribed = system.values(), further.get("prescribed", np.zeros((3, 0)))
    bodies = kinematics(arrays, inputs["x"], inputs["y"], prescribed)
    maxima = path_maxima(arrays, bodies, inputs["y"], prescribed)
    share = 2 * rounding_bound(system.number_of_bodies)
    forcing = forcing_magnitude(arrays, maxima, inputs.get("force"), inputs.get("torque"))
    forcing = forcing + element_magnitude(arrays, bodies, inputs["x"], inputs["y"], **further)
    return share * mass_matrix_magnitude(arrays, maxima), share * forcing
