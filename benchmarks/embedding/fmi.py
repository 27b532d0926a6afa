"""Accelerations of an arm through the functions of FMI 3.0, beside the generated function that they call."""

from __future__ import annotations

from pathlib import Path

import kanegen as kg
from benchmarks.embedding.row import ROUNDS, SECONDS, Row, in_turns
from kanegen.library.native import commands, compilers
from kanegen.library.native.build import program
from kanegen.options import STRICT

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
DRIVER = "fmi_driver.c"


def measure(rounds: int = ROUNDS, seconds: float = SECONDS) -> list[Row]:
    """Return the row of one evaluation of a right side: states set, derivatives of the states asked for."""
    system = kg.load(ROOT / "models" / "panda_arm.toml")
    outputs = ("forward_dynamics", "rollout_rk4")
    source = kg.generate(system, outputs, artifacts=["fmi3"])
    folder = "fmi3/sources/"
    files = {
        path.removeprefix(folder): text
        for path, text in source.files.items()
        if path.startswith(folder) and path.endswith((".c", ".h"))
    }
    files[DRIVER] = (HERE / DRIVER).read_text(encoding="utf-8")
    flags = ("-std=c99", *STRICT.flags)
    path = program("fmi_driver", files, {file: flags for file in files if file.endswith(".c")})

    def turn(which: str) -> float:
        return float(commands.output([path, which, str(seconds)]).split()[0])

    alone, through = in_turns(lambda: turn("alone"), lambda: turn("through"), rounds)
    call = "fmi3SetContinuousStates and fmi3GetContinuousStateDerivatives of panda_arm"
    return [Row("FMI 3.0", call, alone, through, compilers.find().version)]
