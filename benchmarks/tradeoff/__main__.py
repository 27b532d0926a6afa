"""Study speed against accuracy and write docs/tradeoff; takes about three quarters of an hour.

python -m benchmarks.tradeoff [--models NAME ...] [--budgets ERROR ...] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import functools
import sys
from pathlib import Path

from benchmarks import models
from benchmarks.tradeoff import certificates
from kanegen.files import write_whole
from kanegen.studies.tradeoff import report
from kanegen.studies.tradeoff.outcome import Study
from kanegen.studies.tradeoff.plot import simulation_svg, tradeoff_svg
from kanegen.studies.tradeoff.simulation import with_simulations
from kanegen.studies.tradeoff.study import study

DOCS = Path(__file__).parents[2] / "docs" / "tradeoff"
MODELS = ("eight_body", "panda", "talos_reduced")
CERTIFIED = ("eight_body", "panda")
BUDGETS = (1e-6, 1e-9, 1e-12)


def main() -> None:
    """Study the models, write their reports, and certify the fastest variant for each budget."""
    options = _options()
    for name in options.models:
        progress = functools.partial(_say, name)
        system = models.system(name)
        found = with_simulations(system, study(system, progress=progress), progress)
        _write(found, options.docs / name)
    lines = []
    for name in CERTIFIED if options.budgets else ():
        for budget in options.budgets:
            progress = functools.partial(_say, f"{name}, {budget:.0e}")
            lines.append(certificates.write_certificate(models.system(name), budget, options.docs, progress))
            certificates.write_table(lines, options.docs)


def _options() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.tradeoff", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--models", nargs="*", default=MODELS, choices=models.NAMES, help="models to study")
    parser.add_argument(
        "--budgets", nargs="*", type=float, default=BUDGETS, help="error budgets of the certificates"
    )
    parser.add_argument("--docs", type=Path, default=DOCS)
    return parser.parse_args()


def _write(found: Study, folder: Path) -> None:
    """Write the report and the pictures of a study into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / "tradeoff.md", report.markdown(found))
    write_whole(folder / "tradeoff.svg", tradeoff_svg(found))
    write_whole(folder / "tradeoff-simulation.svg", simulation_svg(found))


def _say(what: str, stage: str) -> None:
    """Print the stage of a model to the standard error."""
    print(f"{what}: {stage}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
