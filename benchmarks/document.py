"""The page docs/benchmarks.md, made of saved times: what is slower, summaries, the method, and every
number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from string import Template

from benchmarks import summaries
from kanegen.measure.timing import CONFIDENCE
from kanegen.studies.bench import BenchOptions, Comparison, table
from kanegen.studies.bench.peers import casadi_peer, dynibo_peer
from kanegen.studies.bench.peers.problem import MOST_DERIVATIVE_FREEDOMS
from kanegen.studies.bench.peers.pydy_peer import MOST_FREEDOMS, TIME_LIMIT
from kanegen.studies.bench.record import Record
from kanegen.studies.bench.results import BY_DIFFERENCES, TOLERANCE
from kanegen.studies.bench.settings import (
    CONTRACTED,
    CONTRACTED_AVX2,
    DEFAULT,
    DEFAULT_AVX2,
    MEANINGS,
    PORTABLE,
    Setting,
)
from kanegen.studies.markdown import markdown_table

_INTRODUCTION = f"""\
Written by `make bench` (`python -m benchmarks`) from [benchmarks.json](benchmarks.json); do not edit it
by hand. `kanegen bench MODEL` measures the same for one model. A ratio is the time of kanegen over that
of the peer: 1/8 means that kanegen takes an eighth of the time. In brackets stands the interval that
holds the ratio with {100 * CONFIDENCE:g} % confidence, for 1/8.0 that of 8.0. The ratios carry over to
other machines better than the nanoseconds, but hardly from one set of vector instructions to another:
kanegen and peers are compared where their compilers may use the same."""

_BEHIND = """\
All cases of this run in which kanegen is slower than a peer, or in which the interval does not rule it
out, the worst first."""

_NOWHERE = "In this run kanegen was behind no peer in any case: every interval ends below 1."

_GAINS = """\
Times of the default build over those of portable code, which `kanegen generate` writes; both compute the
same bits."""

_SAME_FLAGS = """\
Above, kanegen stands beside the fastest of CasADi's programs with the same vector instructions. Here the C of
both is compiled with the same flags, those of the setting that the column names."""

_CALLS = f"""\
One state in each call, `library.evaluate(x, y)` and `library.forward_dynamics(x, y, tau)` with arrays of
doubles. The C is the same, compiled as *{DEFAULT.name}*; *beyond* is the time that Python and NumPy add
to it. Large batches hide this time; `library.bind` avoids most of it
([call-times.md](embedding/call-times.md)). Programs that are called from Python stand beside these calls."""

_ALL_CORES = """\
Every program runs once on every core at the same time, with states of its own, and the time is that in
which all cores together have computed one state more."""

_BATCHES = """\
A call of kanegen computes 32 states; the peers of these tables compute one state a call, one after the
other."""

_METHOD = Path(__file__).with_name("method.md")


def document(record: Record) -> str:
    """Return the Markdown: what is slower, summaries, the method, and every number."""
    comparisons = record.comparisons
    machine = record.machine
    parts = [
        "# kanegen beside its peers",
        _INTRODUCTION,
        "Taken on:",
        "\n".join(f"- {line}" for line in machine.lines()),
        "## Where kanegen is slower",
        *_behind(comparisons),
        "![How many times as fast as Pinocchio every program is](benchmarks.svg)",
        *_sections(comparisons),
        *_all_cores(comparisons),
        "## What the default build gains",
        _GAINS,
        *_gains(comparisons),
        *_same_flags(comparisons),
        "## Calls from Python",
        _CALLS,
        summaries.calls(comparisons),
        *_from_python(comparisons),
        "## What is compared",
        _method(record.options),
        "The column *compiler*, and what its words mean:",
        "\n".join(_setting_line(setting) for setting in _settings(comparisons).values()),
        "## Every number",
        *(section(comparison) for comparison in comparisons),
    ]
    return "\n\n".join(parts) + "\n"


def section(comparison: Comparison) -> str:
    """Return the section with every number of one model."""
    parts = [f"### {comparison.model}, {comparison.n} freedoms"]
    for quantity in comparison.quantities:
        parts.append(
            markdown_table(
                table.head(comparison, quantity), table.rows(comparison, quantity), table.TEXT_COLUMNS
            )
        )
    return "\n\n".join([*parts, *table.notes(comparison), *table.left_out(comparison)])


def _behind(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield what stands first: the cases in which kanegen is not certainly faster."""
    rows = summaries.behind(comparisons)
    if not rows:
        yield _NOWHERE
        return
    yield _BEHIND
    yield markdown_table(["model", "quantity", "kanegen", "peer", "ratio"], rows, 4)


