"""Fixed steps that run in C: the rollouts of a library, in parts between which results are looked at."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from kanegen.errors import StatusError
from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.recursion.outputs.integrators import ROLLOUT
from kanegen.simulation.integration import Step
from kanegen.simulation.motion import Motion
from kanegen.simulation.sampled_inputs import StepInputs
from kanegen.simulation.stretches import Flags, Marks, Stretch, steps_between
from kanegen.simulation.work import do_work, work_of_steps

IN_C = {
    "RK4": "rk4",
    "euler": "euler",
    "semi_implicit_euler": "semi_implicit_euler",
    "implicit_midpoint": "implicit_midpoint",
    "variational_midpoint": "variational_midpoint",
    "linearly_implicit": "linearly_implicit",
}
"""Methods that the C has, with the end of the names of their functions."""

_STAGES = {"RK4": 4}
"""Evaluations of {ydot} in a step of methods that take several; those that iterate count steps."""

_LONGEST = 1024
"""Number of steps of a rollout, so that a motion that is interrupted loses no more."""

_ALIKE = 8
"""Difference of intervals that rounding of their ends makes, in units of the last place of the times."""


def why_not_in_c(method: str, motion: Motion) -> str:
    """Return why the rollouts of a library do not compute a motion, in a sentence; "" if they do."""
    function = f"{ROLLOUT}{IN_C.get(method)}"
    if function not in motion.library.source.integrators:
        return f"Build the library with the output {function!r}."
    if motion.inputs.depend_on_state:
        return (
            "It runs in C, where inputs depend on the time alone. Give forces that depend on the state to "
            "the model, as drives."
        )
    return ""


@dataclass(frozen=True)
class CompiledSteps:
    """Steps of fixed length in C: each interval between two marks is cut into equal steps.

    Attributes:
        motion: Right side of the equations of motion, on which nothing acts that depends on the state.
        method: One of `IN_C`.
        one_step: The same step in NumPy, which says what fails where a step fails; None where there is none.
        step: Largest step, s.
        compensated: Whether the rounding errors of the additions to the state are compensated.
    """

    motion: Motion
    method: str
    one_step: Step | None
    step: float
    compensated: bool = False

    def stretches(self, start: Floats, marks: Marks, every: bool) -> Iterator[Stretch]:
        """Yield the motion from a first state, see `Integrator`."""
        state = start
        inputs = self.motion.inputs
        jumps = np.empty(0) if inputs.are_held else inputs.jumps
        for first, last, count in _alike(marks, self.step, np.isin(marks.times, jumps)):
            stored = 1 if every or self._does_work else count
            at_once = max(1, _LONGEST // count)
            for left in range(first, last, at_once):
                right = min(left + at_once, last)
                for stretch in self._parts(state, marks, (left, right), count, stored):
                    yield stretch
                    state = stretch.states[-1]

    def _parts(
        self, state: Floats, marks: Marks, ends: tuple[int, int], count: int, stored: int
    ) -> Iterator[Stretch]:
        """Yield the steps of some equal intervals, or of a part of one interval at a time.

        Args:
            state: State at the first mark.
            marks: Times at which steps end.
            ends: Numbers of the first and the last mark.
            count: Number of steps of each interval.
            stored: Number of steps between stored states: 1 or `count`.
        """
        left, right = ends
        begin, end = float(marks.times[left]), float(marks.times[right])
        total = count * (right - left)
        length = (end - begin) / total
        done = 0
        while done < total:
            part = min(total - done, _LONGEST)
            rows = stored if part % stored == 0 else part
            states, made = self._rollout(state, begin + done * length, part, length, rows)
            places = done + rows * np.arange(len(states))
            times = np.asarray(begin + places * length, np.float64)
            whole, rest = np.divmod(places, count)
            at_mark = rest == 0
            times[at_mark] = marks.times[left + whole[at_mark]]
            wanted = at_mark & marks.wanted[np.minimum(left + whole, right)]
            wanted[0] = False
            kept = len(states) if made == part else made // rows + 1
            yield Stretch(times[:kept], states[:kept], wanted[:kept])
            if made < part:
                if made == 0 and times[0] == marks.times[0]:
                    self.motion.evaluations = 0  # the motion does not begin, whatever the step
                self._explain(states, times, made, length, rows)
                wanted[kept - 1] = False
                yield Stretch(times[kept - 1 :], states[kept - 1 :], wanted[kept - 1 :])
            done, state = done + part, states[-1]

    def _rollout(
        self,
        state: Floats,
        time: float,
        steps: int,
        length: float,
        every: int,
        library: Library | None = None,
    ) -> tuple[Floats, int]:
        """Return the states of some steps, the first state included, and after how many steps one fails.

        Reports of failing steps are ignored unless a `library` is given, which has them.
        """
        motion, layout = self.motion, self.motion.state
        motion.evaluations += _STAGES.get(self.method, 1) * steps
        acting = StepInputs.of(motion.inputs, time, steps, length)
        given: dict[str, Any] = {"t": time} if "t" in motion.library.further_inputs else {}
        given |= {name: rows.astype(state.dtype) for name, rows in acting.rows.items()}
        found = (library or motion.library.with_on_status("ignore")).rollout(
            layout.x(state),
            layout.y(state),
            steps=steps,
            step=length,
            every=every,
            method=IN_C[self.method],
            hold=acting.hold,
            compensated=self.compensated,
            **{name: rows[None] if state.ndim > 1 and name != "t" else rows for name, rows in given.items()},
        )
        x, y = found.x, found.y
        if state.ndim > 1:
            x, y = np.moveaxis(x, 1, 0), np.moveaxis(y, 1, 0)
        work = np.broadcast_to(state[..., -1], y.shape[:-1]).copy()
        if self._does_work:
            times = time + length * np.arange(len(x), dtype=np.float64)
            work[1:] += np.cumsum(work_of_steps(motion.library, x, y, times, acting, length), axis=0)
        return layout.join(x, y, work), int(np.min(found.made))

    @property
    def _does_work(self) -> bool:
        """Whether there is work to count, for which the states after all steps are needed."""
        return self.motion.counts_work and do_work(self.motion.library, self.motion.inputs.arguments_given)

    def _explain(self, states: Floats, times: Floats, made: int, length: float, rows: int) -> None:
        """Say why a step fails or may be inaccurate, by the same steps in NumPy, or in C one by one.

        Raises:
            StatusError: If accelerations are missing or not finite; the message has the time.
        """
        row = made // rows
        time, state = float(times[row]), states[row]
        for _ in range(made - row * rows + 1):
            self.motion.interval = time, time + length
            if self.one_step is None:
                state = self._reported_step(time, length, state)
            else:
                state = state + self.one_step(self.motion, time, length, state)
            time += length
            if not np.isfinite(state).all():
                return

    def _reported_step(self, time: float, length: float, state: Floats) -> Floats:
        """Return the state after a step in C, whose failure is reported as that of any function."""
        x, y = self.motion.state.x(state), self.motion.state.y(state)
        library = self.motion.library_at(time, x, y, length)
        states, _ = self._rollout(state, time, 1, length, 1, library)
        last: Floats = states[-1]
        return last

    def advance(self, time: float, state: Floats, until: float) -> Floats:
        """Return the state at a later time (s) by one step from the state at `time`."""
        states, made = self._rollout(state, time, 1, until - time, 1)
        if made < 1 and not np.isfinite(states[-1]).all():
            raise StatusError(f"at t = {until:.9g} s: the state is not finite.")
        last: Floats = states[-1]
        return last


def _alike(marks: Marks, step: float, jumps: Flags) -> Iterator[tuple[int, int, int]]:
    """Yield first and last mark of intervals of one length, and the number of steps of each of them.

    Args:
        marks: Times at which steps end.
        step: Largest step, s.
        jumps: (M,) whether an input jumps at a mark, at which intervals then end.
    """
    first = 0
    times = marks.times.tolist()
    for k, (begin, end) in enumerate(pairwise(times)):
        change = (end - begin) - (times[first + 1] - times[first])
        if (k > first and jumps[k]) or abs(change) > _ALIKE * math.ulp(max(abs(times[first]), abs(end))):
            yield first, k, steps_between(times[first], times[first + 1], step)
            first = k
    yield first, len(times) - 1, steps_between(times[first], times[first + 1], step)
