"""A compiled library in memory: its functions, loaded with cffi."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import MappingProxyType

import _cffi_backend
import cffi
from numpy.typing import ArrayLike

from kanegen.c import Source
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE, Function
from kanegen.errors import BuildError, OptionError, quoted
from kanegen.library.native import cache, floating_point, openmp, processor
from kanegen.library.native.build import Recipe, made
from kanegen.library.native.calls import Call, arguments_of
from kanegen.library.native.constants import Constants
from kanegen.library.native.entries import Entries
from kanegen.library.native.rollouts import RolloutCall
from kanegen.library.native.status import OnStatus, naming
from kanegen.model.arguments import MODEL_DEPENDENT, state
from kanegen.program.ir import EVALUATE, PARAMETERS

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
        entries: Addresses and C types of all functions.
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
            self.entries = Entries(ffi, library, source.model.name)
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
