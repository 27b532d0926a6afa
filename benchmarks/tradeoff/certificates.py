"""Certificates of error for docs/tradeoff, and the page with their table."""

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
"""Distance of the domains from gimbal lock, where [A] is singular."""

HEAD = """# Certificates of error

`make tradeoff` (`python -m benchmarks.tradeoff`) writes this page. `kanegen verify` generates the C of a
certificate again and measures it in fresh states.

A budget bounds the error of {{ydot}} in forward dynamics, relative to the accelerations that loads, gravity,
speeds and tau would each cause by themselves ([budget.md](../budget.md)). The domain is the default one
without the states next to gimbal lock (`exclude.clearance = {clearance}`), and no state that is tried may
exceed the budget. *exceeded* counts the fresh states of the validation whose error is larger than the
budget. *share* is the upper limit, with 95 % confidence, on the part of the domain in which the error is
larger. *median* and *largest* describe the errors in the fresh states, and *found* is the largest error
that two searches found. *ns* is the median time of one evaluation.

| model | budget | variant | exceeded | share | median | largest | found | ns |
| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |
"""


@dataclass(frozen=True)
class Line:
    """A row of the table.

    Attributes:
        model: Name of the model.
        budget: Budget of the error.
        cells: Texts of the columns after these two.
    """

    model: str
    budget: float
    cells: Sequence[str]


def write_certificate(
    system: kg.System, budget: float, folder: Path, progress: Callable[[str], None]
) -> Line:
    """Certify the fastest variant that keeps a budget, write its certificate, and return its row."""
    domain = region_from_table(system, {"exclude": {"clearance": CLEARANCE}})
    try:
        found = certify_variant(system, domain, Request(error=budget, attempts=1), progress=progress)
    except BudgetError as error:
        return Line(system.name, budget, (str(error), *("-",) * 6))
    name = f"{system.name}{SUFFIX}"
    write_whole(folder / f"{system.name}_{budget:.0e}{SUFFIX}", found.source.files[name])
    return Line(system.name, budget, _cells(found))


def _cells(found: CertifiedSource) -> tuple[str, ...]:
    """Return the columns of one certificate after the model and the budget."""
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


def write_table(lines: Sequence[Line], folder: Path) -> None:
    """Write the page with the table of all certificates."""
    rows = [f"| {line.model} | {line.budget:.0e} | {' | '.join(line.cells)} |" for line in lines]
    write_whole(folder / "certificates.md", HEAD.format(clearance=CLEARANCE) + "\n".join(rows) + "\n")
