"""The summary of a system for `kanegen info`: its contents, and the operation counts of its outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from kanegen import compiler
from kanegen import options as variants
from kanegen.cli.model_facts import ModelFacts, model_facts
from kanegen.model.coordinates import FREEDOMS, Freedom, selected_freedoms
from kanegen.model.identification.base_parameters import BaseParameters, base_parameters
from kanegen.model.numbers import map_numbers, value_of
from kanegen.model.reaction import Reaction
from kanegen.model.system import System
from kanegen.model.system_numbers import expression_summaries
from kanegen.program.passes import Stage, savings
from kanegen.recursion.outputs import (
    EQUATIONS,
    OF_CONTACTS,
    OUTPUTS,
    available,
    available_methods,
    solving,
    takes_long,
)
from kanegen.reference.independence import dependent_rows
from kanegen.reference.regularity import massless_motions
from kanegen.studies.explain import Exactness

TOGETHER = " + ".join(EQUATIONS)
"""The key of [A] and {f} computed together among the operation counts."""


@dataclass(frozen=True)
class RightAngleChanges:
    """The changes that exact right angles make to a model, or would make.

    Attributes:
        tolerance: Largest distance from a multiple of pi/2 that counts as a right angle (rad).
        applied: Whether the system that is shown has exact right angles already.
        exactness: The system as written compared with the system with exact right angles.
    """

    tolerance: float
    applied: bool
    exactness: Exactness

    def as_dict(self) -> dict[str, Any]:
        """Return all fields as plain data for JSON."""
        return {"tolerance": self.tolerance, "taken": self.applied, **self.exactness.as_dict()}


@dataclass(frozen=True)
class Summary:
    """A system and the operation counts of its outputs.

    Attributes:
        system: The tree.
        operations: Operations by kind, for each output by itself and for [A] and {f} together.
        methods: The algorithm of each output.
        massless: Names of the speeds that move neither mass nor inertia. If there are some, [A] is singular
            in every state, and outputs that solve with it are left out of `operations`.
        dependent: Names of the held directions of contacts that depend on others in every state. If there are
            some, outputs that need the loads of contacts are left out of `operations`.
        refinement: The number of steps of iterative refinement in forward dynamics, and its reason; "" if
            there is no forward dynamics.
        stages: Operations of [A] and {f} together after lowering and after every pass.
        right_angles: The changes of exact right angles; None if the model misses no right angle.
        facts: Frames, limits and massless bodies, and what the reader left out.
        outputs: Names of the outputs that the system has, also those that are not in `operations`.
        base: The base parameters.
    """

    system: System
    operations: dict[str, dict[str, int]]
    methods: dict[str, str]
    massless: tuple[str, ...]
    dependent: tuple[str, ...]
    refinement: str
    stages: tuple[Stage, ...]
    right_angles: RightAngleChanges | None
    facts: ModelFacts
    outputs: tuple[str, ...]
    base: BaseParameters

    @property
    def uncounted(self) -> tuple[str, ...]:
        """Names of the outputs whose operations are not counted."""
        return tuple(name for name in self.outputs if name not in self.operations)

    @property
    def steps(self) -> tuple[str, ...]:
        """Names of the methods by which C can follow the motion in steps."""
        return () if self.massless else available_methods(self.system)

    def as_dict(self) -> dict[str, Any]:
        """Return the contents of the system and all counts as plain data for JSON."""
        return {
            **_contents(self.system),
            **self.facts.as_dict(),
            "outputs": list(self.outputs),
            "steps": list(self.steps),
            "operations": self.operations,
            "methods": self.methods,
            "massless": list(self.massless),
            "dependent": list(self.dependent),
            "refinement": self.refinement,
            "passes": [asdict(stage) for stage in self.stages],
            "saved": savings(self.stages),
            "base_parameters": {
                "is_proven": self.base.is_proven,
                "sums": list(self.base.names),
                "at_defaults": list(self.base.at_defaults),
            },
            "right_angles": self.right_angles.as_dict() if self.right_angles else None,
        }


def summarize(
    system: System,
    progress: Callable[[str], None],
    without: Iterable[str] | None = None,
    right_angles: RightAngleChanges | None = None,
    *,
    every: bool = False,
    left_out: Sequence[str] = (),
) -> Summary:
    """Count the operations of every output by itself, and of [A] and {f} together.

    Args:
        system: The tree.
        progress: Function that receives the name of each stage.
        without: Names of the optimiser passes to leave out.
        right_angles: The changes of exact right angles, to be part of the summary.
        every: Whether to count derivatives, error bounds and operational inertias of all bodies, too;
            deriving those of a large tree takes minutes.
        left_out: Warnings of the reader of the model.
    """
    variant = variants.chosen_variant(without=without)
    massless = tuple(system.speed_names[motion[0]] for motion in massless_motions(system))
    dependent = tuple(group[0].name for group in dependent_rows(system))
    missing = (*(solving(OUTPUTS) if massless else ()), *(OF_CONTACTS if dependent else ()))
    possible = [name for name in available(system) if name not in missing]
    names = [name for name in possible if every or not takes_long(system, name)]
    alone = {name: compiler.compile_module(system, (name,), progress, variant) for name in names}
    together = compiler.compile_module(system, EQUATIONS, progress, variant)
    operations = {name: compiled.operations for name, compiled in alone.items()}
    methods = {name: compiled.methods[name] for name, compiled in alone.items()}
    refinement = "" if massless else alone["forward_dynamics"].refinement
    operations[TOGETHER] = together.operations
    return Summary(
        system,
        operations,
        methods,
        massless,
        dependent,
        refinement,
        together.stages,
        right_angles,
        model_facts(system, left_out),
        tuple(possible),
        base_parameters(system),
    )


def _contents(system: System) -> dict[str, Any]:
    """Return the contents of the system, by the keys of the JSON."""
    coordinates = zip(system.coordinate_names, system.coordinates, strict=True)
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
        "coupled": _directions(system.coupled_names, [one.freedom for one in system.coupled]),
        "couplings": [coupling.as_table() for coupling in system.named_couplings],
        "rotors": [rotor.as_table() for rotor in system.named_rotors],
        "contacts": [contact.as_table() for contact in system.contacts],
        "speeds": list(system.speed_names),
        "poses": list(system.pose_names),
        "reactions": [_reaction(row) for row in system.reaction_rows],
        "parameters": {parameter.name: parameter.value for parameter in system.parameters},
        "expressions": list(expression_summaries(system)),
        "force_elements": [
            {"kind": element.KEY, **element.as_table()} for element in system.named_force_elements
        ],
    }


def _bodies(system: System) -> list[dict[str, Any]]:
    """Return the bodies as plain data for JSON."""
    return [
        {
            "number": k,
            "name": body.name,
            "connection": body.lower,
            "mass": value_of(body.mass),
            "free": selected_freedoms(body.joint.free),
            "prescribed": selected_freedoms(body.joint.prescribed),
            "coupled": selected_freedoms(body.joint.coupled),
            "armature": body.joint.as_table().get("armature", {}),
            "coordinates": body.joint.coordinates,
            "sequence": body.joint.sequence,
            "loads": body.loads,
        }
        for k, body in enumerate(system.bodies, start=1)
    ]


def _directions(names: Sequence[str], freedoms: Sequence[Freedom]) -> list[dict[str, Any]]:
    """A row for each freedom, with the unit of its coordinate."""
    return [
        {"name": name, "body": freedom.body, "freedom": FREEDOMS[freedom.index], "unit": freedom.unit}
        for name, freedom in zip(names, freedoms, strict=True)
    ]


def _reaction(row: Reaction) -> dict[str, Any]:
    """A row of `reaction_loads`: a locked freedom, or a component in a frame."""
    what = {"frame": row.frame} if row.frame else {"freedom": FREEDOMS[row.index]}
    return {"name": row.name, "body": row.body, **what, "unit": row.effort}
