"""The functions of a compiled library, called with NumPy arrays."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cffi
import numpy as np

from kanegen.c import ModelFacts, Source
from kanegen.c.interface import PREPARE, Function
from kanegen.errors import BuildError
from kanegen.native.arguments import Floats, companion, load, state

LOADS = frozenset({"force", "torque"})
"""Arguments that may be left out, which is zero, and that one batch may share."""

_DOUBLE = np.dtype(np.float64)


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
        try:
            library = ffi.dlopen(str(path))
            self.calls = {f.name: Call(ffi, library, source.model, f) for f in source.functions}
        except (OSError, AttributeError) as error:
            raise BuildError(
                f"{path}: the compiled library cannot be loaded: {error}. Does the compiler make code for this "
                "machine?"
            ) from error

    def constants(self, parameters: Mapping[str, float]) -> tuple[Floats, ...]:
        """What `prepare` makes of the parameters; nothing where there are none."""
        prepare = self.calls.get(PREPARE)
        if prepare is None:
            return ()
        return prepare((), {"parameters": np.array(list(parameters.values()))})


class Call:
    """One C function and its batch form.

    Neither keeps anything of a call, and C runs without the interpreter's lock, so threads may share a `Call`.
    """

    def __init__(self, ffi: Any, library: Any, model: ModelFacts, function: Function) -> None:
        name = f"{model.name}_{function.name}"
        self._single = getattr(library, name)
        self._batch = getattr(library, f"{name}_batch") if function.has_batch else None
        self._pointer = ffi.from_buffer
        self._doubles = ffi.typeof("double[]")
        self._inputs = [(a.name, a.shape) for a in function.inputs if a.name not in function.shared]
        self._outputs = [array.shape for array in function.outputs]
        self._unloaded = [
            "" if is_loaded else body for body, is_loaded in zip(model.body_names, model.loaded, strict=True)
        ]
        zeros = {n: np.zeros(shape) for n, shape in self._inputs if n in LOADS}
        self._zeros = {n: self._pointer(self._doubles, array) for n, array in zeros.items()}
        self._checked = LOADS if any(self._unloaded) else frozenset()

    def __call__(self, constants: tuple[Floats, ...], values: Mapping[str, object]) -> tuple[Floats, ...]:
        """Call C for one state or many.

        Args:
            constants: Values of the inputs that all states share.
            values: By argument name what the user passed; more names than needed do no harm.

        Returns:
            One array for each output.

        Raises:
            ArrayError: If a value has the wrong type or shape.
        """
        pointers = [self._pointer(self._doubles, array) for array in constants]
        for name, shape in self._inputs:
            value = values[name]
            if (
                isinstance(value, np.ndarray)
                and value.shape == shape
                and value.dtype is _DOUBLE
                and value.flags.carray
                and name not in self._checked
            ):
                pointers.append(self._pointer(self._doubles, value))
            elif value is None and name in self._zeros:
                pointers.append(self._zeros[name])
            else:
                return self._general(constants, values)
        results = tuple(np.empty(shape) for shape in self._outputs)
        for array in results:
            pointers.append(self._pointer(self._doubles, array))
        self._single(*pointers)
        return results

    def _general(self, constants: tuple[Floats, ...], values: Mapping[str, object]) -> tuple[Floats, ...]:
        """The same after conversion and with every check."""
        arrays = self._converted(values)
        batch = arrays[0].shape[: arrays[0].ndim - len(self._inputs[0][1])]
        results = tuple(np.empty((*batch, *shape)) for shape in self._outputs)
        pointers = [self._pointer(self._doubles, array) for array in (*constants, *arrays, *results)]
        if not batch:
            self._single(*pointers)
        elif self._batch is not None:
            self._batch(batch[0], *pointers)
        return results

    def _converted(self, values: Mapping[str, object]) -> list[Floats]:
        (first, shape), *others = self._inputs
        arrays = [state(first, values[first], shape)]
        batch = arrays[0].shape[: arrays[0].ndim - len(shape)]
        for name, shape in others:
            if name in LOADS:
                arrays.append(load(name, values[name], shape, batch, self._unloaded))
            else:
                arrays.append(companion(name, values[name], shape, batch, first))
        return arrays
