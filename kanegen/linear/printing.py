"""A linear model as text, Markdown, LaTeX, JSON or Python."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from kanegen.choices import require_one
from kanegen.linear.eigenvalues import Floats
from kanegen.linear.modes import Mode
from kanegen.linear.state_space import StateSpace

MATRICES = {
    "A": "states by states",
    "B": "states by inputs",
    "C": "outputs by states",
    "D": "outputs by inputs",
}
"""The matrices of a linear model, with what their rows and columns are."""


def render(model: StateSpace, format_: str = "text") -> str:
    """Return a linear model in one of the `FORMATS`, with a newline at the end.

    Raises:
        OptionError: If there is no such format.

    Example:
        print(render(model, "latex"))
    """
    require_one("format", format_, FORMATS)
    return FORMATS[format_](model)


def as_dict(model: StateSpace) -> dict[str, Any]:
    """Return all names and numbers of a linear model as plain data; complex numbers are pairs."""
    return {
        "system": model.name,
        "states": list(model.state_names),
        "inputs": list(model.input_names),
        "outputs": list(model.output_names),
        "at": {name: list(map(float, getattr(model, name))) for name in ("x", "y", "tau", "xdot", "ydot")},
        **{name: getattr(model, name).tolist() for name in MATRICES},
        "eigenvalues": [[value.real, value.imag] for value in model.eigenvalues],
        "modes": [_mode_as_dict(mode) for mode in model.modes],
        "stability": {"verdict": model.stability.verdict, "reason": model.stability.reason},
        "controllable_states": model.controllability.dimension,
        "observable_states": model.observability.dimension if model.output_names else None,
    }


def text(model: StateSpace) -> str:
    """Return matrices, modes, stability and controllability as text."""
    lines = [f"{model.name}: small deviations, d/dt xi = A xi + B u, about"]
    lines += [f"  {line}" for line in about(model)]
    rows, columns = names_of_sides(model)
    for name, sides in MATRICES.items():
        matrix: Floats = getattr(model, name)
        if matrix.size:
            lines += ["", f"{name}, {sides}", *_table(matrix, rows[name], columns[name])]
    modes = [
        f"  {'; '.join((value, *facts))}; shape {shape}" for value, *facts, shape in mode_words(model.modes)
    ]
    return "\n".join([*lines, "", "modes", *modes, "", *conclusions(model)]) + "\n"


def about(model: StateSpace) -> Iterator[str]:
    """Yield the state about which a model holds: what is not zero, and what moves where it is not at rest."""
    m = len(model.x)
    names = [*model.state_names, *(f"tau.{name.partition('.')[2]}" for name in model.state_names[m:])]
    values = [*model.x, *model.y, *model.tau]
    yield ", ".join(f"{a} = {v:.9g}" for a, v in zip(names, values, strict=True) if v) or "zero"
    if not model.is_equilibrium:
        rates = zip(model.state_names, (*model.xdot, *model.ydot), strict=True)
        moving = ", ".join(f"d/dt {name} = {value:.6g}" for name, value in rates if abs(value) > 1e-9)
        yield f"not at rest: {moving}"


def conclusions(model: StateSpace) -> Iterator[str]:
    """Yield what follows from the matrices: stability, controllability, observability."""
    yield f"stability: {model.stability}"
    if model.input_names:
        words = model.controllability.words("controllable", "no input moves")
        yield f"inputs {', '.join(model.input_names)}: {words}"
    if model.output_names:
        yield f"outputs: {model.observability.words('observable', 'no output shows')}"
    if not model.is_minimal:
        yield (
            "The length of a quaternion has no meaning, so that deviations along it are neutral; modes, "
            f"stability and ranks are those of the {2 * len(model.y)} states without it."
        )


def markdown(model: StateSpace) -> str:
    """Return matrices and modes as tables in Markdown, and what follows from them as sentences."""
    parts = [
        f"# {model.name}: small deviations",
        f"d/dt xi = A xi + B u about {'; '.join(about(model))}.",
    ]
    rows, columns = names_of_sides(model)
    for name, sides in MATRICES.items():
        matrix: Floats = getattr(model, name)
        if matrix.size:
            cells = ([f"{value:.6g}" for value in row] for row in matrix.tolist())
            lines = [[row, *values] for row, values in zip(rows[name], cells, strict=True)]
            parts += [f"## {name}, {sides}", _markdown_table([["", *columns[name]], *lines])]
    words = ([value, kind, " ".join(facts), shape] for value, kind, *facts, shape in mode_words(model.modes))
    parts += ["## Modes", _markdown_table([["eigenvalue", "mode", "", "shape"], *words])]
    return "\n\n".join([*parts, *conclusions(model)]) + "\n"


def _markdown_table(rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown whose first row is its head; a bar in a name stays a bar."""
    lines = [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows]
    lines.insert(1, "|" + " --- |" * len(rows[0]))
    return "\n".join(lines)


