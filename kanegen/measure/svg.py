"""Pictures of Matplotlib as SVG: the same picture has the same bytes, and its text stays text."""

from __future__ import annotations

import io
import math
from typing import Any

from kanegen.extras import module

STYLE = {"svg.hashsalt": "kanegen", "svg.fonttype": "none", "font.size": 9, "text.parse_math": False}
"""Settings of Matplotlib for all pictures; names of models are no formulas."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def svg_text(figure: Any) -> str:
    """Return a figure of Matplotlib as the text of an SVG file; ticks of logarithmic axes read "10⁻⁵"."""
    ticker = module("matplotlib.ticker")
    for axis in (axis for panel in figure.axes for axis in (panel.xaxis, panel.yaxis)):
        if isinstance(axis.get_major_formatter(), ticker.LogFormatterMathtext):
            axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: power_of_ten(value)))
            axis.set_minor_formatter(ticker.LogFormatter())
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()


def power_of_ten(value: float) -> str:
    """Return a power of ten as text, as in "10⁻⁵"; "" for another number."""
    exponent = round(math.log10(value)) if value > 0 else 0
    is_power = math.isclose(value, 10.0**exponent, rel_tol=1e-9)
    return f"10{str(exponent).translate(_RAISED)}" if is_power else ""
