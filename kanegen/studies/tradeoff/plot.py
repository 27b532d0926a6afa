"""The pictures of a study: error against time of its variants, and error against work of its simulations."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from typing import Any

from kanegen.extras import module
from kanegen.measure.timing import OBJECTIVES
from kanegen.measure.truth.bounds import FACTOR
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.tradeoff.outcome import SimulationRun, Study
from kanegen.studies.tradeoff.tables import TITLES

STYLE = {"svg.hashsalt": "kanegen", "svg.fonttype": "none", "font.size": 9, "text.parse_math": False}
"""Settings of matplotlib for all pictures; the salt makes the SVG reproducible."""

_MARKS = {"articulated bodies": "o", "factorisation": "s", "cheapest": "o"}

LEAST = 1e-40
"""The error at which an error of 0 is drawn."""

_LINES = {"semi-implicit Euler": ":", "RK4": "-", "RK4, compensated": "-.", "DOP853": "--"}


def tradeoff_svg(study: Study) -> str:
    """Return the picture of a study as SVG: error against time of every variant, a column for each objective.

    The upper row has the errors, from the median to the quantile by which variants are ranked. The lower row
    has the largest errors divided by their bound without its factor.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(STYLE):
        figure = module("matplotlib.figure").Figure(figsize=(10, 7.5), layout="constrained")
        panels = figure.subplots(2, len(OBJECTIVES), sharex="col", sharey="row", squeeze=False)
        for column, objective in enumerate(OBJECTIVES):
            _errors(panels[0][column], study, objective)
            _shares(panels[1][column], study, objective)
            panels[0][column].set_title(f"{study.model}, {TITLES[objective]}")
            panels[1][column].set_xlabel("ns")
        panels[0][0].set_ylabel(f"normwise error, median to {study.options.quantile}")
        panels[1][0].set_ylabel("largest error / u chi formation (4 N + kappa_s)")
        handles = {text: handle for panel in panels.flat for handle, text in _legend(panel)}
        figure.legend(handles.values(), handles.keys(), ncols=4, loc="outside upper center")
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _errors(panel: Any, study: Study, objective: str) -> None:
    """Draw the errors of all variants and the Pareto front."""
    _scatter(panel, study, objective, lambda errors: errors.quantile(study.share))
    for point in study.points(objective):
        ends = (point.item.errors[objective].median, point.error)
        if all(map(math.isfinite, ends)):
            panel.plot([point.time] * 2, [max(end, LEAST) for end in ends], color="0.85", zorder=0)
    best = [confirmed.result for confirmed in study.pareto_fronts[objective]]
    corners = [point for point in study.points(objective) if any(point.item is result for result in best)]
    corners.sort(key=lambda point: point.time)
    panel.step(
        [point.time for point in corners],
        [max(point.error, LEAST) for point in corners],
        where="post",
        color="0.3",
        linewidth=1,
        label="front",
    )


def _shares(panel: Any, study: Study, objective: str) -> None:
    """Draw the errors of all variants in units of their bound, and the promised limit."""
    _scatter(panel, study, objective, lambda errors: errors.bound_share)
    panel.axhline(FACTOR, color="0.3", linewidth=0.8, linestyle="--", label="what is promised")


def _scatter(panel: Any, study: Study, objective: str, figure: Callable[[Measurement], float]) -> None:
    """Draw a figure of the errors of each program against its time; colours are precisions, marks solvers."""
    colours = {name: f"C{number}" for number, name in enumerate(_precisions(study))}
    for point in study.points(objective):
        if point.item.same_as is None:
            variant = point.item.candidate.variant
            style = {"color": colours[variant.precision], "markersize": 4, "linestyle": "", "alpha": 0.8}
            value = figure(point.item.errors[objective])
            if math.isfinite(value):
                mark, name = _MARKS.get(variant.solver, "^"), f"{variant.precision}, {variant.solver}"
                panel.plot(point.time, max(value, LEAST), mark, label=name, **style)
            elif math.isinf(value):
                top = panel.get_xaxis_transform()
                panel.plot(point.time, 0.97, "x", label="no result somewhere", transform=top, **style)
    panel.set_xscale("log")
    panel.set_yscale("log")


def _precisions(study: Study) -> list[str]:
    """Return the precisions of all variants, each once."""
    return list(dict.fromkeys(result.candidate.variant.precision for result in study.results))


def _legend(panel: Any) -> list[tuple[Any, str]]:
    """Return the drawn objects of a panel with their labels."""
    return list(zip(*panel.get_legend_handles_labels(), strict=True))


def simulation_svg(study: Study) -> str:
    """Return the picture of the simulations as SVG: error at the end against the time of all evaluations.

    Every variant has a colour, and every method of integration a line style.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    with mpl.rc_context(STYLE):
        figure = module("matplotlib.figure").Figure(figsize=(8, 6.5), layout="constrained")
        panel = figure.subplots()
        for number, variant in enumerate(dict.fromkeys(run.variant for run in study.runs)):
            own = [run for run in study.runs if run.variant == variant]
            panel.plot([], [], color=f"C{number}", label=variant)
            for method in dict.fromkeys(run.method for run in own):
                _curve(panel, [run for run in own if run.method == method], f"C{number}")
        for method in dict.fromkeys(run.method for run in study.runs):
            panel.plot([], [], color="0.3", linestyle=_LINES[method], label=method)
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_title(f"{study.model}, {study.duration:.3g} s of free motion")
        panel.set_xlabel("ms for all evaluations")
        panel.set_ylabel("error of the coordinates at the end")
        figure.legend(ncols=2, loc="outside upper center")
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _curve(panel: Any, runs: Sequence[SimulationRun], colour: str) -> None:
    """Draw the finite errors of the simulations of one variant with one method."""
    finite = [run for run in runs if math.isfinite(run.error)]
    panel.plot(
        [1e3 * run.work for run in finite],
        [max(run.error, LEAST) for run in finite],
        marker=".",
        color=colour,
        linestyle=_LINES[runs[0].method],
        linewidth=1,
    )
