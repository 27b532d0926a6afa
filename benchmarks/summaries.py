"""Tables of docs/benchmarks.md: a row a model, kanegen in one compiler setting over its peers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kanegen.measure.timing import speedup
from kanegen.studies.bench import Comparison, Entry, table
from kanegen.studies.bench.comparison import KANEGEN, PYTHON
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, QUANTITIES, of_peers
from kanegen.studies.bench.settings import AS_SHIPPED, DEFAULT, PORTABLE, Setting
from kanegen.studies.markdown import markdown_table

FROM_PYTHON = ("frax",)
"""Peers that are called from Python, and are compared with kanegen's C called from Python."""


@dataclass(frozen=True)
class Case:
    """One quantity of kanegen in one compiler setting, to be compared with all peers.

    Attributes:
        quantity: One of `QUANTITIES`.
        setting: Compiler setting.
        batch: Whether one call computes many states.
        cores: Number of cores that work at the same time.
        participant: kanegen's C called from C, or from Python.
    """

    quantity: str
    setting: Setting
    batch: bool = False
    cores: int = 1
    participant: str = KANEGEN

    @property
    def title(self) -> str:
        """The words of the quantity and of how it is called."""
        words = [table.TITLES[self.quantity]]
        words += ["batch"] * self.batch
        words += [f"{self.cores} cores"] * (self.cores > 1)
        return ", ".join(words)

    def own(self, comparison: Comparison) -> Entry | None:
        """Return the entry of kanegen; None if it was not timed."""
        return comparison.best(self.participant, self.quantity, self.setting, self.batch, cores=self.cores)

    def peer(self, comparison: Comparison, name: str) -> Entry | None:
        """Return the fastest entry of a peer with the same vector instructions; None if there is none.

        A peer without batches computes one state a call. A library in compiled form chooses its instructions.
        """
        quantity = of_peers(self.quantity)
        found = [
            comparison.best(name, quantity, None, batch, self.setting.instructions, self.cores)
            for batch in (False, self.batch)
        ]
        shipped = [
            entry
            for entry in comparison.entries
            if (entry.participant, entry.task.quantity, entry.cores) == (name, quantity, self.cores)
            and entry.setting.name == AS_SHIPPED.name
            and entry.times.rounds
            and entry.task.batch in (False, self.batch)
        ]
        timed = [entry for entry in (*found, *shipped) if entry is not None]
        return min(timed, key=lambda entry: entry.median, default=None)


def peers(comparisons: Sequence[Comparison], case: Case) -> list[str]:
    """Return the peers that have an entry beside a case in any model, in the order of the entries."""
    names = dict.fromkeys(name for one in comparisons for name in one.participants)
    comparable = [
        name
        for name in names
        if name not in (KANEGEN, PYTHON) and (name in FROM_PYTHON) == (case.participant == PYTHON)
    ]
    return [name for name in comparable if any(case.peer(one, name) for one in comparisons)]


def summary(comparisons: Sequence[Comparison], case: Case) -> str:
    """Return the table of one case; "" if no model has it."""
    if not any(case.own(one) for one in comparisons):
        return ""
    names = peers(comparisons, case)
    rows = []
    for one in comparisons:
        own = case.own(one)
        shares = [table.ratio(own, case.peer(one, name)) for name in names]
        rows.append([one.model, str(one.n), table.ns(own and own.median), *shares])
    return markdown_table(["", "freedoms", f"{case.title}, ns", *(f"over {name}" for name in names)], rows)


def summaries(comparisons: Sequence[Comparison], setting: Setting, batch: bool = False) -> Iterator[str]:
    """Yield one table for each quantity."""
    for quantity in QUANTITIES:
        if text := summary(comparisons, Case(quantity, setting, batch)):
            yield text


def behind(comparisons: Sequence[Comparison]) -> list[list[str]]:
    """Return one row for each case in which kanegen is not certainly faster than a peer, the worst first.

    Its columns are the model, the quantity, kanegen's setting, the peer with its setting, and the ratio.
    """
    found: list[tuple[float, list[str]]] = []
    for one in comparisons:
        for case in cases(one):
            own = case.own(one)
            for name in peers([one], case):
                peer = case.peer(one, name)
                if own is None or peer is None:
                    continue
                gain = speedup(peer.times, own.times)
                if gain.low <= 1:
                    row = [one.model, case.title, f"{case.participant}, {case.setting.words}"]
                    row += [f"{name}, {peer.setting.words}", table.ratio(own, peer)]
                    found.append((gain.median, row))
    return [row for _, row in sorted(found, key=lambda pair: pair[0])]


def cases(comparison: Comparison) -> Iterator[Case]:
    """Yield every case that a comparison has timed."""
    own = [one for one in comparison.entries if one.participant in (KANEGEN, PYTHON) and one.times.rounds]
    for entry in own:
        yield Case(entry.task.quantity, entry.setting, entry.task.batch, entry.cores, entry.participant)


def gains_of_default(comparisons: Sequence[Comparison], setting: Setting) -> str:
    """Return the table of what the build for a processor gains over portable code; "" without such times."""
    head = ["", *(f"{Case(q, setting, batch).title}" for q in QUANTITIES for batch in (False, True))]
    rows = []
    for one in comparisons:
        cells = [
            table.ratio(
                one.best(KANEGEN, quantity, setting, batch), one.best(KANEGEN, quantity, PORTABLE, batch)
            )
            for quantity in QUANTITIES
            for batch in (False, True)
        ]
        rows.append([one.model, *cells])
    return markdown_table(head, rows) if any(set(row[1:]) != {"-"} for row in rows) else ""


def calls(comparisons: Sequence[Comparison]) -> str:
    """Return the table of calls from C and from Python, and the difference; one row for each model."""
    head, rows = [""], [[comparison.model] for comparison in comparisons]
    for quantity in (EQUATIONS, DYNAMICS):
        head += [f"{table.TITLES[quantity]} from C, ns", "from Python", "beyond"]
        for comparison, row in zip(comparisons, rows, strict=True):
            own, call = comparison.best(KANEGEN, quantity, DEFAULT), comparison.best(PYTHON, quantity)
            beyond = table.ns(comparison.overhead(quantity))
            row += [table.ns(own and own.median), table.ns(call and call.median), beyond]
    return markdown_table(head, rows)


def with_the_same_flags(comparisons: Sequence[Comparison], peer: str, settings: Sequence[Setting]) -> str:
    """Return the table of kanegen over a peer that is compiled with the same flags; "" without such times.

    Args:
        comparisons: One for each model.
        peer: Name of the peer.
        settings: Compiler settings, a column for each of them and each quantity.
    """
    columns = [(quantity, setting) for quantity in (EQUATIONS, DYNAMICS) for setting in settings]
    head = ["", *(f"{table.TITLES[quantity]}, {setting.name}" for quantity, setting in columns)]
    rows = [
        [
            one.model,
            *(table.ratio(*(one.best(name, *column) for name in (KANEGEN, peer))) for column in columns),
        ]
        for one in comparisons
    ]
    return markdown_table(head, rows) if any(set(row[1:]) != {"-"} for row in rows) else ""
