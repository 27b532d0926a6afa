"""Runs the battery of extremes and writes docs/extremes.md and docs/extremes.svg.

    python -m tests.battery [--quick | --nightly] [--only X1 ...] [--docs FOLDER]

Needs the extras `truth`, `bench`, `study` and `test`. The full size takes about half an hour, the nightly
size hours.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from kanegen.extras import require
from kanegen.files import write_whole
from tests.battery.battery import experiments
from tests.battery.experiments import Row, Size
from tests.battery.plot import svg
from tests.battery.report import report
from tests.support.paths import ROOT

DOCS = ROOT / "docs"


def main() -> None:
    options = _options()
    require("matplotlib")
    results: dict[str, list[Row]] = {}
    size = Size(full=not options.quick, nightly=options.nightly)
    for experiment in experiments():
        if experiment.number in (options.only or [experiment.number]):
            print(f"{experiment.number} {experiment.title}", file=sys.stderr, flush=True)
            results[experiment.number] = list(experiment.rows(size))
            for row in results[experiment.number]:
                if not row.holds:
                    print(f"  missed: {row.case}, {row.figure:.1e}, limit {row.limit:.1e}", file=sys.stderr)
    if options.only:
        print(report(results))
    else:
        options.docs.mkdir(parents=True, exist_ok=True)
        write_whole(options.docs / "extremes.md", report(results))
        write_whole(options.docs / "extremes.svg", svg(results))
    unexplained = [row for rows in results.values() for row in rows if not row.holds and not row.cause]
    if unexplained:
        sys.exit("rows miss their limits for unknown causes; the report says which")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.battery", description=__doc__.splitlines()[0])
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument("--quick", action="store_true", help="run the size that the tests run")
    sizes.add_argument("--nightly", action="store_true", help="run many more random examples")
    parser.add_argument(
        "--only", nargs="+", help="run these experiments, such as X1, and print the report without writing it"
    )
    parser.add_argument("--docs", type=Path, default=DOCS, help="folder of the report")
    return parser.parse_args()


if __name__ == "__main__":
    main()
