"""Instructions and accesses of the stack in compiled functions, by the order of their statements.

python -m benchmarks.spills [MODEL ...]

For every order that `kanegen.program.arrange` chooses among it prints the instructions that
`kanegen.program.machine` predicts, and those that gcc makes for a processor with AVX2, with how many of them
read or write the stack. The order that is chosen has a star. Statements have no loops: a processor executes
what the file holds, but for sines and cosines and the test of results.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from unittest import mock

import kanegen as kg
from benchmarks import models
from kanegen.c.c99 import C99_TARGET
from kanegen.c.render import printed
from kanegen.program import split
from kanegen.program.arrange import arrange
from kanegen.program.cut import cut
from kanegen.program.ir import Program
from kanegen.program.machine import instructions
from kanegen.program.orders import by_rows, depth_first, longest_chain_first
from kanegen.program.semantics import UNFUSED
from kanegen.studies.bench.settings import DEFAULT_AVX2

FLAGS = ("-std=c99", "-fPIC", *DEFAULT_AVX2.flags, UNFUSED)
"""Flags of the default build on a processor with AVX2, with the one that gcc 12.1 and 12.2 need."""

OUTPUTS = (
    ("mass_matrix", "forcing"),
    ("inverse_dynamics_derivatives",),
    ("forward_dynamics",),
    ("forward_dynamics_derivatives",),
)
_STACK = re.compile(r"\(%r[sb]p")


def derived(program: Program) -> Program:
    """Return the program in the order of its derivation."""
    return program


ORDERS: dict[str, Callable[[Program], Program]] = {
    "derived": derived,
    "by rows": by_rows,
    "depth first": depth_first,
    "longest chain first": longest_chain_first,
}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.spills", description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=["ur5", "panda", "talos_reduced"], metavar="MODEL")
    for name in parser.parse_args().models:
        system = models.system(name)
        for outputs in OUTPUTS:
            with mock.patch.object(split, "arrange", derived):
                source = kg.generate(system, outputs, functions=["evaluate"])
            print(f"{name}: {' and '.join(outputs)}", flush=True)
            for order in ORDERS:
                print(_line(source, order), flush=True)


def _line(source: kg.Source, order: str) -> str:
    """Return a line on the code of a source whose statements have an order."""
    (program,) = source.module.functions.values()
    other = ORDERS[order](program)
    render_input = source.render_input
    module = replace(render_input.module, functions={name: other for name in source.module.functions})
    code = printed(replace(render_input, module=module), C99_TARGET).code
    predicted = instructions(cut(other))
    one, many = (_counted(code, f"{source.model.name}{end}.c") for end in ("", "_batch"))
    star = "*" if arrange(program) == other else " "
    return f"  {star} {order:20} predicted {predicted:7}; one state {one}; batch {many}"


def _counted(code: dict[str, str], file: str) -> str:
    """Return instructions and accesses of the stack of one compiled file."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in code.items():
            (Path(folder) / name).write_text(text)
        subprocess.run(["gcc", *FLAGS, "-c", file, "-o", "code.o"], cwd=folder, check=True)
        command = ["objdump", "-d", "--no-show-raw-insn", "code.o"]
        text = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
    lines = [line for line in text.splitlines() if "\t" in line]
    return f"{len(lines):7}, {sum(bool(_STACK.search(line)) for line in lines):6} of the stack"


if __name__ == "__main__":
    main()
