"""The evaluator of all studies of variants: it builds them, measures their errors, and times them.

Times and errors are measured on the same libraries. Variants with other generalized speeds
or coordinates get the same physical states.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from kanegen.c.formats import formats
from kanegen.extras import module
from kanegen.library.native import compilers
from kanegen.measure.timing import BATCH, LATENCY, Rounds, Times
from kanegen.measure.truth.measurement import Measurement
from kanegen.model.arrays import Floats
from kanegen.model.coordinates import FREEDOMS, Freedom
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.reference.kinematics import BodyKinematics, kinematics
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.compare import take_turns
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.results import DYNAMICS, Task
from kanegen.studies.bench.settings import Setting
from kanegen.studies.bench.states import without_loads_and_parameters, write_states
from kanegen.studies.tradeoff import EXTRA
from kanegen.studies.tradeoff.compilation import CompiledVariant, compile_variants
from kanegen.studies.tradeoff.domain import Sample, rounded
from kanegen.studies.tradeoff.exact_results import OUTPUT, ExactResults, compute_accelerations
from kanegen.studies.tradeoff.state_bounds import normwise_bounds
from kanegen.studies.tradeoff.variants import Candidate, Refusal

_TASKS = (Task(LATENCY, DYNAMICS), Task(BATCH, DYNAMICS, batch=True))
_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")


class VariantEvaluator:
    """Builds the variants of one system, measures their errors and times them.

    Args:
        system: The system; its parameters stand at their defaults.
        progress: Function that is called with the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
    """

    def __init__(self, system: System, progress: Progress = quiet) -> None:
        compilers.find()
        self.system = system
        self._progress = progress
        self._exact: dict[System, ExactResults] = {}

    @property
    def exact(self) -> ExactResults:
        """Exact results of the system with its own generalized speeds and coordinates."""
        return self._exact_results(self.system)

    def build(self, candidates: Iterable[Candidate]) -> tuple[list[CompiledVariant], list[Refusal]]:
        """Compile candidates for this machine; return the compiled ones and the refusals of the others."""
        return compile_variants(self.system, candidates, self._progress)

    def errors(self, variant: CompiledVariant, sample: Sample, objective: str) -> Measurement:
        """Return the errors of a variant.

        Args:
            variant: A variant of the system.
            sample: States of the system with its own generalized speeds and coordinates.
            objective: The way to call the library, one of `OBJECTIVES`.
        """
        own = variant.candidate.of(self.system)
        exact = self._exact_results(own)
        return exact.errors(variant.library, convert_sample(sample, self.system, own), objective)

    def proven_bounds(self, variant: CompiledVariant, sample: Sample, objective: str) -> Floats:
        """Return (B,) proven bounds on the normwise errors of a variant; see `state_bounds`.

        The arguments are those of `errors`.
        """
        own = variant.candidate.of(self.system)
        states = convert_sample(sample, self.system, own)
        values = compute_accelerations(variant.library, states, objective)
        return normwise_bounds(self._exact_results(own), states, values)

    def times(
        self, variants: Sequence[CompiledVariant], sample: Sample, rounds: Rounds
    ) -> dict[CompiledVariant, dict[str, Times]]:
        """Return the times of variants by objective, without loads and with constant parameters.

        The timing driver knows neither loads nor parameters. Variants of a system that has them are built
        again without.

        Args:
            variants: Variants of the system.
            sample: The states that are computed in turn; their loads are ignored.
            rounds: Number of rounds, and seconds of each objective in every round.

        Raises:
            MissingError: If the driver cannot be compiled, or a library fails in it.
        """
        system, _ = without_loads_and_parameters(self.system)
        timed = {one.candidate: one for one in variants}
        if system != self.system:
            built, _ = compile_variants(system, timed, self._progress)
            timed = {one.candidate: one for one in built}
        unloaded = replace(sample, force=None, torque=None)
        samples = {
            one: convert_sample(unloaded, system, candidate.of(system)) for candidate, one in timed.items()
        }
        found = time_variants(samples, rounds, self._progress)
        return {one: found[timed[one.candidate]] for one in variants if one.candidate in timed}

    def _exact_results(self, system: System) -> ExactResults:
        """Return the exact results of the system with the generalized speeds and coordinates of a variant."""
        if system not in self._exact:
            self._exact[system] = ExactResults(system)
        return self._exact[system]


def time_variants(
    samples: Mapping[CompiledVariant, Sample], rounds: Rounds, progress: Progress
) -> dict[CompiledVariant, dict[str, Times]]:
    """Return the times of variants by objective; all take turns, each in a separate process.

    Args:
        samples: The states that each variant computes, without loads.
        rounds: Number of rounds, and seconds of each objective in every round.
        progress: Function that is called with the name of each stage.

    Raises:
        BuildError: If there is no C compiler.
        MissingError: If the driver cannot be compiled, or a library fails in it.
    """
    with tempfile.TemporaryDirectory() as folder:
        participants = {
            variant: _participant(variant, sample, Path(folder) / str(number))
            for number, (variant, sample) in enumerate(samples.items())
        }
        found = take_turns(list(participants.values()), rounds, progress)
        return {
            variant: {task.name: found[participant, task.name] for task in _TASKS}
            for variant, participant in participants.items()
        }


def accelerations_of_driver(variant: CompiledVariant, sample: Sample) -> dict[str, Floats]:
    """Return the (B, n) accelerations {ydot} that the timing driver computes, by objective.

    Tests compare them with those of the library, to make sure that the timed code is the measured code.
    """
    with tempfile.TemporaryDirectory() as folder:
        results = _participant(variant, sample, Path(folder) / "states").results(sample.tau.shape[1])
    return {objective: rows[:, 0] for objective, rows in results.items()}


def _participant(variant: CompiledVariant, sample: Sample, file: Path) -> Participant:
    """Return the timing driver of a variant with its states in `file`."""
    library = variant.library
    states = write_states(sample, file)
    real = formats(library.source.variant).storage
    kind = "-DDOUBLE_DOUBLE" if real.trailing_shape else f"-DREAL={real.c_type}"
    files = {"variant.c": driver("variant.c")}
    program = compiled("variant", files, (*_FLAGS, kind), ("-lm", "-ldl"))
    setting = Setting(variant.candidate.label, library.source.variant.flags)
    function = f"{library.name}_{OUTPUT}"
    return Participant(
        "kanegen", setting, (str(program),), states, _TASKS, (function,), loads=(library.path,)
    )


def convert_sample(sample: Sample, system: System, other: System) -> Sample:
    """Return the same physical states for a system whose joints have other speeds or coordinates.

    If the relative angular velocity replaces rates of angles, y becomes [P] y, Eq. (8), and tau becomes
    [P]^-T tau, which does the same work. A quaternion replaces angles of the same orientation. All numbers
    are rounded to single precision: the states agree up to this rounding, and each is the exact input of its
    variant.

    Args:
        sample: States of `system`.
        system: The system of the sample.
        other: The same system with other generalized speeds or coordinates.
    """
    if other == system:
        return sample
    bodies = kinematics(system.values(), sample.x, sample.y)
    y, tau = sample.y.copy(), sample.tau.copy()
    pairs = zip(system.bodies, other.bodies, strict=True)
    for k, (body, changed) in enumerate(pairs, start=1):
        if body.joint.speeds_are_rates and not changed.joint.speeds_are_rates:
            own = [system.places[Freedom(k, index)] for index in range(3)]
            matrix = bodies[k - 1].rate_matrix
            y[:, own] = np.einsum("bij,bj->bi", matrix, y[:, own])
            tau[:, own] = np.linalg.solve(matrix.swapaxes(1, 2), tau[:, own, None])[..., 0]
    x = np.stack(list(_converted_coordinates(sample.x, system, other, bodies)), axis=1)
    return replace(sample, x=rounded(x), y=rounded(y), tau=rounded(tau))


def _converted_coordinates(
    x: Floats, system: System, other: System, bodies: tuple[BodyKinematics, ...]
) -> Iterator[Floats]:
    """Yield the (B,) values of each coordinate of `other`, from the coordinates x (B, m) of `system`."""
    orientations = system.values().joint_orientation
    for coordinate in other.coordinates:
        if coordinate in system.coordinate_places:
            yield x[:, system.coordinate_places[coordinate]]
        else:
            k = coordinate.body - 1
            turn = bodies[k].relative_rotation @ orientations[k].T
            yield _quaternions(turn.swapaxes(1, 2))[:, coordinate.index - len(FREEDOMS)]


def _quaternions(rotations: Floats) -> Floats:
    """Return the (B, 4) quaternions, scalar first, of (B, 3, 3) rotations from body to joint components."""
    found = module("scipy.spatial.transform", extra=EXTRA).Rotation.from_matrix(rotations)
    return np.roll(found.as_quat(), 1, axis=1)
