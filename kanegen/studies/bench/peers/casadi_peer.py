"""The peer CasADi: C that it generates for the same quantities of the same joints."""

from __future__ import annotations

import functools

from kanegen.extras import module
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers.problem import DERIVATIVES_TASKS, SINGLE_STATE_TASKS, Builders, Problem
from kanegen.studies.bench.settings import DEFAULT, DEFAULT_AVX2, NATIVE, NATIVE_AVX2, PORTABLE, Setting, here

CASADI = "CasADi"
"""Name of the participant."""

MOST_DERIVATIVE_FREEDOMS = 20
"""Largest number of freedoms for which CasADi derives: a compiler takes too long for the C of larger
models."""

_DERIVATIVES = ("derivatives.c", "inverse_derivatives.c")
"""Files of the derivatives, which are left out of portable code to save time of compilers."""


def builders(problem: Problem) -> Builders:
    """Yield the builder of one participant for each compiler setting."""
    yield CASADI, functools.partial(_build, problem)


def _build(problem: Problem) -> list[Participant]:
    """Build the participants of all compiler settings."""
    module("casadi")
    derives = len(problem.system.freedoms) <= MOST_DERIVATIVE_FREEDOMS
    files = module("kanegen.studies.bench.peers.casadi_code").code(problem.system, derives)
    settings = here((DEFAULT, DEFAULT_AVX2, PORTABLE, NATIVE, NATIVE_AVX2))
    return [_participant(problem, files, setting, derives and setting != PORTABLE) for setting in settings]


def _participant(problem: Problem, files: dict[str, str], setting: Setting, derives: bool) -> Participant:
    """Return the participant of one compiler setting."""
    needed = files if derives else {name: text for name, text in files.items() if name not in _DERIVATIVES}
    texts = {"casadi.c": driver("casadi.c"), **needed}
    program = compiled("casadi", texts, (*setting.flags, *(["-DDERIVATIVES"] if derives else [])))
    tasks = (*SINGLE_STATE_TASKS, *DERIVATIVES_TASKS) if derives else SINGLE_STATE_TASKS
    return Participant(CASADI, setting, (str(program),), problem.states_file, tasks)
