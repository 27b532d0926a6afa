"""The document docs/benchmarks.md: summaries, the method, and every number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from string import Template

from kanegen.measure.machine import Machine
from kanegen.studies.bench import BenchOptions, Comparison, Entry, table
from kanegen.studies.bench.comparison import KANEGEN, PYTHON
from kanegen.studies.bench.participant import EXACT, NATIVE, RELAXED, SETTINGS, Setting
from kanegen.studies.bench.peers.casadi_peer import CASADI
from kanegen.studies.bench.peers.mujoco_peer import MUJOCO
from kanegen.studies.bench.peers.pinocchio_peer import FREE_FLYER, PINOCCHIO
from kanegen.studies.bench.peers.problem import MOST_DERIVATIVE_FREEDOMS
from kanegen.studies.bench.peers.pydy_peer import MOST_FREEDOMS, PYDY, TIME_LIMIT
from kanegen.studies.bench.results import QUANTITIES, TOLERANCE
from kanegen.studies.markdown import markdown_table

PEERS = (PINOCCHIO, FREE_FLYER, MUJOCO, CASADI, PYDY)
"""The peers in the order of the columns."""

_INTRODUCTION = """\
Written by `make bench` (`python -m benchmarks`); do not edit it by hand. `kanegen bench MODEL` measures the
same for one model. A ratio is the time of kanegen over that of the peer: 1/8 means that kanegen takes an
eighth of the time. The ratios carry over to other machines better than the nanoseconds."""

_SHARED = """\
Other work ran on the machine while the times were taken. The programs were timed in turns, so the load
affected all of them alike; the nanoseconds are those of this machine under this load."""

_CALLS = f"""\
One state in each call, `library.evaluate(x, y)` and `library.forward_dynamics(x, y, tau)` with arrays of
doubles. The C is the same, compiled as *{EXACT.name}*; *beyond* is the time that Python and NumPy add to it.
Large batches hide this time."""

_METHOD = Path(__file__).with_name("method.md")


def document(comparisons: Sequence[Comparison], options: BenchOptions) -> str:
    """Return the Markdown: summaries first, then the method, then every number."""
    parts = [
        "# kanegen beside its peers",
        _INTRODUCTION,
        "![Times of all programs on all models](benchmarks.svg)",
        f"## One state, compiler setting *{NATIVE.name}*",
        *_summaries(comparisons, NATIVE),
        f"## Many states at once, compiler setting *{NATIVE.name}*",
        *_summaries(comparisons, NATIVE, batch=True),
        f"## The default, *{EXACT.name}*",
        *_summaries(comparisons, EXACT),
        f"## Compiler setting *{RELAXED.name}*",
        *_summaries(comparisons, RELAXED),
        *_summaries(comparisons, RELAXED, batch=True),
        "## Calls from Python",
        _CALLS,
        _calls(comparisons),
        "## What is compared",
        _method(options),
        "Compiler settings:",
        "\n".join(f"- *{setting.name}*: `{' '.join(setting.flags)}`" for setting in SETTINGS),
        "## Machine",
        "\n".join(f"- {line}" for line in Machine.here().lines()),
        _SHARED,
        "## Every number",
        *(section(comparison) for comparison in comparisons),
    ]
    return "\n\n".join(parts) + "\n"


def section(comparison: Comparison) -> str:
    """Return the section with every number of one model."""
    parts = [f"### {comparison.model}, {comparison.n} freedoms"]
    for quantity in QUANTITIES:
        parts.append(
            markdown_table(
                table.head(comparison, quantity), table.rows(comparison, quantity), table.TEXT_COLUMNS
            )
        )
    return "\n\n".join([*parts, *table.notes(comparison), *table.left_out(comparison)])


def _summaries(comparisons: Sequence[Comparison], setting: Setting, batch: bool = False) -> Iterator[str]:
    """Yield one table for each quantity: a row a model, kanegen in one compiler setting over its peers."""
    for quantity in QUANTITIES:
        title = f"{table.TITLES[quantity]}{', batch' if batch else ''}, ns a state"
        rows = []
        for comparison in comparisons:
            own = comparison.best(KANEGEN, quantity, setting, batch)
            shares = [table.ratio(own, comparison.best(peer, quantity)) for peer in PEERS]
            rows.append([comparison.model, str(comparison.n), _ns(own), *shares])
        yield markdown_table(["", "freedoms", title, *(f"over {peer}" for peer in PEERS)], rows)


def _calls(comparisons: Sequence[Comparison]) -> str:
    """Return the table of calls from C, calls from Python, and the difference; one row for each model."""
    head, rows = [""], [[comparison.model] for comparison in comparisons]
    for quantity in QUANTITIES:
        head += [f"{table.TITLES[quantity]} from C, ns", "from Python", "beyond"]
        for comparison, row in zip(comparisons, rows, strict=True):
            own, call = comparison.best(KANEGEN, quantity, EXACT), comparison.best(PYTHON, quantity)
            beyond = table.ns(comparison.overhead(quantity))
            row += [_ns(own), _ns(call), beyond]
    return markdown_table(head, rows)


def _ns(entry: Entry | None) -> str:
    return table.ns(None if entry is None else entry.median)


def _method(options: BenchOptions) -> str:
    template = Template(_METHOD.read_text(encoding="utf-8"))
    numbers = {
        "states": options.states,
        "rounds": options.rounds,
        "seconds": f"{options.seconds:g}",
        "tolerance": f"{TOLERANCE:.0e}",
        "most": MOST_FREEDOMS,
        "derived": MOST_DERIVATIVE_FREEDOMS,
        "time_limit": TIME_LIMIT,
    }
    return template.substitute(numbers).strip()
