"""Names of the elements of arrays along their axes, such as the freedoms along the rows of [A]."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import zip_longest

from kanegen.c.description import ModelDescription
from kanegen.program.ir import PARAMETERS, Array
from kanegen.recursion.outputs import DIFFERENTIATED, SECOND_DERIVATIVES, Product

Names = tuple[str, ...]
"""Names along one axis of an array; () for an axis whose places have none."""

AXES = ("x", "y", "z")
"""Names of the components of a vector."""

WRENCH = ("angular_x", "angular_y", "angular_z", "linear_x", "linear_y", "linear_z")
"""Names of the six components of a motion of a frame or a load on it."""

MOMENTUM = (*WRENCH[3:], *WRENCH[:3])
"""Names of the six components of a momentum."""

MOTION = ("values", "rates", "second_derivatives")
"""Names of the rows of the array of prescribed motion."""

_OF_COORDINATES = ("x", "xdot", "x_next", "coordinate_rates")
_OF_FREEDOMS = ("y", "ydot", "tau", "y_next", "error_bound")
_SQUARE = ("A", "C", "A_inverse")


def names_of_y(model: ModelDescription) -> Names:
    """Return the names of the speeds: those of their coordinates, or of components of a velocity."""
    pairs = zip(model.speeds, model.freedom_names, strict=True)
    return tuple(speed or name for speed, name in pairs)


def names_of_elements(array: Array, model: ModelDescription) -> tuple[Names, ...]:
    """Return the names of the elements of an array along each of its axes.

    Args:
        array: An input or output of a generated function.
        model: The model of the function.

    Example:
        names_of_elements(mass_matrix, model)  # (("shoulder", "elbow"), ("shoulder", "elbow"))
    """
    if array.pattern and len(array.shape) == 1:
        speeds = names_of_y(model)
        return (tuple(f"{speeds[row]} {speeds[column]}" for row, column in array.pattern),)
    names = list(_axes(array, model))
    if _has_variables(array.name):
        axes = 2 if array.name in SECOND_DERIVATIVES else 1
        last = len(array.shape) - axes
        variables = names_of_variables(array.name, model, array.shape[-1])
        names = [*names[:last], *([()] * (last - len(names))), *[variables] * axes]
    return tuple(_fitting(one, size) for one, size in zip_longest(names[: len(array.shape)], array.shape))


def _has_variables(output: str) -> bool:
    """Return whether the last axis of an output counts the variables by which another is differentiated."""
    derivation = DIFFERENTIATED.get(output)
    return derivation is not None and not (
        isinstance(derivation, Product) and not derivation.kind.is_weighted
    )


def names_of_variables(output: str, model: ModelDescription, size: int) -> Names:
    """Return the names of the variables of an output that is a derivative, such as "x elbow".

    Args:
        output: Name of the output.
        model: The model.
        size: Number of variables, which tells whether the time is one of them.
    """
    derivative = DIFFERENTIATED[output]
    by = (*derivative.by, *((PARAMETERS,) if derivative.by_parameters else ()))
    names = [f"{one} {name}" for one in by for name in _names_of_input(one, model)]
    return tuple(names if len(names) == size else [name for name in names if name != "t t"])


def _names_of_input(array: str, model: ModelDescription) -> Names:
    """Return a name for each element of an input, () for one that the model does not have."""
    bodies = model.body_names if model.takes_loads else ()
    points = [name for name, _ in model.points] if any(model.loaded_points) else []
    tables = {
        **dict.fromkeys(("force", "torque"), (bodies, AXES)),
        **dict.fromkeys(("point_force", "point_moment"), (points, AXES)),
        "prescribed": (MOTION, model.prescribed_names),
    }
    if array in tables:
        rows, columns = tables[array]
        return tuple(f"{row} {column}" for row in rows for column in columns)
    named = {"x": model.coordinate_names, PARAMETERS: _parameters(model), "t": ("t",)}
    return named.get(array, names_of_y(model))


def _fitting(names: Sequence[str] | None, size: int) -> Names:
    """Return names if there is one for each place of an axis, else ()."""
    return tuple(names) if names and len(names) == size else ()


def _axes(array: Array, model: ModelDescription) -> tuple[Sequence[str], ...]:
    """Return the names along the axes of an array, the first ones first, as far as there are names."""
    speeds, points = names_of_y(model), [name for name, _ in model.points]
    named: dict[str, tuple[Sequence[str], ...]] = {
        **dict.fromkeys(_OF_COORDINATES, (model.coordinate_names,)),
        **dict.fromkeys(_SQUARE, (speeds, speeds)),
        **dict.fromkeys(("force", "torque"), (model.body_names, AXES)),
        **dict.fromkeys(("momentum", "centroidal_momentum_bias"), (MOMENTUM,)),
        PARAMETERS: (_parameters(model),),
        "prescribed": (MOTION, model.prescribed_names),
        "prescribed_efforts": (model.prescribed_names,),
        "reaction_loads": ([name for name, _, _ in model.reactions],),
        "contact_force": ([name for name, _ in model.contact_rows],),
        "centroidal_momentum_matrix": (MOMENTUM, speeds),
        "mass_center": (AXES,),
        "body_poses": (model.poses,),
        "frame_jacobians": (model.poses, WRENCH, speeds),
        "point_jacobians": (points, AXES, speeds),
    }
    name = array.name.removesuffix("_derivatives").removesuffix("_input")
    if name in named:
        return named[name]
    if name.startswith("point_"):
        return points, AXES
    if name.startswith(("frame_", "operational_")):
        return model.poses, WRENCH, WRENCH
    return (speeds,) if array.of_freedoms or name in _OF_FREEDOMS else ()


def _parameters(model: ModelDescription) -> Names:
    return tuple(name for name, _ in model.parameters)
