"""All of docs/benchmarks.md."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from string import Template

from kanegen.measure import machine
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

_INTRODUCTION = """\
Written by `make bench` (`python -m benchmarks`); nobody edits it by hand. `kanegen bench MODEL` does the same
for one model. A ratio is the time of kanegen over that of the peer: 1/8 is an eighth of its time."""

_SHARED = """\
The machine was shared with other work while the times were taken. The programs took turns, so ratios carry
over; nanoseconds are those of this machine under that load."""

_CALLS = f"""\
One state a call, `library.evaluate(x, y)` and `library.forward_dynamics(x, y, tau)` with arrays of doubles.
The C is the same, compiled as *{EXACT.name}*; *beyond* is what Python and NumPy add to it."""

_METHOD = Path(__file__).with_name("method.md")


def document(comparisons: Sequence[Comparison], terms: BenchOptions) -> str:
    """Markdown with summaries first, then how it was done, then every number."""
    parts = [
        "# kanegen beside its peers",
        _INTRODUCTION,
        "![Times of everybody on every model](benchmarks.svg)",
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
        _method(terms),
        "Settings of the compilers:",
        "\n".join(f"- *{setting.name}*: `{' '.join(setting.flags)}`" for setting in SETTINGS),
        "## Machine",
        "\n".join(f"- {line}" for line in machine.description()),
        _SHARED,
        "## Every number",
        *(section(comparison) for comparison in comparisons),
    ]
    return "\n\n".join(parts) + "\n"


def section(comparison: Comparison) -> str:
    """Every number of one model."""
    parts = [f"### {comparison.model}, {comparison.n} freedoms"]
    for quantity in QUANTITIES:
        parts.append(
            markdown_table(table.head(comparison, quantity), table.rows(comparison, quantity), table.TEXTS)
        )
    return "\n\n".join([*parts, *table.notes(comparison), *table.left_out(comparison)])


def _summaries(comparisons: Sequence[Comparison], setting: Setting, batch: bool = False) -> Iterator[str]:
    """A table a quantity, a line a model: kanegen compiled in one setting over its peers."""
    for quantity in QUANTITIES:
        title = f"{table.TITLES[quantity]}{', batch' if batch else ''}, ns a state"
        rows = []
        for comparison in comparisons:
            own = comparison.best(KANEGEN, quantity, setting, batch)
            shares = [table.ratio(own, comparison.best(peer, quantity)) for peer in PEERS]
            rows.append([comparison.model, str(comparison.n), _ns(own), *shares])
        yield markdown_table(["", "freedoms", title, *(f"over {peer}" for peer in PEERS)], rows)


def _calls(comparisons: Sequence[Comparison]) -> str:
    """A line a model: from C, from Python, and the difference."""
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


def _method(terms: BenchOptions) -> str:
    template = Template(_METHOD.read_text(encoding="utf-8"))
    numbers = {
        "states": terms.states,
        "rounds": terms.rounds,
        "seconds": f"{terms.seconds:g}",
        "tolerance": f"{TOLERANCE:.0e}",
        "most": MOST_FREEDOMS,
        "derived": MOST_DERIVATIVE_FREEDOMS,
        "time_limit": TIME_LIMIT,
    }
    return template.substitute(numbers).strip()
