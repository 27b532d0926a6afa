"""Pictures of Matplotlib as SVG: the same picture has the same bytes, and its text stays text."""

from __future__ import annotations

import io
from typing import Any

STYLE = {"svg.hashsalt": "kanegen", "svg.fonttype": "none", "font.size": 9, "text.parse_math": False}
"""Settings of Matplotlib for all pictures; names of models are no formulas."""


def svg_text(figure: Any) -> str:
    """Return a figure of Matplotlib as the text of an SVG file."""
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()
