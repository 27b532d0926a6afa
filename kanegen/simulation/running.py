"""A motion as it is computed: what is kept, where events end it, and what is left of one that breaks off."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from kanegen.errors import StatusError
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.events import Occurrence, Watch
from kanegen.simulation.motion import Motion
from kanegen.simulation.stretches import Integrator, Marks, Stretch

ReportTime = Callable[[float], None]
"""Function that is called with the simulated time (s) from time to time."""


@dataclass
class Record:
    """What has been computed of a motion so far.

    Attributes:
        times: Times of the states, s.
        states: The states.
        events: The events so far.
    """

    times: list[float]
    states: list[Floats]
    events: list[Occurrence] = field(default_factory=list)

    def add(self, stretch: Stretch) -> None:
        """Add the wanted states of a stretch."""
        self.times += stretch.times[stretch.wanted].tolist()
        self.states += list(stretch.states[stretch.wanted])

    def end(self, time: float, state: Floats) -> None:
        """Add a last state, unless there is one at its time."""
        if time > self.times[-1]:
            self.times.append(time)
            self.states.append(state)

    @property
    def arrays(self) -> tuple[Doubles, Floats]:
        """(T,) times and (T, ..., k) states."""
        return np.array(self.times), np.stack(self.states)


def run(
    motion: Motion,
    integrator: Integrator,
    start: Floats,
    marks: Marks,
    watch: Watch | None,
    record: Record,
    report_time: ReportTime,
) -> None:
    """Compute a motion into a record, which holds what there is whatever ends the computation.

    Args:
        motion: Right side of the equations of motion.
        integrator: The method.
        start: State at the first mark.
        marks: Times at which steps end.
        watch: Looks for events; None where there are none.
        record: The record, which begins with the first state.
        report_time: Function that is called with the simulated time.

    Raises:
        StatusError: If the state stops being finite; the message has the time, the place and the last state.
    """
    for stretch in integrator.stretches(start, marks, every=watch is not None):
        found = _until_not_finite(stretch)
        events = watch.found(found) if watch is not None and len(found.times) > 1 else []
        last = next((one for one in events if one[0].terminal), None)
        if last is not None:
            time, state = last[0].time, last[1]
            record.add(_until(found, time))
            record.events += [event for event, _ in events if event.time <= time]
            record.end(time, state)
            report_time(time)
            return
        record.add(found)
        record.events += [event for event, _ in events]
        report_time(float(found.times[-1]))
        if len(found.times) < len(stretch.times):
            raise _not_finite(motion, stretch, len(found.times))


def _until(stretch: Stretch, time: float) -> Stretch:
    """Return the part of a stretch before a time (s)."""
    before = stretch.times < time
    return Stretch(stretch.times[before], stretch.states[before], stretch.wanted[before])


def _until_not_finite(stretch: Stretch) -> Stretch:
    """Return the part of a stretch before the first state that is not finite."""
    finite = [bool(np.isfinite(state).all()) for state in stretch.states]
    count = len(finite) if all(finite) else finite.index(False)
    return Stretch(stretch.times[:count], stretch.states[:count], stretch.wanted[:count])


def _not_finite(motion: Motion, stretch: Stretch, row: int) -> StatusError:
    """Return the error that a state is not finite, with its time, its place and the last finite state."""
    library = motion.library
    names = [*(f"x.{n}" for n in library.coordinate_names), *(f"y.{n}" for n in library.speed_names), "work"]
    place = np.argwhere(~np.isfinite(stretch.states[row]))[0]
    which = f" of state {place[0]}" if len(place) > 1 else ""
    value = stretch.states[row][tuple(place)]
    before = stretch.states[row - 1] if len(place) == 1 else stretch.states[row - 1][place[0]]
    shown = ", ".join(f"{n} = {v:.6g}" for n, v in zip(names[:-1], before.tolist(), strict=False))
    return StatusError(
        f"at t = {stretch.times[row]:.9g} s: {names[place[-1]]}{which} is {value}. The last finite state, at "
        f"t = {stretch.times[row - 1]:.9g} s, is {_shortened(shown)}. Take a smaller step, or look for what "
        "drives the motion away."
    )


def _shortened(text: str, longest: int = 400) -> str:
    """Return the beginning of a long list."""
    return text if len(text) <= longest else f"{text[:longest].rpartition(',')[0]}, ..."
