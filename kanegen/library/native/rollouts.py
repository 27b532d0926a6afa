"""The functions of a compiled library that make many steps, called with NumPy arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import _cffi_backend
import numpy as np
from numpy.typing import NDArray

from kanegen.c import ModelDescription
from kanegen.c.formats import Formats
from kanegen.c.steps import Rollout
from kanegen.errors import ArrayError, OptionError
from kanegen.library.native.constants import Constants
from kanegen.library.native.status import INACCURATE, NOT_FINITE, OnStatus, Status, StatusReport, report
from kanegen.model.arguments import (
    LOADS,
    MODEL_DEPENDENT,
    OPTIONAL,
    Floats,
    Shape,
    Values,
    companion,
    floats,
    load,
    required,
    state,
)
from kanegen.program.ir import PREPARED, Array

HOLDS: dict[str, Callable[[int], int]] = {
    "zero": lambda steps: steps,
    "linear": lambda steps: steps + 1,
    "quadratic": lambda steps: 2 * steps + 1,
}
"""Number of rows of an input over a number of steps, by the way in which it is held between them."""

PRESCRIBED = "prescribed"
"""Name of the input of the motion of prescribed freedoms."""

Counts = NDArray[np.uintp]
"""Numbers of steps."""


@dataclass(frozen=True)
class Course:
    """How far a rollout goes, and in which steps.

    Attributes:
        step: Length of a step, s.
        steps: Number of steps.
        every: Number of steps from one stored state to the next.
        hold: How inputs with rows are held over a step, one of `HOLDS`.
        compensated: Whether rounding errors of the additions to the state are compensated.
    """

    step: float
    steps: int
    every: int = 1
    hold: str = "zero"
    compensated: bool = False

    @property
    def kept(self) -> int:
        """Number T of stored states, the first included."""
        return self.steps // self.every + 1


@dataclass(frozen=True)
class Input:
    """An input of a rollout as C reads it.

    Attributes:
        array: (..., m) state, (...) time, or (..., R, *shape) rows of an input that is held over steps.
        rows: Number R of rows; None for an input that is not held.
    """

    array: Floats
    rows: int | None = None


class RolloutCall:
    """One C function that makes many steps, and its batch form.

    A call keeps nothing of its arguments, and C runs without the interpreter's lock, so threads may share a
    `RolloutCall`.
    """

    def __init__(
        self,
        library: Any,
        ffi: Any,
        arrays: Formats,
        model: ModelDescription,
        rollout: Rollout,
        arguments: tuple[str, ...],
        before_batch: Callable[[], None] | None = None,
    ) -> None:
        """Prepare everything that does not depend on the values.

        Args:
            library: Library of cffi that has the function.
            ffi: The declarations of cffi.
            arrays: Precisions of the arrays.
            model: Description of the model.
            rollout: The C function.
            arguments: Names of the values that the call takes, in order.
            before_batch: Function to call before each batch, from `openmp.before_batch`.
        """
        self._before_batch = before_batch
        self._name, self._status = rollout.name, Status.of(rollout.step, model)
        self._single = getattr(library, f"{model.name}_{rollout.name}")
        self._batch = getattr(library, f"{model.name}_{rollout.name}_batch")
        types = (arrays.storage.c_type, arrays.of(PREPARED).c_type, "size_t")
        self._pointer, self._prepared, self._counts = (
            partial(_cffi_backend.from_buffer, ffi.typeof(f"{one}[]")) for one in types
        )
        self._dtype, self._arguments = arrays.storage.dtype, arguments
        self._inputs = [array for array in rollout.inputs if array.name != PREPARED]
        self._held = {array.name for array in rollout.held}
        self._by_state = PREPARED not in rollout.step.shared
        self._unloaded = {name: model.unloaded(kind) for name, kind in LOADS.items()}
        words = {"count": len(model.prescribed_names), "prescribed": ", ".join(model.prescribed_names)}
        self._meanings = {name: text.format(**words) for name, text in MODEL_DEPENDENT.items()}
        self._takes_loads, self._system = model.takes_loads, model.shown

    def __call__(
        self, constants: Constants, values: Values, on_status: OnStatus = "ignore", *, course: Course
    ) -> tuple[Floats, Floats, Counts]:
        """Call the C function for one state, or its batch form for many.

        Args:
            constants: Prepared constants, from `NativeLibrary.constants`.
            values: The values of `arguments`, None where an optional one is left out.
            on_status: What to do with a status other than 0, see `status.report`.
            course: How far to go.

        Returns:
            (T, m) or (B, T, m) coordinates, (T, n) or (B, T, n) speeds, and () or (B,) numbers of steps
            before the one with a status, or of all steps.

        Raises:
            ArrayError: If a value has the wrong type or shape, or the system has no use for it.
            OptionError: If memory cannot hold the states of the course.
            StatusError: As `status.report`.
        """
        given = dict(zip(self._arguments, values, strict=True))
        inputs, batch = self._converted(given, course)
        constants.require(batch, "x")
        status, x, y, made = self._called(constants, inputs, batch, course)
        if status and on_status != "ignore":
            report(self._report(constants, inputs, (status, made, y), course), on_status)
        return x, y, made

    def _called(
        self, constants: Constants, inputs: Mapping[str, Input], batch: Shape, course: Course
    ) -> tuple[int, Floats, Floats, Counts]:
        """Call the C function and return its status, the stored states and numbers of steps."""
        x, y = self._paths([inputs[name].array.shape[-1] for name in "xy"], batch, course)
        made = np.empty(batch, np.uintp)
        arguments = [*constants.read(batch, self._by_state, self._prepared)]
        for one in inputs.values():
            arguments.append(self._pointer(one.array))
            arguments += [] if one.rows is None else [one.rows]
        arguments += [self._pointer(np.array([course.step], self._dtype)), course.steps, course.every]
        arguments += [course.compensated, self._pointer(x), self._pointer(y), self._counts(made)]
        if not batch:
            return int(self._single(*arguments)), x, y, made
        if self._before_batch is not None:
            self._before_batch()
        return int(self._batch(batch[0], *arguments)), x, y, made

    def _paths(self, sizes: Sequence[int], batch: Shape, course: Course) -> list[Floats]:
        """Return arrays for the stored coordinates and speeds.

        Raises:
            OptionError: If memory cannot hold them.
        """
        try:
            return [np.empty((*batch, course.kept, size), self._dtype) for size in sizes]
        except (MemoryError, ValueError):  # NumPy raises the second where the size is no index
            count = course.kept * (batch[0] if batch else 1)
            raise OptionError(
                f"steps: memory cannot hold {count} states, {count * sum(sizes) * self._dtype.itemsize:.2g} "
                "bytes. Store fewer of them with a larger `every`, or make fewer steps."
            ) from None

    def _converted(self, given: Mapping[str, object], course: Course) -> tuple[dict[str, Input], Shape]:
        """Return the inputs as C reads them, and `()` for one state or `(B,)` for a batch."""
        for name in ("force", "torque"):
            if given.get(name) is not None and not self._takes_loads:
                raise ArrayError(
                    f"{name}: no body of system {self._system!r} takes loads. Enter one among the loads of "
                    "the model."
                )
        found: dict[str, Input] = {}
        batch: Shape = ()
        for array in self._inputs:
            name, value = array.name, given[array.name]
            if name == "x":
                one = state(name, value, array.shape, self._dtype)
                batch = one.shape[:-1]
                found[name] = Input(one)
            elif name == "y":
                found[name] = Input(companion(name, value, array.shape, batch, self._dtype, "x"))
            elif name not in self._held:
                needed = required(name, value, self._meanings[name])
                found[name] = Input(load(name, needed, array.shape, batch, self._dtype, {}))
            else:
                found[name] = self._rows(array, value, batch, course)
        return found, batch

    def _rows(self, array: Array, value: object, batch: Shape, course: Course) -> Input:
        """Return the rows of an input that is held over steps.

        Raises:
            ArrayError: If the shape fits neither a constant nor a row for each place of the course, or both,
                or a row that takes no loads is not zero.
        """
        name, shape = array.name, array.shape
        if value is None and name in OPTIONAL:
            return Input(np.zeros(0, self._dtype), 0)
        given = floats(name, required(name, value, self._meanings.get(name, "")), self._dtype)
        rows, before = HOLDS[course.hold](course.steps), given.ndim - len(shape)
        lead = given.shape[:before] if before >= 0 and given.shape[before:] == shape else None
        meanings = [
            full
            for full in ((), (rows,), batch, (*batch, rows), (*batch, 1), (1, rows))
            if lead == full and (batch or full in ((), (rows,)))
        ]
        if not meanings:
            raise ArrayError(
                f"{name}: expected {shape} for a constant or {(rows, *shape)} for {course.hold} hold over "
                f"{course.steps} steps{', in a batch with B in front' if batch else ''}; got {given.shape}."
            )
        if name == PRESCRIBED and rows in (lead or ())[-1:] and course.hold != "quadratic":
            raise ArrayError(
                f"{name}: rows at the start, the middle and the end of each step are needed, whose values "
                'and rates belong together. Give hold="quadratic".'
            )
        if lead and batch == (rows,) and len(lead) == 1 and rows > 1:
            raise ArrayError(
                f"{name}: shape {given.shape} may mean a row for each state or one for each step, since both "
                f"are {rows}. Give shape {(rows, 1, *shape)} or {(1, rows, *shape)}."
            )
        if lead == batch and lead:
            given = given[:, None]
        elif len(lead or ()) < 2:
            given = given[None] if lead else given[None, None]
        given = np.broadcast_to(given, (*(batch or (1,)), *given.shape[1:]))
        self._require_unloaded(name, given)
        rows = given.shape[1]
        return Input(np.ascontiguousarray(given if batch else given[0]), rows)

    def _require_unloaded(self, name: str, rows: Floats) -> None:
        """Refuse loads on bodies or points that take none; `rows` is (B, R, *shape)."""
        for place, who in self._unloaded.get(name, {}).items():
            if rows[:, :, place].any():
                raise ArrayError(
                    f"{name}: row {place} is not zero, but {who} takes no loads. Enter it among the loads of "
                    "the model."
                )

    def _report(
        self,
        constants: Constants,
        inputs: Mapping[str, Input],
        found: tuple[int, Counts, Floats],
        course: Course,
    ) -> StatusReport:
        """Return the report of a rollout with a status: the first state concerned, its step, and the reason.

        Args:
            constants: Prepared constants.
            inputs: The inputs as C has read them.
            found: What the C function returned, numbers of steps before the status, and stored speeds.
            course: How far the rollout should go.
        """
        status, made, y = found
        if not made.ndim:
            when, words, kind = self._clause(status, inputs, constants, int(made), course)
            return StatusReport(f"{self._name}: {when} {words}", kind, is_alone=False, of_step=words)
        concerned = np.flatnonzero(made < course.steps)
        lost = [k for k in concerned if not np.isfinite(y[k, -1]).all()]
        first = int((lost or concerned)[0])
        alone = {
            name: Input(np.ascontiguousarray(one.array[first]), one.rows) if one.array.size else one
            for name, one in inputs.items()
        }
        own = constants.alone(first, self._prepared)
        code, *_ = self._called(own, alone, (), course)
        when, words, kind = self._clause(code, alone, own, int(made[first]), course)
        where = f"in {status} of {len(made)} states, first in state {first}"
        message = f"{self._name}: {where}, {when} {words}"
        return StatusReport(message, kind, is_alone=False, states=status, of_step=f"{where}, {words}")

    def _clause(
        self, status: int, inputs: Mapping[str, Input], constants: Constants, made: int, course: Course
    ) -> tuple[str, str, str]:
        """Return after how many steps a state has a status, the sentence on it, and its kind."""
        start = float(inputs["t"].array.reshape(-1)[0]) if "t" in inputs else 0.0
        when = f"after {made} of {course.steps} steps, at t = {start + made * course.step:.9g} s,"
        kind = self._status.kind(status)
        arrays: dict[str, Floats] = {name: one.array for name, one in inputs.items() if one.array.size}
        first = arrays | constants.inputs
        if kind == NOT_FINITE:
            cause = self._status.bad_input(first) if made == 0 else ""
            advice = f"because {cause}" if cause else "a smaller step may avoid this"
            return when, f"the next state is not finite: {advice}.", kind
        words = self._status.clause(status, first if made == 0 else {}, ())
        if kind == INACCURATE:
            return when, f"accelerations may not be accurate: {words}", kind
        return when, words, kind
