"""`Function`: a generated function that takes and returns arrays of JAX."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from typing import Any

from kanegen.c.formats import formats
from kanegen.interop.jax.arguments import Arguments
from kanegen.interop.jax.calls import Arrays, Call, Signature
from kanegen.interop.jax.derivatives import differentiable_calls
from kanegen.interop.jax.facade import functions_of, inputs_of
from kanegen.interop.jax.handlers import Handlers
from kanegen.interop.products import products_of
from kanegen.interop.slopes import slopes

POSITIONAL, KEYWORD = inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY


@dataclass(frozen=True, eq=False)
class Function:
    """A generated function that takes and returns arrays of JAX.

    Attributes:
        arguments: What it takes.
        shapes: Shape of each result for one state.
        call: Its call through XLA.
    """

    arguments: Arguments
    shapes: tuple[tuple[int, ...], ...]
    call: Call

    @property
    def __name__(self) -> str:
        """Name of the function, by which JAX calls it in what it compiles."""
        return self.arguments.function

    @property
    def __signature__(self) -> inspect.Signature:
        """Names of the arguments, as `help` shows them."""
        by_place = [
            inspect.Parameter(one, POSITIONAL, default=None) for one in self.arguments.names.positional
        ]
        by_name = [inspect.Parameter(one, KEYWORD, default=None) for one in self.arguments.names.named]
        return inspect.Signature([*by_place, *by_name])

    def __repr__(self) -> str:
        named = "".join(f", {name}=" for name in self.arguments.names.named)
        return f"<Function {self.arguments.function}({', '.join(self.arguments.names.positional)}{named})>"

    def __call__(self, *values: Arrays, **named: Arrays) -> Any:
        """Return the result, (*lead, *shape), or a tuple of the results where there are several.

        Args:
            values: Arguments of the method of `Library` in their order, each (*lead, *shape); the leading
                axes of all arguments are broadcast, as in NumPy.
            named: The same by name; further inputs, and `parameters`, (*lead, P) or values by name.

        Raises:
            ArrayError: If an argument has the wrong shape or type, is missing, is passed twice or does not
                exist.
            ModelError: If there is no parameter of a name.
            OptionError: If JAX rounds all numbers to 32 bits, and the library is in double precision.
        """
        found = self.call(*self.arguments.operands(values, named))
        results = [
            one.reshape(*one.shape[:-1], *shape) for one, shape in zip(found, self.shapes, strict=True)
        ]
        return results[0] if len(results) == 1 else tuple(results)


def functions_by_name(handlers: Handlers) -> dict[str, Function]:
    """Return every function of a library that JAX can call, by name.

    Args:
        handlers: The library, and the names by which JAX knows its functions.
    """
    library = handlers.library
    source = library.source
    numbers = formats(source.variant)
    signatures, arguments = {}, {}
    found = functions_of(source)
    for one in found:
        inputs = inputs_of(source, one)
        types = tuple(numbers.of(array.name).dtype for array in inputs)
        arguments[one.name] = Arguments(one.name, library, inputs, types)
        signatures[one.name] = Signature(
            one.name,
            handlers.targets[one.name],
            tuple(array.name for array in inputs),
            tuple(array.size for array in one.outputs),
            numbers.storage.dtype,
            str(library.on_status),
            handlers.device,
            handlers.prepared if inputs[:1] != one.inputs[:1] else None,
        )
    of = {name: slopes(name, source) for name in signatures}
    calls = differentiable_calls(signatures, of, products_of(source))
    shapes = {one.name: tuple(array.shape for array in one.outputs) for one in found}
    return {name: Function(arguments[name], shapes[name], call) for name, call in calls.items()}
