"""What is printed: a table a model, and summaries of kanegen over its peers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchmarks.peers.building import Setting
from benchmarks.peers.contest import Entry
from benchmarks.peers.field import CASADI, FREE_FLYER, KANEGEN, PINOCCHIO

LABELS = {
    "equations": "A + f",
    "equations batch": "A + f, batch",
    "dynamics": "forward dynamics",
    "dynamics batch": "forward dynamics, batch",
    "aba": "forward dynamics, `aba`",
    "cholesky": "forward dynamics, `crba` + Cholesky",
}
QUANTITIES = {"equations": "A + f", "dynamics": "forward dynamics"}


@dataclass(frozen=True)
class Outcome:
    """One model: its number of freedoms, every entry, and who was left out for what reason."""

    model: str
    n: int
    entries: tuple[Entry, ...]
    missing: tuple[str, ...]

    def best(self, peer: str, quantity: str) -> float | None:
        """Smallest median of a peer in its ways to compute a quantity, ns."""
        times = [e.median for e in self._timed(peer) if e.task.quantity == quantity]
        return min(times, default=None)

    def own(self, setting: Setting) -> dict[str, float]:
        """kanegen's medians by task, ns."""
        return {e.task.name: e.median for e in self._timed(KANEGEN) if e.setting == setting}

    def _timed(self, contestant: str) -> list[Entry]:
        return [entry for entry in self.entries if entry.contestant == contestant and entry.times]


def table(outcome: Outcome) -> str:
    """A Markdown table of one model, A + f first."""
    head = ["", "compiler", "task", "ns, median", "range", "over Pinocchio", "difference"]
    ordered = sorted(outcome.entries, key=lambda entry: entry.task.quantity != "equations")
    lines = [
        f"### {outcome.model}, {outcome.n} freedoms",
        "",
        *_markdown(head, 3, [_row(outcome, entry) for entry in ordered]),
        "",
        *(f"Left out: {reason}." for reason in outcome.missing),
    ]
    return "\n".join(lines)


def summary(outcomes: Sequence[Outcome], setting: Setting, batch: bool = False) -> str:
    """One line a model: kanegen compiled in one setting over its peers, one state at a time or many."""
    peers = (PINOCCHIO, FREE_FLYER, CASADI)
    unit = "ns a state" if batch else "ns"
    head = ["", "freedoms"]
    for title in QUANTITIES.values():
        head += [f"{title}, {unit}", *(f"over {peer}" for peer in peers)]
    rows = []
    for outcome in outcomes:
        row, own = [outcome.model, str(outcome.n)], outcome.own(setting)
        for quantity in QUANTITIES:
            mine = own.get(f"{quantity} batch" if batch else quantity)
            row += [_ns(mine), *(_ratio(mine, outcome.best(peer, quantity)) for peer in peers)]
        rows.append(row)
    return "\n".join(_markdown(head, 1, rows))


def _row(outcome: Outcome, entry: Entry) -> list[str]:
    row = [entry.contestant, entry.setting.name, LABELS[entry.task.name]]
    if not entry.times:
        return [*row, "not timed", "", "", f"{entry.error:.0e}"]
    ratio = _ratio(entry.median, outcome.best(PINOCCHIO, entry.task.quantity))
    spread = f"{_ns(min(entry.times))}-{_ns(max(entry.times))}"
    return [*row, _ns(entry.median), spread, ratio, f"{entry.error:.0e}"]


def _markdown(head: Sequence[str], texts: int, rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Lines of a table whose first `texts` columns are text, the others numbers."""
    rule = ["---"] * texts + ["---:"] * (len(head) - texts)
    for row in (head, rule, *rows):
        yield f"| {' | '.join(row)} |"


def _ns(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def _ratio(part: float | None, whole: float | None) -> str:
    """`part` over `whole`, as 1/r where it is smaller."""
    if whole is None or part is None:
        return "-"
    return f"1/{whole / part:.1f}" if whole > part else f"{part / whole:.2f}"
