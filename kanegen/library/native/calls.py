"""The functions of a compiled library, called with NumPy arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import _cffi_backend
import cffi
import numpy as np

from kanegen.c import ModelDescription, Source
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function
from kanegen.errors import BuildError
from kanegen.library.native import environment
from kanegen.library.native.status import Status
from kanegen.model.arguments import (
    ARGUMENTS,
    COMMON,
    FURTHER,
    LOADS,
    OPTIONAL,
    Floats,
    Values,
    companion,
    load,
    required,
    state,
)
from kanegen.program.precision import Precision

_STAY = getattr(os, "RTLD_NODELETE", 0)
"""A library is never unmapped: threads of its OpenMP runtime outlive the `Library` that started them."""

_CALLER = 5
"""Frames from a warning of a `Status` to the line that called a method of the library."""

Pointers = tuple[Any, ...]
"""C pointers; each keeps its array alive."""


class Native:
    """A shared library in memory.

    Attributes:
        source: What was compiled.
        path: The shared library.
        calls: Its functions by name, without prefix.
    """

    def __init__(self, source: Source, path: Path) -> None:
        self.source = source
        self.path = path
        ffi = cffi.FFI()
        ffi.cdef(source.cdef)
        held = formats(source.variant)
        # The function behind `ffi.from_buffer`, which takes twice as long.
        pointers = {
            precision: partial(_cffi_backend.from_buffer, ffi.typeof(f"{precision.c_type}[]"))
            for precision in held.every
        }
        self._prepared = pointers[held.arithmetic]
        try:
            with environment.unchanged(path):
                library = ffi.dlopen(str(path), ffi.RTLD_NOW | _STAY)
            self.calls = {f.name: Call(library, pointers, held, source.model, f) for f in source.functions}
        except (OSError, AttributeError) as error:
            raise BuildError(
                f"{path}: the compiled library cannot be loaded: {error}. Does the compiler make code for "
                "this machine?"
            ) from error

    def constants(self, parameters: Mapping[str, float]) -> Pointers:
        """What `prepare` makes of the parameters, for `Call`; nothing where there are none."""
        prepare = self.calls.get(PREPARE)
        if prepare is None:
            return ()
        prepared = prepare((), (np.array(list(parameters.values())),))
        return tuple(map(self._prepared, prepared))


class Call:
    """One C function and its batch form.

    Nothing of a call is kept, and C runs without the interpreter's lock, so threads may share a `Call`.
    """

    def __init__(
        self,
        library: Any,
        pointers: Mapping[Precision, Callable[[Floats], Any]],
        held: Formats,
        model: ModelDescription,
        f: Function,
    ) -> None:
        self._status = Status.of(f, model)
        name = f"{model.name}_{f.name}"
        self._single = getattr(library, name)
        self._batch = getattr(library, f"{name}_batch") if f.has_batch else None
        taken, given = held.of(f.inputs[-1].name), held.of(f.outputs[0].name)
        self._pointer, self._result_pointer = pointers[taken], pointers[given]
        self._dtype, self._result_dtype = taken.dtype, given.dtype
        places = {n: k for k, n in enumerate(ARGUMENTS)}
        own = [array for array in f.inputs if array.name not in f.shared]
        self._inputs = [
            (array.name, places.get(array.name, 0), array.shape + taken.trailing_shape) for array in own
        ]
        self._outputs = [array.shape + given.trailing_shape for array in f.outputs]
        told = model.prescribed_names
        words = {"count": len(told), "prescribed": ", ".join(told)}
        self._further = {n: what.format(**words) for n, what in FURTHER.items()}
        self._unloaded = {name: model.unloaded(kind) for name, kind in LOADS.items()}
        self._plan = [
            (k, shape, self._zeros(shape) if n in OPTIONAL else None, not self._unloaded.get(n))
            for n, k, shape in self._inputs
        ]

    def _zeros(self, shape: tuple[int, ...]) -> Any:
        return self._pointer(np.zeros(shape, self._dtype))

    def __call__(self, constants: Pointers, values: Values) -> list[Floats]:
        """Call C for one state or many.

        Args:
            constants: From `Native.constants`.
            values: What the user passed, in the order of `ARGUMENTS`; the parameters, for `prepare`.

        Returns:
            One array for each output.

        Raises:
            ArrayError: If a value has the wrong type or shape.
            SingularError: If a result of the one state does not exist. In a batch its row is NaN, with a
                warning.
        """
        pointer, dtype = self._pointer, self._dtype
        pointers = [*constants]
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
                return self._general(constants, values)
        results = []
        for shape in self._outputs:
            result = np.empty(shape, self._result_dtype)
            results.append(result)
            pointers.append(self._result_pointer(result))
        place = self._single(*pointers)
        if place:
            self._status.complain(place, _CALLER)
        return results

    def _general(self, constants: Pointers, values: Values) -> list[Floats]:
        """The same after conversion and with every check."""
        arrays, batch = self._converted(values)
        results = [np.empty((*batch, *shape), self._result_dtype) for shape in self._outputs]
        pointers = [*constants, *map(self._pointer, arrays), *map(self._result_pointer, results)]
        if not batch or self._batch is None:
            place = self._single(*pointers)
            if place:
                self._status.complain(place, _CALLER + 1)
            return results
        failed = self._batch(*batch, *pointers)
        if failed:
            self._status.count(failed, results, _CALLER + 1)
        return results

    def _converted(self, values: Values) -> tuple[list[Floats], tuple[int, ...]]:
        """The inputs as C takes them, and `()` for one state or `(B,)` for a batch."""
        (first, k, shape), *others = self._inputs
        arrays = [state(first, values[k], shape, self._dtype)]
        batch = arrays[0].shape[: arrays[0].ndim - len(shape)]
        for name, k, shape in others:
            if name in COMMON:
                unloaded = self._unloaded.get(name, {})
                value = values[k] if name in OPTIONAL else required(name, values[k], self._further[name])
                arrays.append(load(name, value, shape, batch, self._dtype, unloaded))
            else:
                arrays.append(companion(name, values[k], shape, batch, self._dtype, first))
        return arrays, batch
