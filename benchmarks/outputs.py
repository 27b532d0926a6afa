"""Time the outputs of kanegen beside Pinocchio's functions on robots and write docs/output-times.md.

python -m benchmarks.outputs [--models NAME ...] [--rounds N] [--seconds S] [--file FILE]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks import models
from kanegen.files import write_whole
from kanegen.measure.machine import Machine
from kanegen.studies.bench import BenchOptions, Comparison
from kanegen.studies.bench.comparison import KANEGEN
from kanegen.studies.bench.outputs import FUNCTIONS, compare_outputs
from kanegen.studies.bench.peers.pinocchio_peer import PINOCCHIO
from kanegen.studies.bench.table import ns, ratio
from kanegen.studies.markdown import markdown_table

PAGE = Path(__file__).parents[1] / "docs" / "output-times.md"
MODELS = ("ur5", "panda", "talos_reduced")

HEAD = """# Times of outputs beside Pinocchio

`python -m benchmarks.outputs` writes this page. Each output of kanegen's C is timed beside the function of
Pinocchio for the same quantity, on the same states and in turns, after their results agreed to 1e-10. Both
are compiled with `-O3 -march=native`. *ns* is the median time of one evaluation over the rounds; *one state*
and *batch* are the times of kanegen over that of Pinocchio. The chosen frame is that of the body with the
most bodies below it; `contact_dynamics` holds its origin. Pinocchio has the coordinates of kanegen: a
floating base is three translations and three turns there. It computes one state a call, also where *batch*
compares it with a call of kanegen for 32 states.
"""


_DIFFERENCE = (
    "results differ, because bodies have the frames of the robot's file in kanegen, and those of their "
    "joints in the tree that Pinocchio is given."
)
"""Why results may differ."""


def main() -> None:
    """Compare the outputs on every model, print the tables, and write the page."""
    options = _options()
    parts = [HEAD]
    for name in options.models:
        found = compare_outputs(
            models.system(name), FUNCTIONS, BenchOptions(256, options.rounds, options.seconds), _say
        )
        parts.append(_section(name, found))
        print(parts[-1], flush=True)
    parts.append("## Where\n\n" + "\n".join(f"- {line}" for line in Machine.here().lines()) + "\n")
    write_whole(options.file, "\n".join(parts))


def _section(name: str, found: Comparison) -> str:
    """Return the section of a model."""
    head = ["output", "Pinocchio", "ns", "kanegen, ns", "batch, ns", "one state", "batch"]
    lines = [f"## {name}, {found.n} freedoms", "", markdown_table(head, _rows(found), left=2), ""]
    lines += [f"- {note}." for note in found.notes]
    differing = dict.fromkeys(entry.task.quantity for entry in found.entries if not entry.agrees)
    lines += [f"- {quantity} is not timed: {_DIFFERENCE}" for quantity in differing]
    lines += [f"- Left out: {absence.name}: {absence.reason}" for absence in found.absences]
    return "\n".join(lines) + "\n"


def _rows(found: Comparison) -> list[list[str]]:
    """Return a row for each output."""
    rows = []
    for quantity in found.quantities:
        peer = found.best(PINOCCHIO, quantity)
        single, batch = (found.best(KANEGEN, quantity, batch=many) for many in (False, True))
        times = [ns(entry and entry.median) for entry in (peer, single, batch)]
        rows.append([quantity, FUNCTIONS[quantity], *times, ratio(single, peer), ratio(batch, peer)])
    return rows


def _options() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.outputs", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--models", nargs="+", default=MODELS, choices=models.NAMES)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--seconds", type=float, default=0.02)
    parser.add_argument("--file", type=Path, default=PAGE)
    return parser.parse_args()


def _say(stage: str) -> None:
    """Print a stage to the standard error."""
    print(stage, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
