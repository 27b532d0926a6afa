"""Simulations of a study in words and as a picture."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any

from kanegen.extras import module
from kanegen.studies.tradeoff.outcome import Run, Study
from kanegen.studies.tradeoff.plot import LEAST, STYLE

LEVELS = tuple(10.0**-k for k in range(1, 14, 2))
"""Errors at which the cheapest way is told."""

HEAD = ["error below", "variant", "method", "setting", "evaluations", "ms", "error"]
"""Heads of the columns of `cheapest`."""

TEXTS = 4
"""How many of them are text, before those of numbers."""

_METHOD = """
A free motion of {study.duration:.3g} s from one state, by the variants on the front for one state a call
whose speeds are rates of coordinates, and by the default. *ms* is the time of all evaluations of forward
dynamics together; what an integrator does beside them does not count. *error* is that of the coordinates at
the end, relative to 1 rad or 1 m and their size, from a reference in long double with much smaller steps. The
table has the least work with which an error is reached; {failed} of {count} simulations failed.
"""

_LINES = {"semi-implicit Euler": ":", "RK4": "-", "RK4, compensated": "-.", "DOP853": "--"}


def cheapest(study: Study) -> list[list[str]]:
    """For every error that is reached, the way that takes the least time of evaluations."""
    rows = []
    for level in LEVELS:
        enough = [run for run in study.runs if run.error <= level]
        if enough:
            best = min(enough, key=lambda run: run.work)
            figures = [str(best.evaluations), f"{1e3 * best.work:.3g}", f"{best.error:.1e}"]
            rows.append([f"{level:.0e}", best.variant, best.method, best.setting, *figures])
    return rows


def explained(study: Study) -> str:
    """What was simulated."""
    failed = sum(not math.isfinite(run.error) for run in study.runs)
    return " ".join(_METHOD.format(study=study, failed=failed, count=len(study.runs)).split())


def svg(study: Study) -> str:
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
