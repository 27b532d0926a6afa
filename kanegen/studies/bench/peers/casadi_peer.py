"""The peer CasADi: C that it generates for the same quantities of the same joints."""

from __future__ import annotations

import functools

from kanegen.extras import module
from kanegen.studies.bench.building import compiled, driver
from kanegen.studies.bench.participant import EXACT, NATIVE, Participant, Setting
from kanegen.studies.bench.peers.problem import Builders, Problem

CASADI = "CasADi"
"""Name of the participant."""


def builders(problem: Problem) -> Builders:
    """Yield the builder of one participant for each compiler setting."""
    yield CASADI, functools.partial(_build, problem)


def _build(problem: Problem) -> list[Participant]:
    """Build the participants of all compiler settings."""
    module("casadi")
    files = module("kanegen.studies.bench.peers.casadi_code").code(problem.system, problem.has_derivatives)
    texts = {"casadi.c": driver("casadi.c"), **files}
    return [_participant(problem, texts, setting) for setting in (EXACT, NATIVE)]


def _participant(problem: Problem, texts: dict[str, str], setting: Setting) -> Participant:
    """Return the participant of one compiler setting."""
    wanted = ("-DDERIVATIVES",) if problem.has_derivatives else ()
    program = compiled("casadi", texts, (*setting.flags, *wanted))
    return Participant(CASADI, setting, (str(program),), problem.states_file, problem.single_state_tasks)
