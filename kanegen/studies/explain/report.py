"""The cost report of a model: the operations that each of its choices saves, and those that are left."""

from __future__ import annotations

import re
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from kanegen import compiler
from kanegen.c import Source, description, render
from kanegen.library.native import commands, compilers, environment
from kanegen.library.native.build import code, write
from kanegen.lowering.compilation import Compiled
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, quiet
from kanegen.program.count import COUNTED, count
from kanegen.program.expand import expanded
from kanegen.program.ir import PREPARED, Program
from kanegen.recursion.outputs import EQUATIONS, chosen
from kanegen.studies.explain.general_form import equivalent_outputs, steps

ALL_BODIES = 0
"""The body number under which operations are counted that belong to no single body."""

_BODY = re.compile(r"(?:Derivatives\. )?Body (\d+) ")
"""Beginning of the comment of a quantity that belongs to a body."""


@dataclass(frozen=True)
class Step:
    """One of the programs from the general program to that of the model.

    Attributes:
        without: Generality that this program leaves out, beyond the programs before it.
        freedoms: Number of freedoms n.
        parameters: Number of run-time parameters.
        inputs: Number of numbers that one evaluation reads: coordinates, speeds, loads and the like.
        operations: Operations by kind; "prepare" counts those that run once for each set of parameters.
        bytes: Size of the C of the functions for one state.
        seconds: Time to compile this C (s); None if it was not compiled.
    """

    without: str
    freedoms: int
    parameters: int
    inputs: int
    operations: dict[str, int]
    bytes: int
    seconds: float | None = None

    @property
    def total(self) -> int:
        """The number of operations of one evaluation."""
        return sum(self.operations.values()) - self.operations["prepare"]


@dataclass(frozen=True)
class CostReport:
    """The costs of a model beside those of the general program of its tree.

    Attributes:
        system: The model.
        outputs: Names of the outputs that are computed.
        steps: The programs from the general one, which is first, to that of the model, which is last.
        bodies: Operations of the model by number of the body; `ALL_BODIES` for those of no single body.
        alone: Operations of each output by itself.
    """

    system: System
    outputs: tuple[str, ...]
    steps: tuple[Step, ...]
    bodies: dict[int, int]
    alone: dict[str, int]

    @property
    def ratio(self) -> float:
        """The operations of the general program over those of the model."""
        return self.steps[0].total / max(self.steps[-1].total, 1)

    def as_dict(self) -> dict[str, Any]:
        """Return all fields as plain data for JSON."""
        names = {ALL_BODIES: "all", **{k: body.name for k, body in enumerate(self.system.bodies, start=1)}}
        return {
            "name": self.system.name,
            "outputs": list(self.outputs),
            "steps": [{**asdict(step), "total": step.total} for step in self.steps],
            "ratio": self.ratio,
            "bodies": [{"number": k, "name": names[k], "operations": n} for k, n in self.bodies.items()],
            "outputs_alone": self.alone,
        }


def cost_report(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    timed: bool = False,
    progress: Progress = quiet,
) -> CostReport:
    """Compare the program of a model with the general program of its tree, step by step.

    Args:
        system: The model.
        outputs: Names of the outputs to compute.
        timed: Whether to compile the general and the specialised C and report the time that this takes.
        progress: Function that receives the name of each stage.

    Raises:
        BuildError: If times are asked for and there is no compiler.
        OptionError: If an output is unknown.
        SingularError: If [A] of the model is singular in every state.
    """
    names = chosen(outputs)
    if timed:
        compilers.find()
    found: list[Step] = []
    compiled = compiler.compile_module(system, names)
    stages = list(steps(system))
    for number, (without, stage) in enumerate(stages):
        progress(f"without {without}")
        is_end = number in (0, len(stages) - 1)
        made = compiled
        if stage != system:
            made = compiler.compile_module(stage, equivalent_outputs(stage, names), regular=False)
        found.append(_step(without, stage, made, timed and is_end))
    alone = {name: sum(count(compiled.module.functions[name]).values()) for name in names}
    return CostReport(
        system, names, tuple(found), operations_by_body(expanded(compiled.module.together)), alone
    )


def operations_by_body(program: Program) -> dict[int, int]:
    """Count operations by number of the body whose quantities they compute; `ALL_BODIES` for the rest.

    The parts of an expression belong to the quantity whose value the expression is.
    """
    owners = [ALL_BODIES] * len(program.instructions)
    for i in reversed(range(len(program.instructions))):
        instruction = program.instructions[i]
        found = _BODY.match(instruction.note) if instruction.name else None
        if found:
            owners[i] = int(found[1])
        if not instruction.name or found:
            for j in instruction.operands:
                if not program.instructions[j].name:
                    owners[j] = owners[i]
    costs = Counter(owners[i] for i, x in enumerate(program.instructions) if x.op in COUNTED)
    return dict(sorted(costs.items()))


def seconds_to_compile(source: Source) -> float:
    """Return the time (s) that the C compiler takes for the functions of one state.

    The flags are those of the variant of `source`.

    Raises:
        BuildError: If there is no C compiler, or it fails.
    """
    file = f"{source.model.name}.c"
    command = [*compilers.find().command, "-std=c99", *source.variant.flags, "-c", file, "-o", "model.o"]
    with tempfile.TemporaryDirectory() as folder:
        write(code(source), Path(folder))
        start = time.perf_counter()
        commands.make(command, "model.o", Path(folder), environment.compile_seconds())
        return time.perf_counter() - start


def _step(without: str, system: System, compiled: Compiled, timed: bool) -> Step:
    """Return the step of a compiled program."""
    module = compiled.module
    source: Source = render(description(system), module, compiled.operations, STRICT, {})
    return Step(
        without=without,
        freedoms=len(system.freedoms),
        parameters=len(system.parameters),
        inputs=sum(array.size for array in module.together.inputs if array.name != PREPARED),
        operations=compiled.operations,
        bytes=len(source.files[f"{system.identifier}.c"].encode()),
        seconds=seconds_to_compile(source) if timed else None,
    )
