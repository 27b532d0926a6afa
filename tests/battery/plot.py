"""The plot docs/extremes.svg: figures and limits over length, mass ratio, distance to gimbal lock and
time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.extras import module
from kanegen.measure.svg import STYLE, svg_text
from tests.battery.experiments import Point, Row
from tests.battery.report import Results


@dataclass(frozen=True)
class Panel:
    """One panel of the plot.

    Attributes:
        title: Title.
        across: Label of the horizontal axis.
        up: Label of the vertical axis.
        series: Beginning and end of the case of a row, by label of its curve.
        limits: Whether limits are drawn.
    """

    title: str
    across: str
    up: str
    series: dict[str, tuple[str, str]]
    limits: bool = True


def _both(start: str) -> dict[str, tuple[str, str]]:
    return {precision: (start, precision) for precision in ("double", "float")}


_ERROR = "normwise error"
PANELS = {
    "X1": Panel("straight chain", "bodies", _ERROR, _both("")),
    "X4": Panel(
        "8 rods, masses by a factor", "factor from body to body, outward", _ERROR, _both("any ratio")
    ),
    "X7": Panel(
        "next to gimbal lock, all 4 bodies", "distance, rad; leftmost: pi/2 rounded", _ERROR, _both("N = 4")
    ),
    "X8": Panel("the same, angular velocities", "distance, rad", _ERROR, _both("N = 4")),
    "X9": Panel(
        "passage next to gimbal lock, DOP853",
        "distance, rad",
        "evaluations",
        {
            name: (f"evaluations, {name}", "")
            for name in ("angle rates", "angular velocity", "joint frame turned")
        },
        limits=False,
    ),
    "X23": Panel(
        "pendulum over time",
        "time, s",
        "distance from where it is, m",
        {
            name: (name, "")
            for name in (
                "RK4, step 5 ms, float",
                "RK4, step 5 ms, compensated, float",
                "RK4, step 5 ms, double",
                "DOP853, tolerance 1e-12, double",
            )
        },
        limits=False,
    ),
}
"""The panels by number of the experiment."""

_NOWHERE = 1e-17
"""Place of distance 0 and error 0 on logarithmic axes."""


def svg(results: Results) -> str:
    """Draw the largest figures as points and the limits as lines.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(STYLE):
        figure = module("matplotlib.figure").Figure(figsize=(10, 8), layout="constrained")
        places = figure.subplots(2, -(-len(PANELS) // 2)).ravel()
        for place, (number, panel) in zip(places, PANELS.items(), strict=True):
            _draw(place, results[number], panel)
        return svg_text(figure)


def _draw(place: Any, rows: Sequence[Row], panel: Panel) -> None:
    for number, (label, (start, end)) in enumerate(panel.series.items()):
        row = next(row for row in rows if row.case.startswith(start) and row.case.endswith(end) and row.curve)
        across = sorted({point.at for point in row.curve})
        tops = [max(p.figure for p in _at(row, x)) for x in across]
        limits = [min(p.limit for p in _at(row, x)) for x in across]
        places, colour = [max(x, _NOWHERE) for x in across], f"C{number}"
        few = len(across) < 50
        style: dict[str, Any] = (
            {"marker": "o", "markersize": 3.5, "linestyle": ""} if few else {"linewidth": 1}
        )
        if few and not panel.limits:
            style |= {"linestyle": "-", "linewidth": 0.8}
        place.plot(places, [max(top, _NOWHERE) for top in tops], color=colour, label=label, **style)
        if panel.limits:
            place.plot(places, limits, "-", color=colour, linewidth=0.8, label=f"limit, {label}")
    place.set_xscale("log")
    place.set_yscale("log")
    place.set_title(panel.title)
    place.set_xlabel(panel.across)
    place.set_ylabel(panel.up)
    place.legend(fontsize=6, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)


def _at(row: Row, place: float) -> list[Point]:
    return [point for point in row.curve if point.at == place]
