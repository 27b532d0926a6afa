"""A compiled function bound to arrays of its own, for loops in which the time of every call counts."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any, NoReturn

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, quoted
from kanegen.library.native.calls import Call
from kanegen.library.native.constants import Constants
from kanegen.library.native.loaded import NativeLibrary
from kanegen.library.native.status import OnStatus
from kanegen.model.arguments import Floats, Shape, floats
from kanegen.model.parameter_sets import ParameterSets, parameter_sets


class BoundCall:
    """A function of a compiled model with arrays of its own, which a call reads and fills.

    The arrays are attributes with the names that they have in C, such as `x`, `y`, `tau` and
    `acceleration`. They stay the same arrays: write into them, by `call.x[:] = x` or `call.x = x`, then
    call. A call allocates nothing and costs a few hundred nanoseconds beside the C. Only one thread at a
    time may use a bound call.

    Attributes:
        name: Name of the function.
        states: Number B of states of a batch, None for one state.
        inputs: Arrays that a call reads, by name. They begin with zeros; quaternions are those of no
            rotation.
        outputs: Arrays that a call fills, by name, NaN before the first call.

    Example:
        call = library.bind("forward_dynamics")
        call.x[:], call.y[:] = x, y
        call()
        print(call.acceleration)
    """

    __slots__ = (
        "__dict__",
        "_batch",
        "_call",
        "_constants",
        "_function",
        "_native",
        "_on_status",
        "_unloaded",
        "_usual",
        "inputs",
        "name",
        "outputs",
        "states",
    )

    name: str
    states: int | None
    inputs: Mapping[str, Floats]
    outputs: Mapping[str, Floats]

    def __init__(
        self,
        name: str,
        native: NativeLibrary,
        parameters: Mapping[str, float],
        constants: Constants,
        on_status: OnStatus,
        states: int | None = None,
    ) -> None:
        """Make the arrays.

        Args:
            name: Name of the function, one of `native.calls`.
            native: The loaded library.
            parameters: Values of the run-time parameters by name.
            constants: Prepared constants for these values.
            on_status: What a call does where a result is missing, not finite or not accurate.
            states: Number of states of a batch, None for one state.
        """
        call: Call = native.calls[name]
        batch = () if states is None else (states,)
        inputs, outputs = (_unresizable(arrays) for arrays in call.arrays(batch))
        if "x" in inputs:
            x = inputs["x"]
            (x if x.ndim == len(batch) + 1 else x[..., 0])[...] = native.source.model.neutral_coordinates
        vars(self).update(inputs | outputs)
        self._keep("name", name)
        self._keep("states", states)
        self._keep("inputs", MappingProxyType(inputs))
        self._keep("outputs", MappingProxyType(outputs))
        self._keep("_native", native)
        self._keep("_usual", dict(parameters))
        self._keep("_on_status", on_status)
        self._keep("_call", call)
        self._keep("_batch", batch)
        self._keep("_unloaded", tuple(_unloaded(call, inputs, batch)))
        self._bind(constants)

    def __call__(self) -> int:
        """Call the function and return its status.

        Returns:
            0 where all results are finite and accurate. Else, for one state, the status that the header
            describes; for a batch the number of states that have one.

        Raises:
            ArrayError: If a load is not zero on a body or point that takes none.
            StatusError: See `Library.with_on_status`.
        """
        status: int = self._function()
        if status:
            self._react(status)
        return status

    def __repr__(self) -> str:
        shapes = [f"{name} {array.shape}" for name, array in self.inputs.items()]
        filled = [f"{name} {array.shape}" for name, array in self.outputs.items()]
        return f"<BoundCall {self.name}: {', '.join(shapes)} -> {', '.join(filled)}>"

    def __reduce__(self) -> NoReturn:
        """Say that a bound call cannot be pickled or copied."""
        raise TypeError(
            "a bound call has arrays of its process: pickle the library, and bind it again there."
        )

    def __getattr__(self, name: str) -> Any:
        """Say which arrays there are, where there is no attribute `name`."""
        arrays = (*vars(self), "parameters")
        raise AttributeError(f"there is no array {quoted(name)}. {did_you_mean(name, arrays)}")

    def __setattr__(self, name: str, value: object) -> None:
        """Copy numbers into an input, or prepare the constants of other `parameters`.

        Raises:
            AttributeError: If there is no input of this name.
            ArrayError: If the numbers have neither the shape of the array nor, for a batch, that of one
                state.
        """
        if name == "parameters":
            super().__setattr__(name, value)
        elif name in self.inputs:
            array = self.inputs[name]
            given = floats(name, value, array.dtype)
            if given.shape not in (array.shape, array.shape[len(self._batch) :]):
                raise ArrayError(f"{name}: expected shape {array.shape}, got {given.shape}.")
            array[...] = given
        else:
            known = (*self.inputs, "parameters")
            raise AttributeError(f"there is no input {quoted(name)}. {did_you_mean(name, known)}")

    def __delattr__(self, name: str) -> NoReturn:
        """Say that a call needs all of its arrays."""
        raise AttributeError(f"{quoted(name)} cannot be deleted: a bound call needs all of its arrays.")

    @property
    def parameters(self) -> Floats:
        """(P,) run-time parameters in the order of `Library.parameter_names`, or (B, P) for each state.

        The array cannot be written: set the attribute, by values in order or by name, which prepares the
        constants anew.

        Raises:
            ArrayError: Where values are set, if they do not fit.
            ModelError: Where values are set by name, if there is no parameter of a name.
            OptionError: Where values differ by state, if the library was built with one set for all.

        Example:
            call = library.bind("forward_dynamics")
            call.parameters = {"m1": 3.0}
        """
        found = self._constants.parameters
        shown = np.zeros(0) if found is None else found.view()
        shown.flags.writeable = False
        return shown

    @parameters.setter
    def parameters(self, values: ParameterSets) -> None:
        """Bind the function to the constants of other parameters."""
        if not self._usual:
            raise ArrayError(
                f"parameters: system {quoted(self._native.source.model.shown)} has no run-time parameters."
            )
        sets = parameter_sets(values, self._usual, self._native.parameter_type)
        self._bind(self._native.constants(np.array(sets), self._on_status))

    def _keep(self, name: str, value: object) -> None:
        """Set an attribute that is not an array."""
        object.__setattr__(self, name, value)

    def _bind(self, constants: Constants) -> None:
        """Bind the function to its arrays and to prepared constants."""
        inputs, outputs = list(self.inputs.values()), list(self.outputs.values())
        function = self._call.bound(constants, inputs, outputs, self._batch)
        self._keep("_function", partial(_checked, self._unloaded, function) if self._unloaded else function)
        self._keep("_constants", constants)

    def _react(self, status: int) -> None:
        """Report a status other than 0 by the rule of the library."""
        if self._on_status != "ignore":
            results = list(self.outputs.values())
            self._call.react(status, self._constants, self.inputs, results, self._batch, self._on_status)


def _unresizable(arrays: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return arrays that NumPy refuses to resize, whose memory C reads and fills."""
    return {name: array.view() for name, array in arrays.items()}


