"""Facts on a model for `kanegen info`: frames, limits, massless bodies, and what was left out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from kanegen.errors import counted
from kanegen.model.frame import GROUND
from kanegen.model.joint import IDENTITY
from kanegen.model.numbers import value_of
from kanegen.model.system import System

MOST_NAMED = 6
"""Most names in a line, unless all of them are asked for."""


@dataclass(frozen=True)
class ModelFacts:
    """Facts on a model that its freedoms, parameters and operations do not show.

    Attributes:
        frames: Names of the frames that are fixed in each body or in the ground, by its name. In a robot file
            these are the links that are welded to it, and sensors and tools.
        other_names: Further names of these frames and of bodies, such as those of joints, with the frame or
            body that each means.
        turned: Names of bodies whose frame of the model is turned against the one that users see.
        massless: Names of bodies without mass and inertia.
        limits: Limits of position, speed and effort by freedom, those that are finite; None for an open end.
        limit_words: How many coordinates, speeds, efforts and coupled freedoms have limits.
        left_out: Warnings of the reader: what it left out, changed or took for none.
    """

    frames: dict[str, tuple[str, ...]]
    other_names: dict[str, str]
    turned: tuple[str, ...]
    massless: tuple[str, ...]
    limits: dict[str, dict[str, Any]]
    limit_words: str
    left_out: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return all facts as plain data for JSON."""
        return {
            "frames": {body: list(names) for body, names in self.frames.items()},
            "other_names_of_frames": self.other_names,
            "turned": list(self.turned),
            "bodies_without_mass": list(self.massless),
            "limits": self.limits,
            "left_out": list(self.left_out),
        }

    def lines(self, verbose: bool) -> Iterator[str]:
        """Yield the facts in words, one a line.

        Args:
            verbose: Whether to name everything; otherwise a line counts what it does not name.
        """
        if self.frames:
            yield from self._frames(verbose)
        if verbose and self.other_names:
            count = counted(len(self.other_names), "frame has", "frames have")
            yield f"{count} the place of another frame, as that of a joint has the place of its body:"
            yield from (f"  {name} is {other}" for name, other in self.other_names.items())
        if self.turned:
            bodies = counted(len(self.turned), "body has", "bodies have")
            yield (
                f"{bodies} another frame in the equations than in the file, along the axis of the joint; "
                f"poses, points and loads are in that of the file: {_named(self.turned, verbose)}"
            )
        if self.massless:
            bodies = counted(len(self.massless), "body has", "bodies have")
            yield f"{bodies} no mass: {_named(self.massless, verbose)}"
        if self.limits:
            yield f"limits on {self.limit_words}"
        if verbose:
            yield from (f"  {name}: {_limit_text(table)}" for name, table in self.limits.items())

    def _frames(self, verbose: bool) -> Iterator[str]:
        """Yield the frames that are fixed in bodies and in the ground."""
        count = sum(map(len, self.frames.values()))
        places = [
            f"{', '.join(names)} in {body}" if verbose or count <= MOST_NAMED else f"{len(names)} in {body}"
            for body, names in self.frames.items()
        ]
        start = f"{counted(count, 'frame')} fixed in bodies or in the ground"
        if verbose:
            yield f"{start}:"
            yield from (f"  {place}" for place in places)
        else:
            yield f"{start}: {_named(places, verbose)}"


def model_facts(system: System, left_out: Sequence[str]) -> ModelFacts:
    """Return the facts on a system; `left_out` are the warnings of its reader."""
    own = {body.name for body in system.bodies}
    names = [GROUND, *(body.name for body in system.bodies)]
    frames: dict[str, list[str]] = {}
    other_names: dict[str, str] = {}
    for frame in system.frames:
        if frame.name in own:
            continue
        if frame.frame and frame.is_trivial:
            other_names[frame.name] = frame.frame
        else:
            frames.setdefault(names[frame.body], []).append(frame.name)
    return ModelFacts(
        frames={body: tuple(found) for body, found in frames.items()},
        other_names=other_names,
        turned=tuple(f.name for f in system.frames if f.name in own and f.orientation != IDENTITY),
        massless=tuple(
            body.name
            for body in system.bodies
            if value_of(body.mass) == 0 and not any(value_of(entry) for row in body.inertia for entry in row)
        ),
        limits=dict(_limits(system)),
        limit_words=_limit_words(system),
        left_out=tuple(left_out),
    )


def _limit_words(system: System) -> str:
    """Return how many coordinates, speeds, efforts, prescribed and coupled freedoms have limits."""
    named = dict(_limits(system))
    further = [("prescribed", system.prescribed_names), ("coupled", system.coupled_names)]
    counts = [(kind, len(named.keys() & {*names})) for kind, names in further]
    parts = [counted(count, f"{kind} freedom", f"{kind} freedoms") for kind, count in counts if count]
    own = replace(system.limits, not_kept=()).words
    return ", ".join([own, *parts] if own else parts)


def _limits(system: System) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the limits of each freedom that has some."""
    names = (*system.freedom_names, *system.prescribed_names, *system.coupled_names)
    freedoms = (*system.freedoms, *system.prescribed, *(one.freedom for one in system.coupled))
    for name, freedom in zip(names, freedoms, strict=True):
        joint = system.bodies[freedom.body - 1].joint
        if table := joint.limits.table_of(freedom.index):
            if "position" in table:
                table["position"] = [end if math.isfinite(end) else None for end in table["position"]]
            yield name, table


def _limit_text(table: Mapping[str, Any]) -> str:
    """Return the limits of one freedom in words."""
    parts = []
    if "position" in table:
        low, high = ("open" if end is None else f"{end:g}" for end in table["position"])
        parts.append(f"position {low} to {high}")
    parts += [f"{key} {table[key]:g}" for key in ("speed", "effort") if key in table]
    return ", ".join(parts)


def _named(names: Sequence[str], verbose: bool) -> str:
    """Return names, of many the first ones with the number of the others."""
    if verbose or len(names) <= MOST_NAMED:
        return ", ".join(names)
    return f"{', '.join(names[:MOST_NAMED])} and {len(names) - MOST_NAMED} more (--verbose names all)"
