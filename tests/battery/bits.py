"""The bits of all that generated code computes, printed by a C program for any compiler and machine."""

from __future__ import annotations

import shlex
import tempfile
from pathlib import Path

import numpy as np

from kanegen.c import Source
from kanegen.library.native import commands
from kanegen.library.native.build import code, write
from kanegen.program.precision import Precision, precision_named
from tests.battery.state_classes import State

STRICT = "-ffp-contract=off"
"""Flag that every compiler needs for the bits that are promised."""

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")
"""The outputs that the program computes."""

_DRIVER = Path(__file__).parent / "bits.c"


def storage(source: Source) -> Precision:
    """Return the precision of the arrays of states and results."""
    return precision_named(source.storage)


def printed(source: Source, state: State, command: str, flags: str = "", emulator: str = "") -> str:
    """Return the bits of all `OUTPUTS` in all states, one by one and as a batch, as text.

    Args:
        source: Generated C with the `OUTPUTS`, of a system without loads and further inputs.
        state: States in the type of the arrays.
        command: Command of the compiler.
        flags: Compiler flags beside `STRICT`.
        emulator: Program that runs what the compiler makes, with its options; "" where none is needed.

    Raises:
        CommandError: If the compiler or the program fails.
    """
    name, precision = source.model.name, storage(source)
    defined = {
        "HEADER": f'"{name}.h"',
        "MODEL": name,
        "M": len(source.model.coordinate_names),
        "N": len(source.model.freedom_names),
        "STORED": precision.c_type,
        "WORD": f"uint{8 * precision.bytes}_t",
    }
    files = {**code(source), _DRIVER.name: _DRIVER.read_text(), "states": _as_text(state)}
    with tempfile.TemporaryDirectory() as folder:
        write(files, Path(folder))
        definitions = [f"-D{key}={value}" for key, value in defined.items()]
        sources = [file for file in files if file.endswith(".c")]
        options = ["-std=c99", STRICT, *flags.split(), *definitions, *sources, "-o", "bits", "-lm"]
        commands.make([*shlex.split(command), *options], "bits", Path(folder))
        run = [*emulator.split(), "./bits", str(len(state[0]))]
        return commands.output(run, Path(folder))


def _as_text(state: State) -> str:
    """Return the bit patterns of all numbers of the states, one a line."""
    words = np.concatenate([np.ravel(array.view(f"u{array.itemsize}")) for array in state])
    return "\n".join(f"{word:x}" for word in words.tolist())
