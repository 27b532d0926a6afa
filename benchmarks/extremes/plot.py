"""The picture: errors and limits over length, mass ratio and distance to gimbal lock."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from benchmarks.extremes.document import Results
from benchmarks.extremes.rows import Point, Row
from kanegen.bench.optional import module

_STYLE = {"svg.hashsalt": "kanegen", "svg.fonttype": "none", "font.size": 9}
PANELS = {
    "X1": ("straight chain", "bodies", ""),
    "X4": ("8 rods, masses by a factor", "factor from body to body, outward", "any ratio"),
    "X7": ("next to gimbal lock, all 4 bodies", "distance, rad; leftmost: pi/2 rounded", "N = 4"),
}
"""By subject: title, axis, and how the names of its rows begin."""

_NOWHERE = 1e-17
"""Where distance 0 and error 0 stand on logarithmic axes."""


def svg(results: Results) -> str:
    """Points are the largest errors, lines the limits there.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(_STYLE):
        figure = module("matplotlib.figure").Figure(figsize=(10, 3.6), layout="constrained")
        panels = figure.subplots(1, len(PANELS), sharey=True)
        for panel, (number, words) in zip(panels, PANELS.items(), strict=True):
            _panel(panel, results[number], *words)
        panels[0].set_ylabel("normwise error")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, ncols=4, loc="outside upper center")
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _panel(panel: Any, rows: Sequence[Row], title: str, axis: str, start: str) -> None:
    for row in rows:
        precision = row.case.split()[-1]
        if not row.case.startswith(start) or not row.curve:
            continue
        places = sorted({point.at for point in row.curve})
        tops = [max(p.figure for p in _at(row, place)) for place in places]
        limits = [min(p.limit for p in _at(row, place)) for place in places]
        across = [max(place, _NOWHERE) for place in places]
        colour = {"double": "C0", "float": "C1"}[precision]
        panel.plot(
            across, [max(top, _NOWHERE) for top in tops], "o", color=colour, markersize=3.5, label=precision
        )
        panel.plot(across, limits, "-", color=colour, linewidth=0.8, label=f"limit, {precision}")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_title(title)
    panel.set_xlabel(axis)


def _at(row: Row, place: float) -> list[Point]:
    return [point for point in row.curve if point.at == place]
