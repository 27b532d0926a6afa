"""Measures the costs of trees of 1 to 256 bodies; writes docs/growth.md and docs/growth.svg.

    python -m benchmarks.growth [--most N] [--rounds R] [--seconds S] [--time-limit S] [--docs FOLDER]

Needs the extra `bench` for the plot. It takes about an hour, most of it in the C compiler.
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
    arguments = _arguments()
    options = GrowthOptions(arguments.rounds, arguments.seconds, arguments.time_limit)
    require("matplotlib")
    arguments.docs.mkdir(parents=True, exist_ok=True)
    study = Study([Point(case) for case in cases(arguments.most)])
    with tempfile.TemporaryDirectory() as folder:
        folders = [Path(folder) / str(i) for i in range(len(study.points))]
        for _ in range(options.rounds):
            _generate(study, folders)
        _compile(study, folders, options)
        _time(study, folders, options)
    write_whole(arguments.docs / "growth.md", document(study, options))
    write_whole(arguments.docs / "growth.svg", svg(study))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=int, default=256, help="number of bodies of the largest tree")
    parser.add_argument(
        "--rounds",
        type=int,
        default=GrowthOptions.rounds,
        help="rounds, of which medians are taken",
    )
    parser.add_argument(
        "--seconds", type=float, default=GrowthOptions.seconds, help="duration of each timing of one state"
    )
    parser.add_argument(
        "--time-limit",
        type=float,
        default=GrowthOptions.time_limit,
        help="seconds to compile one file",
    )
    parser.add_argument("--docs", type=Path, default=DOCS)
    return parser.parse_args()


def _generate(study: Study, folders: Sequence[Path]) -> None:
    """Generate the C of all points once."""
    for point, folder in zip(study.points, folders, strict=True):
        _say(f"generating {point.case}")
        point.add(generated(point.case, folder))


def _compile(study: Study, folders: Sequence[Path], options: GrowthOptions) -> None:
    """Compile the C of all points in all rounds; a file over the time limit excludes larger trees of its
    curve."""
    given_up: dict[tuple[Curve, str], int] = {}
    for turn, (point, folder), kind in product(
        range(options.rounds), list(zip(study.points, folders, strict=True)), compiling.KINDS
    ):
        curve, bodies = point.case.curve, point.case.bodies
        known = point.median(f"compile{kind}") or 0.0
        if bodies >= given_up.get((curve, kind), bodies + 1) or (turn and known > options.time_limit * ONCE):
            continue
        _say(f"compiling {point.case}{kind}")
        try:
            point.add(compiling.compiled(folder, kind, options.time_limit))
        except TimeLimitError as error:
            given_up[curve, kind] = bodies
            reason = f"the compiler took more than {error.seconds:g} s for a file"
            study.missing.append(f"{point.case}{kind} and larger ones: {reason}")


def _time(study: Study, folders: Sequence[Path], options: GrowthOptions) -> None:
    """Time one state of every point in each round."""
    programs = {
        id(point): compiling.link(point.case, folder, int(point.found["freedoms"][0]))
        for point, folder in zip(study.points, folders, strict=True)
        if point.median("compile") is not None
    }
    for turn in range(options.turns):
        _say(f"timing, round {turn + 1}")
        for point in study.points:
            if id(point) in programs:
                point.add({"run": compiling.run_time(programs[id(point)], options.seconds)})


def _say(stage: str) -> None:
    print(stage, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
