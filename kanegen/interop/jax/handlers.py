"""Handlers that are compiled, loaded and known to JAX, and what they report to Python."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from kanegen.c.formats import formats
from kanegen.extras import JAX, module
from kanegen.interop.jax.calls import Prepared
from kanegen.interop.jax.facade import facade, functions_of, inputs_of
from kanegen.library import Library
from kanegen.library.native.build import Recipe, made
from kanegen.library.native.calls import arguments_of
from kanegen.library.native.constants import Constants
from kanegen.library.native.loaded import NativeLibrary
from kanegen.library.native.status import ON_STATUS, OnStatus, StatusReport, report
from kanegen.model.arguments import Floats
from kanegen.program.ir import PARAMETERS

jax = module("jax", "jaxlib", extra=JAX)

_REPORTER = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_char_p,
    ctypes.c_int64,
    ctypes.c_int64,
    ctypes.POINTER(ctypes.c_int64),
    ctypes.POINTER(ctypes.c_void_p),
    ctypes.POINTER(ctypes.POINTER(ctypes.c_int64)),
    ctypes.c_void_p,
    ctypes.c_size_t,
)
"""The type `kanegen_xla_report` of C."""

_REGISTERED: dict[str, tuple[NativeLibrary, ctypes.CDLL, Any]] = {}
"""For each entry of the cache whose handlers JAX knows, the library, its functions and its reporter.

JAX may call them as long as the process lives.
"""

_LOCK = Lock()


@dataclass(frozen=True)
class Handlers:
    """A library whose functions JAX can call.

    Attributes:
        library: The same functions with NumPy arrays.
        targets: The name by which JAX knows each function.
        device: Where JAX calls them, "cpu" or "cuda".
        prepared: How kernels get what depends on parameters alone; None on the CPU, where a call computes it,
            and without parameters.
    """

    library: Library
    targets: Mapping[str, str]
    device: str = "cpu"
    prepared: Prepared | None = None


def handlers(recipe: Recipe, parameters: Mapping[str, float], on_status: OnStatus) -> Handlers:
    """Return a library whose functions JAX knows, compiled if need be.

    Args:
        recipe: What is compiled and how.
        parameters: Values of the run-time parameters.
        on_status: What the library does with a status other than 0.

    Raises:
        OptionError: If the arrays hold numbers that JAX has not.
        BuildError: If there is no compiler, or it fails.
    """
    entry, native = _registered(replace(recipe, facade=facade(recipe.source)))
    targets = {one.name: _target(entry, one.name) for one in functions_of(recipe.source)}
    return Handlers(Library(native, parameters, on_status), targets)


def _registered(recipe: Recipe) -> tuple[str, NativeLibrary]:
    """Return the name of the entry in the cache, and the loaded library, after JAX has been told of both."""
    native, functions = made(recipe.product(), partial(_loaded, recipe))
    entry = native.path.parent.name
    with _LOCK:
        if entry not in _REGISTERED:
            reporter = _REPORTER(partial(_report, native))
            name = recipe.source.model.name
            functions[f"{name}_jax_report_to"](reporter)
            for one in functions_of(recipe.source):
                handler = jax.ffi.pycapsule(functions[f"{name}_jax_{one.name}"])
                jax.ffi.register_ffi_target(_target(entry, one.name), handler, platform="cpu")
            _REGISTERED[entry] = native, functions, reporter
        return entry, _REGISTERED[entry][0]


def _loaded(recipe: Recipe, path: Path) -> tuple[NativeLibrary, ctypes.CDLL]:
    """Load a shared library for NumPy and for JAX."""
    return NativeLibrary(recipe, path), ctypes.CDLL(str(path))


def _target(entry: str, function: str) -> str:
    """Return the name of a function in JAX, which depends on all that its code depends on.

    A function that JAX compiled in another process, and kept on disk, therefore never calls other code.
    """
    return f"kanegen_{entry}_{function}"


def _report(
    native: NativeLibrary,
    name: bytes,
    rule: int,
    axes: int,
    shape: Any,
    operands: Any,
    dims: Any,
    message: int,
    size: int,
) -> int:
    """Report the states of a call some of which have a status, as a call with NumPy arrays does.

    Args:
        native: The library.
        name: Name of the function.
        rule: Number of the rule in `RULES`.
        axes: Number of leading axes.
        shape: Their lengths.
        operands: Address of each operand.
        dims: Lengths of the axes of each operand.
        message: Address of the room for a message.
        size: Bytes of this room.

    Returns:
        0, or 1 where the call must fail, with the message.
    """
    try:
        function = name.decode()
        lead = tuple(shape[:axes])
        arrays = _read(native, function, operands, dims, lead)
        _called_again(native, function, ON_STATUS[rule], arrays)
    except BaseException as error:  # nothing may pass through the code of XLA
        text = " ".join(str(error).split()) or type(error).__name__
        data = text.encode()[: size - 1].decode(errors="ignore").encode() + b"\0"
        ctypes.memmove(message, data, len(data))
        return 1
    return 0


def _read(
    native: NativeLibrary, name: str, operands: Any, dims: Any, lead: tuple[int, ...]
) -> dict[str, Floats]:
    """Return the operands of a call by name, each of its shape, or (B, *shape) for B states."""
    function = next(one for one in native.source.functions if one.name == name)
    found = {}
    storage = formats(native.source.variant).storage.dtype
    for k, array in enumerate(inputs_of(native.source, function)):
        dtype = native.parameter_type if array.name == PARAMETERS else storage
        own = tuple(dims[k][: len(lead) + 1])
        count = int(np.prod(own)) * dtype.itemsize
        rows = np.frombuffer(ctypes.string_at(operands[k], count), dtype).reshape(own)
        full = np.broadcast_to(rows, (*lead, own[-1]))
        found[array.name] = full.reshape((*((-1,) if lead else ()), *array.shape)).copy()
    return found


def _called_again(native: NativeLibrary, name: str, rule: OnStatus, arrays: Mapping[str, Floats]) -> None:
    """Call a function with NumPy arrays, by a rule for statuses.

    Raises:
        KanegenError: What that call raises.
    """
    found: list[StatusReport] = []
    constants = Constants()
    if PARAMETERS in arrays:
        constants = native.constants(arrays[PARAMETERS], found.append)
    of_parameters = len(found)
    values = tuple(map(arrays.get, (*arguments_of(name), *native.named_inputs)))
    native.calls[name](constants, values, found.append)
    for one in found[of_parameters:] or found:
        report(one, rule)
