"""The pictures of a study: error against time of its variants, and error against work of its simulations."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from kanegen.extras import module
from kanegen.measure.svg import STYLE, svg_text
from kanegen.measure.timing import OBJECTIVES
from kanegen.measure.truth.bounds import FACTOR
from kanegen.measure.truth.measurement import Measurement
from kanegen.options import STRICT
from kanegen.studies.tradeoff.outcome import SimulationRun, Study, VariantResult
from kanegen.studies.tradeoff.pareto_front import Point
from kanegen.studies.tradeoff.tables import TITLES
from kanegen.studies.tradeoff.variants import Candidate

_MARKS = {"articulated bodies": "o", "factorisation": "s", "cheapest": "o"}

LEAST = 1e-40
"""The error at which an error of 0 is drawn."""

WIDEST_GAP = 4.0
"""Decades without any error that a picture shows; it leaves out wider gaps."""

_ERRORS_HEIGHT, _SHARES_HEIGHT, _LINE_HEIGHT, _FRAME_HEIGHT = 4.2, 1.8, 0.15, 1.6
"""Heights (inches) of the errors, of the errors over bounds, of a line of the key, and of what is around."""

_LINES = {"semi-implicit Euler": ":", "RK4": "-", "RK4, compensated": "-.", "DOP853": "--"}


def tradeoff_svg(study: Study) -> str:
    """Return the picture of a study as SVG: error against time of every variant, a column for each objective.

    The upper rows have the errors, from the median to the quantile by which variants are ranked. Their axis
    is broken where no variant has an error. The last row has the largest errors divided by their bound
    without its factor. Numbers mark the Pareto front and a star the default; a key below has their names.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl = module("matplotlib")
    bands = error_bands(_drawn_errors(study))
    key_height = _LINE_HEIGHT * max(len(study.pareto_fronts[objective]) for objective in OBJECTIVES)
    decades = sum(map(_decades, bands))
    inches = [_ERRORS_HEIGHT * _decades(band) / decades for band in bands]
    with mpl.rc_context(STYLE):
        size = (10, _ERRORS_HEIGHT + _SHARES_HEIGHT + key_height + _FRAME_HEIGHT)
        figure = module("matplotlib.figure").Figure(figsize=size, layout="constrained")
        figure.get_layout_engine().set(hspace=0, h_pad=0.04)
        rows = [*inches, _SHARES_HEIGHT, key_height]
        panels = figure.subplots(len(rows), len(OBJECTIVES), sharey="row", squeeze=False, height_ratios=rows)
        for column, objective in enumerate(OBJECTIVES):
            for row, band in enumerate(bands):
                _errors(panels[row][column], study, objective)
                panels[row][column].set_ylim(*band)
                _break_axis(panels[row][column], above=row > 0, below=row < len(bands) - 1)
            _shares(panels[-2][column], study, objective)
            panels[0][column].set_title(f"{study.model}, {TITLES[objective]}")
            panels[-2][column].set_xlabel("ns")
            for panel in panels[:-2, column]:
                panel.sharex(panels[-2][column])
                panel.tick_params(labelbottom=False)
            panels[-1][column].axis("off")
            panels[-1][column].text(0, 1, "\n".join(_key(study, objective)), va="top", fontsize=7.5)
        widest = max(range(len(bands)), key=inches.__getitem__)
        panels[widest][0].set_ylabel(f"normwise error, median to {study.options.quantile}")
        panels[-2][0].set_ylabel("error / u chi\nformation (4 N + kappa_s)")
        handles = {text: handle for panel in panels.flat for handle, text in _legend(panel)}
        figure.legend(handles.values(), handles.keys(), ncols=4, loc="outside upper center")
        return svg_text(figure)


def error_bands(errors: Sequence[float]) -> list[tuple[float, float]]:
    """Return the ranges of errors that a picture shows, the largest first, each half a decade wider.

    Two ranges are apart where more than `WIDEST_GAP` decades hold no error.
    """
    groups: list[list[float]] = []
    for value in sorted(math.log10(max(error, LEAST)) for error in errors if math.isfinite(error)):
        if not groups or value - groups[-1][-1] > WIDEST_GAP:
            groups.append([])
        groups[-1].append(value)
    bands = [(10 ** (group[0] - 0.5), 10 ** (group[-1] + 0.5)) for group in reversed(groups)]
    return bands or [(LEAST, 1.0)]


def _drawn_errors(study: Study) -> list[float]:
    """Return every error that is drawn: medians, and the quantiles by which variants are ranked."""
    found: list[float] = []
    for objective in OBJECTIVES:
        for point in (*study.points(objective), *study.reformulated_points(objective)):
            found += [point.error, point.item.errors[objective].median]
    return found


