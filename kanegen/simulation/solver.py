"""The solver of one motion: a library, a method, inputs, events, and the outputs that are recorded."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from kanegen.errors import ArrayError, OptionError, StatusError
from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.events import Crossing, Watch
from kanegen.simulation.inputs import Inputs
from kanegen.simulation.limits import warn_outside_limits
from kanegen.simulation.methods import Method
from kanegen.simulation.motion import Motion, StateLayout
from kanegen.simulation.running import Record, ReportTime, run
from kanegen.simulation.stretches import Marks
from kanegen.simulation.trajectory import Trajectory


class Solver:
    """Solves the equations of motion of a library by a method, from any first state; all of it is checked."""

    def __init__(
        self,
        library: Library,
        method: Method,
        inputs: Inputs,
        crossings: Sequence[Crossing],
        outputs: tuple[str, ...],
    ) -> None:
        self._library, self._method, self._inputs = library, method, inputs
        self._crossings, self._outputs = crossings, outputs
        self._layout = StateLayout.of(library)
        self._motion = Motion(library, self._layout, inputs)

    def states(self, x: Floats, y: Floats, times: Doubles) -> tuple[Floats, int]:
        """Return (T, ..., k) states and the evaluations of a motion, up to where it breaks off.

        The works in the states do not count.
        """
        start = self._layout.join(x, y, np.zeros(y.shape[:-1], y.dtype))
        record = Record([float(times[0])], [start])
        marks = Marks.of(times, self._inputs.breaks)
        motion = replace(self._motion, counts_work=False)
        with suppress(StatusError):
            run(motion, self._method.integrator(motion), start, marks, None, record, lambda time: None)
        return self._layout.with_first_lengths(record.arrays[1]), motion.evaluations

    def trajectory(self, x: Floats, y: Floats, times: Doubles, report_time: ReportTime) -> Trajectory:
        """Return the motion from a first state.

        Raises:
            StatusError: As `simulate`; the error, like that of an interruption, carries the part before it.
        """
        start = self._layout.join(x, y, np.zeros(y.shape[:-1], y.dtype))
        if start.ndim > 1 and self._method.is_adaptive:
            raise ArrayError(f"x: method {self._method.name!r} takes one state, got {len(start)}.")
        if start.ndim > 1 and self._crossings:
            raise OptionError(f"events: a motion with events begins in one state, not in {len(start)}.")
        integrator = self._method.integrator(self._motion)
        watch = Watch(self._motion, integrator, self._crossings) if self._crossings else None
        record = Record([float(times[0])], [start])
        marks = Marks.of(times, self._inputs.breaks)
        try:
            run(self._motion, integrator, start, marks, watch, record, report_time)
        except (StatusError, KeyboardInterrupt) as stopped:
            stopped.trajectory = self._made(record)  # type: ignore[union-attr]
            raise
        self._motion.report_inaccurate()
        return self._made(record)

    def _made(self, record: Record) -> Trajectory:
        """Return the trajectory of a record."""
        times, states = record.arrays
        x, y = self._layout.with_first_lengths(self._layout.x(states)), self._layout.y(states)
        found = Trajectory(
            self._library,
            times,
            x,
            y,
            states[..., -1],
            self._motion.evaluations,
            self._inputs.over(times, x, y),
            str(self._method),
            self._outputs,
            tuple(record.events),
        )
        warn_outside_limits(found)
        return found
