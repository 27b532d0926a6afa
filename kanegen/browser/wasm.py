"""WebAssembly of generated C: one module without imports, which exports every function and its memory."""

from __future__ import annotations

from pathlib import Path

from kanegen.artifacts.wasm import refusal
from kanegen.browser import toolchain
from kanegen.c import Source
from kanegen.c.interface import Function
from kanegen.c.simd import SIMD
from kanegen.c.sincos import SHARED
from kanegen.c.templates import fill
from kanegen.choices import flag
from kanegen.errors import OptionError
from kanegen.library.native.build import Product, code, made
from kanegen.program import semantics
from kanegen.program.precision import DOUBLE

STACK_BYTES = 1 << 20
"""Size of the stack of a module. Beyond its end the memory ends, so that an overflow stops the module."""

_HEADERS = "include"
"""Folder of the headers that stand for those of a C library."""

_RUNTIME = "runtime"
"""Folder of the functions that stand for those of a C library."""

_ERROR = "-Werror=implicit-function-declaration"
"""Flag with which a function of the C library that there is not is an error of the compiler."""

_OWN = {
    f"{_HEADERS}/math.h": "wasm/math.h",
    f"{_HEADERS}/string.h": "wasm/string.h",
    f"{_RUNTIME}/memory.c": "wasm/memory.c",
    f"{_RUNTIME}/mathematics.c": "wasm/mathematics.c",
    f"{_RUNTIME}/kanegen_sincos.h": "c99/kanegen_sincos.h",
}
"""Templates of the files that are compiled beside generated C, by path."""


def wasm_module(source: Source, *, batch: bool = False, simd: bool = False) -> bytes:
    """Compile generated C to a module of WebAssembly, unless the cache has it already.

    The module imports nothing. It exports each function under its name in C, `memory`, and `__heap_base`, the
    first address of the memory that is free. With strict semantics every result has the bits that native code
    gives; only the sign and the payload of a NaN may differ. The same source, options and compiler give the
    same bytes. Where sines of states are in single precision or polynomials, sines of parameters are
    kanegen's own, not those of a C library, from which they may differ in the last place.

    Args:
        source: Generated C, from `kanegen.generate`. Choices of a processor are ignored: there is only one.
        batch: Whether to export also the functions for several states at once.
        simd: Whether to use vectors of two doubles, which need a browser of 2023 or later. No bit of a result
            depends on them.

    Raises:
        BuildError: If there is no compiler for WebAssembly, it fails, or the cache folder cannot be used.
        OptionError: If the C needs what WebAssembly does not have: long double, sines of a C library, or a
            mode that flushes subnormal numbers; or it is no C99.

    Example:
        source = kg.generate(kg.load("models/double_pendulum.toml"), outputs=("forward_dynamics",))
        Path("double_pendulum.wasm").write_bytes(wasm_module(source))
    """
    if why := refusal(source):
        raise OptionError(why)
    return made(_product(source, flag("batch", batch), flag("simd", simd)), Path.read_bytes)


def exports(source: Source, batch: bool = False) -> tuple[str, ...]:
    """Return the names of the functions that the module of `source` exports.

    Args:
        source: Generated C.
        batch: Whether the module has functions for several states at once.
    """
    return tuple(
        f"{source.model.name}_{function.name}{suffix}"
        for function in source.functions
        for suffix in _suffixes(function, batch)
    )


def library_files() -> dict[str, str]:
    """Return headers and functions that stand for those of a C library, by path.

    Example:
        sorted(library_files())[0]  # 'include/math.h'
    """
    variables = {"precision": DOUBLE, "sincos": SHARED[DOUBLE], "simd": SIMD[DOUBLE]}
    return {path: fill(template, **variables) for path, template in _OWN.items()}


def _suffixes(function: Function, batch: bool) -> tuple[str, ...]:
    """Return the ends of the names in C of a function and its batch form."""
    return ("", "_batch") if batch and function.has_batch else ("",)


def _product(source: Source, batch: bool, simd: bool) -> Product:
    """Return the module with the commands that make it."""
    found = toolchain.find()
    variant = source.variant
    flags = semantics.compiler_flags(variant.semantics, "portable", variant.optimisation)
    command = (
        *found.compile,
        "-std=c99",
        _ERROR,
        *flags,
        *(("-msimd128",) if simd else ()),
        "-isystem",
        _HEADERS,
    )
    files = {file: text for file, text in code(source).items() if batch or not file.endswith("_batch.c")}
    options = (
        "--no-entry",
        "--strip-all",
        "--stack-first",
        *("-z", f"stack-size={STACK_BYTES}"),
        "--export=__heap_base",
        *(f"--export={name}" for name in exports(source, batch)),
    )
    own = library_files()
    by_itself = (*command, "-fno-builtin")  # or a loop that copies would become a call of itself
    return Product(
        name=f"{source.model.name}.wasm",
        files={**files, **own},
        compile={
            **{file: command for file in files if file.endswith(".c")},
            **{file: by_itself for file in own if file.endswith(".c")},
        },
        link=found.link,
        link_arguments=found.linker_options(options),
        fingerprints=(found.fingerprint,),
        pieces=source.pieces,
    )
