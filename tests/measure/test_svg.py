"""Pictures as SVG: the text of logarithmic axes."""

from __future__ import annotations

import matplotlib
from matplotlib.figure import Figure

from kanegen.measure.svg import STYLE, power_of_ten, svg_text


def test_ticks_of_logarithmic_axes_read_as_powers_of_ten() -> None:
    with matplotlib.rc_context(STYLE):
        figure = Figure()
        panel = figure.subplots()
        panel.loglog([1e-2, 1e1], [1e-2, 1e1], label="a$b$c")
        panel.legend()
        text = svg_text(figure)
    assert ">10⁻²<" in text and ">10¹<" in text
    assert "mathdefault" not in text and "a$b$c" in text


def test_numbers_that_are_no_powers_of_ten_have_no_text() -> None:
    assert [power_of_ten(value) for value in (1e-15, 1.0, 10.0, 20.0, 0.0, -10.0)] == [
        "10⁻¹⁵",
        "10⁰",
        "10¹",
        "",
        "",
        "",
    ]