def latex(model: StateSpace) -> str:
    """Return the matrices as LaTeX, for the package amsmath."""
    rows, columns = names_of_sides(model)
    parts = [f"% {model.name}: states {', '.join(model.state_names)}; inputs {', '.join(model.input_names)}"]
    for name in MATRICES:
        matrix: Floats = getattr(model, name)
        if matrix.size:
            body = r" \\ ".join(" & ".join(map(_latex_number, row)) for row in matrix.tolist())
            parts.append(f"\\[ {name} = \\begin{{bmatrix}} {body} \\end{{bmatrix}} \\]")
            parts.append(f"% rows {', '.join(rows[name])}; columns {', '.join(columns[name])}")
    return "\n".join(parts) + "\n"


def python(model: StateSpace) -> str:
    """Return a Python module with the matrices as NumPy arrays and their names."""
    lines = [f'"""Linear model of {model.name!r}: d/dt xi = A xi + B u, eta = C xi + D u."""', ""]
    lines += ["import numpy as np", ""]
    for name in ("state_names", "input_names", "output_names"):
        lines.append(f"{name} = {list(getattr(model, name))!r}")
    for name in MATRICES:
        matrix: Floats = getattr(model, name)
        lines.append(f"{name} = np.array({matrix.tolist()!r}).reshape{matrix.shape!r}")
    return "\n".join(lines) + "\n"


def names_of_sides(model: StateSpace) -> tuple[Mapping[str, Sequence[str]], Mapping[str, Sequence[str]]]:
    """Return the names of the rows and of the columns of each matrix."""
    states, inputs, outputs = model.state_names, model.input_names, model.output_names
    rows = {"A": [f"d {s}" for s in states], "B": [f"d {s}" for s in states], "C": outputs, "D": outputs}
    return rows, {"A": states, "B": inputs, "C": states, "D": inputs}


def _table(matrix: Floats, rows: Sequence[str], columns: Sequence[str]) -> list[str]:
    """Return a matrix with names, one line a row."""
    cells = [[f"{value:.6g}" for value in row] for row in matrix.tolist()]
    widths = [max(len(name), *(len(row[k]) for row in cells)) for k, name in enumerate(columns)]
    first = max(map(len, rows))
    head = " " * first + "  " + "  ".join(f"{name:>{w}}" for name, w in zip(columns, widths, strict=True))
    body = [
        f"{name:<{first}}  " + "  ".join(f"{cell:>{w}}" for cell, w in zip(row, widths, strict=True))
        for name, row in zip(rows, cells, strict=True)
    ]
    return [f"  {line}" for line in (head, *body)]


def mode_words(modes: Sequence[Mode]) -> Iterator[tuple[str, ...]]:
    """Yield for each mode its eigenvalue, its kind, perhaps frequency and damping ratio, and its shape."""
    for mode in modes:
        value = f"{mode.growth:.6g}" + (f" +- {mode.eigenvalue.imag:.6g}i" if mode.oscillates else "")
        facts = [f"{value} 1/s", mode.kind]
        if mode.oscillates:
            facts.append(f"{mode.frequency:.6g} Hz, damping ratio {mode.damping_ratio:.4g}")
        elif mode.growth:
            facts.append(f"time constant {1 / abs(mode.growth):.4g} s")
        yield (*facts, ", ".join(f"{name} {_amplitude(mode.shape[name])}" for name in mode.moving()))


def _amplitude(value: complex) -> str:
    """Return a deviation: its value where it is real, else its size and phase in degrees."""
    if abs(value.imag) <= 1e-6 * abs(value):
        return f"{value.real:.4g}"
    return f"{abs(value):.4g} at {math.degrees(math.atan2(value.imag, value.real)):.0f} deg"


def _latex_number(value: float) -> str:
    """Return a number in LaTeX with six digits."""
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    return f"{mantissa} \\cdot 10^{{{int(exponent)}}}" if exponent else mantissa


def _mode_as_dict(mode: Mode) -> dict[str, Any]:
    """Return a mode as plain data."""
    return {
        "eigenvalue": [mode.eigenvalue.real, mode.eigenvalue.imag],
        "error": mode.error,
        "kind": mode.kind,
        "frequency_hz": mode.frequency,
        "damping_ratio": None if math.isnan(mode.damping_ratio) else mode.damping_ratio,
        "shape": {name: [value.real, value.imag] for name, value in mode.shape.items()},
    }


FORMATS: dict[str, Callable[[StateSpace], str]] = {
    "text": text,
    "markdown": markdown,
    "latex": latex,
    "json": lambda model: json.dumps(as_dict(model), indent=2) + "\n",
    "python": python,
}
"""Functions that write a linear model, by name of the format."""
