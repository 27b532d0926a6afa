"""Generated CUDA on the processor: the very files as C++ with a shim, called with NumPy arrays."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kanegen.c import Source
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE
from kanegen.program.ir import PARAMETERS, PREPARED
from tests.support.c_compilers import CPP, WARNINGS

SHIM = Path(__file__).parent / "cuda_shim"
FLAGS = [
    "-std=c++17",
    "-ffp-contract=off",
    "-O0",
    *(flag for flag in WARNINGS if flag not in {"-Wstrict-prototypes", "-Wmissing-prototypes"}),
    "-Wno-unused-function",
]
"""Flags of C++ compilers, whose level of optimisation changes no bit.

nvcc does not warn of device functions that no kernel calls.
"""


@dataclass(frozen=True)
class OnProcessor:
    """The kernels of a source, which run on the processor.

    Attributes:
        source: A source of the target "cuda".
        library: What was compiled of its files.
    """

    source: Source
    library: ctypes.CDLL

    def call(
        self, name: str, count: int, *, stride: int | None = None, rows: bool = False, **inputs: NDArray[Any]
    ) -> tuple[dict[str, NDArray[Any]], NDArray[np.int32]]:
        """Return the outputs of a function, (count, ...) each, and the status of every state.

        Args:
            name: Name of the function.
            count: Number of states.
            stride: Numbers from one element to the next, by default `count`.
            rows: Whether the kernel gets arrays with a row for each state.
            inputs: Arrays with a row for every state; `prepared` and `parameters` are as in the call of C.
        """
        (function,) = [one for one in self.source.functions if one.name == name]
        stride = count if stride is None else stride
        common = () if self.source.parameters_by_state else (PARAMETERS, PREPARED)
        is_for_all = name == PREPARE and bool(common)
        of = formats(self.source.variant).of
        arrays = []
        for array in (*function.inputs, *function.outputs):
            is_common = array.name in common
            memory = np.full((array.size, 1 if is_common else stride), np.nan, of(array.name).dtype)
            if array.name in inputs:
                values = np.asarray(inputs[array.name]).reshape(-1, array.size)
                memory[:, : len(values)] = values.T
            arrays.append(np.ascontiguousarray(memory.T).T if rows else memory)
        status = np.full(stride, -99, np.int32)
        launcher = f"{self.source.model.name}_{name}_{'' if is_for_all else 'batch_'}cuda"
        counts = [] if is_for_all else [ctypes.c_size_t(count), ctypes.c_size_t(0 if rows else stride)]
        pointers = [ctypes.c_void_p(memory.ctypes.data) for memory in (*arrays, status)]
        assert getattr(self.library, launcher)(None, *counts, *pointers) == 0
        outputs = {
            array.name: np.ascontiguousarray(memory.T)
            if array.name in common
            else self._rows(memory, count, array.shape)
            for array, memory in zip(function.outputs, arrays[len(function.inputs) :], strict=True)
        }
        return outputs, status[:count]

    @staticmethod
    def _rows(memory: NDArray[Any], count: int, shape: tuple[int, ...]) -> NDArray[Any]:
        """Return the rows of the states; numbers behind the last of them must be untouched."""
        assert np.isnan(memory[:, count:]).all()
        return np.ascontiguousarray(memory[:, :count].T).reshape(count, *shape)


def build(folder: Path, output: str, *files: str, compiler: str = "g++", flags: Sequence[str] = ()) -> None:
    """Compile files of CUDA in a folder for the processor; a warning fails."""
    command = [*CPP[compiler], *FLAGS, *flags, f"-I{SHIM}", "-x", "c++", *files, "-o", output]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


def on_processor(source: Source, folder: Path, compiler: str = "g++", *flags: str) -> OnProcessor:
    """Return the kernels of a source, compiled for the processor in `folder`."""
    source.write(folder)
    name = source.model.name
    build(folder, f"{name}.so", f"{name}.cu", compiler=compiler, flags=("-shared", "-fPIC", *flags))
    return OnProcessor(source, ctypes.CDLL(str(folder / f"{name}.so")))
