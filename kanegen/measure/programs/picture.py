"""The picture of programs beside each other: a heat map of entries, and errors against distances, as SVG."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from kanegen.extras import module
from kanegen.measure.programs.program_errors import ProgramErrors
from kanegen.measure.svg import STYLE, svg_text
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.pictures.picture import Picture
from kanegen.reference.states import States

EXTRA = "study"
"""The extra that brings what a picture needs."""

LEAST = 1e-20
"""The error at which smaller ones are drawn: no program reaches it but by being exact."""

GAP = 0.5
"""Width between [A] and {f}, in cells."""

MOST_LABELS = 12
"""Largest number of freedoms whose names stand beside a heat map."""

_TIP = re.compile(r'<a xlink:href="tip:(\d+)"[^>]*>')


@dataclass
class _Tips:
    """Texts that a browser shows for parts of the picture, which hold their numbers as addresses."""

    texts: list[str] = field(default_factory=list)

    def add(self, text: str) -> str:
        """Return the address of a new text."""
        self.texts.append(text)
        return f"tip:{len(self.texts) - 1}"

    def shown(self, svg: str) -> str:
        """Return the SVG with titles in the place of the addresses."""
        titled = _TIP.sub(lambda found: f"<g><title>{escape(self.texts[int(found[1])])}</title>", svg)
        return titled.replace("</a>", "</g>")


@dataclass(frozen=True)
class Drawn:
    """What is drawn.

    Attributes:
        system: The system.
        states: The B states.
        distances: (B,) distances from the nearest singular matrix.
        programs: The errors of each program.
    """

    system: System
    states: States
    distances: Floats
    programs: tuple[ProgramErrors, ...]


def draw(drawn: Drawn) -> Picture:
    """Return the picture of programs.

    The upper row has a heat map for each program: the largest error of every entry of [A] and, apart at the
    right, of {f}, over the magnitudes of its terms. The lower row has the errors of [A], {f} and {ydot} in
    every state against its distance from a singular [A]. Cells and points have titles that name the state;
    those of the worst hold all its numbers.

    Raises:
        MissingError: If matplotlib is not installed.
    """
    mpl, tips = module("matplotlib", extra=EXTRA), _Tips()
    with mpl.rc_context(STYLE):
        count = len(drawn.programs)
        figure = module("matplotlib.figure").Figure(
            figsize=(max(9.0, 2.9 * count), 7.4), layout="constrained"
        )
        figure.suptitle(f"{drawn.system.name}: errors in {len(drawn.states)} states", fontsize=11)
        upper, lower = figure.subfigures(2, 1, height_ratios=[1, 1.15])
        _heat_maps(upper, drawn, tips)
        _against_distance(lower, drawn, tips)
        return Picture(tips.shown(svg_text(figure)))


def _heat_maps(figure: Any, drawn: Drawn, tips: _Tips) -> None:
    """Draw the largest error of every entry, a panel for each program."""
    colours = module("matplotlib.colors")
    largest = [_largest_by_entry(one) for one in drawn.programs]
    errors = np.concatenate([table.ravel() for table in largest])
    shown = errors[(errors > LEAST) & np.isfinite(errors)]
    low, high = (shown.min(), shown.max()) if shown.size else (LEAST, LEAST)
    norm = colours.LogNorm(low, max(high, 2 * low))
    panels = figure.subplots(1, len(largest), sharey=True, squeeze=False)[0]
    for panel, one, table in zip(panels, drawn.programs, largest, strict=True):
        image = _heat_map(panel, drawn, one, table, norm, tips)
    panels[0].set_ylabel("rows of [A] and {f}")
    scale = figure.colorbar(
        image, ax=panels, label="largest error / terms (white: none)", pad=0.01, format=_tick
    )
    scale.ax.yaxis.set_minor_formatter(module("matplotlib.ticker").NullFormatter())


def _heat_map(panel: Any, drawn: Drawn, one: ProgramErrors, table: Floats, norm: Any, tips: _Tips) -> Any:
    """Draw the errors of one program: [A] in n columns, a gap, and {f}; white is no error."""
    n, names = len(table), drawn.system.speed_names
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    corners = [(j + GAP * (j == n), i) for i in range(n) for j in range(n + 1)]
    image = module("matplotlib.collections").PolyCollection(
        [square + corner for corner in corners],
        array=np.ma.masked_less_equal(table.ravel(), LEAST),
        norm=norm,
        cmap="viridis",
        edgecolors="0.85",
        linewidths=0.4,
        urls=[tips.add(text) if text else None for text in _cell_tips(drawn, one)],
    )
    panel.add_collection(image)
    panel.set_xlim(-GAP, n + 1 + 2 * GAP)
    panel.set_ylim(n, 0)
    panel.set_title(one.name, fontsize=9)
    panel.set_aspect("equal")
    panel.set_frame_on(False)
    panel.tick_params(length=0)
    if n <= MOST_LABELS:
        panel.set_xticks([*(np.arange(n) + 0.5), n + GAP + 0.5], [*names, "{f}"], rotation=90)
        panel.set_yticks(np.arange(n) + 0.5, names)
    else:
        panel.set_xticks([n / 2, n + GAP + 0.5], ["[A]", "{f}"])
    return image


def _cell_tips(drawn: Drawn, one: ProgramErrors) -> list[str]:
    """Return the titles of the cells of a heat map, row by row; "" for a cell without error.

    The worst cells of [A] and of {f} have all numbers of their states, the others its index.
    """
    names, tips = drawn.system.speed_names, []
    worst = {output: errors.max() for output, errors in one.entries.items()}
    for i, row in enumerate(names):
        for j, column in enumerate((*names, "")):
            output, label = (
                ("mass_matrix", f"[A][{row}, {column}]") if column else ("forcing", f"{{f}}[{row}]")
            )
            errors = one.entries[output][:, i, j] if column else one.entries[output][:, i]
            state = int(errors.argmax())
            where = _state(drawn, state) if errors[state] == worst[output] else f"state {state}"
            tip = f"{one.name}, {label}: {errors[state]:.1e} of its terms in {where}"
            tips.append(tip if errors[state] > LEAST else "")
    return tips


def _against_distance(figure: Any, drawn: Drawn, tips: _Tips) -> None:
    """Draw errors against the distance from a singular [A], a panel for [A], {f} and {ydot}."""
    distances = np.maximum(drawn.distances, LEAST)
    panels = figure.subplots(1, 3, sharex=True)
    for number, one in enumerate(drawn.programs):
        kinds = {
            "[A], error / terms": one.entries["mass_matrix"].max(axis=(1, 2)),
            "{f}, error / terms": one.entries["forcing"].max(axis=1),
            "{ydot}, normwise error": one.accelerations,
        }
        for panel, (title, errors) in zip(panels, kinds.items(), strict=True):
            _points(panel, drawn, one, errors, distances, number, tips)
            panel.set_title(title, fontsize=9)
    for panel in panels:
        panel.set_xscale("log")
        panel.set_xlim(min(distances.min() / 2, 0.01), 2)
        panel.set_yscale("log" if panel.collections else "linear")
        panel.grid(alpha=0.25)
        for axis in (panel.xaxis, panel.yaxis):
            axis.set_major_formatter(_tick)
            axis.set_minor_formatter(module("matplotlib.ticker").NullFormatter())
    if not panels[2].collections:
        panels[2].text(0.5, 0.5, "no exact accelerations", ha="center", transform=panels[2].transAxes)
        panels[2].set_yticks([])
    figure.supxlabel("distance from a singular [A]: 1 / scaled condition number", fontsize=9)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, ncols=len(labels), loc="outside upper center", frameon=False)


def _points(
    panel: Any,
    drawn: Drawn,
    one: ProgramErrors,
    errors: Floats,
    distances: Floats,
    number: int,
    tips: _Tips,
) -> None:
    """Draw one error of one program in every state, the worst with a ring."""
    finite = np.flatnonzero(np.isfinite(errors))
    if not finite.size:
        return
    panel.scatter(
        distances[finite],
        np.maximum(errors[finite], LEAST),
        s=9,
        marker="osD^v<>"[number % 7],
        color=f"C{number}",
        alpha=0.7,
        linewidths=0,
        label=one.name,
        urls=[tips.add(f"{one.name}: {errors[k]:.1e} in state {k}") for k in finite],
    )
    worst = int(finite[errors[finite].argmax()])
    tip = tips.add(f"{one.name}: the worst, {errors[worst]:.1e}, in {_state(drawn, worst)}")
    place = (distances[worst], max(errors[worst], LEAST))
    panel.scatter(*place, s=55, facecolors="none", edgecolors=f"C{number}", urls=[tip])


def _largest_by_entry(one: ProgramErrors) -> Floats:
    """Return the (n, n + 1) largest errors of the entries of [A] and {f} over all states."""
    return np.column_stack([one.entries["mass_matrix"].max(axis=0), one.entries["forcing"].max(axis=0)])


def _tick(value: float, _: object = None) -> str:
    """Return the text of a number at a tick."""
    return f"{value:.0e}" if value < 1 else f"{value:g}"


def _state(drawn: Drawn, number: int) -> str:
    """Return a state in words, with numbers that can be put into a program."""
    states = drawn.states
    arrays = {"x": states.x, "y": states.y, "force": states.force, "torque": states.torque, **states.inputs}
    given = {name: values[number].tolist() for name, values in arrays.items() if values is not None}
    return f"state {number}: " + ", ".join(f"{name} = {values}" for name, values in given.items())
