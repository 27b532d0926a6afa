"""Outputs beside [A], {f} and {ydot}, each timed beside Pinocchio's function of the same quantity."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from kanegen import compiler
from kanegen.choices import several
from kanegen.errors import KanegenError, MissingError
from kanegen.library.native.build import code
from kanegen.model.description import require_unprescribed
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.recursion.outputs import OUTPUTS
from kanegen.reference.states import states_away_from_gimbal_lock
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.compare import evaluate
from kanegen.studies.bench.comparison import KANEGEN, Absence, BenchOptions, Comparison
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.pinocchio_peer import PINOCCHIO, participant_of_outputs
from kanegen.studies.bench.peers.problem import Problem
from kanegen.studies.bench.results import Task
from kanegen.studies.bench.settings import CONTRACTED
from kanegen.studies.bench.states import (
    limits_note,
    without_couplings,
    without_loads_and_parameters,
    write_states,
)

FUNCTIONS = {
    "gravity_forces": "computeGeneralizedGravity",
    "velocity_forces": "nonLinearEffects without gravity",
    "coriolis_matrix": "computeCoriolisMatrix",
    "mass_matrix_inverse": "computeMinverse",
    "frame_jacobians": "computeJointJacobians, getJointJacobian",
    "frame_bias_accelerations": "forwardKinematics, getClassicalAcceleration",
    "centroidal_momentum_matrix": "computeCentroidalMap",
    "operational_inertia_inverse": "computeJointJacobians, computeMinverse, products",
    "regressor": "computeJointTorqueRegressor",
    "contact_dynamics": "constraintDynamics, three rows",
}
"""The functions of Pinocchio that are timed, by the output of kanegen with the same quantity."""

_HELD = "held"
"""Name of the point that is held in contact."""

_ARRAYS = {("x",): 1, ("x", "y"): 2}
"""Numbers of the arrays that drivers/output.c passes, by their names; all others take three."""


@dataclass(frozen=True)
class OutputBench:
    """The outputs of one model that are timed, beside those that it does not have.

    Attributes:
        system: The model, without loads and parameters, with one chosen frame, whose origin a contact holds.
        body: Number of the body of this frame, the deepest leaf of the tree.
        names: Names of the outputs.
    """

    system: System
    body: int
    names: tuple[str, ...]

    def task(self, output: str, name: str, *, batch: bool = False) -> Task:
        """Return the task of an output."""
        shape = OUTPUTS[output].array(self.system).shape
        rows, columns = shape[-2:] if len(shape) > 1 else (1, *shape)
        return Task(name, output, batch, (rows, columns))


def compare_outputs(
    system: System, names: Iterable[str], options: BenchOptions, progress: Progress = quiet
) -> Comparison:
    """Time outputs of kanegen beside Pinocchio's functions, after comparing their results.

    The chosen frame is that of the body with the most bodies below it; `contact_dynamics` holds its origin.

    Args:
        system: The model; loads are switched off, run-time parameters become constants, and coupled freedoms
            move by themselves.
        names: Outputs, names among `FUNCTIONS`.
        options: Numbers of states and rounds, and the duration of each timing.
        progress: Function that receives the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If Pinocchio is missing or cannot compute the model.
        OptionError: If there is no such output, or a freedom is prescribed.
    """
    require_unprescribed(system, "bench")
    chosen = several("outputs", "output", names, FUNCTIONS)
    independent, left_out = without_couplings(system)
    model, notes = without_loads_and_parameters(independent)
    body = _deepest(model)
    name = model.bodies[body - 1].name
    model = model.with_poses([name]).with_points({_HELD: (name, (0.0, 0.0, 0.0))}).with_contacts([_HELD])
    bench = OutputBench(model, body, tuple(chosen))
    progress("building the programs; Pinocchio takes minutes the first time")
    with tempfile.TemporaryDirectory() as folder:
        states = states_away_from_gimbal_lock(model, options.states)
        problem = Problem(model, states, write_states(states, Path(folder) / "states"), Path(folder))
        ours, absences = _built(bench, problem)
        tasks = [bench.task(one.tasks[0].quantity, one.tasks[0].quantity) for one in ours]
        present = [participant_of_outputs(problem, tasks, body), *ours]
        entries, failed = evaluate(present, len(model.freedoms), options, progress)
    if not any(entry.participant == PINOCCHIO for entry in entries):
        raise MissingError("; ".join(f"{absence.name}: {absence.reason}" for absence in failed))
    notes = (*left_out, *notes, *limits_note(model))
    return Comparison(system.name, len(model.freedoms), tuple(entries), (*absences, *failed), notes)


def _built(bench: OutputBench, problem: Problem) -> tuple[list[Participant], list[Absence]]:
    """Build the C of every output, and name those that the model does not have."""
    found: list[Participant] = []
    absences: list[Absence] = []
    for name in bench.names:
        try:
            found.append(_participant(bench, problem, name))
        except KanegenError as error:
            absences.append(Absence(name, str(error)))
    return found, absences


def _participant(bench: OutputBench, problem: Problem, output: str) -> Participant:
    """Build the participant that computes one output, one state a call and in batches.

    Raises:
        KanegenError: If the model does not have the output, or it cannot be compiled.
    """
    system = bench.system
    source = compiler.generate(system, (output,))
    rows, columns = bench.task(output, output).shape_for(0)
    arrays = tuple(name for name in OUTPUTS[output].arguments if name in ("x", "y", "ydot", "tau"))
    defined = {
        "HEADER": f'"{system.identifier}.h"',
        "MODEL": system.identifier,
        "OUTPUT": output,
        "SIZE": str(rows * columns),
        "ARRAYS": str(_ARRAYS.get(arrays, 3)),
    }
    flags = [*CONTRACTED.flags, "-I.", *(f"-D{name}={value}" for name, value in defined.items())]
    program = compiled(f"{KANEGEN}_{output}", {"output.c": driver("output.c"), **code(source)}, flags)
    tasks = (bench.task(output, "single"), bench.task(output, "batch", batch=True))
    return Participant(KANEGEN, CONTRACTED, (str(program),), problem.states_file, tasks)


def _deepest(system: System) -> int:
    """Return the number of the body with the most bodies below it."""
    depth = {0: 0}
    for k, body in enumerate(system.bodies, start=1):
        depth[k] = depth[system.connection[k - 1]] + (1 if any(body.joint.free) else 0)
    return max(range(1, len(depth)), key=depth.__getitem__)