def _sections(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield the summaries of every compiler setting, for one state a call and for batches."""
    known = _settings(comparisons)
    for name in (DEFAULT.name, CONTRACTED.name, DEFAULT_AVX2.name, CONTRACTED_AVX2.name, PORTABLE.name):
        if (setting := known.get(name)) is None:
            continue
        for words, batch in (("One state a call", False), ("Batches", True)):
            yield f"## {words}: {setting.words}"
            yield f"Compiled with `{' '.join(setting.flags)}`: {MEANINGS[name]}." + f" {_BATCHES}" * batch
            yield from summaries.summaries(comparisons, setting, batch)


def _all_cores(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield the section about all cores; nothing where only one core was used."""
    several = {
        summaries.Case(case.quantity, case.setting, case.batch, case.cores): None
        for one in comparisons
        for case in summaries.cases(one)
        if case.cores > 1
    }
    if several:
        yield "## All cores"
        yield _ALL_CORES
    for case in several:
        yield f"*{case.setting.words}*:\n\n{summaries.summary(comparisons, case)}"


def _gains(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield what default builds gain over portable code."""
    known = _settings(comparisons)
    for name in (DEFAULT.name, DEFAULT_AVX2.name):
        if name in known and (text := summaries.gains_of_default(comparisons, known[name])):
            yield f"*{known[name].words}*:\n\n{text}"


def _same_flags(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield the section about CasADi's C with the flags of kanegen's; nothing where it was not timed."""
    known = _settings(comparisons)
    compared = [one for one in (DEFAULT, DEFAULT_AVX2, PORTABLE, CONTRACTED) if one.name in known]
    if text := summaries.with_the_same_flags(comparisons, casadi_peer.CASADI, compared):
        yield "## CasADi with the same flags"
        yield _SAME_FLAGS
        yield text


def _from_python(comparisons: Sequence[Comparison]) -> Iterator[str]:
    """Yield the tables of kanegen's C called from Python beside programs that are called from Python."""
    python = {
        case: None
        for one in comparisons
        for case in summaries.cases(one)
        if case.participant == summaries.PYTHON
    }
    for case in python:
        if summaries.peers(comparisons, case):
            yield summaries.summary(comparisons, case)


def _settings(comparisons: Sequence[Comparison]) -> dict[str, Setting]:
    """Return the compiler settings of all entries by their names."""
    return {entry.setting.name: entry.setting for one in comparisons for entry in one.entries}


def _setting_line(setting: Setting) -> str:
    """Return the line of a compiler setting in the list of all."""
    flags = f"`{' '.join(setting.flags)}`" if setting.flags else "as the program chooses"
    return "; ".join(filter(None, (f"- *{setting.words}*: {flags}", MEANINGS.get(setting.name))))


def _method(options: BenchOptions) -> str:
    """Return the description of the method with its numbers, without the first paragraph of the template."""
    _, _, text = _METHOD.read_text(encoding="utf-8").partition("\n\n")
    template = Template(text)
    numbers = {
        "states": options.states,
        "rounds": options.rounds,
        "seconds": f"{options.seconds:g}",
        "tolerance": f"{TOLERANCE:.0e}",
        "differences": f"{BY_DIFFERENCES:.0e}",
        "most": MOST_FREEDOMS,
        "derived": MOST_DERIVATIVE_FREEDOMS,
        "casadi_derived": casadi_peer.MOST_DERIVATIVE_FREEDOMS,
        "time_limit": TIME_LIMIT,
        "dynibo": dynibo_peer.VERSION,
        "confidence": f"{100 * CONFIDENCE:g} %",
    }
    return template.substitute(numbers).strip()
