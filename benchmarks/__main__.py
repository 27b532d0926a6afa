"""Times kanegen and its peers on the standard models; writes docs/benchmarks.md and docs/benchmarks.svg.

python -m benchmarks [--models NAME ...] [--rounds R] [--seconds S] [--states B] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import functools
import sys
from pathlib import Path

from benchmarks import models
from benchmarks.document import document, section
from kanegen.files import write_whole
from kanegen.studies.bench import BenchOptions, Comparison, compare
from kanegen.studies.bench.plot import svg

DOCS = Path(__file__).parents[1] / "docs"


def main() -> None:
    arguments = _arguments()
    options = BenchOptions(arguments.states, arguments.rounds, arguments.seconds)
    arguments.docs.mkdir(parents=True, exist_ok=True)
    comparisons: list[Comparison] = []
    for name in arguments.models:
        comparisons.append(compare(models.system(name), options, functools.partial(_say, name)))
        print(section(comparisons[-1]), flush=True)
        write_whole(arguments.docs / "benchmarks.md", document(comparisons, options))
        write_whole(arguments.docs / "benchmarks.svg", svg(comparisons))
    if not all(comparison.agrees for comparison in comparisons):
        sys.exit("some results do not agree; the tables say which")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.splitlines()[0])
    parser.add_argument("--models", nargs="+", default=models.NAMES, choices=models.NAMES)
    parser.add_argument("--rounds", type=int, default=BenchOptions.rounds)
    parser.add_argument(
        "--seconds", type=float, default=BenchOptions.seconds, help="duration of each task in every round"
    )
    parser.add_argument("--states", type=int, default=BenchOptions.states)
    parser.add_argument("--docs", type=Path, default=DOCS)
    return parser.parse_args()


def _say(model: str, stage: str) -> None:
    print(f"{model}: {stage}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
