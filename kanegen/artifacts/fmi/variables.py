"""The variables of an FMU: names, shapes, units, ranges and places of what the arrays of the C hold.

An instance keeps all arrays one after the other as one array of numbers. A value reference is a place there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from kanegen.artifacts.fmi.names import dotted
from kanegen.c.description import ModelDescription
from kanegen.program.ir import Array
from kanegen.recursion.outputs import OF_FRAMES

Shape = tuple[int, ...]

_PARTS: dict[str, tuple[tuple[str, Shape, str], ...]] = {
    "body_poses": (("rotation", (3, 3), "1"), ("origin", (3,), "m")),
    "frame_velocities": (("angular", (3,), "rad/s"), ("linear", (3,), "m/s")),
    "frame_accelerations": (("angular", (3,), "rad/s^2"), ("linear", (3,), "m/s^2")),
    "frame_bias_accelerations": (("angular", (3,), "rad/s^2"), ("linear", (3,), "m/s^2")),
    "momentum": (("linear", (3,), "kg m/s"), ("angular", (3,), "kg m^2/s")),
    "centroidal_momentum_bias": (("linear", (3,), "N"), ("angular", (3,), "N m")),
}
"""Parts of a row of an output whose numbers differ in unit: the name, the shape and the unit of each."""


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU: a number or an array of numbers, which follow each other row by row.

    Attributes:
        name: Its name.
        first: Place of its first number among the numbers of an instance.
        shape: Lengths of its axes, () for a number.
        unit: Its unit, "" where the numbers of one array differ in unit.
        description: What it is, in a phrase.
        causality: "independent", "parameter", "input", "output" or "local".
        variability: "continuous", "tunable" or "fixed".
        start: The value that each number has at first; None where it is computed.
        minimum: The smallest value, infinite where there is none.
        maximum: The largest value, infinite where there is none.
        state: Place of the first number of the state whose derivative this is.
        is_state: Whether it is a continuous state.
    """

    name: str
    first: int
    shape: Shape
    unit: str
    description: str
    causality: str
    variability: str = "continuous"
    start: float | None = None
    minimum: float = -math.inf
    maximum: float = math.inf
    state: int | None = None
    is_state: bool = False

    @property
    def size(self) -> int:
        """How many numbers it holds."""
        return math.prod(self.shape)

    @property
    def places(self) -> range:
        """Places of its numbers among those of an instance."""
        return range(self.first, self.first + self.size)

    def elements(self) -> Iterator[Variable]:
        """Yield a variable for each number; those of an array have indices from 1, as Modelica counts them.

        Example:
            [one.name for one in variable.elements()]  # ["force.arm[1]", "force.arm[2]", "force.arm[3]"]
        """
        if not self.shape:
            yield self
            return
        indices = product(*(range(1, length + 1) for length in self.shape))
        for place, index in zip(self.places, indices, strict=True):
            yield replace(self, name=f"{self.name}[{','.join(map(str, index))}]", first=place, shape=())


@dataclass(frozen=True)
class Part:
    """A part of an array that becomes one variable.

    Attributes:
        label: Name of the part behind that of the array, "" for the whole array.
        first: Place of its first number in the array.
        shape: Lengths of its axes, () for a number.
        unit: Its unit, "" where its numbers differ in unit.
    """

    label: str
    first: int
    shape: Shape
    unit: str


@dataclass(frozen=True)
class Block:
    """An array of the C among the numbers of an instance.

    Attributes:
        array: The array.
        first: Place of its first number among those of an instance.
        output: Name of the output that fills it, "" for an input.
        parts: The parts of it that become variables.
    """

    array: Array
    first: int
    output: str = ""
    parts: tuple[Part, ...] = field(default=())

    @property
    def name(self) -> str:
        """Name of the array in C."""
        return self.array.name

    @property
    def places(self) -> range:
        """Places of its numbers among those of an instance."""
        return range(self.first, self.first + self.array.size)


