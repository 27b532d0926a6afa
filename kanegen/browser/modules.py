"""The modules of a page: WebAssembly in base64, with the functions and arrays that its script calls."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from kanegen.browser.wasm import wasm_module
from kanegen.c import Source
from kanegen.c.c99 import C99
from kanegen.c.formats import formats
from kanegen.compiler import generate
from kanegen.model.system import System
from kanegen.options import Variant
from kanegen.program.ir import Array
from kanegen.program.precision import DOUBLE_DOUBLE
from kanegen.recursion.outputs.integrators import INTEGRATORS

_SHORT_PARTS = C99(longest_part=150)
"""C whose functions consist of short parts. The time of compilers for WebAssembly grows with the square of
the length of a function, and an operation on pairs of doubles is about twenty operations."""

_C99 = C99()


@dataclass(frozen=True)
class PageModule:
    """A module of WebAssembly as the script of a page reads it.

    Attributes:
        code: Base64 of the module, compressed by zlib.
        functions: For each function its name, its symbol in the module, and its input and output arrays, each
            with name, size and precision.
        sines: Number of sines and cosines of one evaluation of all outputs.
        bytes: Size of the module.
        not_converged: Status of a step whose iteration does not converge.
    """

    code: str
    functions: list[dict[str, Any]]
    sines: int
    bytes: int
    not_converged: int

    @classmethod
    def of(cls, system: System, outputs: Iterable[str], variant: Variant) -> PageModule:
        """Generate C for outputs of a system, compile it, and return the module.

        Args:
            system: The tree.
            outputs: Names of outputs, of which each has a function.
            variant: The choices between speed and accuracy.

        Raises:
            OptionError, ModelError, SingularError: As `kanegen.generate`.
            BuildError: As `wasm_module`.
        """
        target = _SHORT_PARTS if variant.precision == DOUBLE_DOUBLE.name else _C99
        names = tuple(outputs)
        functions = None if INTEGRATORS.keys() & names else names  # steps call a function of several outputs
        source = generate(system, names, tier=variant, functions=functions, target=target)
        module = wasm_module(source, simd=True)
        return cls(
            code=base64.b64encode(zlib.compress(module, 9)).decode("ascii"),
            functions=_functions(source),
            sines=source.operations["sincos"],
            bytes=len(module),
            not_converged=source.model.not_converged,
        )

    def as_table(self) -> dict[str, Any]:
        """Return what the script of a page reads, as JSON can hold it."""
        return {"code": self.code, "functions": self.functions}


def _functions(source: Source) -> list[dict[str, Any]]:
    """Return the functions of a source as tables of names, symbols and arrays."""
    kinds = formats(source.variant)

    def arrays(some: Iterable[Array]) -> list[dict[str, Any]]:
        return [{"name": one.name, "size": one.size, "precision": kinds.of(one.name).name} for one in some]

    return [
        {
            "name": function.name,
            "symbol": f"{source.model.name}_{function.name}",
            "inputs": arrays(function.inputs),
            "outputs": arrays(function.outputs),
        }
        for function in source.functions
    ]
