"""NVRTC, NVIDIA's compiler of CUDA C++ as a library, from a package or a CUDA toolkit."""

from __future__ import annotations

import ctypes
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import util
from pathlib import Path

from kanegen.errors import MissingError


@cache
def nvrtc_library() -> ctypes.CDLL:
    """Return the loaded library, of the package or of a CUDA toolkit.

    Raises:
        MissingError: If there is none.
    """
    found = util.find_spec("nvidia")
    folders = (
        [Path(one) / "cuda_nvrtc" / "lib" for one in (found.submodule_search_locations or [])]
        if found
        else []
    )
    toolkit = Path(os.environ.get("CUDA_HOME", "/usr/local/cuda"))
    for folder in (*folders, toolkit / "lib64", toolkit / "targets" / "x86_64-linux" / "lib"):
        for path in sorted(folder.glob("libnvrtc.so*")):
            return ctypes.CDLL(str(path))
    raise MissingError(
        "NVRTC, NVIDIA's compiler, is not installed. Run: pip install nvidia-cuda-nvrtc-cu12, or set "
        "$CUDA_HOME to the folder of a CUDA toolkit."
    )


@dataclass(frozen=True)
class Usage:
    """What a kernel, or a function that it calls, takes of a multiprocessor, for each thread.

    Attributes:
        registers: Registers of 32 bits; 0 for a function that is no kernel.
        stack: Bytes of local memory.
        stores: Bytes that are stored in local memory because there are too few registers.
        loads: Bytes that are loaded from there.
    """

    registers: int
    stack: int
    stores: int
    loads: int


@dataclass(frozen=True)
class Compiled:
    """What the compiler made of a program.

    Attributes:
        log: All that it says.
        binary: The code for the architecture; assembly (PTX) where the architecture is a virtual one.
    """

    log: str
    binary: bytes

    @property
    def messages(self) -> str:
        """Warnings and errors: the log without the resources of kernels, which -v prints."""
        lines = self.log.strip("\0\n").splitlines()
        return "\n".join(line for line in lines if not re.match(r"ptxas +(info|\.) |\s*$", line))

    @property
    def usage(self) -> dict[str, Usage]:
        """The resources of every kernel and of every function that is not joined to one, by its name."""
        found = re.findall(
            r"Function properties for (\w+)\nptxas +\. +(\d+) bytes stack frame, (\d+) bytes spill stores, "
            r"(\d+) bytes spill loads\n(?:.*?Used (\d+) registers)?",
            self.log,
        )
        return {
            name: Usage(int(registers or 0), int(stack), int(stores), int(loads))
            for name, stack, stores, loads, registers in found
        }


def compile_cuda(files: Mapping[str, str], name: str, architecture: str, *options: str) -> Compiled:
    """Compile the file `name` among `files` for an architecture such as "sm_80".

    Raises:
        ValueError: If the compiler refuses the program; the message is its log.
    """
    nvrtc = nvrtc_library()
    headers = {one: text for one, text in files.items() if one != name}
    texts = (ctypes.c_char_p * len(headers))(*(text.encode() for text in headers.values()))
    names = (ctypes.c_char_p * len(headers))(*(one.encode() for one in headers))
    program = ctypes.c_void_p()
    given = (files[name].encode(), name.encode(), len(headers), texts, names)
    _require(nvrtc.nvrtcCreateProgram(ctypes.byref(program), *given))
    flags = [f"--gpu-architecture={architecture}", *options]
    result = nvrtc.nvrtcCompileProgram(
        program, len(flags), (ctypes.c_char_p * len(flags))(*(flag.encode() for flag in flags))
    )
    log = _read(nvrtc, "ProgramLog", program).decode()
    if result:
        raise ValueError(log)
    compiled = Compiled(log, _read(nvrtc, "CUBIN" if architecture.startswith("sm") else "PTX", program))
    nvrtc.nvrtcDestroyProgram(ctypes.byref(program))
    return compiled


def _read(nvrtc: ctypes.CDLL, what: str, program: ctypes.c_void_p) -> bytes:
    size = ctypes.c_size_t()
    _require(getattr(nvrtc, f"nvrtcGet{what}Size")(program, ctypes.byref(size)))
    text = ctypes.create_string_buffer(size.value)
    _require(getattr(nvrtc, f"nvrtcGet{what}")(program, text))
    return text.raw


def _require(result: int) -> None:
    if result:
        raise RuntimeError(f"NVRTC returns {result}")
