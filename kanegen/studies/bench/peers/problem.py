"""The model and the states from which every participant is built, and the tasks of most of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from kanegen.model.system import System
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, INVERSE_DERIVATIVES, Task

SINGLE_STATE_TASKS = (Task("equations", EQUATIONS), Task("dynamics", DYNAMICS))
"""The tasks of [A] and {f} and of {ydot}, one state in each call."""

DERIVATIVES_TASKS = (
    Task("derivatives", DERIVATIVES),
    Task("inverse derivatives", INVERSE_DERIVATIVES),
)
"""The tasks of the derivatives of forward and of inverse dynamics, one state in each call."""

MOST_DERIVATIVE_FREEDOMS = 48
"""Largest number of freedoms for which derivatives are compared; larger ones take long to compile."""

Builders = Iterator[tuple[str, Callable[[], list[Participant]]]]
"""Names of participants, and functions that build them, compile them and may raise MissingError."""


@dataclass(frozen=True)
class Problem:
    """A model and its states.

    Attributes:
        system: The model, without loads and parameters.
        states: The states that are computed.
        states_file: File of the states that the drivers read.
        folder: Folder for other files of the drivers.
    """

    system: System
    states: ActuatedStates
    states_file: Path
    folder: Path

    @property
    def has_derivatives(self) -> bool:
        """Whether derivatives are compared, too."""
        return len(self.system.freedoms) <= MOST_DERIVATIVE_FREEDOMS

    @property
    def single_state_tasks(self) -> tuple[Task, ...]:
        """The tasks that compute one state in each call."""
        return (*SINGLE_STATE_TASKS, *DERIVATIVES_TASKS) if self.has_derivatives else SINGLE_STATE_TASKS

    def write(self, name: str, text: str) -> str:
        """Write `text` into a new file of the folder and return its path."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return str(path)
