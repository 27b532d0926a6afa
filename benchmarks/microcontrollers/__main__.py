"""Count instructions, stack and flash memory of generated functions on microcontrollers in QEMU.

    python -m benchmarks.microcontrollers [--file FILE] [MODEL ...]

Writes docs/embedding/microcontroller-costs.md. Needs arm-none-eabi-gcc with newlib, and qemu-system-arm. The
numbers are counts: they do not depend on the machine on which QEMU runs.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import kanegen as kg
from benchmarks.microcontrollers.boards import (
    BOARDS,
    GCC,
    QEMU,
    Board,
    compile_for,
    flash_of,
    numbers,
    run_on,
)
from benchmarks.microcontrollers.programs import REPEATS, program_of_costs, random_inputs
from kanegen.c import Source
from kanegen.files import write_whole
from kanegen.studies.markdown import markdown_table

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "embedding" / "microcontroller-costs.md"
MODELS = ("double_pendulum", "panda_arm", "satellite")
FUNCTIONS = ("forward_dynamics", "step_rk4")
FLAGS = ("-O2",)

HEAD = """# Costs on microcontrollers

`python -m benchmarks.microcontrollers` writes this page: what one call takes on three processors, as QEMU
counts it. *Instructions* are all that the processor runs in the call, those of arithmetic in software among
them: the Cortex-M0+ has no instructions for floating-point numbers, the Cortex-M4F none for double
precision. On these processors most instructions take one cycle. *Stack* is what a call overwrites of it.
*Flash* is what a program grows by when it calls the function, with sine, cosine, and arithmetic in
software. The results of every call have the bits that a PC computes; `make embed-microcontrollers` tests
this.
"""


@dataclass(frozen=True)
class Cost:
    """What a call takes.

    Attributes:
        instructions: Number of instructions.
        stack: Bytes of stack.
        flash: Bytes of code and constants.
    """

    instructions: int
    stack: int
    flash: int

    def cells(self) -> list[str]:
        """Return the numbers as cells of a table."""
        return [f"{number:,}".replace(",", " ") for number in (self.instructions, self.stack, self.flash)]


def measured(source: Source, function: str, board: Board, folder: Path) -> Cost:
    """Return what a call of a function takes on a board, in a random state."""
    source.write(folder, force=True)
    states = random_inputs(source, [function], 1)
    (folder / "costs.c").write_text(program_of_costs(source, states, function))
    (folder / "without.c").write_text(program_of_costs(source, states, function, is_called=False))
    code = f"{source.model.name}.c"
    without = flash_of(compile_for(board, folder, ["without.c", code], FLAGS))
    program = compile_for(board, folder, ["costs.c", code], FLAGS)
    found = numbers(run_on(board, program))
    return Cost(round(found["ticks"] * board.tick / REPEATS), found["stack"], flash_of(program) - without)


def rows(model: str) -> Iterator[list[str]]:
    """Yield a row for every function, precision and board."""
    for precision in ("float", "double"):
        system = kg.load(ROOT / "models" / f"{model}.toml")
        source = kg.generate(system, FUNCTIONS, precision=precision, batches=False)
        for function in FUNCTIONS:
            for board in BOARDS.values():
                with tempfile.TemporaryDirectory() as folder:
                    cost = measured(source, function, board, Path(folder) / "code")
                yield [f"`{model}_{function}`", precision, board.name, *cost.cells()]


def version(command: str) -> str:
    """Return the first line that a program prints about its version."""
    printed = subprocess.run([command, "--version"], capture_output=True, text=True, check=True).stdout
    return printed.splitlines()[0]


def document(models: list[str]) -> str:
    """Return the page."""
    table = [row for model in models for row in rows(model)]
    columns = ["function", "precision", "processor", "instructions", "stack, bytes", "flash, bytes"]
    tools = [
        f"- {version(GCC)}, `{' '.join(FLAGS)} -ffp-contract=off`",
        f"- {version(QEMU)}, `-icount shift=0`",
    ]
    return "\n".join([HEAD, markdown_table(columns, table, left=3), "", *tools, ""])


def main() -> None:
    """Measure, print the page and write it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.microcontrollers")
    parser.add_argument("models", nargs="*", metavar="MODEL", default=list(MODELS))
    parser.add_argument("--file", type=Path, default=PAGE)
    options = parser.parse_args()
    text = document(options.models)
    print(text)
    write_whole(options.file, text)


if __name__ == "__main__":
    main()
