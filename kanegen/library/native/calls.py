"""The functions of a compiled library, loaded with cffi and called with NumPy arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import _cffi_backend
import cffi
import numpy as np
from numpy.typing import ArrayLike

from kanegen.c import ModelDescription, Source
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function
from kanegen.errors import ArrayError, BuildError, OptionError, quoted
from kanegen.library.native import cache, floating_point, openmp, processor
from kanegen.library.native.build import Recipe, made
from kanegen.library.native.constants import Constants
from kanegen.library.native.rollouts import RolloutCall
from kanegen.library.native.status import OnStatus, States, Status, naming, report
from kanegen.model.arguments import (
    ARGUMENTS,
    LOADS,
    MODEL_DEPENDENT,
    OPTIONAL,
    SHAREABLE,
    STEP,
    Floats,
    Values,
    companion,
    load,
    required,
    state,
)
from kanegen.program.ir import EVALUATE, PARAMETERS, PREPARED
from kanegen.program.precision import Precision
from kanegen.recursion.outputs import INTEGRATORS, OUTPUTS

EVERY_ARGUMENT = tuple(name for name in ARGUMENTS if name not in MODEL_DEPENDENT)
"""Arguments of the function that computes all outputs, in order."""

_NEVER_UNLOAD = getattr(os, "RTLD_NODELETE", 0)
"""Flag of `dlopen` that keeps a library mapped: the threads of its OpenMP runtime outlive the `Library`."""


class NativeLibrary:
    """A shared library in memory.

    Attributes:
        recipe: What was compiled and how.
        path: Path of the shared library.
        named_inputs: Names of the inputs that some function reads and that are passed by name.
        calls: The functions by name without prefix; `EVALUATE` computes all outputs, also where there is one.
        rollouts: The functions that make many steps, by name without prefix.
        parameter_type: Type of the numbers in arrays of run-time parameters.
    """

    def __init__(self, recipe: Recipe, path: Path) -> None:
        """Load the shared library `path` that was compiled by `recipe`.

        Raises:
            BuildError: If the library cannot be loaded, or changes the arithmetic of the process.
        """
        self.recipe = recipe
        self.path = path
        source = recipe.source
        read = {array.name for function in source.functions for array in function.inputs}
        self.named_inputs = tuple(name for name in MODEL_DEPENDENT if name in read)
        ffi = cffi.FFI()
        ffi.cdef(source.cdef)
        arrays = formats(source.variant)
        # The function behind `ffi.from_buffer`, which takes twice as long.
        pointers = {
            precision: partial(_cffi_backend.from_buffer, ffi.typeof(f"{precision.c_type}[]"))
            for precision in arrays.every
        }
        self._prepared = pointers[arrays.arithmetic]
        self.parameter_type = arrays.parameters.dtype
        functions = {function.name: function for function in source.functions}
        if len(source.outputs) == 1:
            functions[EVALUATE] = functions[source.outputs[0]]
        try:
            with floating_point.unchanged(path):
                library = ffi.dlopen(str(path), ffi.RTLD_NOW | _NEVER_UNLOAD)
            before_batch = openmp.before_batch(path)
            self.calls = {
                name: Call(
                    library,
                    pointers,
                    arrays,
                    source.model,
                    function,
                    self._arguments(name, function),
                    before_batch,
                )
                for name, function in functions.items()
            }
            self.rollouts = {
                one.name: RolloutCall(
                    library,
                    ffi,
                    arrays,
                    source.model,
                    one,
                    self._arguments(one.step.name, one.step),
                    before_batch,
                )
                for one in source.rollouts
            }
        except (OSError, AttributeError) as error:
            raise BuildError(
                f"{path}: the compiled library cannot be loaded: {error}. Does the compiler make code for "
                "this machine?"
            ) from error

    @classmethod
    def made(cls, recipe: Recipe) -> NativeLibrary:
        """Compile a library, or find it in the cache, and load it.

        Raises:
            BuildError: If there is no compiler, it fails, or the compiled library cannot be loaded.
        """
        return made(recipe.product(), partial(cls, recipe))

    @classmethod
    def found(cls, recipe: Recipe, entry: str, file: str, machine: str) -> NativeLibrary:
        """Load a library that another process has made, without a compiler where that is possible.

        Args:
            recipe: What was compiled and how.
            entry: Name of its entry in the cache of that process.
            file: Name of its file.
            machine: Fingerprint of the machine of that process.

        Raises:
            BuildError: If the library has to be made again and cannot be made.
        """
        path = cache.find(entry, file) if machine == processor.fingerprint() else None
        with suppress(BuildError):  # another process has removed it meanwhile
            if path is not None:
                return cls(recipe, path)
        return cls.made(recipe)

    @property
    def source(self) -> Source:
        """The generated C that was compiled."""
        return self.recipe.source

    def constants(
        self,
        parameters: ArrayLike,
        on_status: OnStatus,
        changed: Mapping[str, float] = MappingProxyType({}),
    ) -> Constants:
        """Return the first argument of every `Call`: the results of `prepare` for some run-time parameters.

        Args:
            parameters: (P,) values in the order of the C array, or (B, P) for each state of a batch.
            on_status: What to do where a constant is missing or not finite, see `status.report`.
            changed: The parameters that were set, which a report then names.

        Raises:
            ArrayError: If the values have another shape or type.
            OptionError: If there is a set for each state, and the C has no such functions.
            StatusError: As `status.report`.
        """
        prepare = self.calls.get(PREPARE)
        if prepare is None:
            return Constants()
        sets = state(PARAMETERS, parameters, (len(self.source.model.parameters),), self.parameter_type)
        if sets.ndim > 1 and not self.source.parameters_by_state:
            raise OptionError(
                f"parameters: system {quoted(self.source.model.shown)} was built with one set of parameters "
                "for all states of a batch. Build it with parameters_by_state=True."
            )
        (array,) = prepare(Constants(), (sets,), naming(changed, on_status))
        pointers = () if sets.ndim > 1 else (self._prepared(array),)
        return Constants(pointers, array, sets, tuple(name for name, _ in self.source.model.parameters))

    def _arguments(self, name: str, function: Function) -> tuple[str, ...]:
        """Return the names of the values that a call takes, in the order of the table of outputs."""
        if name == PREPARE:
            return tuple(array.name for array in function.inputs)
        return (*arguments_of(name), *self.named_inputs)


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
        self._dtype, self._result_dtype = read.dtype, filled.dtype
        own = [array for array in function.inputs if array.name != PREPARED]
        # Whether each state of a batch has its own prepared constants.
        self._by_state = len(own) < len(function.inputs) and PREPARED not in function.shared
        self._prepared = pointers[arrays.arithmetic]
        self._inputs = [(a.name, arguments.index(a.name), a.shape + read.trailing_shape) for a in own]
        self._outputs = [array.shape + filled.trailing_shape for array in function.outputs]
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
        return self._pointer(np.zeros(shape, self._dtype))

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
        pointer, dtype = self._pointer, self._dtype
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
        for shape in self._outputs:
            result = np.empty(shape, self._result_dtype)
            results.append(result)
            pointers.append(self._result_pointer(result))
        status = self._single(*pointers)
        if status and on_status != "ignore":
            # An optional value that was left out is zero, and cannot be why a result is not finite.
            read = {name: values[k] for name, k, _ in self._inputs}
            inputs = {name: value for name, value in read.items() if isinstance(value, np.ndarray)}
            report(self._status.of_state(status, inputs | constants.inputs, results), on_status)
        return results

    def _general(self, constants: Constants, values: Values, on_status: OnStatus = "ignore") -> list[Floats]:
        """Call the C function after conversion of the values, with every check."""
        arrays, batch = self._converted(values)
        constants.require(batch, self._inputs[0][0])
        results = [np.empty((*batch, *shape), self._result_dtype) for shape in self._outputs]
        pointers = [
            *constants.read(batch, self._by_state, self._prepared),
            *map(self._pointer, arrays),
            *map(self._result_pointer, results),
        ]
        inputs = {name: array for (name, *_), array in zip(self._inputs, arrays, strict=True)}
        if not batch or self._batch is None:
            status = self._single(*pointers)
            if status and on_status != "ignore":
                report(self._status.of_state(status, inputs | constants.inputs, results), on_status)
            return results
        failed = self._many(batch[0], pointers)
        if failed and on_status != "ignore":
            inputs |= constants.inputs if constants.sets is not None else {}
            states = partial(self._some, constants, arrays)
            report(self._status.of_batch(failed, inputs, results, states), on_status)
        return results

    def _some(self, constants: Constants, arrays: Sequence[Floats], states: States) -> int:
        """Return the status of one state of a batch, or of several how many have another status than 0.

        Args:
            constants: Prepared constants.
            arrays: Inputs of the batch.
            states: Numbers of the states.
        """
        chosen = [np.ascontiguousarray(array[states]) for array in arrays]
        results = [np.empty((len(states), *shape), self._result_dtype) for shape in self._outputs]
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
        arrays = [state(first, values[k], shape, self._dtype)]
        batch = arrays[0].shape[: arrays[0].ndim - len(shape)]
        for name, k, shape in others:
            if name in SHAREABLE:
                unloaded = self._unloaded.get(name, {})
                value = values[k] if name in OPTIONAL else required(name, values[k], self._meaning[name])
                arrays.append(load(name, value, shape, batch, self._dtype, unloaded))
            else:
                arrays.append(companion(name, values[k], shape, batch, self._dtype, first))
        return arrays, batch


def _meaning_of_named_inputs(model: ModelDescription) -> dict[str, str]:
    """Return a description of each input that is passed by name, for error messages."""
    names = model.prescribed_names
    words = {"count": len(names), "prescribed": ", ".join(names)}
    return {name: meaning.format(**words) for name, meaning in (MODEL_DEPENDENT | STEP).items()}
