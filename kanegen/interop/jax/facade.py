"""The handlers in C through which XLA calls the functions of a source."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kanegen.c import ModelDescription, Source
from kanegen.c.formats import Formats, formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.templates import fill
from kanegen.errors import OptionError, quoted
from kanegen.extras import JAX, module
from kanegen.library.native.facade import Facade
from kanegen.model.arguments import LOADS
from kanegen.options import Variant
from kanegen.program.ir import EVALUATE, PREPARED, STATE_RATES, STATE_RATES_DERIVATIVES, Array
from kanegen.program.precision import DOUBLE, FLOAT, Precision

jax = module("jax", "jaxlib", extra=JAX)

_HEADER = "xla/ffi/api/c_api.h"
"""Header of the foreign function interface, in the include folder of jaxlib."""

_INNER = (PREPARE, EVALUATE, STATE_RATES, STATE_RATES_DERIVATIVES)
"""Functions in C that JAX does not call: the outputs one by one are enough, since XLA calls what it needs."""

_TYPES = {DOUBLE.name: "XLA_FFI_DataType_F64", FLOAT.name: "XLA_FFI_DataType_F32"}
"""XLA's name of the type of numbers, by precision."""


@dataclass(frozen=True)
class Operand:
    """An array of a function, as the template prints it.

    Attributes:
        name: Its name in C.
        count: Numbers for one state.
        bytes: Bytes of these.
        type: XLA's name of the type of the numbers.
        zeros: Places that must be zero, such as the force on a body that takes none.
        function: Name of the function.
    """

    name: str
    count: int
    bytes: int
    type: str
    zero_places: tuple[int, ...] = ()
    function: str = ""

    @property
    def zeros(self) -> int:
        """Number of places that must be zero."""
        return len(self.zero_places)

    @property
    def table(self) -> str:
        """Name of the table of these places in C."""
        return f"{self.function}_{self.name}_zeros" if self.zero_places else "NULL"


def require_numbers(system: str, variant: Variant) -> None:
    """Make sure that JAX has the numbers in the arrays of a variant.

    Args:
        system: Name of the system, used in error messages.
        variant: The choices that shape the code.

    Raises:
        OptionError: If a type of numbers is unknown to JAX, or has 64 bits, which JAX has switched off.
    """
    numbers = formats(variant)
    for precision in (numbers.storage, numbers.parameters):
        if precision.name not in _TYPES:
            raise OptionError(
                f"precision: JAX has no numbers in {precision.name}. Take precision 'double' or 'float', or "
                "storage 'double'."
            )
        if precision.bytes == DOUBLE.bytes and not jax.config.jax_enable_x64:
            raise OptionError(
                f"precision: system {quoted(system)} has numbers of 64 bits, which JAX rounds to 32. "
                'Call jax.config.update("jax_enable_x64", True) first, or build with precision="float".'
            )


def functions_of(source: Source) -> tuple[Function, ...]:
    """Return the functions of a source that JAX can call."""
    return tuple(function for function in source.functions if function.name not in _INNER)


def inputs_of(source: Source, function: Function) -> tuple[Array, ...]:
    """Return the arrays that a function reads, with run-time parameters in place of what `prepare` makes."""
    prepare = next((one for one in source.functions if one.name == PREPARE), None)
    own = tuple(array for array in function.inputs if array.name != PREPARED)
    return own if prepare is None or len(own) == len(function.inputs) else (*prepare.inputs, *own)


def facade(source: Source) -> Facade:
    """Return the handlers of a source, with the header of the jaxlib that is installed.

    Example:
        path = kanegen.library.native.build.build(source, facade=facade(source))
    """
    numbers = formats(source.variant)
    name = source.model.name
    functions = [_printed(source, function, numbers) for function in functions_of(source)]
    handlers = fill(
        "jax/handlers.c",
        model=name,
        functions=functions,
        prepares=any(one["prepares"] for one in functions),
        most_inputs=max(len(one["inputs"]) for one in functions),
        most_outputs=max(len(one["outputs"]) for one in functions),
    )
    files = {f"{name}_jax.c": handlers, "kanegen_xla.h": fill("jax/kanegen_xla.h"), **header_of_xla()}
    return Facade(f"{name}_jax", files)


def header_of_xla() -> dict[str, str]:
    """Return the header of XLA's foreign function interface, of the jaxlib that is installed, by its path."""
    return {_HEADER: (Path(jax.ffi.include_dir()) / _HEADER).read_text(encoding="utf-8")}


def _printed(source: Source, function: Function, numbers: Formats) -> dict[str, Any]:
    """Return a function as the template prints it."""
    inputs = inputs_of(source, function)
    prepares = inputs[:1] != function.inputs[:1]
    prepared = next((array for array in function.inputs if array.name == PREPARED), None)
    read = len(inputs) - prepares
    arguments = [*(["prepared"] if prepares else []), *(f"in[{k}]" for k in range(read))]
    return {
        "name": function.name,
        "inputs": [operand(source.model, function, array, numbers.of(array.name)) for array in inputs],
        "outputs": [operand(source.model, function, one, numbers.of(one.name)) for one in function.outputs],
        "prepares": prepares,
        "prepared_bytes": prepared.size * numbers.arithmetic.bytes if prepared is not None else 0,
        "arguments": ", ".join([*arguments, *(f"out[{k}]" for k in range(len(function.outputs)))]),
    }


def operand(model: ModelDescription, function: Function, array: Array, precision: Precision) -> Operand:
    """Return an array as the template prints it."""
    zeros = tuple(_unloaded(model, array))
    type_ = _TYPES[precision.name]
    return Operand(array.name, array.size, array.size * precision.bytes, type_, zeros, function.name)


def _unloaded(model: ModelDescription, array: Array) -> Iterator[int]:
    """Yield the places of loads on bodies and points that take none."""
    for row in model.unloaded(LOADS[array.name]) if array.name in LOADS else ():
        yield from range(3 * row, 3 * row + 3)
