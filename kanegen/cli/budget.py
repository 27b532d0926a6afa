"""`kanegen generate` with a budget, and `verify`; imported only where the extra `study` is installed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape

from kanegen.c.folder import require_room
from kanegen.model.system import System
from kanegen.program.precision import named
from kanegen.studies.budget.certification import Certified, file_names, find, words
from kanegen.studies.budget.confidence import quantile_level
from kanegen.studies.budget.region import read_domain
from kanegen.studies.budget.request import Effort, Request, error_budget, time_budget
from kanegen.studies.budget.variant_evaluator import field_of, is_reproducible
from kanegen.studies.budget.verification import Verification, verify
from kanegen.studies.tradeoff.variants import Candidate

__all__ = ["BudgetOptions", "generate", "show", "show_verification", "verify"]

_MARKS = {True: "[green]holds[/]", False: "[bold red]does not hold[/]", None: "open"}


@dataclass(frozen=True)
class BudgetOptions:
    """Options as they were typed."""

    error: str | None
    budget: str | None
    domain: str | None
    objective: str
    quantile: str
    confidence: float
    attempts: int
    states: int
    search: int
    reproducible: bool
    precision: str | None
    seed: int

    @classmethod
    def typed(cls, options: Mapping[str, Any]) -> BudgetOptions:
        """Those among all options of `generate`, by their names."""
        return cls(**{field.name: options[field.name] for field in fields(cls)})

    @property
    def request(self) -> Request:
        """What they ask for.

        Raises:
            OptionError: If that makes no sense.
        """
        return Request(
            error=None if self.error is None else error_budget(self.error),
            time=None if self.budget is None else time_budget(self.budget),
            objective=self.objective,
            quantile=quantile_level(self.quantile),
            confidence=self.confidence,
            attempts=self.attempts,
            effort=Effort(select=self.states, attack=self.search),
        )

    def admits(self, candidate: Candidate) -> bool:
        """Whether a variant may be chosen."""
        right = self.precision is None or candidate.variant.precision == named(self.precision).name
        return right and (is_reproducible(candidate) or not self.reproducible)


def generate(
    system: System, terms: BudgetOptions, folder: Path, force: bool, progress: Callable[[str], None]
) -> Certified:
    """The C that keeps the budget, with its certificate, once it is known that a folder will take them.

    Raises:
        BudgetError, BuildError, OptionError: As `budget.finding.find`.
        WriteError: If the folder will not.
    """
    request = terms.request
    region = read_domain(terms.domain, system)
    require_room(file_names(system), folder, force)
    return find(system, region, request, field_of(terms.admits), terms.seed, progress)


def show(found: Certified, console: Console) -> None:
    """Say which variant it is and what is claimed of it."""
    choice, request = found.choice, found.request
    console.print(f"variant: {escape(choice.candidate.label)}", soft_wrap=True)
    console.print(escape(words(request, choice)), soft_wrap=True)
    console.print(escape(_time(found)), soft_wrap=True)


def show_verification(path: Path, found: Verification, console: Console) -> None:
    """A line for every finding, then the verdict."""
    for finding in found.findings:
        console.print(f"{finding.what}: {_MARKS[finding.holds]}; {escape(finding.words)}", soft_wrap=True)
    verdict = "holds as far as it was looked at" if found.passed else "DOES NOT HOLD"
    console.print(f"{escape(str(path))}: {verdict}", soft_wrap=True)


def _time(found: Certified) -> str:
    choice, objective = found.choice, found.request.objective
    said = f"time: {choice.times.median:.4g} ns for {objective} on this machine"
    if choice.candidate == choice.reference:
        return f"{said}; no variant as accurate as {choice.standard.label!r} is faster"
    against = f"{choice.reference.label!r}, the fastest that is as accurate as {choice.standard.label!r}"
    if choice.gain is None:
        return f"{said}; not measurably faster than {against}"
    return f"{said}; {choice.gain.median:.2f} times as fast as {against}"
