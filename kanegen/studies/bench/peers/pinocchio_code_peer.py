"""The peer Pinocchio with its code generation: its algorithms, recorded and written as C by CppADCodeGen."""

from __future__ import annotations

import functools
import tempfile
from pathlib import Path

from kanegen.errors import MissingError
from kanegen.extras import headers
from kanegen.library.native import commands
from kanegen.library.native.build import program
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.joints import single_joints
from kanegen.studies.bench.peers.pinocchio_peer import BOOST, joint_table
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.settings import CONTRACTED, CONTRACTED_AVX2, Setting, here

PINOCCHIO_CODE = "Pinocchio, CppADCodeGen"
"""Name of the participant."""

MOST_DERIVATIVE_FREEDOMS = 20
"""Largest number of freedoms with derivatives; compilers take too long for the C of larger models."""

COMPILE_SECONDS = 1800
"""Time limit of the compiler for the generator, which takes three minutes and 5 GB on a quiet machine."""

GENERATE_SECONDS = 300
"""Time limit of the generator for one model."""


_FUNCTIONS = ("equations", "dynamics")
_DERIVATIVES = ("derivatives", "inverse_derivatives")


def builders(problem: Problem) -> Builders:
    """Yield the builders of the functions and of the derivatives, which a compiler may not finish."""
    yield PINOCCHIO_CODE, functools.partial(_build, problem, False)
    if len(problem.system.freedoms) <= MOST_DERIVATIVE_FREEDOMS:
        yield f"{PINOCCHIO_CODE}, derivatives", functools.partial(_build, problem, True)


def _build(problem: Problem, derives: bool) -> list[Participant]:
    """Build the participants of all compiler settings."""
    files = {"functions.c": driver("functions.c"), **_code(problem, derives)}
    return [_participant(problem, files, setting, derives) for setting in here((CONTRACTED, CONTRACTED_AVX2))]


def _participant(problem: Problem, files: dict[str, str], setting: Setting, derives: bool) -> Participant:
    """Return the participant of one compiler setting."""
    flags = (*setting.flags, *(["-DDERIVATIVES"] if derives else []))
    command = (str(compiled("pinocchio_code", files, flags)),)
    tasks = DERIVATIVES_TASKS if derives else SINGLE_STATE_TASKS
    return Participant(PINOCCHIO_CODE, setting, command, problem.states_file, tasks)


def _code(problem: Problem, derives: bool) -> dict[str, str]:
    """Return the C of a model by name of the file."""
    names = _DERIVATIVES if derives else _FUNCTIONS
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "joints"
        table.write_text(joint_table(problem.system, single_joints(problem.system)), encoding="utf-8")
        command = [str(_generator()), str(table), folder, *(["derivatives"] if derives else [])]
        try:
            done = commands.run(command, seconds=GENERATE_SECONDS)
        except commands.TimeLimitError:
            raise MissingError(f"its generator did not finish in {GENERATE_SECONDS} s") from None
        if done.returncode:
            raise MissingError(f"its generator failed with status {done.returncode}")
        files = [Path(folder) / f"{name}.c" for name in names]
        return {file.name: file.read_text(encoding="utf-8") for file in files}


def _generator() -> Path:
    """Compile the generator, without optimisation since only what it writes is timed, and return its path.

    Raises:
        MissingError: If a package or a C++ compiler is missing, or the compiler fails.
    """
    include = headers("libpinocchio", "pinocchio/codegen/cppadcg.hpp")
    eigen = headers("cmeel-eigen", "eigen3/Eigen/Core") / "eigen3"
    recorder = headers("cmeel-cppadcodegen", "cppad/cg.hpp")
    tapes = headers("cmeel-cppad", "cppad/cppad.hpp")
    folders = (include, eigen, recorder, tapes)
    flags = (*BOOST, "-O0", *(f"-I{folder}" for folder in dict.fromkeys(folders)))
    name = "pinocchio_code.cpp"
    files = {file: driver(file) for file in ("driver.h", "pinocchio_model.h", name)}
    try:
        return program("pinocchio_code_generator", files, {name: flags}, ("-ldl",), COMPILE_SECONDS)
    except commands.TimeLimitError as error:
        raise MissingError(f"the compiler took more than {error.seconds:g} s") from None
    except commands.CommandError as error:
        raise MissingError(f"the compiler failed: {error.reason}") from None
