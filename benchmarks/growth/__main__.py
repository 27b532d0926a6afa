"""Measures how kanegen grows from 1 to 256 bodies, and writes docs/growth.md and docs/growth.svg.

python -m benchmarks.growth [--most N] [--rounds R] [--seconds S] [--time-limit S] [--docs FOLDER]

Needs the extra `bench` for the picture. The whole takes about an hour, most of it in the C compiler.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Sequence
from itertools import product
from pathlib import Path

from benchmarks.growth import compiling
from benchmarks.growth.cases import Curve, cases
from benchmarks.growth.document import ONCE, GrowthOptions, document
from benchmarks.growth.generating import generated
from benchmarks.growth.plot import svg
from benchmarks.growth.results import Point, Study
from kanegen.extras import require
from kanegen.files import write_whole
from kanegen.library.native.commands import TimeLimitError

DOCS = Path(__file__).parents[2] / "docs"


def main() -> None:
    options = _options()
    terms = GrowthOptions(options.rounds, options.seconds, options.time_limit)
    require("matplotlib")
    options.docs.mkdir(parents=True, exist_ok=True)
    study = Study([Point(case) for case in cases(options.most)])
    with tempfile.TemporaryDirectory() as folder:
        folders = [Path(folder) / str(i) for i in range(len(study.points))]
        for _ in range(terms.rounds):
            _generate(study, folders)
        _compile(study, folders, terms)
        _time(study, folders, terms)
    write_whole(options.docs / "growth.md", document(study, terms))
    write_whole(options.docs / "growth.svg", svg(study))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=int, default=256, help="bodies of the largest tree")
    parser.add_argument(
        "--rounds", type=int, default=GrowthOptions.rounds, help="of everything; medians count"
    )
    parser.add_argument(
        "--seconds", type=float, default=GrowthOptions.seconds, help="of every timing of one state"
    )
    parser.add_argument(
        "--time-limit", type=float, default=GrowthOptions.time_limit, help="s for one file of C"
    )
    parser.add_argument("--docs", type=Path, default=DOCS)
    return parser.parse_args()


def _generate(study: Study, folders: Sequence[Path]) -> None:
    """One round."""
    for point, folder in zip(study.points, folders, strict=True):
        _say(f"generating {point.case}")
        point.add(generated(point.case, folder))


def _compile(study: Study, folders: Sequence[Path], terms: GrowthOptions) -> None:
    """All rounds; where a file has exceeded the time limit, larger trees of the same curve are left out."""
    given_up: dict[tuple[Curve, str], int] = {}
    for turn, (point, folder), kind in product(
        range(terms.rounds), list(zip(study.points, folders, strict=True)), compiling.KINDS
    ):
        curve, bodies = point.case.curve, point.case.bodies
        known = point.median(f"compile{kind}") or 0.0
        if bodies >= given_up.get((curve, kind), bodies + 1) or (turn and known > terms.time_limit * ONCE):
            continue
        _say(f"compiling {point.case}{kind}")
        try:
            point.add(compiling.compiled(folder, kind, terms.time_limit))
        except TimeLimitError as error:
            given_up[curve, kind] = bodies
            reason = f"the compiler took more than {error.seconds:g} s for a file"
            study.missing.append(f"{point.case}{kind} and larger ones: {reason}")


def _time(study: Study, folders: Sequence[Path], terms: GrowthOptions) -> None:
    """Everybody has a turn in every round."""
    programs = {
        id(point): compiling.link(point.case, folder, int(point.found["freedoms"][0]))
        for point, folder in zip(study.points, folders, strict=True)
        if point.median("compile") is not None
    }
    for turn in range(terms.turns):
        _say(f"timing, round {turn + 1}")
        for point in study.points:
            if id(point) in programs:
                point.add({"run": compiling.run_time(programs[id(point)], terms.seconds)})


def _say(stage: str) -> None:
    print(stage, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
