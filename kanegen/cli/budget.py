"""Budgets on the command line: from options to a request, and from results to text.

`kanegen generate` with a budget and `kanegen verify` import this module when they run, since it needs the
extra `study`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from rich.markup import escape

from kanegen.artifacts import places
from kanegen.c.folder import require_room
from kanegen.cli.terminal import print_plain, screen
from kanegen.model.system import System
from kanegen.program.precision import precision_named
from kanegen.studies.budget.budget_evaluator import allowed_candidates, is_reproducible
from kanegen.studies.budget.certification import (
    CertifiedSource,
    certified_file_names,
    certify_variant,
)
from kanegen.studies.budget.confidence import quantile_level
from kanegen.studies.budget.region import read_region
from kanegen.studies.budget.request import Effort, Request, error_budget, time_budget
from kanegen.studies.budget.verification import Verification, verify
from kanegen.studies.tradeoff.variants import Candidate

__all__ = ["BudgetOptions", "generate", "show", "show_verification", "verify"]

_MARKS = {True: "[green]holds[/]", False: "[bold red]does not hold[/]", None: "open"}


@dataclass(frozen=True)
class BudgetOptions:
    """The options of a budget as they were typed."""

    error: str | None
    budget: str | None
    domain: str | None
    objective: str
    relative_to: str
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
        """Take the options of a budget from all options of `kanegen generate`, by their names."""
        return cls(**{field.name: options[field.name] for field in fields(cls)})

    @property
    def request(self) -> Request:
        """The request that the options make.

        Raises:
            OptionError: If an option has an impossible value.
        """
        return Request(
            error=None if self.error is None else error_budget(self.error),
            time=None if self.budget is None else time_budget(self.budget),
            objective=self.objective,
            relative_to=self.relative_to,
            quantile=quantile_level(self.quantile),
            confidence=self.confidence,
            attempts=self.attempts,
            effort=Effort(select=self.states, search=self.search),
        )

    def admits(self, candidate: Candidate) -> bool:
        """Return whether --precision and --reproducible allow a variant."""
        right = self.precision is None or candidate.variant.precision == precision_named(self.precision).name
        return right and (is_reproducible(candidate) or not self.reproducible)


def generate(
    system: System, options: BudgetOptions, folder: Path, force: bool, progress: Callable[[str], None]
) -> CertifiedSource:
    """Find the C that keeps the budget and certify it, after checking that `folder` can take the files.

    Raises:
        BudgetError: If no variant keeps the budget.
        BuildError: If a variant cannot be compiled.
        OptionError: If an option has an impossible value.
        WriteError: If the folder cannot take the files.
    """
    request = options.request
    region = read_region(options.domain, system)
    require_room(certified_file_names(system), folder, force, system.identifier, places(system.identifier))
    return certify_variant(
        system, region, request, allowed_candidates(options.admits), options.seed, progress
    )


def show(found: CertifiedSource) -> None:
    """Print the chosen variant, the claim of its certificate, and its time."""
    print_plain(f"variant: {found.choice.candidate.label}")
    print_plain(found.certificate.section("claim")["words"])
    print_plain(_time(found))


def show_verification(path: Path, found: Verification) -> None:
    """Print a line for each finding of a verification, then its verdict."""
    for finding in found.findings:
        screen.print(
            f"{finding.subject}: {_MARKS[finding.holds]}; {escape(finding.explanation)}", soft_wrap=True
        )
    verdict = "holds as far as it was looked at" if found.passed else "DOES NOT HOLD"
    print_plain(f"{path}: {verdict}")


def _time(found: CertifiedSource) -> str:
    """Return the time of the variant, and its ratio to the fastest variant as accurate as the default."""
    choice, objective = found.choice, found.request.objective
    said = f"time: {choice.times.median:.4g} ns for {objective} on this machine"
    if choice.candidate == choice.reference:
        return f"{said}; no variant as accurate as {choice.standard.label!r} is faster"
    against = f"{choice.reference.label!r}, the fastest that is as accurate as {choice.standard.label!r}"
    if choice.gain is None:
        return f"{said}; not measurably faster than {against}"
    return f"{said}; {choice.gain.median:.2f} times as fast as {against}"
