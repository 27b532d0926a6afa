"""A linear model in a notebook: its matrices with the names of rows and columns, modes and stability."""

from __future__ import annotations

from collections.abc import Iterator

from markupsafe import Markup

from kanegen.linear.eigenvalues import Floats
from kanegen.linear.printing import MATRICES, about, conclusions, mode_words, names_of_sides
from kanegen.linear.state_space import StateSpace
from kanegen.pictures.html import MOST_ROWS, name, sentence, shown, table

MOST_COLUMNS = 16
"""Number of columns up to which a matrix is shown whole."""


def model_html(model: StateSpace) -> str:
    """Return the HTML of a linear model for a notebook."""
    modes = [(value, kind, " ".join(facts), shape) for value, kind, *facts, shape in mode_words(model.modes)]
    head = ("eigenvalue", "mode", "", "shape")
    return shown(
        sentence(
            "small deviations, d/dt xi = A xi + B u, about {}", "; ".join(about(model)), strong=model.name
        ),
        *_matrices(model),
        table(head, modes, "model.modes"),
        *(sentence("{}", line) for line in conclusions(model)),
    )


def _matrices(model: StateSpace) -> Iterator[Markup]:
    """Yield each matrix that is not empty."""
    rows, columns = names_of_sides(model)
    for letter, sides in MATRICES.items():
        matrix: Floats = getattr(model, letter)
        if not matrix.size:
            continue
        if max(matrix.shape) > MOST_COLUMNS:
            shape = f"{matrix.shape[0]} by {matrix.shape[1]}"
            yield sentence("{}, {}: {} numbers in model.{}", letter, sides, shape, letter)
            continue
        named = zip(rows[letter], matrix.tolist(), strict=True)
        cells = [(name(row), *(f"{value:.6g}" for value in values)) for row, values in named]
        yield table((letter, *map(name, columns[letter])), cells, f"model.{letter}", MOST_ROWS)
