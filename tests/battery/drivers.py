"""C programs that call generated code from outside Python: for flags, rounding modes and sanitizers."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.library.native import compilers
from kanegen.program.precision import Precision
from kanegen.reference.states import States
from tests.battery.measuring import FORWARD, Floats

HERE = Path(__file__).parent


def printed(
    driver: str,
    system: kg.System,
    precision: Precision,
    states: States,
    tau: Floats,
    flags: Sequence[str],
    sincos: str = "shared",
) -> str:
    """What the program `driver` prints, which reads states from the files x, y and tau.

    Args:
        driver: File next to this one.
        system: Whose forward dynamics it calls, as ONE(x, y, tau, found) and MANY(count, ...).
        precision: Its type is REAL.
        states: B of them, without loads.
        tau: (B, n).
        flags: Of the compiler, for the driver and the generated code.
        sincos: Which sine and cosine the code has, as in `Variant`.

    Raises:
        CalledProcessError: If the compiler or the program fails; `output` says why.
    """
    source = kg.generate(system, FORWARD, tier=kg.Variant(precision=precision.name, sincos=sincos))
    with tempfile.TemporaryDirectory() as name:
        folder = source.write(Path(name) / "c")
        for array, values in (("x", states.x), ("y", states.y), ("tau", tau)):
            (folder / array).write_bytes(values.astype(precision.dtype).tobytes())
        code = [f"{system.name}.c", f"{system.name}_batch.c", str(HERE / driver)]
        defined = [f"-DN={len(system.freedoms)}", f"-DREAL={precision.name}", f'-DHEADER="{system.name}.h"']
        calls = [f"-DONE={system.name}_forward_dynamics", f"-DMANY={system.name}_forward_dynamics_batch"]
        command = [
            *compilers.find().command,
            "-std=c99",
            *flags,
            *defined,
            *calls,
            "-I.",
            *code,
            "-lm",
        ]
        run([*command, "-o", "driver"], folder)
        return run([str(folder / "driver"), str(len(states))], folder)


def run(command: Sequence[str], folder: Path) -> str:
    """What a command prints.

    Raises:
        CalledProcessError: If it fails.
    """
    done = subprocess.run(command, cwd=folder, check=True, text=True, capture_output=True)
    return done.stdout


def failure(error: subprocess.CalledProcessError) -> str:
    """The first line of what a failed program said."""
    lines = [line for line in str(error.stderr).splitlines() if line.strip()]
    return next((line for line in lines if "error" in line), lines[0] if lines else str(error))


def efforts_for(states: States, seed: int) -> Floats:
    """(B, n) random, up to 10."""
    values: Floats = np.random.default_rng(seed).uniform(-10, 10, states.x.shape)
    return values
