"""The plot docs/growth.svg: one panel for each measure, one line for each curve, on logarithmic axes."""

from __future__ import annotations

from typing import Any

from benchmarks.growth.cases import CURVES, FAMILIES, LARGEST
from benchmarks.growth.results import MEASURES, Measure, Study, series
from kanegen.extras import module
from kanegen.measure.svg import STYLE, svg_text

_PANELS = ("operations", "derive", "generate", "memory", "code", "compile", "text", "run")
_MARKERS = dict(zip(FAMILIES, "os", strict=True))
_COLOURS = {output: f"C{i}" for i, output in enumerate(LARGEST)}


def svg(study: Study) -> str:
    """Draw the file for one state as full lines and the file for many states as dotted lines.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(STYLE):
        figure = module("matplotlib.figure").Figure(figsize=(8, 11), layout="constrained")
        measures = {measure.name: measure for measure in MEASURES}
        panels = figure.subplots(4, 2, sharex=True).flat
        for panel, name in zip(panels, _PANELS, strict=True):
            _panel(panel, study, measures[name])
        for panel in figure.axes[-2:]:
            panel.set_xlabel("bodies")
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, ncols=4, loc="outside upper center")
        return svg_text(figure)


def _panel(panel: Any, study: Study, measure: Measure) -> None:
    highest = 0.0
    for curve in CURVES:
        style = {"color": _COLOURS[curve.output], "marker": _MARKERS[curve.family], "markersize": 3.5}
        for name, line in ((measure.name, "-"), (f"{measure.name} batch", ":")):
            values = [(bodies, value) for bodies, value in series(study.curve(curve), name) if value > 0]
            scaled = [value / measure.unit for _, value in values]
            highest = max([highest, *scaled])
            label = str(curve) if line == "-" else None
            panel.plot([bodies for bodies, _ in values], scaled, linestyle=line, label=label, **style)
    panel.set_xscale("log", base=2)
    panel.set_yscale("log")
    bodies = sorted({point.case.bodies for point in study.points})
    panel.set_xticks(bodies, [str(n) for n in bodies])
    panel.set_ylim(panel.get_ylim())
    panel.plot(
        bodies,
        [highest * n / bodies[-1] for n in bodies],
        color="0.6",
        linewidth=0.8,
        zorder=0,
        label="linear",
    )
    panel.set_title(measure.title)
