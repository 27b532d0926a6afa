"""Kernels for GPUs that are compiled by nvcc, loaded and known to JAX."""

from __future__ import annotations

import ctypes
import shlex
import shutil
import subprocess
from collections.abc import Mapping
from dataclasses import replace
from threading import Lock
from typing import Any

from kanegen.c import Source
from kanegen.c.cuda import CUDA_TARGET
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE, Function
from kanegen.c.render import printed
from kanegen.c.templates import fill
from kanegen.errors import BuildError, OptionError, quoted
from kanegen.extras import JAX, module
from kanegen.interop.jax.calls import Prepared
from kanegen.interop.jax.facade import functions_of, header_of_xla, operand
from kanegen.interop.jax.handlers import Handlers
from kanegen.library import Library
from kanegen.library.native.build import Product, Recipe, made
from kanegen.library.native.loaded import NativeLibrary
from kanegen.options import AUTO
from kanegen.program.ir import PREPARED

jax = module("jax", "jaxlib", extra=JAX)

PLATFORM = "CUDA"
"""JAX's name of the platform whose calls the handlers answer."""

FLAGS = ("-O3", "--fmad=false", "-arch=native")
"""Flags of nvcc with which results have the bits of the C."""

_LOADED: dict[str, ctypes.CDLL] = {}
"""The library of every entry of the cache whose handlers JAX knows; it stays until the process ends."""

_LOCK = Lock()


def kernels(recipe: Recipe, parameters: Mapping[str, float], nvcc: str) -> Handlers:
    """Return a library whose functions JAX calls on GPUs, compiled if need be.

    Args:
        recipe: The C, and how it is compiled for calls with NumPy arrays.
        parameters: Values of the run-time parameters.
        nvcc: Command of nvcc, with further flags if there are any.

    Raises:
        OptionError: If the target CUDA lacks an output or a choice.
        BuildError: If there is no nvcc, or it fails.
    """
    source = _source(recipe.source)
    entry, library = made(_product(source, nvcc), lambda path: (path.parent.name, ctypes.CDLL(str(path))))
    functions = _functions(source)
    targets = {one.name: f"kanegen_{entry}_cuda_{one.name}" for one in functions}
    with _LOCK:
        if entry not in _LOADED:
            for name, target in targets.items():
                handler = library[f"{source.model.name}_jax_cuda_{name}"]
                jax.ffi.register_ffi_target(target, jax.ffi.pycapsule(handler), platform=PLATFORM)
            _LOADED[entry] = library
    native = made(recipe.product(), lambda path: NativeLibrary(recipe, path))
    return Handlers(Library(native, parameters, "ignore"), targets, "cuda", _prepared(source, targets))


def _source(source: Source) -> Source:
    """Return the kernels of the functions of a source in C."""
    if source.render_input is None:
        raise OptionError(
            f"functions: system {quoted(source.model.shown)} does not carry its programs. Give the system."
        )
    variant = replace(source.render_input.variant, machine=AUTO)  # a choice of processors, for the C alone
    longest = CUDA_TARGET.longest_part
    return printed(replace(source.render_input, variant=variant, longest_part=longest), CUDA_TARGET)


def _functions(source: Source) -> tuple[Function, ...]:
    """Return the functions that JAX calls, and `prepare`."""
    prepare = tuple(one for one in source.functions if one.name == PREPARE)
    return (*prepare, *functions_of(source))


def _prepared(source: Source, targets: Mapping[str, str]) -> Prepared | None:
    """Return how the constants that depend on parameters are computed; None for a model without."""
    for one in source.functions:
        if one.name == PREPARE:
            dtype = formats(source.variant).of(PREPARED).dtype
            return Prepared(targets[PREPARE], one.outputs[0].size, dtype)
    return None


def _product(source: Source, nvcc: str) -> Product:
    """Return the shared library with the commands that make it.

    Raises:
        BuildError: If there is no nvcc.
    """
    command = _command(nvcc)
    name = source.model.name
    handlers = f"{name}_jax_cuda.c"
    files = {**source.code, **handler_files(source)}
    return Product(
        name=f"lib{name}_jax_cuda.so",
        files=files,
        compile={
            f"{name}.cu": (*command, *FLAGS, "-Xcompiler", "-fPIC"),
            handlers: (*command, "-O2", "-Xcompiler", "-fPIC", "-I."),
        },
        link=(*command, "-shared"),
        link_arguments=(),
        fingerprints=(_version(command),),
    )


def _command(nvcc: str) -> tuple[str, ...]:
    """Return the command of nvcc, split as a shell does it.

    Raises:
        BuildError: If there is no such command.
    """
    parts = tuple(shlex.split(nvcc))
    if not parts or shutil.which(parts[0]) is None:
        raise BuildError(
            f"nvcc: there is no compiler {quoted(nvcc)}. Install the CUDA toolkit, or give its path."
        )
    return parts


def _version(command: tuple[str, ...]) -> str:
    """Return what nvcc says of its version."""
    result = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return result.stdout


def handler_files(source: Source) -> dict[str, str]:
    """Return the handlers of kernels, in C, with the headers that they include.

    Args:
        source: Code of the target "cuda".

    Example:
        files = {**source.code, **handler_files(source)}
    """
    functions = [_printed(source, one) for one in _functions(source)]
    text = fill(
        "jax/handlers_cuda.c",
        model=source.model.name,
        functions=functions,
        most_inputs=max(len(one["inputs"]) for one in functions),
        most_outputs=1 + max(len(one["outputs"]) for one in functions),
    )
    return {
        f"{source.model.name}_jax_cuda.c": text,
        "kanegen_xla.h": fill("jax/kanegen_xla.h"),
        **header_of_xla(),
    }


def _printed(source: Source, function: Function) -> dict[str, Any]:
    """Return a function as the template prints it."""
    numbers = formats(source.variant)
    return {
        "name": function.name,
        "inputs": [operand(source.model, function, one, numbers.of(one.name)) for one in function.inputs],
        "outputs": [operand(source.model, function, one, numbers.of(one.name)) for one in function.outputs],
    }
