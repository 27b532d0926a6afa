"""The picture: time against error, both logarithmic, for one state a call and for batches."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from typing import Any

from kanegen.extras import module
from kanegen.measure.timing import OBJECTIVES
from kanegen.measure.truth.bounds import FACTOR
from kanegen.measure.truth.measurement import Measurement
from kanegen.studies.tradeoff.outcome import Run, Study
from kanegen.studies.tradeoff.tables import TITLES

STYLE = {"svg.hashsalt": "kanegen", "svg.fonttype": "none", "font.size": 9}
_MARKS = {"articulated bodies": "o", "factorisation": "s", "cheapest": "o"}
LEAST = 1e-40
"""Where an error of 0 stands."""


def tradeoff_svg(study: Study) -> str:
    """Above, errors, from the median to the one that counts; below, the largest over what the problem costs.

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
        panels[0][0].set_ylabel(f"normwise error, median to {study.terms.quantile}")
        panels[1][0].set_ylabel("largest error / u chi formation (4 N + kappa_s)")
        handles = {text: handle for panel in panels.flat for handle, text in _legend(panel)}
        figure.legend(handles.values(), handles.keys(), ncols=4, loc="outside upper center")
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def _errors(panel: Any, study: Study, objective: str) -> None:
    _scatter(panel, study, objective, lambda errors: errors.quantile(study.share))
    for point in study.points(objective):
        ends = (point.what.errors[objective].median, point.error)
        if all(map(math.isfinite, ends)):
            panel.plot([point.time] * 2, [max(end, LEAST) for end in ends], color="0.85", zorder=0)
    best = [confirmed.entry for confirmed in study.fronts[objective]]
    corners = [point for point in study.points(objective) if any(point.what is entry for entry in best)]
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
    _scatter(panel, study, objective, lambda errors: errors.bound_share)
    panel.axhline(FACTOR, color="0.3", linewidth=0.8, linestyle="--", label="what is promised")


def _scatter(panel: Any, study: Study, objective: str, figure: Callable[[Measurement], float]) -> None:
    colours = {name: f"C{number}" for number, name in enumerate(_precisions(study))}
    for point in study.points(objective):
        if point.what.same_as is None:
            variant = point.what.candidate.variant
            style = {"color": colours[variant.precision], "markersize": 4, "linestyle": "", "alpha": 0.8}
            value = figure(point.what.errors[objective])
            if math.isfinite(value):
                mark, name = _MARKS.get(variant.solver, "^"), f"{variant.precision}, {variant.solver}"
                panel.plot(point.time, max(value, LEAST), mark, label=name, **style)
            elif math.isinf(value):
                top = panel.get_xaxis_transform()
                panel.plot(point.time, 0.97, "x", label="no result somewhere", transform=top, **style)
    panel.set_xscale("log")
    panel.set_yscale("log")


def _precisions(study: Study) -> list[str]:
    return list(dict.fromkeys(entry.candidate.variant.precision for entry in study.entries))


def _legend(panel: Any) -> list[tuple[Any, str]]:
    return list(zip(*panel.get_legend_handles_labels(), strict=True))


_LINES = {"semi-implicit Euler": ":", "RK4": "-", "RK4, compensated": "-.", "DOP853": "--"}


def simulation_svg(study: Study) -> str:
    """Work against error: a colour for every variant, a kind of line for every method.

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


def _curve(panel: Any, runs: Sequence[Run], colour: str) -> None:
    finite = [run for run in runs if math.isfinite(run.error)]
    panel.plot(
        [1e3 * run.work for run in finite],
        [max(run.error, LEAST) for run in finite],
        marker=".",
        color=colour,
        linestyle=_LINES[runs[0].method],
        linewidth=1,
    )
