"""A symbolic linear model as text, Markdown, LaTeX or Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from sympy import Expr, ImmutableMatrix

from kanegen.choices import require_one
from kanegen.symbolic import printers
from kanegen.symbolic.linear.symbolic_model import MATRICES, SymbolicLinearModel


def render_linear_model(model: SymbolicLinearModel, format_: str = "text") -> str:
    """Return a symbolic linear model in one of the `LINEAR_FORMATS`, with a newline at the end.

    Raises:
        OptionError: If there is no such format.

    Example:
        print(render_linear_model(kg.derive(system).linearize(), "latex"))
    """
    require_one("format", format_, LINEAR_FORMATS)
    return LINEAR_FORMATS[format_](model)


def _text(model: SymbolicLinearModel) -> str:
    """Return a line for each entry that is not zero."""
    about, *others = _about(model)
    lines = [f"{model.name}: small deviations, d/dt xi = A xi + B u, about {about}"]
    lines += [f"  {line}" for line in others]
    for name in MATRICES:
        lines += [
            f"  {_equation(f'{name}[{row}, {column}]', value)}"
            for row, column, value in _entries(model, name)
        ]
    return "\n".join(lines) + "\n"


def _about(model: SymbolicLinearModel) -> Iterator[str]:
    """Yield what is not zero in the state of the model, and what moves where it is not at rest."""
    state = [*zip(model.state_names, (*model.x, *model.y), strict=True), *_efforts(model)]
    yield ", ".join(_equation(name, value) for name, value in state if value != 0) or "zero"
    if not model.is_equilibrium:
        rates = zip(model.state_names, (*model.xdot, *model.ydot), strict=True)
        moving = ", ".join(_equation(f"d/dt {name}", value) for name, value in rates if value != 0)
        yield f"not at rest: {moving}"


def _markdown(model: SymbolicLinearModel) -> str:
    """Return the state, the names and the matrices that are not empty in Markdown."""
    about = "; ".join(_about(model))
    parts = [f"# {model.name}: small deviations", f"$\\dot{{\\xi}} = A\\xi + Bu$ about {about}."]
    names = {"states": model.state_names, "inputs": model.input_names, "outputs": model.output_names}
    parts.append("\n".join(f"- {kind}: {', '.join(one)}" for kind, one in names.items() if one))
    parts += [f"$$\n{formula}\n$$" for formula in _formulas(model)]
    return "\n\n".join(parts) + "\n"


def _latex(model: SymbolicLinearModel) -> str:
    """Return the matrices that are not empty as LaTeX, for the package amsmath."""
    head = f"% {model.name}: states {', '.join(model.state_names)}; inputs {', '.join(model.input_names)}"
    return "\n".join([head, *(f"\\[ {formula} \\]" for formula in _formulas(model))]) + "\n"


def _formulas(model: SymbolicLinearModel) -> Iterator[str]:
    """Yield the matrices that are not empty in LaTeX, a line for each row."""
    for name in MATRICES:
        matrix: ImmutableMatrix = getattr(model, name)
        if len(matrix):
            rows = (" & ".join(printers.latex(one, model.names) for one in row) for row in matrix.tolist())
            body = " \\\\\n".join(rows)
            yield f"{name} = \\begin{{bmatrix}}\n{body}\n\\end{{bmatrix}}"


def _python(model: SymbolicLinearModel) -> str:
    """Return a Python module with a function of the symbols that returns the matrices."""
    symbols = ", ".join(symbol.name for symbol in model.symbols)
    lines = [f'"""Linear model of {model.name!r}: d/dt xi = A xi + B u, eta = C xi + D u."""', ""]
    lines += ["from math import *", "", "import numpy as np", ""]
    lines += [
        f"{name} = {list(getattr(model, name))!r}" for name in ("state_names", "input_names", "output_names")
    ]
    lines += ["", "", f"def matrices({symbols}):", '    """Return A, B, C and D."""']
    for name in MATRICES:
        matrix: ImmutableMatrix = getattr(model, name)
        lines.append(f"    {name} = np.zeros({matrix.shape!r})")
        lines += [
            f"    {name}[{i}, {j}] = {printers.python(matrix[i, j])}"
            for i in range(matrix.shape[0])
            for j in range(matrix.shape[1])
            if matrix[i, j] != 0
        ]
    return "\n".join([*lines, f"    return {', '.join(MATRICES)}"]) + "\n"


def _efforts(model: SymbolicLinearModel) -> Iterator[tuple[str, Expr]]:
    """Yield name and value of each generalized force in the state."""
    speeds = model.state_names[len(model.x) :]
    return zip((f"tau.{name.partition('.')[2]}" for name in speeds), model.tau, strict=True)


def _entries(model: SymbolicLinearModel, name: str) -> Iterator[tuple[str, str, Expr]]:
    """Yield names of row and column, and the entry, for each entry of a matrix that is not zero."""
    sides: dict[str, tuple[Sequence[str], Sequence[str]]] = {
        "A": (model.state_names, model.state_names),
        "B": (model.state_names, model.input_names),
        "C": (model.output_names, model.state_names),
        "D": (model.output_names, model.input_names),
    }
    rows, columns = sides[name]
    matrix: ImmutableMatrix = getattr(model, name)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            if matrix[i, j] != 0:
                yield row, column, matrix[i, j]


def _equation(name: str, value: Expr) -> str:
    """Return a name with its value."""
    return f"{name} = {printers.text(value)}"


LINEAR_FORMATS: dict[str, Callable[[SymbolicLinearModel], str]] = {
    "text": _text,
    "markdown": _markdown,
    "latex": _latex,
    "python": _python,
}
"""Functions that print a symbolic linear model, by name of format."""
