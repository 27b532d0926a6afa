"""Names and units of the single numbers of an output, such as `point_positions.tip.z` in m."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from kanegen.c import Source
from kanegen.c.description import ModelDescription
from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.model.components import AXES, angular_first, linear_first
from kanegen.program.ir import EVALUATE, Array
from kanegen.recursion.outputs import DIFFERENTIATED

POSE_ROWS = ("axis_x", "axis_y", "axis_z", "origin")
"""Rows of a pose: the axes of the frame, then its origin, each with inertial components."""

_RATES = {"1": "1/s"}


@dataclass(frozen=True)
class Element:
    """One number of an output.

    Attributes:
        name: Its name, such as "point_positions.tip.z"; that of the output alone if it is a single number.
        unit: Its unit, such as "m"; all units of the output where the element does not tell which it has.
    """

    name: str
    unit: str


@dataclass(frozen=True)
class Axis:
    """One axis of the array of an output.

    Attributes:
        name: What its places are, such as "point".
        labels: Name of each place.
        parts: For each place which of the units of the output it has, from 0; () where that is not known.
        units: Unit of each place, where the places themselves have units.
    """

    name: str
    labels: Sequence[str]
    parts: Sequence[int] = ()
    units: Sequence[str] = ()


def rate_unit(unit: str) -> str:
    """Return the unit of the rate of a coordinate.

    Example:
        rate_unit("rad")  # "rad/s"
    """
    return _RATES.get(unit, f"{unit}/s")


def state_elements(model: ModelDescription) -> dict[str, tuple[Element, ...]]:
    """Return names and units of coordinates "x", generalized speeds "y" and generalized forces "tau".

    Example:
        [one.name for one in state_elements(library.source.model)["x"]]  # ["x.theta3", ...]
    """
    forces = [{"rad": "N m", "m": "N"}[unit] for unit in model.freedom_units]
    rates = [rate_unit(unit) for unit in model.freedom_units]
    return {
        "x": _named("x", model.coordinate_names, model.coordinate_units),
        "y": _named("y", model.speed_names or model.freedom_names, rates),
        "tau": _named("tau", model.freedom_names, forces),
    }


def _named(group: str, names: Sequence[str], units: Sequence[str]) -> tuple[Element, ...]:
    """Return names and units of the columns of a state or of generalized forces."""
    return tuple(Element(f"{group}.{name}", unit) for name, unit in zip(names, units, strict=True))


def output_array(source: Source, output: str) -> Array:
    """Return the array that the functions of a source fill with an output."""
    for function in source.functions:
        if function.name == output:
            return function.outputs[0]
    (together,) = (function for function in source.functions if function.name == EVALUATE)
    return together.outputs[source.outputs.index(output)]


def elements(source: Source, output: str) -> tuple[Element, ...]:
    """Return name and unit of each number of an output, in the order of its array.

    Example:
        [one.name for one in elements(library.source, "mass_center")]  # ["mass_center.x", ...]
    """
    array = output_array(source, output)
    axes = axes_of(source, output)
    found = []
    for place in product(*(range(size) for size in array.shape)):
        labels = [axis.labels[k] for axis, k in zip(axes, place, strict=True)]
        found.append(Element(".".join([output, *labels]), _unit(array.unit, axes, place)))
    return tuple(found)


def _unit(unit: str, axes: Sequence[Axis], place: Sequence[int]) -> str:
    """Return the unit of the element at a place of an array with several units."""
    for axis, k in zip(axes, place, strict=True):
        if axis.units:
            return axis.units[k]
    units = unit.split(", ")
    known = [axis.parts[k] for axis, k in zip(axes, place, strict=True) if axis.parts]
    return units[sum(known)] if ";" not in unit and len(units) == len(known) + 1 else unit


def require_columns(source: Source, names: Sequence[str], has_efforts: bool) -> None:
    """Make sure, before a simulation, that its motion will have columns or outputs of some names.

    Args:
        source: The source of the library.
        names: Names as in `Trajectory.output`.
        has_efforts: Whether generalized forces may act, which are columns then.

    Raises:
        OptionError: If there will be none of a name; the nearest one is proposed.
    """
    groups = state_elements(source.model)
    if not has_efforts:
        del groups["tau"]
    for name in names:
        group = name.partition(".")[0]
        if name == "t" or name in source.outputs:
            continue
        own = elements(source, group) if group in source.outputs else groups.get(group)
        states = [one.name for part in groups.values() for one in part]
        known = [one.name for one in own] if own else [*states, *source.outputs]
        if name not in known:
            raise OptionError(
                f"the motion of {source.model.shown} has no {quoted(name)}. {did_you_mean(name, known)}"
            )


def axes_of(source: Source, output: str) -> list[Axis]:
    """Return the axes of the array of an output, none for a single number."""
    shape = output_array(source, output).shape
    known = _known_axes(source.model, output.removesuffix("_derivatives"))
    if output in DIFFERENTIATED:  # whose unit is one over those of the columns
        known = [Axis(axis.name, axis.labels) for axis in known]
    axes = [axis for axis, size in zip(known, shape, strict=False) if len(axis.labels) == size]
    return axes + [_numbered(size) for size in shape[len(axes) :]]


def _known_axes(model: ModelDescription, output: str) -> list[Axis]:
    """Return the axes that have names, from the first one on."""
    freedoms = Axis("freedom", model.freedom_names, [int(unit == "m") for unit in model.freedom_units])
    six = Axis("component", angular_first(), [0, 0, 0, 1, 1, 1])
    poses, vector = Axis("frame", model.poses), Axis("axis", AXES)
    special = {
        "body_poses": [poses, Axis("row", POSE_ROWS, [0, 0, 0, 1]), vector],
        "contact_forces": [_with_units("contact", model.contact_rows)],
        "coordinate_rates": [
            _with_units(
                "coordinate",
                [
                    (n, rate_unit(u))
                    for n, u in zip(model.coordinate_names, model.coordinate_units, strict=True)
                ],
            )
        ],
        "mass_center": [vector],
        "prescribed_efforts": [
            Axis("prescribed", model.prescribed_names, [int(unit == "m") for _, unit in model.prescribed])
        ],
        "reaction_loads": [_with_units("reaction", [(name, unit) for name, unit, _ in model.reactions])],
    }
    if output in special:
        return special[output]
    if output.startswith("point_"):
        return [Axis("point", [name for name, _ in model.points]), vector, freedoms]
    if output.startswith(("frame_", "operational_")):
        return [poses, six, six if output.startswith("operational_") else freedoms]
    if "momentum" in output:
        return [Axis("momentum_component", linear_first(), [0, 0, 0, 1, 1, 1]), freedoms]
    return [freedoms, freedoms]


def _with_units(name: str, rows: Sequence[tuple[str, str]]) -> Axis:
    """Return an axis whose places have names and units."""
    return Axis(name, [label for label, _ in rows], units=[unit for _, unit in rows])


def _numbered(size: int) -> Axis:
    """Return an axis whose places are numbers, from 1."""
    return Axis("number", [str(k + 1) for k in range(size)])