def parts_of(array: Array, model: ModelDescription, output: str = "") -> tuple[Part, ...]:
    """Return the parts of an array that become variables, with names of freedoms, bodies, frames and points.

    Rows of bodies and points that take no loads have none.

    Args:
        array: The array.
        model: Names of the model.
        output: Name of the output that fills the array, "" for an input.
    """
    if array.name in ("x", "xdot"):
        units = model.coordinate_units
        units = (
            tuple({"1": "1/s"}.get(unit, f"{unit}/s") for unit in units) if array.name == "xdot" else units
        )
        return _rows(model.coordinate_names, units)
    if array.name in ("force", "torque", "point_force", "point_moment"):
        return _loads(array, model)
    if array.name == "parameters":
        return _rows([name for name, _ in model.parameters], [""] * len(model.parameters))
    if array.name == "prescribed":
        return _prescribed(model)
    if (array.of_freedoms and len(array.shape) == 1) or array.name in ("y", "tau"):
        return _rows(speed_names(model), _units_of_freedoms(array.unit, model))
    return _output_parts(array, model, output)


def speed_names(model: ModelDescription) -> tuple[str, ...]:
    """Return n names in the order of {y}."""
    return model.speed_names or model.freedom_names


def _rows(names: Sequence[str], units: Sequence[str]) -> tuple[Part, ...]:
    """Return a part for each number of an array."""
    pairs = zip(names, units, strict=True)
    return tuple(Part(dotted(name), place, (), unit) for place, (name, unit) in enumerate(pairs))


def _units_of_freedoms(unit: str, model: ModelDescription) -> list[str]:
    """Return the unit of each number that belongs to a freedom; the first of two is that of an angle."""
    turning, *moving = unit.split(", ")
    by_kind = {"rad": turning, "m": moving[0] if moving else turning}
    return [by_kind[kind] for kind in model.freedom_units]


def _loads(array: Array, model: ModelDescription) -> tuple[Part, ...]:
    """Return the three components for each body or point that takes loads."""
    if array.name.startswith("point_"):
        named = zip((name for name, _ in model.points), model.loaded_points, strict=True)
    else:
        named = zip(model.body_names, model.loaded, strict=True)
    rows = enumerate(named)
    return tuple(Part(dotted(name), 3 * row, (3,), array.unit) for row, (name, loaded) in rows if loaded)


def _prescribed(model: ModelDescription) -> tuple[Part, ...]:
    """Return value, rate and second derivative of each prescribed freedom."""
    count = len(model.prescribed)
    orders = (("value", ""), ("rate", "/s"), ("second_derivative", "/s^2"))
    return tuple(
        Part(f"{dotted(name)}.{label}", order * count + place, (), f"{unit}{per}")
        for place, (name, unit) in enumerate(model.prescribed)
        for order, (label, per) in enumerate(orders)
    )


def _output_parts(array: Array, model: ModelDescription, output: str) -> tuple[Part, ...]:
    """Return the parts of the array of an output: by row where the rows have names, and by unit."""
    if output == "reaction_loads":
        rows = [(f"{name} in {frame}" if frame else name) for name, _, frame in model.reactions]
        return _rows(rows, [unit for _, unit, _ in model.reactions])
    if output == "prescribed_efforts":
        units = ["N m" if unit == "rad" else "N" for _, unit in model.prescribed]
        return _rows(model.prescribed_names, units)
    names = _row_names(array, model, output)
    shape = array.shape[1:] if names else array.shape
    within = _PARTS.get(output, (("", shape, array.unit if "," not in array.unit else ""),))
    found, first = [], 0
    for name in names or [""]:
        for label, part_shape, unit in within:
            found.append(
                Part(".".join(filter(None, (name and dotted(name), label))), first, part_shape, unit)
            )
            first += math.prod(part_shape)
    return tuple(found)


def _row_names(array: Array, model: ModelDescription, output: str) -> list[str]:
    """Return the names of the rows of an output about frames or points, [] for any other output."""
    if output.startswith("point_"):
        return [name for name, _ in model.points]
    return list(model.poses) if output in OF_FRAMES else []
