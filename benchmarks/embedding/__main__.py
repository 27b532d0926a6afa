"""Time calls through other programs beside the C alone, and write docs/embedding/call-times.md.

    python -m benchmarks.embedding [TARGET ...] [--file FILE]

Run it on a quiet machine. What is not installed is left out and named; `make embed` installs everything.
"""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import benchmarks.embedding
from benchmarks.embedding.row import Row
from kanegen.errors import MissingError
from kanegen.files import write_whole
from kanegen.measure.machine import Machine
from kanegen.studies.bench.table import ns
from kanegen.studies.markdown import markdown_table

PAGE = Path(__file__).parents[2] / "docs" / "embedding" / "call-times.md"

HEAD = """# Call times

`python -m benchmarks.embedding` writes this page. *alone* is the median time of a call of the C function from
C, *through* that of the same call, with the same numbers, through the program; both take turns in one run.
*beyond* is the median of the differences of the rounds: what the program adds. It depends on the sizes of
arrays, not on what the C computes, but for WebAssembly, whose instructions themselves take longer than those
that a compiler makes for this processor. Where a call computes many states, *each* gives the time of one."""


def measures() -> dict[str, Callable[[], list[Row]]]:
    """Return the function that measures each target, by the name of its module."""
    names = [found.name for found in pkgutil.iter_modules(benchmarks.embedding.__path__)]
    modules = {
        name: importlib.import_module(f"benchmarks.embedding.{name}") for name in names if name != "__main__"
    }
    return {name: module.measure for name, module in modules.items() if hasattr(module, "measure")}


def document(rows: Sequence[Row], left_out: Iterable[str], machine: Machine) -> str:
    """Return the page.

    Args:
        rows: All calls.
        left_out: Targets that are not installed, with the reasons.
        machine: Where the times were taken.
    """
    cells = [
        [row.target, row.call, ns(row.alone.median), ns(row.through.median), ns(row.beyond)] for row in rows
    ]
    where = machine.lines()
    where += sorted({row.versions for row in rows if row.versions.lower() not in "\n".join(where).lower()})
    lines = [
        HEAD,
        "",
        markdown_table(["program", "call", "alone, ns", "through, ns", "beyond, ns"], cells, left=2),
        "",
        *(f"- Left out: {one}" for one in left_out),
        "",
        "## Where",
        "",
        *(f"- {line}" for line in where),
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    """Measure, print the page, and write it."""
    found = measures()
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.embedding", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(found))
    parser.add_argument("--file", type=Path, default=PAGE)
    options = parser.parse_args()
    unknown = [name for name in options.targets if name not in found]
    if unknown:
        parser.error(f"no target {', '.join(unknown)}. There are {', '.join(found)}.")
    rows: list[Row] = []
    left_out: list[str] = []
    for name in options.targets or found:
        print(f"timing {name}", file=sys.stderr, flush=True)
        try:
            rows += found[name]()
        except MissingError as error:
            left_out.append(f"{name}, because {error}")
    text = document(rows, left_out, Machine.here())
    print(text)
    write_whole(options.file, text)


if __name__ == "__main__":
    main()
