"""What every contestant is made from."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from kanegen.model.system import System
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, Task
from kanegen.studies.bench.states import States

ONE = (Task("equations", EQUATIONS), Task("dynamics", DYNAMICS))
"""The equations and their solution, one state a call."""

DERIVED = Task("derivatives", DERIVATIVES)
"""The derivatives of the solution by {x}, {y} and {tau}, one state a call."""

MOST_DERIVED = 20
"""Freedoms up to which derivatives are compared; straight-line code of more takes long to compile."""

Makers = Iterator[tuple[str, Callable[[], list[Contestant]]]]
"""Names, and functions that take as long as a compiler takes; they raise MissingError."""


@dataclass(frozen=True)
class Arena:
    """A model and its states.

    Attributes:
        system: Without loads and parameters.
        states: What is computed.
        file: The states as drivers read them.
        folder: For other files of the drivers.
    """

    system: System
    states: States
    file: Path
    folder: Path

    @property
    def derives(self) -> bool:
        """Whether derivatives are compared."""
        return len(self.system.freedoms) <= MOST_DERIVED

    @property
    def one(self) -> tuple[Task, ...]:
        """What is computed one state a call."""
        return (*ONE, DERIVED) if self.derives else ONE

    def written(self, name: str, text: str) -> str:
        """The path of a new file with `text` in it."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return str(path)
