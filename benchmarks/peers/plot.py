"""The plot: every model's times as a share of Pinocchio's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes

from benchmarks.peers.building import NATIVE
from benchmarks.peers.field import CASADI, PINOCCHIO
from benchmarks.peers.report import Outcome

mpl.use("svg")
mpl.rcParams.update({"svg.hashsalt": "kanegen", "svg.fonttype": "none", "font.size": 9})

from matplotlib import pyplot  # noqa: E402  after the choice of a backend


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    """One panel a quantity, one group of bars a model."""
    figure, panels = pyplot.subplots(2, 1, figsize=(8, 6.4), sharex=True, layout="constrained")
    for panel, (quantity, title) in zip(
        panels, (("equations", "A + f"), ("dynamics", "forward dynamics")), strict=True
    ):
        _panel(panel, outcomes, quantity)
        panel.set_title(f"{title}: time over Pinocchio's")
    panels[0].legend(ncols=3, loc="upper center", fontsize=8)
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def _panel(panel: Axes, outcomes: Sequence[Outcome], quantity: str) -> None:
    series = {
        "CasADi": lambda outcome: outcome.best(CASADI, quantity),
        "kanegen": lambda outcome: outcome.own(NATIVE).get(quantity),
        "kanegen, batch": lambda outcome: outcome.own(NATIVE).get(f"{quantity} batch"),
    }
    for place, (label, time) in enumerate(series.items()):
        heights = [_share(time(outcome), outcome.best(PINOCCHIO, quantity)) for outcome in outcomes]
        starts = [i + 0.27 * (place - 1) for i in range(len(outcomes))]
        bars = panel.bar(starts, heights, width=0.25, label=label)
        texts = [f"1/{1 / height:.0f}" if 0 < height < 1 else "" for height in heights]
        panel.bar_label(bars, texts, fontsize=7)
    panel.axhline(1, color="black", linewidth=0.8)
    panel.set_yscale("log")
    panel.set_ylim(0.003, 2.5)
    panel.set_xticks(range(len(outcomes)), [f"{outcome.model}\n{outcome.n}" for outcome in outcomes])


def _share(own: float | None, theirs: float | None) -> float:
    return 0.0 if own is None or theirs is None else own / theirs
