"""The fastest variant under a budget of error, or the most accurate one under a budget of time."""

from __future__ import annotations

from collections.abc import Iterable

from kanegen.compiler import Progress, quiet
from kanegen.model.system import System
from kanegen.options import STRICT
from kanegen.studies.budget.certificate import SUFFIX
from kanegen.studies.budget.certified import Certified, certified
from kanegen.studies.budget.gimbal_lock import require_clear
from kanegen.studies.budget.region import Region
from kanegen.studies.budget.request import Request
from kanegen.studies.budget.selection import choose
from kanegen.studies.budget.workbench import Workbench, field_of
from kanegen.studies.tradeoff.built import generated
from kanegen.studies.tradeoff.variants import Candidate


def find(
    model: System,
    region: Region,
    request: Request,
    field: Iterable[Candidate] | None = None,
    seed: int = 0,
    progress: Progress = quiet,
) -> Certified:
    """C for the forward dynamics of a model that keeps a budget, with a certificate.

    Args:
        model: The tree.
        region: The states that count, of this model.
        request: The budget and its terms.
        field: Candidates, the default first; by default those of the study.
        seed: Of all samples; the same one gives the same states.
        progress: Told the name of each stage.

    Raises:
        BudgetError: If no variant keeps the budget; says how far one gets and with which.
        BuildError: If there is no C compiler.
        OptionError: If [A] is singular somewhere in the region; names what to exclude.
    """
    require_clear(region)
    bench = Workbench(region, request, tuple(field or field_of()), seed, progress)
    choice = choose(bench, request)
    progress("writing the certificate")
    return certified(model, bench, request, choice, seed)


def file_names(model: System) -> set[str]:
    """Names of the files that come of a search, by which a folder can be tried beforehand.

    Raises:
        ModelError, SingularError: As `kanegen.generate`.
    """
    return {*generated(model, Candidate(STRICT)).files, f"{model.name}{SUFFIX}"}
