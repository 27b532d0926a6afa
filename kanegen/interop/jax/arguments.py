"""Arguments of functions of JAX: their names, shapes and types, and what they become for a call of XLA."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.choices import did_you_mean
from kanegen.errors import ArrayError, ModelError, quoted
from kanegen.extras import JAX, module
from kanegen.interop.arguments import ArgumentNames
from kanegen.interop.jax.calls import Arrays
from kanegen.interop.jax.facade import require_numbers
from kanegen.library import Library
from kanegen.model.arguments import MODEL_DEPENDENT, OPTIONAL, STEP, floats, required
from kanegen.program.ir import PARAMETERS, Array

jax = module("jax", "jaxlib", extra=JAX)
jnp = jax.numpy


@dataclass(frozen=True)
class Arguments:
    """What a function takes: its arguments in order, and the arrays that its C reads.

    Attributes:
        function: Name of the function.
        library: The library that has it.
        arrays: The arrays that C reads, in order.
        types: Type of the numbers of each.
    """

    function: str
    library: Library
    arrays: tuple[Array, ...]
    types: tuple[np.dtype[Any], ...]

    @property
    def names(self) -> ArgumentNames:
        """Names of the arguments, by place and by name."""
        return ArgumentNames.of(self.function, self.library, [array.name for array in self.arrays])

    def operands(self, values: Sequence[Any], named: Mapping[str, Any]) -> list[Arrays]:
        """Return the arrays that C reads, each (*lead, numbers of one state) with as many leading axes.

        Args:
            values: Values of `names.positional`, which may end early.
            named: Further values by name.

        Raises:
            ArrayError: If an argument has the wrong shape or type, is missing, is passed twice or does not
                exist.
            ModelError: If there is no parameter of a name.
            OptionError: If JAX has no numbers of the library's precision at the moment.
        """
        given = self.names.bound(values, named)
        require_numbers(self.library.name, self.library.source.variant)
        found = [
            self._converted(array, given.get(array.name), dtype)
            for array, dtype in zip(self.arrays, self.types, strict=True)
        ]
        leads = [
            one.shape[: one.ndim - len(array.shape)] for one, array in zip(found, self.arrays, strict=True)
        ]
        try:
            axes = len(np.broadcast_shapes(*leads))
        except ValueError:
            pairs = zip(self.arrays, found, leads, strict=True)
            shapes = ", ".join(f"{array.name} {one.shape}" for array, one, lead in pairs if lead)
            raise ArrayError(f"{self.function}: the leading axes do not fit together: {shapes}.") from None
        return [
            one.reshape(*(1,) * (axes - len(lead)), *lead, array.size)
            for one, lead, array in zip(found, leads, self.arrays, strict=True)
        ]

    def _converted(self, array: Array, value: Any, dtype: np.dtype[Any]) -> Arrays:
        """Return an argument of the type of the library, (*lead, *shape)."""
        name = array.name
        if name == PARAMETERS:
            value = self._parameters(value, dtype)
        elif value is None and name in OPTIONAL:
            value = np.zeros(array.shape)
        else:
            meaning = (MODEL_DEPENDENT | STEP).get(name, f"shape {array.shape}")
            value = required(name, value, meaning.format(count="p", prescribed="the prescribed freedoms"))
        found = _numbers(name, value, dtype)
        if found.shape[max(found.ndim - len(array.shape), 0) :] != array.shape:
            wanted = f"(..., {', '.join(map(str, array.shape))})" if array.shape else "()"
            raise ArrayError(f"{name}: expected shape {wanted}, got {found.shape}.")
        return found

    def _parameters(self, value: Any, dtype: np.dtype[Any]) -> Any:
        """Return the run-time parameters, from an array, from values by name, or those of the library.

        Raises:
            ModelError: If there is no parameter of a name.
        """
        usual = self.library.parameters
        if value is None:
            return np.array([*usual.values()])
        if not isinstance(value, Mapping):
            return value
        for name in value:
            if name not in usual:
                raise ModelError(f"unknown parameter {quoted(name)}. {did_you_mean(name, usual)}")
        columns = [_numbers(f"parameter {quoted(one)}", value.get(one, usual[one]), dtype) for one in usual]
        return jnp.stack(jnp.broadcast_arrays(*columns), axis=-1)


def _numbers(name: str, value: Any, dtype: np.dtype[Any]) -> Arrays:
    """Return a value as an array of JAX; lists may contain such arrays.

    Raises:
        ArrayError: If it holds anything but real numbers in the range of the type, or is ragged or masked.
    """
    if not any(isinstance(leaf, jax.Array) for leaf in jax.tree.leaves(value)):
        return jnp.asarray(floats(name, value, dtype))
    try:
        array = jnp.asarray(value)
    except (TypeError, ValueError):
        raise ArrayError(f"{name}: the rows have different lengths, or are no numbers.") from None
    if not (jnp.issubdtype(array.dtype, np.integer) or jnp.issubdtype(array.dtype, np.floating)):
        raise ArrayError(f"{name}: expected real numbers, got an array of {array.dtype}.")
    return array.astype(dtype)
