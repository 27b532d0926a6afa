"""Compiled functions for other programs and for tight loops: bound to arrays, broadcast, or by address."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, cast

import numpy as np

from kanegen.c.interface import PREPARE
from kanegen.errors import OptionError, quoted
from kanegen.library.bound import BoundCall
from kanegen.library.broadcasting import BroadcastFunction
from kanegen.library.compiled import CompiledModel
from kanegen.library.native.calls import arguments_of
from kanegen.model.arguments import Floats, NamedInputs


class Embedding(CompiledModel):
    """Methods that hand out functions of a library."""

    def bind(self, name: str, states: int | None = None) -> BoundCall:
        """Return a function with arrays of its own, which costs less to call than a method.

        A bound call of one state costs a few hundred nanoseconds beside the C. It has the parameters and the
        `on_status` of the library at the time when it is bound.

        Args:
            name: Name of an output, of a function that makes one step, or "evaluate" for all outputs.
            states: Number B of states of a batch; None is one state.

        Raises:
            OptionError: If the function was not generated, `states` is no whole number from 0 on, or memory
                cannot hold so many.

        Example:
            call = library.bind("forward_dynamics")
            call.x[:], call.y[:] = x, y
            call()
            print(call.acceleration)
        """
        if name not in self._calls or name == PREPARE:
            raise self._absent(name)
        is_count = isinstance(states, int | np.integer) and not isinstance(states, bool) and states >= 0
        if states is not None and not is_count:
            raise OptionError(f"states: {quoted(states)} is no whole number from 0 on.")
        count = None if states is None else int(states)
        try:
            return BoundCall(name, self._native, self._parameters, self._constants, self._on_status, count)
        except (MemoryError, ValueError):  # NumPy raises the second where the size is no index
            raise OptionError(f"states: memory cannot hold the arrays of {count} states.") from None

    def ufunc(self, name: str) -> BroadcastFunction:
        """Return a function that broadcasts the leading dimensions of its arguments, as a NumPy ufunc does.

        Args:
            name: Name of an output, of a function that makes one step, or "evaluate" for all outputs.

        Raises:
            OptionError: If the function was not generated.

        Example:
            forward_dynamics = library.ufunc("forward_dynamics")
            grid = forward_dynamics(np.zeros((5, 1, library.n)), np.ones((4, library.n)))   # (5, 4, n)
        """
        if name not in self._calls or name == PREPARE:
            raise self._absent(name)
        parameters = len(self._parameters), self._native.parameter_type
        order = arguments_of(name)

        def run(given: Mapping[str, Any]) -> list[Floats]:
            values = tuple(map(given.get, order))
            named = {one: value for one, value in given.items() if one not in order}
            return self._run(name, values, cast(NamedInputs, named))

        return BroadcastFunction(name, self._calls[name], parameters, run, self.ufunc)

    @property
    def c_functions(self) -> tuple[str, ...]:
        """Names of all C functions without the prefix of the model, such as "forward_dynamics_batch"."""
        return self._native.entries.names

    def address(self, name: str) -> int:
        """Return the address of a C function, for code that another program compiles, such as Numba.

        The library stays in memory until the process ends. The header `<model>.h` has the arguments of the
        function; `c_function` has their types.

        Args:
            name: Name of a C function without the prefix of the model, one of `c_functions`.

        Raises:
            OptionError: If there is no function of this name.

        Example:
            address = library.address("forward_dynamics")
        """
        return self._native.entries.address(name)

    def c_function(self, name: str) -> Callable[..., int]:
        """Return a C function as a function of ctypes, which Numba compiles into a direct call.

        It takes the arguments of the C function in their order: pointers to contiguous arrays of the
        library's numbers, such as `array.ctypes` in Numba. It checks their types and nothing else: arrays
        that are too short or not contiguous let C read and write elsewhere. `prepared` is its first
        argument where the model has run-time parameters.

        Args:
            name: Name of a C function without the prefix of the model, one of `c_functions`.

        Returns:
            The function, which returns the status of C: 0 where all results are finite and accurate; a
            batch returns how many states have another status.

        Raises:
            OptionError: If there is no function of this name.

        Example:
            forward_dynamics = library.c_function("forward_dynamics")
            print(forward_dynamics.argtypes)
        """
        return self._native.entries.prototyped(name)

    @property
    def prepared(self) -> Floats:
        """(C,) constants that depend on the run-time parameters alone, the first argument of C functions.

        The array is empty where a model has no run-time parameters; then C functions do not have this
        argument.

        Example:
            prepared = library.prepared
        """
        array = self._constants.array
        return np.zeros(0) if array is None else array.copy()
