"""Certificates of error, and the table of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.artifacts.certificate import SUFFIX
from kanegen.errors import BudgetError
from kanegen.files import write_whole
from kanegen.studies.budget.certification import CertifiedSource, certify_variant
from kanegen.studies.budget.region import region_from_table
from kanegen.studies.budget.request import Request

CLEARANCE = 0.05
"""Of the domains: gimbal lock itself has no accelerations."""

HEAD = """# Certificates of error

Written by `make tradeoff` (`python -m benchmarks.tradeoff`); nobody edits it by hand. `kanegen verify` makes
the C of a certificate anew and measures it in states of its own.

A budget bounds the normwise relative error of {{ydot}} in forward dynamics, in every state that is tried, on
the default domain without what is next to gimbal lock (`exclude.clearance = {clearance}`). *exceeded* counts
the fresh states of one validation in which the error was larger, *share* is what they say of the whole
domain, with 95 % confidence, and *found* is the largest error that two searches found.

| model | budget | variant | exceeded | share | median | largest | found | ns |
| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |
"""


@dataclass(frozen=True)
class Line:
    """A row of the table."""

    model: str
    budget: float
    cells: Sequence[str]


def made(system: kg.System, budget: float, folder: Path, progress: Callable[[str], None]) -> Line:
    """The certificate of the fastest variant that keeps a budget, written into a folder."""
    domain = region_from_table(system, {"exclude": {"clearance": CLEARANCE}})
    try:
        found = certify_variant(system, domain, Request(error=budget, attempts=1), progress=progress)
    except BudgetError as error:
        return Line(system.name, budget, (str(error), *("-",) * 6))
    name = f"{system.name}{SUFFIX}"
    write_whole(folder / f"{system.name}_{budget:.0e}{SUFFIX}", found.source.files[name])
    return Line(system.name, budget, _cells(found))


def _cells(found: CertifiedSource) -> tuple[str, ...]:
    choice, errors = found.choice, found.choice.validation.errors
    return (
        choice.candidate.label,
        f"{choice.validation.exceeded} of {len(errors)}",
        f"{choice.validation.limit:.2g}",
        f"{np.median(errors):.1e}",
        f"{errors.max():.1e}",
        f"{max(search.error for search in choice.searches):.1e}",
        f"{choice.times.median:.4g}",
    )


def write(lines: Sequence[Line], folder: Path) -> None:
    """The table of all."""
    rows = [f"| {line.model} | {line.budget:.0e} | {' | '.join(line.cells)} |" for line in lines]
    write_whole(folder / "certificates.md", HEAD.format(clearance=CLEARANCE) + "\n".join(rows) + "\n")
