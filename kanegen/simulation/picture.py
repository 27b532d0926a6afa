"""The picture of a motion: columns over the time, those of one unit in one panel."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

from kanegen.extras import module
from kanegen.measure.svg import STYLE, svg_text
from kanegen.model.arguments import Floats

EXTRA = "plot"
"""The extra that brings Matplotlib."""

FORMATS = (".svg", ".png", ".pdf")
"""Ends of the names of files of pictures."""

WIDTH, HEIGHT = 7.0, 2.2
"""Width of a picture, and height of a panel, in inches."""


def figure(
    title: str, times: Floats, columns: Mapping[str, Floats], units: Mapping[str, str], caption: str
) -> Any:
    """Return a picture of columns over the time as a `matplotlib.figure.Figure`.

    Args:
        title: Name of the model.
        times: (T,) times, s.
        columns: Columns by name, (T,) or (T, ...).
        units: Unit of each column.
        caption: Text below the picture.
    """
    matplotlib = module("matplotlib", extra=EXTRA)
    panels: dict[str, list[str]] = {}
    for name in columns:
        panels.setdefault(units[name], []).append(name)
    with matplotlib.rc_context(STYLE):
        made = module("matplotlib.figure", extra=EXTRA).Figure(
            figsize=(WIDTH, HEIGHT * len(panels) + 0.8), layout="constrained"
        )
        axes = made.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        for panel, (unit, names) in zip(axes, panels.items(), strict=True):
            for name in names:
                _draw(panel, times, name, columns[name])
            panel.set_ylabel(unit)
            panel.grid(alpha=0.3)
            panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8, frameon=False)
        axes[0].set_title(title)
        axes[-1].set_xlabel("t in s")
        made.supxlabel(caption, fontsize=8)
    return made


def _draw(panel: Any, times: Floats, name: str, values: Floats) -> None:
    """Draw a column, or several of an output or of many states, as lines of one colour each."""
    flat = values.reshape(len(times), -1)
    lines = panel.plot(times, flat, linewidth=1.0)
    for line in lines[1:]:
        line.set_color(lines[0].get_color())
    lines[0].set_label(name)


def picture_file(made: Any, suffix: str) -> bytes:
    """Return the content of a file of a picture, which has no date in it.

    Args:
        made: The picture, from `figure`.
        suffix: One of `FORMATS`.
    """
    if suffix == ".svg":
        with module("matplotlib", extra=EXTRA).rc_context(STYLE):
            return svg_text(made).encode()
    content = io.BytesIO()
    made.savefig(
        content, format=suffix[1:], dpi=150, metadata={"CreationDate": None} if suffix == ".pdf" else {}
    )
    return content.getvalue()
