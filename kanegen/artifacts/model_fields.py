"""What a program may ask about generated code at run time, as fields of JSON.

`docs/embedding/description.schema.json` describes the fields. They hold names as the model has them, in any
script; in JSON all that is not ASCII is escaped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from kanegen import __version__
from kanegen.c.declarations import LIMITS, contacts, reactions
from kanegen.c.element_names import names_of_elements, names_of_y
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.source import Source
from kanegen.c.steps import Rollout
from kanegen.model.identifiers import identifiers
from kanegen.program.ir import Array
from kanegen.recursion.outputs import OF_FRAMES

FORMAT = 1
"""Number of the form of the fields; it changes when a field changes its meaning or goes away."""

Fields = dict[str, Any]


def model_fields(source: Source) -> Fields:
    """Return names, units, limits, sizes, parameters, arrays, functions and statuses of generated code."""
    model = source.model
    n = len(model.freedom_names)
    return {
        "format": FORMAT,
        "generator": f"kanegen {__version__}",
        "name": model.name,
        "title": model.shown,
        "language": source.target,
        "precision": source.precision,
        "storage": source.storage,
        "choices": dict(source.variant.choices()),
        "sizes": _sizes(source),
        "coordinates": _coordinates(source),
        "speeds_are_rates": model.speeds_are_rates,
        "freedoms": _freedoms(source),
        "parameters": _parameters(source),
        "bodies": [
            {"name": name, "takes_loads": loaded}
            for name, loaded in zip(model.body_names, model.loaded, strict=True)
        ],
        "points": _points(source),
        "frames": _frames(source),
        "prescribed": [{"name": name, "unit": unit} for name, unit in model.prescribed],
        "reactions": [{"name": name, "unit": unit} for _, name, unit in reactions(model, source.outputs)],
        "contacts": [{"name": name, "unit": unit} for _, name, unit in contacts(model, source.outputs)],
        "outputs": [*source.outputs, *source.integrators],
        "operations": dict(source.operations),
        "arrays": _arrays(source),
        "functions": [_function(source, function) for function in source.functions],
        "rollouts": [_rollout(source, rollout) for rollout in source.rollouts],
        "status": {
            "success": 0,
            "freedoms": list(model.freedom_names),
            "not_finite": n + 1,
            "rows": list(model.rows),
            **({"not_converged": model.not_converged} if source.may_not_converge else {}),
        },
    }


def _sizes(source: Source) -> dict[str, int]:
    """Return the lengths of arrays, with the names that the enumerators of the header have in lower case."""
    model = source.model
    prepared = [array.size for f in source.functions if f.name == PREPARE for array in f.outputs]
    return {
        "coordinates": len(model.coordinate_names),
        "freedoms": len(model.freedom_names),
        "bodies": len(model.body_names),
        "points": len(model.points),
        "parameters": len(model.parameters),
        "prepared": sum(prepared),
        "prescribed": len(model.prescribed),
    }


def _coordinates(source: Source) -> list[Fields]:
    model = source.model
    members = identifiers(model.coordinate_names, "c")
    lower, upper = (_limits(source, name, len(members)) for name in LIMITS[:2])
    rows = zip(members, model.coordinate_names, model.coordinate_units, lower, upper, strict=True)
    keys = ("member", "name", "unit", "lower", "upper")
    return [dict(zip(keys, row, strict=True)) for row in rows]


def _freedoms(source: Source) -> list[Fields]:
    model = source.model
    speeds = names_of_y(model)
    n = len(speeds)
    speed, effort = (_limits(source, name, n) for name in LIMITS[2:])
    found = []
    for place, name in enumerate(model.freedom_names):
        unit = model.freedom_units[place]
        found.append(
            {
                "member": identifiers(speeds, "c")[place],
                "name": name,
                "speed": speeds[place],
                "body": model.freedom_bodies[place] if model.freedom_bodies else "",
                "unit": f"{unit}/s",
                "effort_unit": {"rad": "N m", "m": "N"}[unit],
                "speed_limit": speed[place],
                "effort_limit": effort[place],
            }
        )
    return found


def _parameters(source: Source) -> list[Fields]:
    names = [name for name, _ in source.model.parameters]
    rows = zip(identifiers(names, "c"), source.model.parameters, strict=True)
    return [{"member": member, "name": name, "default": default} for member, (name, default) in rows]


def _frames(source: Source) -> list[Fields]:
    """Return the rows of outputs about frames, [] where there is no such output."""
    model = source.model
    if not set(OF_FRAMES).intersection(source.outputs):
        return []
    return [{"name": name, "body": body} for name, body in zip(model.poses, model.pose_bodies, strict=True)]


def _points(source: Source) -> list[Fields]:
    model = source.model
    rows = zip(model.points, model.loaded_points, model.load_frames, strict=True)
    keys = ("name", "body", "takes_loads", "load_frame")
    return [dict(zip(keys, (*point, *loads), strict=True)) for point, *loads in rows]


def _limits(source: Source, name: str, size: int) -> Sequence[float | None]:
    """Return limits by the name of their macro, None where there is none."""
    limits = source.model.limits
    values = limits[LIMITS.index(name)] if limits else (math.inf,) * size
    return [value if math.isfinite(value) else None for value in values]


def _arrays(source: Source) -> Fields:
    """Return shape, type, unit, meaning and names of elements of every argument, by its name."""
    made: dict[str, Array] = {}
    for function in (*source.functions, *(rollout.step for rollout in source.rollouts)):
        made |= {array.name: array for array in (*function.inputs, *function.outputs)}
    of = formats(source.variant).of
    return {
        name: {
            "shape": list(array.shape),
            "type": of(name).c_type,
            "unit": array.unit,
            "meaning": array.doc,
            "elements": [list(names) or None for names in names_of_elements(array, source.model)],
        }
        for name, array in made.items()
    }


def _function(source: Source, function: Function) -> Fields:
    return {
        "name": function.name,
        "symbol": f"{source.model.name}_{function.name}",
        "meaning": function.doc,
        "inputs": [array.name for array in function.inputs],
        "outputs": [array.name for array in function.outputs],
        "batch": function.has_batch,
        "shared": list(function.shared),
        "may_fail": list(function.may_fail),
        "fails_where": f"{function.quantity} is not positive: {function.failure}"
        if function.may_fail
        else "",
        "may_be_inaccurate": list(function.may_be_inaccurate),
    }


def _rollout(source: Source, rollout: Rollout) -> Fields:
    return {
        "name": rollout.name,
        "symbol": f"{source.model.name}_{rollout.name}",
        "meaning": rollout.doc,
        "step": rollout.step.name,
        "inputs": [array.name for array in rollout.inputs],
        "held": [array.name for array in rollout.held],
        "batch": rollout.has_batch,
    }