def _decades(band: tuple[float, float]) -> float:
    """Return the width of a range of errors in decades."""
    return math.log10(band[1] / band[0])


def _break_axis(panel: Any, *, above: bool, below: bool) -> None:
    """Take away the frame where an axis goes on in the panel above or below, and mark the break."""
    style = {"color": "0.3", "linestyle": "", "marker": [(-1, -0.6), (1, 0.6)], "markersize": 7}
    for is_broken, spine, place in ((above, "top", 1), (below, "bottom", 0)):
        if is_broken:
            panel.spines[spine].set_visible(False)
            panel.plot([0, 1], [place] * 2, transform=panel.transAxes, clip_on=False, **style)
    if below:
        panel.tick_params(bottom=False, which="both")


def _key(study: Study, objective: str) -> list[str]:
    """Return a line for each number of a column of the picture: the variants on its Pareto front."""
    return [f"{number}  {label}" for label, number in _numbers(study, objective).items()]


def _numbers(study: Study, objective: str) -> dict[str, int]:
    """Return the numbers of the variants on a Pareto front by label, the fastest first."""
    front = study.pareto_fronts[objective]
    return {confirmed.result.label: number for number, confirmed in enumerate(front, start=1)}


def _errors(panel: Any, study: Study, objective: str) -> None:
    """Draw the errors of all variants and the Pareto front."""
    _scatter(panel, study, objective, lambda errors: errors.quantile(study.share))
    every = [*study.points(objective), *study.reformulated_points(objective)]
    for point in every:
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
    _mark(panel, study, objective, every)


def _mark(panel: Any, study: Study, objective: str, every: Sequence[Point[VariantResult]]) -> None:
    """Number the variants on the Pareto front, above and below it in turn, and name the default."""
    numbers = _numbers(study, objective)
    for point in every:
        if not math.isfinite(point.error):
            continue
        place = (point.time, max(point.error, LEAST))
        number = numbers.get(point.item.label)
        if number is not None:
            offset = (-7, 5) if number % 2 else (5, -10)
            style = {"textcoords": "offset points", "fontsize": 8, "annotation_clip": True}
            panel.annotate(str(number), place, offset, fontweight="bold", **style)
        if point.item.candidate == Candidate(STRICT):
            panel.plot(*place, "*", color="k", markersize=9, linestyle="", label="default", zorder=5)


def _shares(panel: Any, study: Study, objective: str) -> None:
    """Draw the errors of all variants in units of their bound, and the promised limit."""
    _scatter(panel, study, objective, lambda errors: errors.bound_share)
    panel.axhline(FACTOR, color="0.3", linewidth=0.8, linestyle="--", label="what is promised")


def _scatter(panel: Any, study: Study, objective: str, figure: Callable[[Measurement], float]) -> None:
    """Draw a figure of the errors of each program against its time; colours are precisions, marks solvers.

    Variants with other coordinates or speeds are hollow.
    """
    colours = {name: f"C{number}" for number, name in enumerate(_precisions(study))}
    for point in (*study.points(objective), *study.reformulated_points(objective)):
        if point.item.same_as is None:
            variant, value = point.item.candidate.variant, figure(point.item.errors[objective])
            style = {"color": colours[variant.precision], "markersize": 4, "linestyle": "", "alpha": 0.8}
            mark, name = _MARKS.get(variant.solver, "^"), f"{variant.precision}, {variant.solver}"
            if point.item.candidate.changes_system:
                style["markerfacecolor"], name = "none", "other coordinates or speeds"
            if math.isfinite(value):
                panel.plot(point.time, max(value, LEAST), mark, label=name, **style)
            elif math.isinf(value):
                top = panel.get_xaxis_transform()
                panel.plot(point.time, 0.97, "x", label="no result somewhere", transform=top, **style)
    logarithmic(panel)


def logarithmic(panel: Any) -> None:
    """Make both axes of a panel logarithmic, with powers of ten as numbers at their ticks."""
    ticker = module("matplotlib.ticker")
    panel.set_xscale("log")
    panel.set_yscale("log")
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: _power(value)))
        axis.set_minor_formatter(ticker.NullFormatter())


def _power(value: float) -> str:
    """Return the text of a number at a tick, such as 100 or 1e-15."""
    return f"{value:g}" if 0.001 <= value < 1e5 else f"{value:.0e}"


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
        logarithmic(panel)
        panel.set_title(f"{study.model}, {study.duration:.3g} s of free motion")
        panel.set_xlabel("ms for all evaluations")
        panel.set_ylabel("error of the coordinates at the end")
        figure.legend(ncols=2, loc="outside upper center")
        return svg_text(figure)


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
