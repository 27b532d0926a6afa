"""Compiled functions whose arguments may have any leading dimensions, which broadcast as in a NumPy ufunc."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError
from kanegen.library.native.calls import Call
from kanegen.model.arguments import Floats, Shape, floats
from kanegen.program.ir import PARAMETERS

Run = Callable[[Mapping[str, Any]], list[Floats]]
"""Function that calls the C function with arguments by name, for one state or for a batch of states."""


class BroadcastFunction:
    """A function of a compiled model that broadcasts the leading dimensions of its arguments.

    It is what NumPy calls a generalized ufunc: the last dimensions of each argument are those of one state,
    the dimensions before them broadcast against those of the other arguments, and one call of C computes all
    states. `np.vectorize` gives the same values by a call for every state.

    Attributes:
        __name__: Name of the function.
        signature: Signature of a generalized ufunc with sizes, such as "(2),(2),(2)->(2)".
        shapes: Shapes of the arguments, and those of the results, for one state by name.

    Example:
        forward_dynamics = library.ufunc("forward_dynamics")
        angles = np.stack(np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 2, 9), indexing="ij"), axis=-1)
        grid = forward_dynamics(angles, [0.0, 0.0])   # (5, 9, 2)
    """

    def __init__(
        self,
        name: str,
        call: Call,
        parameters: tuple[int, np.dtype[Any]],
        run: Run,
        made_by: Callable[[str], BroadcastFunction],
    ) -> None:
        """Keep the function.

        Args:
            name: Name of the function.
            call: The C function, which knows the shapes of its arrays.
            parameters: Number of the run-time parameters, and the type of their numbers.
            run: Function that calls it.
            made_by: Function that makes this one of its name, which `pickle` calls.
        """
        self._made_by = made_by
        self.__name__ = name
        self.shapes = self._inputs, self._outputs = call.shapes
        self._dtype, self._parameters, self._run = call.dtype, parameters, run
        sides = [",".join(map(_core, shapes.values())) for shapes in call.shapes]
        self.signature = "->".join(sides)

    def __reduce__(self) -> tuple[Any, ...]:
        """Return how `pickle` makes the function anew."""
        return self._made_by, (self.__name__,)

    def __repr__(self) -> str:
        return f"<BroadcastFunction {self.__name__}({', '.join(self._inputs)}): {self.signature}>"

    def __call__(
        self, *values: ArrayLike | None, **inputs: ArrayLike | Mapping[str, ArrayLike] | None
    ) -> Floats | tuple[Floats, ...]:
        """Return the results for all states.

        Args:
            values: Arguments in the order of the C function, each with the dimensions of one state last; None
                stands for no load.
            inputs: Arguments by name. `parameters` are run-time parameters in place of those of the library;
                (..., P) values with leading dimensions need a library with `parameters_by_state`.

        Returns:
            The result, or a tuple of results, with the broadcast dimensions before those of one state.

        Raises:
            ArrayError: If an argument has the wrong shape or type, is missing, or does not broadcast, or
                memory cannot hold the arrays of all states.
            StatusError: See `Library.with_on_status`.
        """
        given = self._named(values, inputs)
        try:
            arrays = {name: self._array(name, value) for name, value in given.items()}
            batch = self._batch({name: lead for name, (_, lead) in arrays.items()})
            found = self._run({name: _rows(array, lead, batch) for name, (array, lead) in arrays.items()})
        except MemoryError:
            raise ArrayError(
                f"{self.__name__}: memory cannot hold the arrays of so many states. Give fewer at once."
            ) from None
        shaped = [
            one.reshape((*batch, *shape)) for one, shape in zip(found, self._outputs.values(), strict=True)
        ]
        return shaped[0] if len(shaped) == 1 else tuple(shaped)

    def _batch(self, leads: Mapping[str, Shape]) -> Shape:
        """Return the dimensions to which the leading dimensions of all arguments broadcast.

        Raises:
            ArrayError: If they do not broadcast.
        """
        different = {lead for lead in leads.values() if lead}
        if len(different) <= 1:
            return different.pop() if different else ()
        try:
            return np.broadcast_shapes(*different)
        except ValueError:
            shown = ", ".join(f"{name} {lead}" for name, lead in leads.items())
            raise ArrayError(f"{self.__name__}: leading dimensions do not broadcast: {shown}.") from None

    def _named(self, values: tuple[Any, ...], inputs: Mapping[str, Any]) -> dict[str, Any]:
        """Return all arguments that are not None by name.

        Raises:
            ArrayError: If there are too many, one is given twice, or there is none of a name.
        """
        names = (*self._inputs, PARAMETERS)
        if len(values) > len(self._inputs):
            raise ArrayError(
                f"{self.__name__}: takes {', '.join(self._inputs)}, got {len(values)} arguments."
            )
        given = dict(zip(self._inputs, values, strict=False))
        for name in inputs:
            if name not in names:
                raise ArrayError(f"{name}: there is no such argument. {did_you_mean(name, names)}")
            if name in given:
                raise ArrayError(f"{name}: it is given twice.")
        return {name: value for name, value in {**given, **inputs}.items() if value is not None}

    def _array(self, name: str, value: Any) -> tuple[Any, Shape]:
        """Return an argument and its leading dimensions.

        Raises:
            ArrayError: If the last dimensions are not those of one state.
        """
        if name == PARAMETERS and isinstance(value, Mapping):
            return value, ()
        count, dtype = self._parameters
        shape, kind = ((count,), dtype) if name == PARAMETERS else (self._inputs[name], self._dtype)
        array = floats(name, value, kind)
        before = array.ndim - len(shape)
        if before < 0 or array.shape[before:] != shape:
            expected = ", ".join(["...", *map(str, shape)])
            raise ArrayError(f"{name}: expected shape ({expected}), got {array.shape}.")
        return array, array.shape[:before]


def _core(shape: Shape) -> str:
    """Return the dimensions of one state in a signature, such as "(2,3)"."""
    return f"({','.join(map(str, shape))})"


def _rows(array: Any, lead: Shape, batch: Shape) -> Any:
    """Return an argument with one leading dimension for the batch, or none where there is no batch."""
    if not batch or (lead == batch and len(batch) == 1) or isinstance(array, Mapping):
        return array
    shape = array.shape[len(lead) :]
    return np.broadcast_to(array, (*batch, *shape)).reshape(math.prod(batch), *shape)
