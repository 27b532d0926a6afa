"""The functions of a compiled library, called with NumPy arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import _cffi_backend
import numpy as np

from kanegen.c import ModelDescription
from kanegen.c.formats import Formats
from kanegen.c.interface import Function
from kanegen.errors import ArrayError
from kanegen.library.native.constants import Constants
from kanegen.library.native.status import OnStatus, States, Status, report
from kanegen.model.arguments import (
    ARGUMENTS,
    LOADS,
    MODEL_DEPENDENT,
    OPTIONAL,
    SHAREABLE,
    STEP,
    Floats,
    Shape,
    Values,
    companion,
    load,
    required,
    state,
)
from kanegen.program.ir import PREPARED
from kanegen.program.precision import Precision
from kanegen.recursion.outputs import INTEGRATORS, OUTPUTS

EVERY_ARGUMENT = tuple(name for name in ARGUMENTS if name not in MODEL_DEPENDENT)
"""Arguments of the function that computes all outputs, in order."""


def arguments_of(name: str) -> tuple[str, ...]:
    """Return the arguments of a function other than `prepare`, in order, but for those passed by name.

    Args:
        name: Name of an output, of a function that makes one step, or `EVALUATE`.
    """
    if name in INTEGRATORS:
        return (*OUTPUTS["forward_dynamics"].arguments, *STEP)
    return OUTPUTS[name].arguments if name in OUTPUTS else EVERY_ARGUMENT


class Call:
    """One C function and its batch form.

    A call keeps nothing of its arguments, and C runs without the interpreter's lock, so threads may share a
    `Call`.

    Attributes:
        dtype: Type of the numbers in its inputs.
    """

    def __init__(
        self,
        library: Any,
        pointers: Mapping[Precision, Callable[[Floats], Any]],
        arrays: Formats,
        model: ModelDescription,
        function: Function,
        arguments: tuple[str, ...],
        before_batch: Callable[[], None] | None = None,
    ) -> None:
        """Prepare everything that does not depend on the values.

        Args:
            library: Library of cffi that has the function.
            pointers: For each precision the function that returns a C pointer to an array.
            arrays: Precisions of the arrays.
            model: Description of the model.
            function: The C function.
            arguments: Names of the values that the call takes, in order.
            before_batch: Function to call before each batch, from `openmp.before_batch`.
        """
        self._before_batch = before_batch
        self._status = Status.of(function, model)
        name = f"{model.name}_{function.name}"
        self._single = getattr(library, name)
        self._batch: Any = getattr(library, f"{name}_batch") if function.has_batch else None
        read = arrays.of(function.inputs[-1].name)
        filled = arrays.of(function.outputs[0].name)
        self._pointer, self._result_pointer = pointers[read], pointers[filled]
        self.dtype, self._result_dtype = read.dtype, filled.dtype
        own = [array for array in function.inputs if array.name != PREPARED]
        # Whether each state of a batch has its own prepared constants.
        self._by_state = len(own) < len(function.inputs) and PREPARED not in function.shared
        self._prepared = pointers[arrays.arithmetic]
        self._inputs = [(a.name, arguments.index(a.name), a.shape + read.trailing_shape) for a in own]
        self._outputs = [array.shape + filled.trailing_shape for array in function.outputs]
        # Elements that the function does not fill are zero, as those above the diagonal of a lower triangle.
        made = [np.zeros if array.is_filled_in_part else np.empty for array in function.outputs]
        self._results: tuple[tuple[Any, Shape], ...] = tuple(zip(made, self._outputs, strict=True))
        self._result_names = [array.name for array in function.outputs]
        self._meaning = _meaning_of_named_inputs(model)
        self._unloaded = {name: model.unloaded(kind) for name, kind in LOADS.items()}
        # Place of the force among the values, which the torque follows, if no body takes loads; else 0.
        self._unused_force = 0 if model.takes_loads or "force" not in arguments else arguments.index("force")
        self._system = model.shown
        # For each input: its place among the values, its shape, zeros for an optional one that is left out,
        # and whether every row may differ from zero.
        self._plan = [
            (k, shape, self._zeros(shape) if n in OPTIONAL else None, not self._unloaded.get(n))
            for n, k, shape in self._inputs
        ]

    def _zeros(self, shape: tuple[int, ...]) -> Any:
        """Return a pointer to an array of zeros."""
        return self._pointer(np.zeros(shape, self.dtype))

    def __call__(self, constants: Constants, values: Values, on_status: OnStatus = "ignore") -> list[Floats]:
        """Call the C function for one state, or its batch form for many.

        Args:
            constants: Prepared constants, from `NativeLibrary.constants`.
            values: The values of `arguments`, None where an optional one is left out.
            on_status: What to do with a status other than 0, see `status.report`.

        Returns:
            An array for each output.

        Raises:
            ArrayError: If a value has the wrong type or shape, or the system has no use for it.
            StatusError: As `status.report`.
        """
        force = self._unused_force
        if force and not (values[force] is None and values[force + 1] is None):
            raise self._unused_load("force" if values[force] is not None else "torque")
        if constants.sets is not None:
            return self._general(constants, values, on_status)
        pointer, dtype = self._pointer, self.dtype
        pointers = [*constants.pointers]
        for k, shape, zeros, is_plain in self._plan:
            value = values[k]
            if (
                type(value) is np.ndarray
                and value.shape == shape
                and value.dtype is dtype
                and value.flags.carray
                and is_plain
            ):
                pointers.append(pointer(value))
            elif value is None and zeros is not None:
                pointers.append(zeros)
            else:
                return self._general(constants, values, on_status)
        results = []
        for made, shape in self._results:
            result = made(shape, self._result_dtype)
            results.append(result)
            pointers.append(self._result_pointer(result))
        status = self._single(*pointers)
        if status and on_status != "ignore":
            # An optional value that was left out is zero, and cannot be why a result is not finite.
            read = {name: values[k] for name, k, _ in self._inputs}
            inputs = {name: value for name, value in read.items() if isinstance(value, np.ndarray)}
            self.react(status, constants, inputs, results, (), on_status)
        return results

    def _general(self, constants: Constants, values: Values, on_status: OnStatus = "ignore") -> list[Floats]:
        """Call the C function after conversion of the values, with every check."""
        arrays, batch = self._converted(values)
        constants.require(batch, self._inputs[0][0])
        results = self._new_results(batch)
        pointers = [
            *constants.read(batch, self._by_state, self._prepared),
            *map(self._pointer, arrays),
            *map(self._result_pointer, results),
        ]
        inputs = {name: array for (name, *_), array in zip(self._inputs, arrays, strict=True)}
        status = (
            self._many(batch[0], pointers) if batch and self._batch is not None else self._single(*pointers)
        )
        if status and on_status != "ignore":
            self.react(status, constants, inputs, results, batch, on_status)
        return results

    def react(
        self,
        status: int,
        constants: Constants,
        inputs: Mapping[str, Floats],
        results: Sequence[Floats],
        batch: tuple[int, ...],
        on_status: OnStatus,
    ) -> None:
        """Report a status other than 0.

        Args:
            status: What the C function returned; its batch form returns a number of states.
            constants: Prepared constants that it has read.
            inputs: Arrays that it has read, by name; for a batch all of them.
            results: Arrays that it has filled.
            batch: `()` for one state or `(B,)` for a batch.
            on_status: What to do, see `status.report`.

        Raises:
            StatusError: As `status.report`.
        """
        if not batch or self._batch is None:
            report(self._status.of_state(status, {**inputs, **constants.inputs}, results), on_status)
            return
        states = partial(self._some, constants, list(inputs.values()))
        read = {**inputs, **(constants.inputs if constants.sets is not None else {})}
        report(self._status.of_batch(status, read, results, states), on_status)

    def _new_results(self, batch: tuple[int, ...]) -> list[Floats]:
        """Return new arrays for the results of `()` one state or `(B,)` many."""
        return [made((*batch, *shape), self._result_dtype) for made, shape in self._results]

    def arrays(self, batch: tuple[int, ...]) -> tuple[dict[str, Floats], dict[str, Floats]]:
        """Return new arrays by name: zeros for the inputs, NaN for the results, 0 for what is never filled.

        Args:
            batch: `()` for one state or `(B,)` for a batch.
        """
        inputs = {name: np.zeros((*batch, *shape), self.dtype) for name, shape in self.shapes[0].items()}
        results = dict(zip(self._result_names, self._new_results(batch), strict=True))
        for array, (made, _) in zip(results.values(), self._results, strict=True):
            array.fill(0.0 if made is np.zeros else np.nan)
        return inputs, results

    @property
    def shapes(self) -> tuple[dict[str, Shape], dict[str, Shape]]:
        """Shapes of the inputs and of the results for one state, by name, in the order of the C function."""
        inputs = {name: shape for name, _, shape in self._inputs}
        return inputs, dict(zip(self._result_names, self._outputs, strict=True))

    def bound(
        self,
        constants: Constants,
        inputs: Sequence[Floats],
        results: Sequence[Floats],
        batch: tuple[int, ...],
    ) -> Callable[[], int]:
        """Return a function without arguments that calls C with some arrays and returns the status.

        Args:
            constants: Prepared constants.
            inputs: Contiguous arrays that C reads, as `arrays` makes them.
            results: Contiguous arrays that C fills. The caller keeps all arrays and constants alive as long
                as the function.
            batch: `()` for one state or `(B,)` for a batch.

        Raises:
            ArrayError: If there are more or fewer sets of parameters than states.
        """
        constants.require(batch, self._inputs[0][0])
        pointers = (
            *constants.read(batch, self._by_state, self._prepared),
            *map(self._pointer, inputs),
            *map(self._result_pointer, results),
        )
        if batch:
            return partial(self._many, batch[0], pointers)
        # Pointers of the very types of the arguments are passed on as they are, which takes least time.
        types = _cffi_backend.typeof(self._single).args
        return partial(self._single, *map(_cffi_backend.cast, types, pointers))

    @property
    def unloaded(self) -> dict[str, Mapping[int, str]]:
        """For each load of which only some rows are read, the other rows with their bodies or points."""
        return {name: rows for name, *_ in self._inputs if (rows := self._unloaded.get(name, {}))}

    def _some(self, constants: Constants, arrays: Sequence[Floats], states: States) -> int:
        """Return the status of one state of a batch, or of several how many have another status than 0.

        Args:
            constants: Prepared constants.
            arrays: Inputs of the batch.
            states: Numbers of the states.
        """
        chosen = [np.ascontiguousarray(array[states]) for array in arrays]
        results = self._new_results((len(states),))
        own = constants.of(states).read(states.shape, self._by_state, self._prepared)
        pointers = (*own, *map(self._pointer, chosen), *map(self._result_pointer, results))
        return int(self._single(*pointers)) if len(states) == 1 else self._many(len(states), pointers)

    def _many(self, count: int, pointers: Sequence[Any]) -> int:
        """Call the batch form and return how many of `count` states have another status than 0."""
        if self._before_batch is not None:
            self._before_batch()
        return int(self._batch(count, *pointers))

    def _unused_load(self, name: str) -> ArrayError:
        """Return the error that says that a load was passed and no body takes loads."""
        return ArrayError(
            f"{name}: no body of system {self._system!r} takes loads. Enter one among the loads of the model."
        )

    def _converted(self, values: Values) -> tuple[list[Floats], tuple[int, ...]]:
        """Return the inputs as C reads them, and `()` for one state or `(B,)` for a batch."""
        (first, k, shape), *others = self._inputs
        arrays = [state(first, values[k], shape, self.dtype)]
        batch = arrays[0].shape[: arrays[0].ndim - len(shape)]
        for name, k, shape in others:
            if name in SHAREABLE:
                unloaded = self._unloaded.get(name, {})
                value = values[k] if name in OPTIONAL else required(name, values[k], self._meaning[name])
                arrays.append(load(name, value, shape, batch, self.dtype, unloaded))
            else:
                arrays.append(companion(name, values[k], shape, batch, self.dtype, first))
        return arrays, batch


def _meaning_of_named_inputs(model: ModelDescription) -> dict[str, str]:
    """Return a description of each input that is passed by name, for error messages."""
    names = model.prescribed_names
    words = {"count": len(names), "prescribed": ", ".join(names)}
    return {name: meaning.format(**words) for name, meaning in (MODEL_DEPENDENT | STEP).items()}
