"""The plot of comparisons: how many times as fast as the standard every program is, on a logarithmic axis."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.extras import module
from kanegen.measure.svg import STYLE, svg_text
from kanegen.measure.timing import Speedup, speedup
from kanegen.studies.bench.comparison import KANEGEN, Comparison, Entry
from kanegen.studies.bench.peers.casadi_peer import CASADI
from kanegen.studies.bench.peers.dynibo_peer import DYNIBO
from kanegen.studies.bench.peers.mujoco_peer import MUJOCO
from kanegen.studies.bench.peers.pinocchio_code_peer import PINOCCHIO_CODE
from kanegen.studies.bench.peers.pinocchio_peer import PINOCCHIO
from kanegen.studies.bench.peers.pydy_peer import PYDY
from kanegen.studies.bench.results import DERIVATIVES, DYNAMICS, EQUATIONS, INVERSE_DERIVATIVES
from kanegen.studies.bench.settings import DEFAULT, Setting
from kanegen.studies.bench.table import TITLES

_PANELS = (EQUATIONS, DYNAMICS, INVERSE_DERIVATIVES, DERIVATIVES)
"""The quantities of the panels, row by row."""

_TICKS = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200)
"""Numbers at the axis, as far as there are marks."""


@dataclass(frozen=True)
class Series:
    """The marks of one program: its fastest task on each model.

    Attributes:
        label: Text of the legend.
        participant: Name of the participant.
        marker: Matplotlib's name of the mark.
        color: Matplotlib's name of its colour.
        setting: Compiler setting; None allows every setting.
        batch: Whether the task computes many states in one call.
    """

    label: str
    participant: str
    marker: str
    color: str
    setting: Setting | None = None
    batch: bool = False

    def entry(self, comparison: Comparison, quantity: str) -> Entry | None:
        """Return the entry of a model; None if there is none."""
        return comparison.best(self.participant, quantity, self.setting, self.batch)


SERIES = (
    Series(PINOCCHIO, PINOCCHIO, "|", "0.2"),
    Series(PYDY, PYDY, "x", "tab:brown"),
    Series(DYNIBO, DYNIBO, "v", "tab:pink"),
    Series(MUJOCO, MUJOCO, "s", "tab:orange"),
    Series(PINOCCHIO_CODE, PINOCCHIO_CODE, "^", "tab:olive"),
    Series(CASADI, CASADI, "P", "tab:green"),
    Series(KANEGEN, KANEGEN, "o", "tab:blue", DEFAULT),
    Series(f"{KANEGEN}, batch", KANEGEN, "D", "tab:purple", DEFAULT, batch=True),
)


def svg(comparisons: Sequence[Comparison]) -> str:
    """Draw one panel for each quantity, in it a line for each model with a mark for each program.

    A mark stands at the number of states that a program computes while the standard computes one; a line
    through it is the confidence interval.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(STYLE):
        size = (9, 1.8 + 0.5 * len(comparisons))
        figure = module("matplotlib.figure").Figure(figsize=size, layout="constrained")
        panels = figure.subplots(2, len(_PANELS) // 2, sharex=True, sharey=True)
        for panel, quantity in zip(panels.flat, _PANELS, strict=True):
            _panel(panel, comparisons, quantity)
        figure.supxlabel(
            f"times as fast as {' or '.join(dict.fromkeys(one.standard for one in comparisons))}"
        )
        known = {
            label: mark
            for panel in panels.flat
            for mark, label in zip(*panel.get_legend_handles_labels(), strict=True)
        }
        ordered = [one.label for one in SERIES if one.label in known]
        figure.legend([known[label] for label in ordered], ordered, ncols=4, loc="outside upper center")
        return svg_text(figure)


def _panel(panel: Any, comparisons: Sequence[Comparison], quantity: str) -> None:
    """Draw the panel of one quantity."""
    for series in SERIES:
        marks = list(_marks(series, comparisons, quantity))
        if marks:
            panel.errorbar(
                [found.median for _, found in marks],
                [place for place, _ in marks],
                xerr=list(zip(*(_reach(found) for _, found in marks), strict=True)),
                label=series.label,
                color=series.color,
                marker=series.marker,
                markersize=5,
                elinewidth=1,
                linestyle="none",
            )
    panel.set_title(TITLES[quantity], fontsize="medium")
    panel.set_xscale("log")
    panel.set_xticks(_TICKS, [f"{tick:g}" for tick in _TICKS], fontsize="small")
    panel.minorticks_off()
    panel.axvline(1, color="0.8", linewidth=1, zorder=0)
    panel.grid(axis="y", color="0.92")
    panel.set_axisbelow(True)
    panel.set_yticks(range(len(comparisons)), [f"{one.model}, n = {one.n}" for one in comparisons])
    panel.set_ylim(len(comparisons) - 0.5, -0.5)


def _reach(found: Speedup) -> tuple[float, float]:
    """Return how far the confidence interval reaches to the left and to the right; 0 with too few rounds."""
    has_interval = math.isfinite(found.high)
    return (found.median - found.low, found.high - found.median) if has_interval else (0.0, 0.0)


def _marks(series: Series, comparisons: Sequence[Comparison], quantity: str) -> Iterator[tuple[int, Speedup]]:
    """Yield the places of models and how many times as fast as the standard the series is there."""
    for place, comparison in enumerate(comparisons):
        standard = comparison.best(comparison.standard, quantity)
        entry = series.entry(comparison, quantity)
        if standard is not None and entry is not None:
            yield place, speedup(standard.times, entry.times)
