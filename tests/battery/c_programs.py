"""C programs that call generated code from outside Python: for flags, rounding modes and sanitizers."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.library.native import commands
from kanegen.library.native.build import code, program
from kanegen.program.precision import Precision
from kanegen.reference.states import States
from tests.battery.measurement import FORWARD, Floats

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
    """Return what the program `driver` prints, which reads states from the files x, y and tau.

    Args:
        driver: File name of the C program, in this folder.
        system: Model whose forward dynamics it calls, as ONE(x, y, tau, found) and MANY(count, ...).
        precision: Precision whose type is REAL in the program.
        states: B states without loads.
        tau: (B, n) generalized forces.
        flags: Compiler flags of the driver and the generated code.
        sincos: Which sine and cosine the code has, as in `Variant`.

    Raises:
        CommandError: If the compiler or the program fails.
    """
    source = kg.generate(system, FORWARD, tier=kg.Variant(precision=precision.name, sincos=sincos))
    defined = [f"-DN={len(system.freedoms)}", f"-DREAL={precision.name}", f'-DHEADER="{system.name}.h"']
    calls = [f"-DONE={system.name}_forward_dynamics", f"-DMANY={system.name}_forward_dynamics_batch"]
    files = code(source) | {path.name: path.read_text() for path in (HERE / driver, *HERE.glob("*.h"))}
    every = ["-std=c99", *flags, *defined, *calls]
    by_file = {file: every for file in files if file.endswith(".c")}
    built = program("driver", files, by_file, (*flags, "-lm"))
    with tempfile.TemporaryDirectory() as name:
        for array, values in (("x", states.x), ("y", states.y), ("tau", tau)):
            (Path(name) / array).write_bytes(values.astype(precision.dtype).tobytes())
        return commands.output([built, str(len(states))], Path(name))


def efforts_for(states: States, seed: int) -> Floats:
    """Return (B, n) random generalized forces, up to 10."""
    values: Floats = np.random.default_rng(seed).uniform(-10, 10, states.x.shape)
    return values
