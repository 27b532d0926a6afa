"""The programs that follow the motions: kanegen's C in several settings, Pinocchio, MuJoCo and SciPy."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from kanegen import compiler
from kanegen.c.interface import PREPARE
from kanegen.errors import MissingError
from kanegen.extras import headers, require
from kanegen.library import load
from kanegen.library.native.build import code
from kanegen.model.numbers import Parameter, value_of
from kanegen.model.system import System
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.comparison import KANEGEN
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.joints import joints
from kanegen.studies.bench.peers.mujoco_peer import MUJOCO, mjcf, mujoco_library
from kanegen.studies.bench.peers.pinocchio_peer import BOOST, PINOCCHIO, joint_table
from kanegen.studies.bench.peers.problem import Problem
from kanegen.studies.bench.results import Task
from kanegen.studies.bench.settings import AS_SHIPPED, CONTRACTED, DEFAULT_AVX2, Setting, keeping_bits
from kanegen.studies.bench.states import write_states

HERE = Path(__file__).parent

COMPARED = 20
"""Steps after which motions are compared; rounding errors grow afterwards."""

ROLLOUT = "rollout_rk4"
"""The output of kanegen that is timed."""

SCIPY = "SciPy"
"""Name of the participant that integrates in Python."""

AVX2 = Setting("AVX2", ("-O3", "-march=x86-64-v3"))
"""Four states an instruction, with fused products and sums."""

AVX512 = Setting("AVX-512", ("-O3", "-march=x86-64-v4", "-mprefer-vector-width=512"))
"""Eight states an instruction, with fused products and sums."""

STRICT_AVX2 = Setting("AVX2, strict", DEFAULT_AVX2.flags)
"""The semantics of the default build, whose bits are the same everywhere."""


@dataclass(frozen=True)
class Length:
    """The length of the motions.

    Attributes:
        step: Length of a step (s).
        steps: Number of steps.
    """

    step: float = 1e-3
    steps: int = 1000

    @property
    def arguments(self) -> tuple[str, str]:
        """The arguments of the drivers."""
        return repr(self.step), str(self.steps)


@dataclass(frozen=True)
class Entrant:
    """A participant before the length of its motions is chosen.

    Attributes:
        participant: The participant; the arguments of the length follow its own.
        methods: Name of the method by name of the task, as it is shown.
    """

    participant: Participant
    methods: dict[str, str]

    def over(self, length: Length) -> Participant:
        """Return the participant with the length of its motions."""
        one = self.participant
        return replace(one, arguments=(*one.arguments, *length.arguments))


Builder = Callable[[], Entrant]


def builders(problem: Problem, many: ActuatedStates, machine: Sequence[str]) -> Iterator[tuple[str, Builder]]:
    """Yield the name of every participant, and the function that builds it.

    Args:
        problem: The model and the few states that are compared, and on which peers are timed.
        many: The states of a batch of kanegen, the first of which are those of the problem.
        machine: Names of the instruction sets of this processor.
    """
    states = write_states(many, problem.folder / "many")
    settings = [CONTRACTED, AVX2, keeping_bits(STRICT_AVX2), *([AVX512] if "avx512f" in machine else [])]
    yield PINOCCHIO, lambda: _pinocchio(problem)
    for setting in settings:
        yield f"{KANEGEN} {setting.name}", lambda setting=setting: _kanegen(problem, states, setting)
    for by_state in (False, True):
        yield KANEGEN, lambda by_state=by_state: _kanegen(problem, states, CONTRACTED, by_state)
    yield MUJOCO, lambda: _mujoco(problem)
    yield SCIPY, lambda: _scipy(problem)


def _task(name: str, n: int, *, batch: bool = False) -> Task:
    return Task(name, ROLLOUT, batch, (2, n))


def _own(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def with_payload(system: System) -> System:
    """Return the system with the mass of its last body that has one as a run-time parameter."""
    bodies = list(system.bodies)
    k = max(k for k, body in enumerate(bodies) if value_of(body.mass) > 0)
    bodies[k] = replace(bodies[k], mass=Parameter("payload", value_of(bodies[k].mass)))
    return replace(system, bodies=tuple(bodies))


def _kanegen(problem: Problem, states: Path, setting: Setting, by_state: bool | None = None) -> Entrant:
    """Build kanegen's C, from one state a call and from all at once.

    Args:
        problem: The model.
        states: File of all states.
        setting: Compiler setting.
        by_state: Whether each state has its own mass of the last body, or all have one; None for a number.
    """
    n = len(problem.system.freedoms)
    system = problem.system if by_state is None else with_payload(problem.system)
    source = compiler.generate(system, (ROLLOUT,), parameters_by_state=bool(by_state))
    defined = {"HEADER": f'"{system.identifier}.h"', "MODEL": system.identifier}
    if by_state is not None:
        prepare = next(function for function in source.functions if function.name == PREPARE)
        defined["PREPARED"] = str(prepare.outputs[0].size)
        defined["DEFAULTS"] = ", ".join(repr(value) for _, value in source.model.parameters)
        defined["BY_STATE"] = str(int(by_state))
    flags = [*setting.flags, "-I.", *(f"-D{name}={value}" for name, value in defined.items())]
    program = compiled(f"{KANEGEN}_{ROLLOUT}", {"kanegen.c": _own("kanegen.c"), **code(source)}, flags)
    tasks = (_task("single", n), _task("batch", n, batch=True))
    first = len(problem.states.x)
    participant = Participant(
        KANEGEN,
        setting,
        (str(program),),
        states,
        tasks,
        convert=lambda results: {name: values[:first] for name, values in results.items()},
    )
    words = {None: "", False: ", a parameter", True: ", a parameter by state"}[by_state]
    return Entrant(participant, {"single": f"RK4{words}", "batch": f"RK4, batch{words}"})


def _pinocchio(problem: Problem) -> Entrant:
    """Build Pinocchio's aba in a Runge-Kutta loop.

    Raises:
        MissingError: If Pinocchio or a C++ compiler is missing, or the compiler fails.
    """
    include = headers("libpinocchio", "pinocchio/algorithm/aba.hpp")
    eigen = headers("cmeel-eigen", "eigen3/Eigen/Core") / "eigen3"
    files = {"pinocchio_model.h": driver("pinocchio_model.h"), "pinocchio.cpp": _own("pinocchio.cpp")}
    flags = (*BOOST, *CONTRACTED.flags, f"-I{include}", f"-I{eigen}")
    program = compiled("pinocchio_rollout", files, flags)
    table = problem.write("joints", joint_table(problem.system, joints(problem.system)))
    tasks = (_task("rk4", len(problem.system.freedoms)),)
    participant = Participant(PINOCCHIO, CONTRACTED, (str(program),), problem.states_file, tasks, (table,))
    return Entrant(participant, {"rk4": "RK4 with aba"})


def _mujoco(problem: Problem) -> Entrant:
    """Build a loop over MuJoCo's mj_step.

    Raises:
        MissingError: If MuJoCo is missing or cannot have the model.
    """
    folder = require("mujoco")
    library = mujoco_library(folder)
    flags = (*AS_SHIPPED.flags, f"-I{folder / 'include'}")
    libraries = (str(library), f"-Wl,-rpath,{library.parent}", "-lm")
    program = compiled("mujoco_rollout", {"mujoco.c": _own("mujoco.c")}, flags, libraries)
    model = problem.write("model.xml", mjcf(problem.system))
    n = len(problem.system.freedoms)
    tasks = (_task("rk4", n), _task("implicitfast", n))
    participant = Participant(MUJOCO, AS_SHIPPED, (str(program),), problem.states_file, tasks, (model,))
    return Entrant(participant, {"rk4": "mj_step, RK4", "implicitfast": "mj_step, implicitfast"})


def _scipy(problem: Problem) -> Entrant:
    """Return SciPy's DOP853 with kanegen's forward dynamics, called from Python one state after the other.

    Raises:
        MissingError: If SciPy is missing.
    """
    require("scipy")
    path = problem.folder / "library"
    path.write_bytes(pickle.dumps(load(compiler.generate(problem.system, ("forward_dynamics",)))))
    command = (sys.executable, "-m", "benchmarks.rollouts.scipy_driver")
    tasks = (_task("DOP853", len(problem.system.freedoms)),)
    setting = Setting("Python", ())
    participant = Participant(SCIPY, setting, command, problem.states_file, tasks, (str(path),))
    return Entrant(participant, {"DOP853": "DOP853 with forward_dynamics"})


def built(makers: Iterator[tuple[str, Builder]]) -> tuple[list[Entrant], list[str]]:
    """Build all participants, and name those that are missing with the reasons."""
    found, missing = [], []
    for name, make in makers:
        try:
            found.append(make())
        except MissingError as error:
            missing.append(f"{name}: {error}")
    return found, missing
