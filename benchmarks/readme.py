"""The sentences about speed in README.md, made of saved times, so that both cannot disagree."""

from __future__ import annotations

from pathlib import Path

from benchmarks.summaries import Case
from kanegen.errors import KanegenError
from kanegen.measure.timing import CONFIDENCE
from kanegen.studies.bench import Comparison, table
from kanegen.studies.bench.record import Record
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS
from kanegen.studies.bench.settings import DEFAULT, DEFAULT_AVX2, Setting

README = Path(__file__).parents[1] / "README.md"
BEGIN, END = "<!-- speed: written by make bench -->", "<!-- end of speed -->"
PEER = "Pinocchio"
MODELS = ("panda", "eight_body")


def with_speed(text: str, record: Record) -> str:
    """Return the text of the README with the block about speed made anew.

    Raises:
        KanegenError: If the marks of the block are missing.
    """
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise KanegenError(f"README.md: it lacks the lines {BEGIN} and {END}, between which times stand.")
    return f"{before}{BEGIN}\n{block(record)}\n{END}{after}"


def block(record: Record) -> str:
    """Return the table of ratios to Pinocchio, with the machine's vector instructions.

    A model that was not timed, and a set of vector instructions that the machine lacks, has no row.
    """
    rows = []
    for name in MODELS:
        for one in (found for found in record.comparisons if found.model == name):
            rows += [_row(one, setting) for setting in _settings(one)]
    columns = ["A + f", "in batches", "forward dynamics", "in batches", "its derivatives", "in batches"]
    head = f"| time over {PEER}'s | {' | '.join(columns)} |"
    rule = f"| --- {'| ---: ' * len(columns)}|"
    machine = record.machine
    where = (
        f"*The default build on {machine.processor}, {machine.compiler}; in brackets the "
        f"{100 * CONFIDENCE:g} % confidence interval. In batches a call of kanegen computes 32 states; "
        f"{PEER} computes one state a call, one after the other.*"
    )
    return "\n".join([head, rule, *rows, "", where])


def _settings(comparison: Comparison) -> list[Setting]:
    """Return the default builds that were timed, with the vector instructions of the machine."""
    known = {entry.setting.name: entry.setting for entry in comparison.entries}
    return [known[one.name] for one in (DEFAULT, DEFAULT_AVX2) if one.name in known]


def _row(comparison: Comparison, setting: Setting) -> str:
    """Return the row of a model in one compiler setting."""
    cells = []
    for quantity in (EQUATIONS, DYNAMICS, DERIVATIVES):
        for batch in (False, True):
            case = Case(quantity, setting, batch)
            cells.append(table.ratio(case.own(comparison), case.peer(comparison, PEER)))
    return f"| {comparison.model}, {comparison.n} freedoms, {setting.instructions} | {' | '.join(cells)} |"
