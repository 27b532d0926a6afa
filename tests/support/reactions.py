"""Reaction loads by the program that becomes C, and by the reference with nothing locked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.model.coordinates import Freedom
from kanegen.model.numbers import value_of
from kanegen.program.evaluate import evaluate
from kanegen.reference import equations as reference

Arrays = dict[str, np.ndarray]


def reactions(system: kg.System, given: Arrays) -> np.ndarray:
    """Return the reaction loads by the program that becomes C."""
    module = compile_module(system, ("reaction_loads",)).module
    values = {name: np.ravel(value) for name, value in given.items()}
    if module.prepare:
        parameters = [parameter.value for parameter in system.parameters]
        values["prepared"] = evaluate(module.prepare, {"parameters": parameters}, np)["prepared"]
    (function,) = module.functions.values()
    found = evaluate(function, {array.name: values[array.name] for array in function.inputs}, np)
    return np.array(found["reaction_loads"], float)


def unlocked(system: kg.System, x: np.ndarray, **joint: str) -> tuple[kg.System, np.ndarray]:
    """Return the same tree with nothing locked and with fields of all joints changed, and its coordinates."""
    free = tuple(
        replace(body, joint=replace(body.joint, free=(True,) * 6, name="", **joint))  # type: ignore[arg-type]
        for body in system.bodies
    )
    whole = replace(system, bodies=free, reactions=None)
    found = np.zeros(len(whole.coordinates))
    for coordinate, place in whole.coordinate_places.items():
        locked = system.bodies[coordinate.body - 1].joint.locked
        known = system.coordinate_places.get(coordinate)
        found[place] = value_of(locked[coordinate.index]) if known is None else x[known]
    return whole, found


def efforts(system: kg.System, given: Arrays) -> dict[Freedom, float]:
    """Return [A]{ydot} - {f} by the reference, by freedom of the same tree with nothing locked."""
    whole, x = unlocked(system, given["x"])
    y, ydot = np.zeros((2, len(whole.freedoms)))
    places = [whole.places[freedom] for freedom in system.freedoms]
    y[places], ydot[places] = given["y"], given["ydot"]
    takes = np.array([body.loads for body in system.bodies])[:, None]
    loads = (given[name] * takes for name in ("force", "torque"))
    further = {name: given[name] for name in ("point_force", "point_moment", "t") if name in given}
    needed = reference.mass_matrix(whole, x) @ ydot - reference.forcing(whole, x, y, *loads, **further)
    return dict(zip(whole.freedoms, needed, strict=True))
