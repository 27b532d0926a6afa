"""What `kanegen info` says of a system: everything in it, and what its equations cost."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from kanegen import compiler
from kanegen import options as variants
from kanegen.cli.right_angles import Angles
from kanegen.model.coordinates import Freedom
from kanegen.model.freedoms import FREEDOMS, named
from kanegen.model.numbers import map_numbers, value_of
from kanegen.model.system import System
from kanegen.program.passes import Stage, savings
from kanegen.recursion.outputs import EQUATIONS, OUTPUTS, available

TOGETHER = " + ".join(EQUATIONS)


@dataclass(frozen=True)
class Facts:
    """A system and its operation counts.

    Attributes:
        system: The tree.
        operations: By output, and of [A] and {f} together.
        methods: How each output is derived.
        refinement: Whether {ydot} is refined, and why.
        stages: What all outputs together cost after lowering and after every pass.
        right_angles: What it changes to take them; None where the model misses none.
    """

    system: System
    operations: dict[str, dict[str, int]]
    methods: dict[str, str]
    refinement: str
    stages: tuple[Stage, ...]
    right_angles: Angles | None

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data."""
        return {
            **_contents(self.system),
            "operations": self.operations,
            "methods": self.methods,
            "refinement": self.refinement,
            "passes": [asdict(stage) for stage in self.stages],
            "saved": savings(self.stages),
            "right_angles": self.right_angles.as_dict() if self.right_angles else None,
        }


def gather(
    system: System,
    progress: Callable[[str], None],
    without: Iterable[str] | None = None,
    angles: Angles | None = None,
) -> Facts:
    """Count what every output costs alone and all together, without some passes if so wished."""
    variant = variants.chosen(without=without)
    # Derivatives of a large tree take minutes, and nobody has asked for them.
    names = [name for name in available(system) if not OUTPUTS[name].is_derivative]
    alone = {name: compiler.compile_module(system, (name,), progress, variant) for name in names}
    together = compiler.compile_module(system, EQUATIONS, progress, variant)
    operations = {name: compiled.operations for name, compiled in alone.items()}
    methods = {name: compiled.methods[name] for name, compiled in alone.items()}
    refinement = alone["forward_dynamics"].refinement
    operations[TOGETHER] = together.operations
    return Facts(system, operations, methods, refinement, together.stages, angles)


def _contents(system: System) -> dict[str, Any]:
    coordinates = zip(system.coordinate_names, system.coordinates, strict=True)
    efforts = [freedom.effort for freedom in system.reacting]
    return {
        "name": system.name,
        "gravity": map_numbers(system.gravity, value_of),
        "bodies": _bodies(system),
        "coordinates": [
            {"name": name, "body": coordinate.body, "unit": coordinate.unit}
            for name, coordinate in coordinates
        ],
        "freedoms": _directions(system.freedom_names, system.freedoms),
        "prescribed": _directions(system.prescribed_names, system.prescribed),
        "speeds": list(system.speed_names),
        "poses": list(system.pose_names),
        "reactions": _directions(system.reaction_names, system.reacting, efforts),
        "parameters": {parameter.name: parameter.value for parameter in system.parameters},
        "force_elements": [{"kind": element.KEY, **element.as_table()} for element in system.force_elements],
    }


def _bodies(system: System) -> list[dict[str, Any]]:
    return [
        {
            "number": k,
            "name": body.name,
            "connection": body.lower,
            "mass": value_of(body.mass),
            "free": named(body.joint.free),
            "prescribed": named(body.joint.prescribed),
            "coordinates": body.joint.coordinates,
            "sequence": body.joint.sequence,
            "loads": body.loads,
        }
        for k, body in enumerate(system.bodies, start=1)
    ]


def _directions(
    names: Sequence[str], freedoms: Sequence[Freedom], units: Sequence[str] | None = None
) -> list[dict[str, Any]]:
    """A row for each, in units of the coordinates if nothing else is said."""
    units = [freedom.unit for freedom in freedoms] if units is None else units
    return [
        {"name": name, "body": freedom.body, "freedom": FREEDOMS[freedom.index], "unit": unit}
        for name, freedom, unit in zip(names, freedoms, units, strict=True)
    ]
