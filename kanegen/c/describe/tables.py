"""Tables of what stands at which place of an array."""

from __future__ import annotations

from collections.abc import Sequence

from kanegen.c.interface import ModelFacts


def freedoms(model: ModelFacts) -> list[tuple[int, str, str, str]]:
    """Index in {y}, name, unit in {x}, and the name in {y} where that is not the rate."""
    rows = zip(model.freedom_names, model.freedom_units, model.speeds, strict=True)
    return [(index, name, unit, speed) for index, (name, unit, speed) in enumerate(rows)]


def coordinates(model: ModelFacts) -> list[tuple[int, str, str]]:
    """Index in {x}, name, unit, where there are others than freedoms; otherwise nothing."""
    if not model.has_quaternions:
        return []
    rows = zip(model.coordinate_names, model.coordinate_units, strict=True)
    return [(index, name, unit) for index, (name, unit) in enumerate(rows)]


def loads(model: ModelFacts) -> list[tuple[int, str]]:
    """Row of force and torque, name of the body, for every body that takes them."""
    pairs = zip(model.body_names, model.loaded, strict=True)
    return [(row, name) for row, (name, is_loaded) in enumerate(pairs) if is_loaded]


def point_loads(model: ModelFacts) -> list[tuple[int, str]]:
    """Row of point_force and point_moment, name of the point, for every point that takes them."""
    pairs = zip((name for name, _ in model.points), model.loaded_points, strict=True)
    return [(row, name) for row, (name, is_loaded) in enumerate(pairs) if is_loaded]


def poses(model: ModelFacts, outputs: Sequence[str]) -> list[tuple[int, str]]:
    """Row of poses and name of the body, where they are computed and not of all bodies in their order."""
    some = "body_poses" in outputs and model.poses != model.body_names
    return list(enumerate(model.poses)) if some else []


def reactions(model: ModelFacts, outputs: Sequence[str]) -> list[tuple[int, str, str]]:
    """Place, name of the locked direction, unit of its reaction load, where they are computed."""
    asked = "reaction_loads" in outputs
    return [(place, *names) for place, names in enumerate(model.reactions)] if asked else []
