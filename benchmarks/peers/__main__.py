"""Times kanegen and its peers, and writes docs/benchmarks.md and docs/benchmarks.svg.

python -m benchmarks.peers [--models NAME ...] [--rounds R] [--seconds S] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.peers import models
from benchmarks.peers.building import ROOT
from benchmarks.peers.contest import entries
from benchmarks.peers.document import document
from benchmarks.peers.field import contestants
from benchmarks.peers.plot import draw
from benchmarks.peers.report import Outcome, table
from benchmarks.peers.states import random_states


def main() -> None:
    options = _options()
    options.docs.mkdir(parents=True, exist_ok=True)
    outcomes: list[Outcome] = []
    for name in options.models:
        outcomes.append(_outcome(name, options))
        print(table(outcomes[-1]), flush=True)
        _write(outcomes, options)
    if any(not entry.agrees for outcome in outcomes for entry in outcome.entries):
        sys.exit("some results do not agree; the table says which")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__.splitlines()[0])
    parser.add_argument("--models", nargs="+", default=models.NAMES, choices=models.NAMES)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--seconds", type=float, default=0.05, help="of every task in every round")
    parser.add_argument("--states", type=int, default=256)
    parser.add_argument("--docs", type=Path, default=ROOT / "docs")
    return parser.parse_args()


def _write(outcomes: list[Outcome], options: argparse.Namespace) -> None:
    text = document(outcomes, options.states, options.rounds, options.seconds)
    (options.docs / "benchmarks.md").write_text(text, encoding="utf-8")
    draw(outcomes, options.docs / "benchmarks.svg")


def _outcome(name: str, options: argparse.Namespace) -> Outcome:
    print(f"{name}: generating and compiling", file=sys.stderr, flush=True)
    system = models.system(name)
    n = len(system.freedoms)
    present, missing = contestants(system, random_states(system, options.states))
    for reason in missing:
        print(f"{name}: left out, {reason}", file=sys.stderr, flush=True)
    print(f"{name}: comparing and timing", file=sys.stderr, flush=True)
    return Outcome(name, n, tuple(entries(present, n, options.rounds, options.seconds)), tuple(missing))


if __name__ == "__main__":
    main()
