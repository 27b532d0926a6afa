"""The rows of the output `reaction_loads`: loads along locked directions, and loads of joints in frames.

A locked direction is called `<body>.theta2` or `<body>.s1`, as its freedom is. The whole load that the joint
below a body transmits has six components in a frame of the body: `<frame>.moment1` to `<frame>.moment3` about
the origin of the frame, and `<frame>.force1` to `<frame>.force3`. The latter stand for a body whose users see
another frame than that of the model, in which the directions of its joint have no meaning for them.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from kanegen.choices import did_you_mean, is_among
from kanegen.errors import ModelError, quoted
from kanegen.model.body import Body
from kanegen.model.coordinates import ANGLES, FREEDOMS, TRANSLATIONS, Freedom
from kanegen.model.frame import Frame
from kanegen.model.output_rows import listed_choices, require_once

LABEL = "reaction loads"

COMPONENTS = ("moment1", "moment2", "moment3", "force1", "force2", "force3")
"""Names of the six components of a load in a frame."""


@dataclass(frozen=True)
class Reaction:
    """A row of the output `reaction_loads`.

    Attributes:
        name: Its name.
        body: Number of the body above the joint.
        index: Index of the locked freedom in `FREEDOMS`, or of the component in `COMPONENTS`.
        frame: Name of the frame in which the load has the component; "" for a locked direction.
    """

    name: str
    body: int
    index: int
    frame: str = ""

    @property
    def freedom(self) -> Freedom:
        """The locked freedom; of a component in a frame the freedom of the same index."""
        return Freedom(self.body, self.index)

    @property
    def effort(self) -> Literal["N m", "N"]:
        """Unit of the load, of a moment or of a force."""
        return self.freedom.effort


def every_reaction(bodies: Sequence[Body], frames: Container[str]) -> dict[str, Reaction]:
    """Return the rows of all joints that lock a direction, in the order of Eq. (1), by name.

    Args:
        bodies: The bodies.
        frames: Names of the frames beside those of the model; a body among them has components in its frame.
    """
    found = [
        row
        for indices in (ANGLES, TRANSLATIONS)
        for k, body in enumerate(bodies, start=1)
        for row in (_of_frame(body.name, k) if body.name in frames else _of_directions(body, k))
        if row.index in indices and not all(body.joint.moving)
    ]
    return {row.name: row for row in found}


def _of_directions(body: Body, k: int) -> Iterator[Reaction]:
    """Yield the locked directions of the joint below body `k`."""
    for index, name in enumerate(FREEDOMS):
        if not body.joint.moving[index]:
            yield Reaction(f"{body.name}.{name}", k, index)


def _of_frame(name: str, k: int) -> Iterator[Reaction]:
    """Yield the components of the load of the joint below body `k` in a frame of the body."""
    for index, component in enumerate(COMPONENTS):
        yield Reaction(f"{name}.{component}", k, index, name)


def reaction_rows(bodies: Sequence[Body], frames: Mapping[str, Frame], chosen: Any) -> tuple[Reaction, ...]:
    """Return the rows that are chosen.

    Args:
        bodies: The bodies.
        frames: All frames by name.
        chosen: Names of locked directions, of components in frames, or of frames for all six components.

    Raises:
        ModelError: If a chosen direction is free, does not exist or is named twice, or none is chosen.
    """
    known = {row.name: row for k, body in enumerate(bodies, start=1) for row in _of_directions(body, k)}
    found: list[Reaction] = []
    for name in listed_choices(chosen, LABEL):
        if isinstance(name, str) and name in known:
            found.append(known[name])
        else:
            found += _in_frame(bodies, frames, name, list(known))
    require_once([row.name for row in found], LABEL)
    return tuple(found)


def _in_frame(
    bodies: Sequence[Body], frames: Mapping[str, Frame], name: Any, known: Sequence[str]
) -> list[Reaction]:
    """Return the rows of a frame or of one of its components."""
    place, _, component = name.rpartition(".") if isinstance(name, str) else ("", "", "")
    is_component = place in frames and component in COMPONENTS
    frame = place if is_component else name
    if not isinstance(frame, str) or frame not in frames:
        raise ModelError(f"{LABEL}: {_reason(bodies, name, known, frames)}")
    if not frames[frame].body:
        raise ModelError(f"{LABEL}: {quoted(frame)} is fixed to the ground, below which there is no joint.")
    rows = _of_frame(frame, frames[frame].body)
    return [row for row in rows if not is_component or row.name == name]


def _reason(bodies: Sequence[Body], name: object, known: Sequence[str], frames: Iterable[str]) -> str:
    """Return the reason why a name is no locked direction, and the remedy."""
    for body in bodies:
        for index, freedom in enumerate(FREEDOMS):
            if is_among(name, [f"{body.name}.{freedom}"]):
                if body.joint.coupled[index]:
                    return (
                        f"{quoted(name)} is coupled to other freedoms, so its effort is part of theirs. "
                        "Leave it out."
                    )
                is_free = body.joint.free[index]
                moves, output = (
                    ("free", "inverse_dynamics") if is_free else ("prescribed", "prescribed_efforts")
                )
                return (
                    f"{quoted(name)} is {moves}; its effort is what {output} gives. Lock it, or leave it out."
                )
    if not known:
        return "no direction of a joint is locked. Lock one, or take inverse_dynamics."
    return f"there is no locked direction or frame {quoted(name)}. {did_you_mean(name, [*known, *frames])}"
