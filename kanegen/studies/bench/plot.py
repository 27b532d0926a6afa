"""The plot of comparisons: the times of all programs on all models, with ranges, on a logarithmic axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.extras import module
from kanegen.measure.svg import STYLE, svg_text
from kanegen.studies.bench.comparison import KANEGEN, Comparison, Entry
from kanegen.studies.bench.peers.casadi_peer import CASADI
from kanegen.studies.bench.peers.mujoco_peer import MUJOCO
from kanegen.studies.bench.peers.pinocchio_peer import PINOCCHIO
from kanegen.studies.bench.peers.pydy_peer import PYDY
from kanegen.studies.bench.results import QUANTITIES
from kanegen.studies.bench.settings import CONTRACTED, Setting
from kanegen.studies.bench.table import TITLES, ratio

_BAR = 0.8
"""Width of all bars of a model together, as a share of the distance between models."""

_ROOM_FOR_LABELS = 8.0
"""Factor by which the axis of times goes on above the tallest bar, for the label above it."""


@dataclass(frozen=True)
class Series:
    """The bars of one colour: the fastest task of a participant on each model.

    Attributes:
        label: Text of the legend.
        participant: Name of the participant.
        setting: Compiler setting; None allows every setting.
        batch: Whether the task computes many states in one call.
    """

    label: str
    participant: str
    setting: Setting | None = None
    batch: bool = False

    def entry(self, comparison: Comparison, quantity: str) -> Entry | None:
        """Return the entry that the bar of a model shows; None if there is none."""
        return comparison.best(self.participant, quantity, self.setting, self.batch)


SERIES = (
    *(Series(name, name) for name in (PINOCCHIO, MUJOCO, CASADI, PYDY)),
    Series(KANEGEN, KANEGEN, CONTRACTED),
    Series(f"{KANEGEN}, batch", KANEGEN, CONTRACTED, batch=True),
)


def svg(comparisons: Sequence[Comparison]) -> str:
    """Draw one panel for each quantity and one group of bars for each model.

    The label of a bar is its ratio to the standard.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(STYLE):
        size = (max(5.0, 2 + 1.3 * len(comparisons)), 7)
        figure = module("matplotlib.figure").Figure(figsize=size, layout="constrained")
        panels = figure.subplots(len(QUANTITIES), 1, sharex=True)
        for panel, quantity in zip(panels, QUANTITIES, strict=True):
            _panel(panel, comparisons, quantity)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, ncols=3, loc="outside upper center")
        return svg_text(figure)


def _panel(panel: Any, comparisons: Sequence[Comparison], quantity: str) -> None:
    """Draw the panel of one quantity."""
    present = [
        series
        for series in SERIES
        if any(series.entry(comparison, q) for comparison in comparisons for q in QUANTITIES)
    ]
    width = _BAR / len(present)
    for number, series in enumerate(present):
        shift = width * (number - (len(present) - 1) / 2)
        entries = {
            place + shift: series.entry(comparison, quantity) for place, comparison in enumerate(comparisons)
        }
        timed = {place: entry for place, entry in entries.items() if entry is not None}
        medians = [entry.median for entry in timed.values()]
        ranges = [
            [entry.median - entry.times.least for entry in timed.values()],
            [entry.times.largest - entry.median for entry in timed.values()],
        ]
        color = f"C{SERIES.index(series)}"
        bars = panel.bar(
            list(timed), medians, 0.92 * width, yerr=ranges, label=series.label, color=color, ecolor="0.3"
        )
        standards = [comparison.best(comparison.standard, quantity) for comparison in comparisons]
        shares = [_share(entry, standards[round(place)]) for place, entry in timed.items()]
        panel.bar_label(bars, shares, fontsize=6, padding=2, rotation=90)
    panel.set_yscale("log")
    panel.set_ylim(bottom=1, top=_ROOM_FOR_LABELS * panel.get_ylim()[1])
    panel.set_ylabel(f"{TITLES[quantity]}, ns")
    panel.set_xticks(
        range(len(comparisons)), [f"{comparison.model}\nn = {comparison.n}" for comparison in comparisons]
    )


def _share(entry: Entry, standard: Entry | None) -> str:
    """Return the ratio of a time to that of the standard; "" for the standard itself."""
    return "" if entry is standard else ratio(entry, standard)
