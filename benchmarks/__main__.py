"""Times kanegen and its peers on the standard models; writes docs/benchmarks.md and the speeds in the README.

python -m benchmarks [MODEL ...] [--peer NAME] [--quick] [--rounds R] [--seconds S] [--states B] [--folder F]
python -m benchmarks --prepare [MODEL ...] [--peer NAME]
python -m benchmarks --render

Times are saved in benchmarks.json, from which everything else is made. With models or peers by name, and
with --quick, everything is written into build/benchmarks instead of docs. --prepare compiles all programs
without timing them, so that a later run only measures; --render makes the page, the picture and the README of
saved times anew.
"""

from __future__ import annotations

import argparse
import functools
import os
import sys
from pathlib import Path

from benchmarks import models, readme
from benchmarks.document import document, section
from kanegen.files import write_all, write_whole
from kanegen.studies.bench import BenchOptions, Comparison, compare
from kanegen.studies.bench.against import compare_records, require_comparable
from kanegen.studies.bench.peers.registry import PEERS
from kanegen.studies.bench.plot import svg
from kanegen.studies.bench.record import Record, read_record
from kanegen.studies.bench.table import heads_of_changes, row_of_change, words_of_changes
from kanegen.studies.markdown import markdown_table

ROOT = Path(__file__).parents[1]
FULL = BenchOptions(states=256, rounds=9, seconds=0.02)
"""The extent of a run whose times stand in the documents."""

QUICK = BenchOptions(states=128, rounds=6, seconds=0.005)
"""The extent of --quick: the fewest rounds that have a confidence interval."""

QUICK_PEERS = ("pinocchio", "casadi", "mujoco")
"""The peers of --quick, whose processes start in no time."""


def main() -> None:
    """Measure, or only compile or only render, as the command line asks."""
    arguments = _arguments()
    is_part = arguments.models or arguments.peers or arguments.quick
    folder = arguments.folder or (ROOT / "build" / "benchmarks" if is_part else ROOT / "docs")
    folder.mkdir(parents=True, exist_ok=True)
    saved = folder / "benchmarks.json"
    if arguments.render:
        _render(read_record(saved), folder)
        return
    names = arguments.models or list(models.NAMES)
    peers = arguments.peers or (QUICK_PEERS if arguments.quick else PEERS)
    if arguments.prepare:
        for name in names:
            compare(models.system(name), BenchOptions(8, 0, 0.0), functools.partial(_say, name), peers)
        return
    options = _options(arguments)
    before = None if arguments.against is None else read_record(arguments.against)
    if before is not None:
        for name in names:
            require_comparable(before, arguments.against, name, options.rounds)
    comparisons: list[Comparison] = []
    for name in names:
        cores = 1 if arguments.quick else os.cpu_count() or 1
        say = functools.partial(_say, name)
        comparisons.append(compare(models.system(name), options, say, peers, cores))
        print(section(comparisons[-1]), flush=True)
        record = Record.here(comparisons, options)
        write_whole(saved, record.text())
        _render(record, folder)
    failed = [one.model for one in comparisons if not one.agrees]
    if before is not None:
        verdict = compare_records(record, before, arguments.against)
        print(markdown_table(heads_of_changes(), [row_of_change(row) for row in verdict.rows], 5))
        print("\n".join((*words_of_changes(verdict), *verdict.notes)))
        failed += [f"{row.model} became slower" for row in verdict.slower]
    if failed:
        sys.exit(f"some results do not agree or became slower; the tables say which: {', '.join(failed)}")


def _render(record: Record, folder: Path) -> None:
    """Write the page and the picture of saved times, and where they are those of the docs, the README."""
    texts: dict[Path, str | bytes] = {
        folder / "benchmarks.md": document(record),
        folder / "benchmarks.svg": svg(record.comparisons),
    }
    if folder == ROOT / "docs":
        texts[readme.README] = readme.with_speed(readme.README.read_text(encoding="utf-8"), record)
    write_all(texts)


def _options(arguments: argparse.Namespace) -> BenchOptions:
    """Return the extent of the comparisons."""
    base = QUICK if arguments.quick else FULL
    asked = (arguments.states, arguments.rounds, arguments.seconds)
    chosen = (base.states, base.rounds, base.seconds)
    states, rounds, seconds = (b if a is None else a for a, b in zip(asked, chosen, strict=True))
    return BenchOptions(int(states), int(rounds), seconds)


def _arguments() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("models", nargs="*", metavar="MODEL", help=f"among {', '.join(models.NAMES)}")
    parser.add_argument(
        "--peer",
        action="append",
        dest="peers",
        choices=list(PEERS),
        metavar="NAME",
        help=f"time this peer (repeatable): {', '.join(PEERS)}; all by default",
    )
    parser.add_argument(
        "--quick", action="store_true", help="few and short rounds beside some peers, on one core"
    )
    parser.add_argument("--prepare", action="store_true", help="compile all programs, and time nothing")
    parser.add_argument("--render", action="store_true", help="make the page of saved times")
    parser.add_argument("--against", type=Path, metavar="FILE", help="compare with a saved benchmarks.json")
    parser.add_argument("--rounds", type=int)
    parser.add_argument("--seconds", type=float, help="duration of each task in every round")
    parser.add_argument("--states", type=int)
    parser.add_argument("--folder", type=Path, help="where benchmarks.json and the page lie")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.models if name not in models.NAMES]:
        parser.error(f"no model {unknown[0]!r}; there are {', '.join(models.NAMES)}")
    return arguments


def _say(model: str, stage: str) -> None:
    print(f"{model}: {stage}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
