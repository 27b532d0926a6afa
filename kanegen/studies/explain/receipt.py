"""The receipt of a scene: what each of its choices removes, and where the operations go that remain."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from kanegen import compiler
from kanegen.c import Source, description, render
from kanegen.library.native import compilers
from kanegen.lowering.compilation import Compiled
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, quiet
from kanegen.program.count import count
from kanegen.program.ir import PREPARED
from kanegen.recursion.outputs import EQUATIONS, chosen
from kanegen.studies.explain.compiling import seconds_to_compile
from kanegen.studies.explain.costs import by_body
from kanegen.studies.explain.general import answering, steps


@dataclass(frozen=True)
class Step:
    """A program on the way from the general one to that of the scene.

    Attributes:
        without: What it does without, beside all before it.
        freedoms: n.
        parameters: Numbers that are read at run time.
        inputs: Numbers that one evaluation reads: coordinates, speeds, loads and the like.
        operations: By kind; "prepare" holds what runs once.
        bytes: Of the C of the functions for one state.
        seconds: To compile it; None if that was not asked for.
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
        """Operations of one evaluation."""
        return sum(self.operations.values()) - self.operations["prepare"]


@dataclass(frozen=True)
class Receipt:
    """What is said of a scene.

    Attributes:
        system: The scene.
        outputs: What is computed.
        steps: The general program first, that of the scene last.
        bodies: Operations that remain, by number of the body; 0 for those that are about all.
        alone: Operations of each output by itself.
    """

    system: System
    outputs: tuple[str, ...]
    steps: tuple[Step, ...]
    bodies: dict[int, int]
    alone: dict[str, int]

    @property
    def ratio(self) -> float:
        """Operations of the general program over those that remain."""
        return self.steps[0].total / max(self.steps[-1].total, 1)

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        names = {0: "all", **{k: body.name for k, body in enumerate(self.system.bodies, start=1)}}
        return {
            "name": self.system.name,
            "outputs": list(self.outputs),
            "steps": [{**asdict(step), "total": step.total} for step in self.steps],
            "ratio": self.ratio,
            "bodies": [{"number": k, "name": names[k], "operations": n} for k, n in self.bodies.items()],
            "outputs_alone": self.alone,
        }


def receipt(
    system: System,
    outputs: Iterable[str] = EQUATIONS,
    timed: bool = False,
    progress: Progress = quiet,
) -> Receipt:
    """The receipt of `system`.

    Args:
        system: The scene.
        outputs: What is to be computed.
        timed: Whether to compile the general and the specialised C, and say how long that takes.
        progress: Told the name of each stage.

    Raises:
        BuildError: If there is no compiler and times are asked for.
        OptionError: If an output is unknown.
        SingularError: If [A] of the scene is singular in every state.
    """
    names = chosen(outputs)
    if timed:
        compilers.find()
    found: list[Step] = []
    compiled = compiler.compile_module(system, names)
    stages = list(steps(system))
    for number, (without, stage) in enumerate(stages):
        progress(f"without {without}")
        ends = number in (0, len(stages) - 1)
        made = compiled
        if stage != system:
            made = compiler.compile_module(stage, answering(stage, names), regular=False)
        found.append(_step(without, stage, made, timed and ends))
    alone = {name: sum(count(compiled.module.functions[name]).values()) for name in names}
    return Receipt(system, names, tuple(found), by_body(compiled.module.together), alone)


def _step(without: str, system: System, compiled: Compiled, timed: bool) -> Step:
    module = compiled.module
    source: Source = render(description(system), module, compiled.operations, STRICT, {})
    return Step(
        without=without,
        freedoms=len(system.freedoms),
        parameters=len(system.parameters),
        inputs=sum(array.size for array in module.together.inputs if array.name != PREPARED),
        operations=compiled.operations,
        bytes=len(source.files[f"{system.name}.c"].encode()),
        seconds=seconds_to_compile(source) if timed else None,
    )