class _Unloaded:
    """A row of a load on a body or point that takes none, which has to stay zero.

    Attributes:
        bytes: The row as bytes; these are compared first, because that takes least time.
        zeros: As many bytes, all of them zero.
    """

    __slots__ = ("_message", "_row", "bytes", "zeros")

    def __init__(self, name: str, row: int, who: str, values: Floats) -> None:
        """Keep the (..., 3) values of a row of the load `name`, and who takes no load."""
        self._row = values
        self._message = (
            f"{name}: row {row} is not zero, but {who} takes no loads. Enter it among the loads of the model."
        )
        seen = values.view(np.uint8)
        self.bytes, self.zeros = seen.data, np.zeros_like(seen).data

    def require_zero(self) -> None:
        """Raise an `ArrayError` if the row is not zero; -0 and padding are."""
        if self._row.any():
            raise ArrayError(self._message)


def _unloaded(call: Call, inputs: Mapping[str, Floats], batch: Shape) -> Iterator[_Unloaded]:
    """Yield the rows of the loads that have to stay zero."""
    for name, rows in call.unloaded.items():
        for row, who in rows.items():
            yield _Unloaded(name, row, who, np.moveaxis(inputs[name], len(batch), 0)[row])


def _checked(unloaded: Sequence[_Unloaded], function: Callable[[], int]) -> int:
    """Call a function after a check that loads on bodies or points that take none are zero.

    Raises:
        ArrayError: If one is not.
    """
    for one in unloaded:
        if one.bytes != one.zeros:
            one.require_zero()
    return function()
