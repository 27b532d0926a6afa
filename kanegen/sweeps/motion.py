"""The motions of all rows of a chunk, in blocks of times, by rollouts in C."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kanegen.errors import QUOTED, excerpt
from kanegen.library import Library
from kanegen.library.native.status import NO_CONVERGENCE, NOT_CONVERGED, TOO_LONG
from kanegen.library.rollouts import Rollout
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Flags
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.nodes import TIME
from kanegen.recursion.outputs import OUTPUTS
from kanegen.sweeps.inputs import Inputs
from kanegen.sweeps.job import RolloutJob

NOT_FINITE = "the next state is not finite. A smaller step may avoid this."

BLOCK = 64
"""Times whose states are in memory at once; it does not depend on the number of rows, see `statistics`."""

HOLD = "quadratic"
"""How inputs that depend on the time are held over a step: by values at its start, middle and end."""

STEPS_WITH_INPUTS = 1024
"""Largest number of steps of one rollout with inputs that depend on the time, which are arrays."""


@dataclass
class States:
    """The states of B rows at K times, and outputs in them.

    Attributes:
        times: (K,) times, s.
        x: (B, K, m) coordinates.
        y: (B, K, n) speeds.
        library: Library that computes outputs.
        arguments: (B K, ...) further arguments of outputs by name.
    """

    times: Doubles
    x: Floats
    y: Floats
    library: Library
    arguments: dict[str, Any]
    _known: dict[str, Floats] = field(default_factory=dict)

    def array(self, name: str) -> Floats:
        """Return the (B, K, ...) numbers of "x", of "y", or of an output, with one axis for its elements."""
        if name in ("x", "y"):
            return self.x if name == "x" else self.y
        if name not in self._known:
            self._known[name] = self._output(name)
        return self._known[name].reshape(*self.x.shape[:2], -1)

    def _output(self, name: str) -> Floats:
        """Return the (B K, ...) numbers of an output."""
        given: dict[str, Any] = {"x": self.x, "y": self.y}
        given = {key: value.reshape(-1, value.shape[-1]) for key, value in given.items()}
        if "ydot" in OUTPUTS[name].arguments:
            given["ydot"] = self.array("forward_dynamics").reshape(given["y"].shape)
        further = {
            key: value
            for key, value in self.arguments.items()
            if key in OUTPUTS[name].inputs or key in ("parameters", "prescribed")
        }
        own = {key: value for key, value in given.items() if key in OUTPUTS[name].arguments}
        found: Floats = getattr(self.library, name)(**own, **further)
        return found


class Motion:
    """The motions of B rows."""

    def __init__(
        self,
        library: Library,
        job: RolloutJob,
        inputs: Inputs,
        columns: Mapping[str, Doubles],
        size: int,
    ) -> None:
        """Prepare the motions.

        Args:
            library: Library with the method and the outputs of the job.
            job: The job.
            inputs: How numbers of axes become arguments.
            columns: (B,) numbers of the axes, by name.
            size: Number of rows B.
        """
        self._library = library
        self._job, self._inputs, self._columns, self._size = job, inputs, columns, size
        self._sets = inputs.parameter_sets(columns)
        self._reasons = [""] * size
        self._is_finite = np.ones(size, np.bool_)

    @property
    def failed(self) -> Flags:
        """(B,) flags of the rows whose state has stopped being finite."""
        return ~self._is_finite

    @property
    def reasons(self) -> tuple[str, ...]:
        """(B,) why a row has failed or may be inaccurate, "" for the others."""
        return tuple(self._reasons)

    def blocks(self) -> Iterator[States]:
        """Yield the states at the times of the job, the first of them alone."""
        x: Floats
        y: Floats
        x, y = self._inputs.first_state(self._columns, self._size)
        every, looks = self._job.looks()
        yield self._states(np.zeros(1), x[:, None], y[:, None])
        for first in range(0, looks - 1, BLOCK):
            count = min(BLOCK, looks - 1 - first)
            times = np.arange(first + 1.0, first + count + 1.0) * (every * self._job.step)
            paths = self._follow(x, y, first * every, count, every)
            x, y = (np.ascontiguousarray(path[:, -1]) for path in paths)
            yield self._states(times, *paths)

    def _follow(self, x: Floats, y: Floats, first: int, looks: int, every: int) -> tuple[Floats, Floats]:
        """Return the (B, K, m) coordinates and (B, K, n) speeds at the next looks.

        Args:
            x: (B, m) coordinates at the beginning.
            y: (B, n) speeds at the beginning.
            first: Number of steps before the beginning.
            looks: Number of looks K.
            every: Number of steps from one to the next.
        """
        if not self._inputs.timed or looks * every <= STEPS_WITH_INPUTS:
            return self._rollout(x, y, first, looks * every, every)
        paths: list[tuple[Floats, Floats]] = []
        for look in range(looks):
            start = first + look * every
            for begin in range(start, start + every, STEPS_WITH_INPUTS):
                count = min(STEPS_WITH_INPUTS, start + every - begin)
                path = self._rollout(x, y, begin, count, count)
                x, y = (np.ascontiguousarray(one[:, -1]) for one in path)
            paths.append((x, y))
        return np.stack([one for one, _ in paths], axis=1), np.stack([one for _, one in paths], axis=1)

    def _rollout(self, x: Floats, y: Floats, first: int, steps: int, every: int) -> tuple[Floats, Floats]:
        """Return the states at every `every`-th of some steps, without the first one."""
        found = self._called(self._library, x, y, first, steps, every)
        bad = np.flatnonzero(found.made < steps)
        self._is_finite &= np.isfinite(found.x[:, -1]).all(axis=1) & np.isfinite(found.y[:, -1]).all(axis=1)
        for row in bad:
            if not self._reasons[row]:
                self._reasons[row] = self._reason(x, y, first, int(found.made[row]), int(row))
        return found.x[:, 1:], found.y[:, 1:]

    def _reason(self, x: Floats, y: Floats, first: int, made: int, row: int) -> str:
        """Return why a row failed or may be inaccurate, from the last state before, which is found again."""
        rows = slice(row, row + 1)
        last = self._called(self._library, x, y, first, made, max(made, 1), rows)
        time = (first + made) * self._job.step
        state = self._states(np.array([time]), last.x[:, -1:], last.y[:, -1:], rows)
        messages: list[str] = []
        library = self._library.with_on_status(lambda report: messages.append(report.message))
        x, y = state.x[0, 0], state.y[0, 0]
        arguments: dict[str, Any] = {
            name: own[0] for name, own in state.arguments.items() if name != "parameters"
        }
        if self._sets:
            arguments["parameters"] = {name: float(own[row]) for name, own in self._sets.items()}
        library.forward_dynamics(x, y, **arguments)
        numbers = np.concatenate([x, y])
        names = [f"x.{name}" for name in self._library.coordinate_names]
        names += [f"y.{name}" for name in self._library.speed_names]
        values = ", ".join(f"{name} = {value:.6g}" for name, value in zip(names, numbers, strict=True))
        why = " ".join(messages) or self._why_no_state((x, y), first + made, row)
        return f"in the step from t = {time:.9g} s, {excerpt(values, QUOTED)}: {why}"

    def _why_no_state(self, state: tuple[Floats, Floats], made: int, row: int) -> str:
        """Return why the step from a state with accelerations leads to none.

        Args:
            state: (m,) coordinates and (n,) speeds.
            made: Number of steps before.
            row: Number of the row.
        """
        x, y = (np.tile(one, (row + 1, 1)) for one in state)
        kinds: list[str] = []
        library = self._library.with_on_status(lambda report: kinds.append(report.kind))
        self._called(library, x, y, made, 1, 1, slice(row, row + 1))
        return f"{NO_CONVERGENCE}: {TOO_LONG}" if NOT_CONVERGED in kinds else NOT_FINITE

    def _called(
        self,
        library: Library,
        x: Floats,
        y: Floats,
        first: int,
        steps: int,
        every: int,
        rows: slice = slice(None),
    ) -> Rollout:
        """Call the rollout of a library for some rows."""
        columns = {name: column[rows] for name, column in self._columns.items()}
        arguments: dict[str, Any] = self._inputs.over_steps(columns, first, steps, self._job.step)
        if TIME in library.further_inputs:
            arguments[TIME] = np.full(len(x[rows]), first * self._job.step)
        if self._sets:
            arguments["parameters"] = {name: own[rows] for name, own in self._sets.items()}
        job = self._job
        return library.rollout(
            x[rows],
            y[rows],
            steps=steps,
            step=job.step,
            every=every,
            method=job.method,
            hold=HOLD,
            compensated=job.compensated,
            **arguments,
        )

    def _states(self, times: Doubles, x: Floats, y: Floats, rows: slice = slice(None)) -> States:
        """Return states of some rows, with the further arguments of outputs in them."""
        size, looks = x.shape[:2]
        arguments: dict[str, Any] = {}
        for name, own in self._inputs.at(self._columns, times).items():
            full = np.broadcast_to(own[rows], (size, looks, *own.shape[2:]))
            arguments[name] = np.ascontiguousarray(full).reshape(size * looks, *own.shape[2:])
        if self._sets:
            arguments["parameters"] = {name: np.repeat(own[rows], looks) for name, own in self._sets.items()}
        if TIME in self._library.further_inputs:
            arguments[TIME] = np.tile(times, size)
        return States(times, np.ascontiguousarray(x), np.ascontiguousarray(y), self._library, arguments)
