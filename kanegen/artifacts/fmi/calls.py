"""The calls of functions of the C that an FMU makes, as text of C, and what their statuses mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from kanegen.artifacts.fmi.layout import Layout
from kanegen.c.interface import PREPARE, Function
from kanegen.program.ir import PREPARED

LOADS = ("force", "torque", "point_force", "point_moment")
"""Arrays that {ydot} contains linearly, so that a difference of two of its values is exactly a derivative."""

NONE, OF_LOADS, IDENTITY = "NO_DERIVATIVES", "DERIVATIVES_BY_LOADS", "IDENTITY"
"""In place of columns of derivatives: there are none, differences of {ydot}, or the identity matrix."""


@dataclass(frozen=True)
class Call:
    """A call of a function of the C.

    Attributes:
        label: Name of the function.
        text: The call as an expression of C, whose value is the status; "" where there is no function.
        reads_prepared: Whether it reads prepared constants.
        reads_acceleration: Whether it reads {ydot}.
        quantity: Name of the quantity that is positive where the results exist.
        failure: Clause on the state where it is not.
        row_quantity: The same for the rows of an output, "" where there is none.
        row_failure: The same for the rows of an output.
    """

    label: str
    text: str
    reads_prepared: bool = False
    reads_acceleration: bool = False
    quantity: str = ""
    failure: str = ""
    row_quantity: str = ""
    row_failure: str = ""


@dataclass(frozen=True)
class Columns:
    """Columns of derivatives with respect to one array.

    Attributes:
        array: Name of the array.
        first: Place of its first number among those of an instance.
        count: How many numbers it has.
        column: The first column as text of C, or one of `NONE`, `OF_LOADS` and `IDENTITY`.
    """

    array: str
    first: int
    count: int
    column: str


@dataclass(frozen=True)
class Differentiated:
    """What a computed array depends on, and where its derivatives are.

    Attributes:
        first: Place of its first number among those of an instance.
        count: How many numbers it has.
        call: Number of the call that computes the derivatives, -1 without one.
        slopes: Place of the first derivative.
        width: Number of columns of derivatives.
        columns: The columns of each array on which it depends.
    """

    first: int
    count: int
    call: int
    slopes: int
    width: int
    columns: tuple[Columns, ...]


def calls(layout: Layout) -> list[Call]:
    """Return the calls: one for each computed array, then derivatives, prepared constants and a step."""
    found = []
    for block in layout.computed.values():
        function = layout.functions.get(block.output)
        target = f"v + {block.first}"
        found.append(_call(layout, function, target) if function else Call("state rates", ""))
    for slopes in layout.slopes.values():
        found.append(_call(layout, slopes.function, f"data->slopes + {slopes.first}"))
    if layout.has_prepare:
        found.append(_call(layout, layout.functions[PREPARE], "data->prepared"))
    found.append(_words(layout.rollout.step, ""))
    return found


def differentiated(layout: Layout, read: dict[str, list[str]]) -> list[Differentiated]:
    """Return for each computed array where its derivatives are.

    Args:
        layout: The numbers of an instance.
        read: For each computed array the arrays on which it depends.
    """
    found = []
    after = len(layout.computed)
    order = {name: after + number for number, name in enumerate(layout.slopes)}
    for name, block in layout.computed.items():
        slopes = layout.slopes.get(name)
        columns = tuple(_columns(layout, name, array) for array in read[name])
        found.append(
            Differentiated(
                block.first,
                block.array.size,
                order.get(name, -1),
                slopes.first if slopes else 0,
                slopes.function.outputs[0].row if slopes else 0,
                columns,
            )
        )
    return found


def _columns(layout: Layout, name: str, array: str) -> Columns:
    """Return the columns of the derivatives of a computed array with respect to an array."""
    block, slopes = layout.inputs[array], layout.slopes.get(name)
    column = NONE
    if slopes and array in slopes.columns:
        column = str(slopes.columns[array].start)
    elif name == "xdot" and layout.computed[name].output not in layout.functions:
        column = IDENTITY
    elif name == "acceleration" and slopes and array in LOADS:
        column = OF_LOADS
    return Columns(array, block.first, block.array.size, column)


def rollout_arguments(layout: Layout) -> Sequence[str]:
    """Return the arguments of the call that makes one step, in their order."""
    found = []
    for array in layout.rollout.inputs:
        if array.name == PREPARED:
            found.append("data->prepared")
        elif array.name == "prescribed":
            found += ["prescribed", "3"]
        elif array in layout.rollout.held:
            found += [f"v + {layout.inputs[array.name].first}", "1"]
        else:
            found.append(f"v + {layout.inputs[array.name].first}")
    return (*found, "&length", "1", "1", "0", "x_path", "y_path", "&made")


def _call(layout: Layout, function: Function, target: str) -> Call:
    """Return the call of a function that fills one array."""
    places = {name: f"v + {block.first}" for name, block in layout.inputs.items()}
    places |= {PREPARED: "data->prepared", "ydot": f"v + {layout.computed['acceleration'].first}"}
    arguments = ", ".join([*(places[array.name] for array in function.inputs), target])
    return _words(function, f"{layout.source.model.name}_{function.name}({arguments})")


def _words(function: Function, text: str) -> Call:
    """Return a call with the words for its statuses."""
    read = {array.name for array in function.inputs}
    rows = next(iter(function.row_conditions), None)
    return Call(
        function.name,
        text,
        PREPARED in read,
        "ydot" in read,
        function.quantity,
        function.failure,
        rows.quantity if rows else "",
        rows.failure if rows else "",
    )
