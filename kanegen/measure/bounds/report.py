"""The result of `kanegen.bound`: bounds by output, as numbers, as text and as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.choices import require_one
from kanegen.measure.bounds import statement
from kanegen.measure.bounds.domain import InputBox
from kanegen.model.arrays import Floats
from kanegen.pictures.html import code, folded, sentence, shown, table


@dataclass(frozen=True)
class Bounds:
    """Proven bounds of the errors of generated code over a box of inputs.

    Attributes:
        model: Name of the model.
        precision: Name of the precision of the arithmetic.
        box: The box of inputs in which the bounds hold.
        outputs: Bounds of |computed - exact| of every entry, by output, in the shape and unit of the output;
            infinite where there is none.
        magnitudes: Bounds of |exact| of every entry, by output.
        unbounded: Why there is no bound, by output.
        assumptions: What the proof takes for granted, one sentence each.
        units: Unit of every output, or those of its parts.
    """

    model: str
    precision: str
    box: InputBox
    outputs: Mapping[str, Floats]
    magnitudes: Mapping[str, Floats]
    unbounded: Mapping[str, str]
    assumptions: tuple[str, ...]
    units: Mapping[str, str]

    def __getitem__(self, output: str) -> Floats:
        """Return the bounds of the entries of one output.

        Raises:
            OptionError: If the generated code does not have this output.
        """
        require_one("output", output, self.outputs)
        return self.outputs[output]

    @property
    def largest(self) -> dict[str, float]:
        """The largest bound of each output."""
        return {name: float(np.max(errors, initial=0.0)) for name, errors in self.outputs.items()}

    def __str__(self) -> str:
        """Return a table of the largest bound and the largest magnitude of each output, and the box."""
        width = max(map(len, self.outputs), default=0)
        lines = [f"{self.model}, {self.precision}: proven bounds of |computed - exact| in the whole box"]
        for name, largest, size, unit in self._rows():
            ends = self.unbounded.get(name) or f"{largest}  where entries reach {size}  ({unit})"
            lines.append(f"  {name:<{width}}  {ends}")
        lines += ["The box, to 6 digits:", *(f"  {line}" for line in statement.lines(self.box))]
        return "\n".join([*lines, *(f"Assumed: {sentence}" for sentence in self.assumptions)])

    def __repr__(self) -> str:
        """Name of the model, its precision and the largest bounds; `print` shows the box, too."""
        largest = ", ".join(f"{name} {bound:.1e}" for name, bound in self.largest.items())
        return f"<Bounds of {self.model}, {self.precision}: {largest}>"

    def _repr_html_(self) -> str:
        """The largest bound of each output, the box, and what the proof assumes, for a notebook."""
        rows = [(name, self.unbounded.get(name) or bound, *others) for name, bound, *others in self._rows()]
        about = "{}: proven bounds of |computed - exact| in the whole box"
        return shown(
            sentence(about, self.precision, strong=self.model),
            table(("output", "largest bound", "entries reach", "unit"), rows, "bounds.largest"),
            folded("The box, to 6 digits", code("\n".join(statement.lines(self.box)), "bounds.box")),
            *(sentence("Assumed: {}", one) for one in self.assumptions),
        )

    def _rows(self) -> Iterator[tuple[str, str, str, str]]:
        """Yield the name of each output, its largest bound and magnitude, and its unit."""
        for name, largest in self.largest.items():
            size = float(np.max(self.magnitudes[name], initial=0.0))
            yield name, f"{largest:.3g}", f"{size:.3g}", self.units[name]

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data for JSON; None stands for infinity, and "box" is a domain."""
        return {
            "model": self.model,
            "precision": self.precision,
            "box": statement.as_table(self.box),
            "units of the box": statement.units(self.box.system),
            "outputs": {
                name: {
                    "bounds": _plain(errors),
                    "magnitudes": _plain(self.magnitudes[name]),
                    "unit": self.units[name],
                    "no bound because": self.unbounded.get(name),
                }
                for name, errors in self.outputs.items()
            },
            "assumptions": list(self.assumptions),
        }


def _plain(values: Floats) -> Any:
    """Return an array as nested lists with None for numbers that are not finite."""
    if values.ndim == 0:
        return float(values) if np.isfinite(values) else None
    return [_plain(np.asarray(row)) for row in values]
