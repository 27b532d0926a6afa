"""The table of products: every file that a compiler can make of a source."""

from __future__ import annotations

from kanegen.artifacts.wasm import FOLDER
from kanegen.browser import toolchain
from kanegen.browser.wasm import wasm_module
from kanegen.products import fmu
from kanegen.products.compiled_file import CompiledFile

PRODUCTS: dict[str, CompiledFile] = {
    product.name: product
    for product in (
        CompiledFile(
            "fmi2",
            "An FMU for FMI 2.0, with model exchange and co-simulation.",
            lambda source: fmu.name(source, 2),
            lambda source, platforms: fmu.fmu(source, 2, platforms),
            fmu.require_compilers,
        ),
        CompiledFile(
            "fmi3",
            "An FMU for FMI 3.0, with model exchange and co-simulation.",
            lambda source: fmu.name(source, 3),
            lambda source, platforms: fmu.fmu(source, 3, platforms),
            fmu.require_compilers,
        ),
        CompiledFile(
            "wasm",
            "A module of WebAssembly, for browsers and Node.js.",
            lambda source: f"{source.model.name}.wasm",
            lambda source, _: wasm_module(source, batch=True, simd=True),
            lambda _: toolchain.find(),
            folder=FOLDER,
            has_platforms=False,
        ),
    )
}
"""Every product by its name."""
