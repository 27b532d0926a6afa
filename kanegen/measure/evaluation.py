"""One entry of an output in one state, as a program computed it, and everything to compute it again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.reference.states import States

Row = tuple[float, ...]


@dataclass(frozen=True)
class Evaluation:
    """An entry of an output, such as the worst, with the whole state, so that it can be computed again.

    Attributes:
        state: Index of the state, from 0.
        entry: Name of the entry, made of the names of its generalized speeds.
        value: Value that the library computed.
        reference: Value that the reference computed.
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds (rad/s, m/s).
        force: (N, 3) forces on the bodies (N); None where no body takes loads.
        torque: (N, 3) torques on the bodies (N m); None where no body takes loads.
        inputs: Further inputs of the system by name, such as "prescribed" or "t".
    """

    state: int
    entry: str
    value: float
    reference: float
    x: Row
    y: Row
    force: tuple[Row, ...] | None
    torque: tuple[Row, ...] | None
    inputs: Mapping[str, Any]


def evaluation(
    names: Sequence[str], states: States, *, state: int, entry: Sequence[int], value: float, reference: float
) -> Evaluation:
    """Return one entry of an output in one of B states, with the whole state.

    Args:
        names: (n,) names of the generalized speeds.
        states: The states.
        state: Index of the state.
        entry: Indices of the entry, one or two.
        value: Value that a program computed.
        reference: The value with which it is compared.
    """
    force, torque = (
        None if load is None else tuple(tuple(row) for row in load[state].tolist())
        for load in (states.force, states.torque)
    )
    return Evaluation(
        state=state,
        entry=f"[{', '.join(names[i] for i in entry)}]",
        value=value,
        reference=reference,
        x=tuple(states.x[state].tolist()),
        y=tuple(states.y[state].tolist()),
        force=force,
        torque=torque,
        inputs={name: values[state].tolist() for name, values in states.inputs.items()},
    )
