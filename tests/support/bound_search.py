"""Searches for errors of generated code that are larger than their proven bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kanegen as kg
from kanegen.measure.bounds import InputBox
from kanegen.model.arrays import Floats
from kanegen.program.constants import MULTIPRECISION
from kanegen.program.evaluate import evaluate
from kanegen.program.precision import precision_named

MARGIN = 1 + 2.0**-8
"""A bound is broken beyond this ratio; long doubles err by 2^-11 of the rounding error of doubles."""


@dataclass(frozen=True)
class Search:
    """Errors of one library over states of a box.

    Attributes:
        library: The compiled library.
        box: The box of inputs.
    """

    library: kg.Library
    box: InputBox

    def random(self, count: int, seed: int = 0) -> dict[str, Floats]:
        """Return `count` random states: rows of every input array, by name."""
        rng = np.random.default_rng(seed)
        low, high = self.box.low, self.box.high
        return self._inside(
            {name: rng.uniform(low[name], high[name], (count, len(low[name]))) for name in low}
        )

    def corners(self, count: int, seed: int = 0) -> dict[str, Floats]:
        """Return `count` random corners of the box, a quarter of them with zero speeds and accelerations."""
        rng = np.random.default_rng(seed)
        found = {}
        for name, low in self.box.low.items():
            take = rng.integers(0, 2, (count, len(low)))
            found[name] = np.where(take, self.box.high[name], low)
            if name in ("y", "ydot") and (low <= 0).all() and (self.box.high[name] >= 0).all():
                found[name][::4] = 0.0
        return self._inside(found)

    def climbed(self, output: str, entry: int, rounds: int = 30, seed: int = 0) -> dict[str, Floats]:
        """Return states that a hill climb on the error of one entry leads to."""
        rng = np.random.default_rng(seed)
        states = self.random(256, seed)
        errors = self.errors(output, states)[:, entry]
        for step in range(rounds):
            width = 0.3 * 0.85**step
            moved = {}
            for name, values in states.items():
                low, high = self.box.low[name], self.box.high[name]
                chosen = rng.random(values.shape) < 0.3
                step_taken = chosen * width * rng.normal(size=values.shape) * (high - low)
                moved[name] = np.clip(values + step_taken, low, high)
            moved = self._inside(moved)
            new = self.errors(output, moved)[:, entry]
            better = (new > errors)[:, None]
            states = {name: np.where(better, moved[name], values) for name, values in states.items()}
            errors = np.maximum(errors, new)
        return states

    def errors(self, output: str, states: dict[str, Floats]) -> Floats:
        """Return (states, entries) errors against the same program in long double, less its last rounding."""
        computed = self.computed(output, states)
        exact = self.exact(output, states)
        errors = np.abs(computed.astype(np.longdouble) - exact) - np.longdouble(2.0**-63) * np.abs(exact)
        return np.maximum(errors, 0.0).astype(np.float64)

    def computed(self, output: str, states: dict[str, Floats]) -> NDArray[Any]:
        """Return (states, entries) results of the library, one state at a time with its own parameters."""
        count = len(next(iter(states.values())))
        parameters = states.get("parameters")
        if parameters is None or (parameters == parameters[0]).all():
            return self._call(self.library, output, states).reshape(count, -1)
        names = [name for name, _ in self.library.source.model.parameters]
        rows = []
        for k in range(count):
            library = self.library.with_parameters(dict(zip(names, parameters[k], strict=True)))
            one = {name: values[k : k + 1] for name, values in states.items()}
            rows.append(self._call(library, output, one).reshape(1, -1))
        return np.concatenate(rows)

    def exact(self, output: str, states: dict[str, Floats]) -> NDArray[np.longdouble]:
        """Return (states, entries) results of the program that was printed, in long double."""
        module = self.library.source.module
        assert module is not None
        inputs = {name: list(values.T.astype(np.longdouble)) for name, values in states.items()}
        if module.prepare is not None:
            inputs |= evaluate(module.prepare, inputs, np, wide)
        program = module.functions[output]
        (filled,) = program.outputs
        values = evaluate(program, inputs, np, wide)[filled.array.name]
        count = len(next(iter(states.values())))
        return np.stack([np.broadcast_to(value, count) for value in values], axis=1)

    def _call(self, library: kg.Library, output: str, states: dict[str, Floats]) -> NDArray[Any]:
        count = len(states["x"])
        names = next(f for f in library.source.functions if f.name == output).inputs
        arguments = {}
        for array in names:
            if array.name not in ("parameters", "prepared"):
                arguments[array.name] = states[array.name].reshape(count, *array.shape)
        return np.asarray(getattr(library, output)(**arguments))

    def _inside(self, states: dict[str, Floats]) -> dict[str, Floats]:
        """Return states rounded to the precision of the arrays."""
        dtype = precision_named(self.library.storage).dtype
        return {name: values.astype(dtype).astype(np.float64) for name, values in states.items()}


def wide(number: Any) -> np.longdouble:
    """Return a constant of a program as a long double."""
    return np.longdouble(number if isinstance(number, float) else MULTIPRECISION.nstr(number, 40))
