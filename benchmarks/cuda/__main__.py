"""Registers of kernels, or their states a second on a card.

python -m benchmarks.cuda [FOLDER]                  prepare all that a card needs, and run it if there is one
python -m benchmarks.cuda --registers [MODEL ...]   print registers and local memory of kernels

Preparing takes about a minute and needs NVRTC, from the package nvidia-cuda-nvrtc-cu12 or a CUDA toolkit. On
a machine with a card `python3 FOLDER/card.py` is enough: it needs Python and the driver, and takes a minute.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

from benchmarks.cuda.cases import OUTPUT, Case, write
from benchmarks.cuda.nvrtc import compile_cuda, nvrtc_library
from kanegen.errors import MissingError


def main() -> int:
    """Run what the command line asks for, and return the status of the process."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cuda", description=__doc__.splitlines()[0])
    parser.add_argument("--registers", nargs="*", metavar="MODEL", help="print registers of these models")
    parser.add_argument("--output", default=OUTPUT, help="the output whose registers are printed")
    parser.add_argument("folder", nargs="?", type=Path, default=Path("build/cuda"))
    options = parser.parse_args()
    try:
        nvrtc_library()
    except MissingError as error:
        print(error, file=sys.stderr)
        return 2
    if options.registers is not None:
        _print_registers(options.registers or ["panda", "go2", "hyq", "talos_reduced"], options.output)
        return 0
    write(options.folder)
    return subprocess.run([sys.executable, options.folder / "card.py"], check=False).returncode


def _print_registers(names: list[str], output: str) -> None:
    """Print a row of a table for every model, precision and architecture."""
    print("| model | precision | card | form | registers | spilled, bytes | stack, bytes |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in names:
        for precision in ("float", "double"):
            source = Case(name, precision, output).source()
            program = source.files[f"{source.model.name}.cu"]
            text = program + source.files[f"{source.model.name}.cuh"]
            form = "parts" if "__noinline__" in text else "one thread"
            form = "two warps" if f"_{output}_warp_2" in program else form
            for architecture in ("sm_80", "sm_90"):
                found = compile_cuda(
                    source.files,
                    f"{source.model.name}.cu",
                    architecture,
                    "--fmad=false",
                    "--ptxas-options=-v",
                )
                usage = found.usage
                spilled = sum(one.stores for one in usage.values())
                kernel = usage[f"{source.model.name}_{output}_kernel"]
                row = name, precision, architecture, form, kernel.registers, spilled, kernel.stack
                print(f"| {' | '.join(map(str, row))} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
