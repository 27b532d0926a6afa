"""The peer CasADi: C that it generates for the same quantities of the same joints."""

from __future__ import annotations

import functools

from kanegen.extras import module
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.settings import (
    CONTRACTED,
    CONTRACTED_AVX2,
    DEFAULT,
    DEFAULT_AVX2,
    PORTABLE,
    Setting,
    here,
)

CASADI = "CasADi"
"""Name of the participant."""

MOST_DERIVATIVE_FREEDOMS = 20
"""Largest number of freedoms for which CasADi derives: a compiler takes too long for the C of larger
models."""


def builders(problem: Problem) -> Builders:
    """Yield the builders of the functions and of the derivatives, which a compiler may not finish."""
    yield CASADI, functools.partial(_build, problem, False)
    if len(problem.system.freedoms) <= MOST_DERIVATIVE_FREEDOMS:
        yield f"{CASADI}, derivatives", functools.partial(_build, problem, True)


def _build(problem: Problem, derives: bool) -> list[Participant]:
    """Build the participants of all compiler settings."""
    module("casadi")
    code = module("kanegen.studies.bench.peers.casadi_code")
    files = (code.derivatives if derives else code.functions)(problem.system)
    settings = here((DEFAULT, DEFAULT_AVX2, *(() if derives else (PORTABLE,)), CONTRACTED, CONTRACTED_AVX2))
    return [_participant(problem, files, setting, derives) for setting in settings]


def _participant(problem: Problem, files: dict[str, str], setting: Setting, derives: bool) -> Participant:
    """Return the participant of one compiler setting."""
    texts = {"casadi.c": driver("casadi.c"), **files}
    program = compiled("casadi", texts, (*setting.flags, *(["-DDERIVATIVES"] if derives else [])))
    tasks = DERIVATIVES_TASKS if derives else SINGLE_STATE_TASKS
    return Participant(CASADI, setting, (str(program),), problem.states_file, tasks)
