"""Inputs that depend on the time alone, at many times at once: the rows that steps in C read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats as Doubles
from kanegen.simulation.inputs import Inputs

Rows = dict[str, Doubles]
"""Arguments of `Library.forward_dynamics` with a first axis for times."""


@dataclass(frozen=True)
class StepInputs:
    """What acts at the start, in the middle and at the end of S equal steps.

    Attributes:
        hold: How the rows are held over a step, as in `Library.rollout`: "zero" or "quadratic".
        rows: Rows for this hold, S or 2 S + 1.
    """

    hold: str
    rows: Rows

    @classmethod
    def of(cls, inputs: Inputs, time: float, steps: int, length: float) -> StepInputs:
        """Return the inputs of some steps.

        Inputs that are all constant between times of tables are constant over each step. Others have values
        at the start, the middle and the end of each step; then none may jump between the first step and the
        last, see `Inputs.jumps`.

        Args:
            inputs: Inputs that depend on the time alone.
            time: Start of the first step, s.
            steps: Number of steps S.
            length: Length of a step, s.
        """
        if inputs.are_held:
            middles: Doubles = time + length * (np.arange(steps, dtype=np.float64) + 0.5)
            return cls("zero", sampled(inputs, middles, middles))
        times: Doubles = time + 0.5 * length * np.arange(2 * steps + 1, dtype=np.float64)
        return cls("quadratic", sampled(inputs, times, np.full(len(times), time + 0.5 * length * steps)))

    def at(self, place: int) -> Rows:
        """Return the inputs of all steps at their start, 0, their middle, 1, or their end, 2."""
        if self.hold == "zero":
            return self.rows
        last = {0: -2, 1: -1, 2: None}[place]
        return {name: values[place:last:2] for name, values in self.rows.items()}


def sampled(inputs: Inputs, times: Doubles, inside: Doubles) -> Rows:
    """Return what acts at some times as arguments of `Library.forward_dynamics`.

    Args:
        inputs: Inputs that depend on the time alone.
        times: (K,) times, s.
        inside: (K,) times, s, between which and `times` no input jumps, but for at `times` themselves.
    """
    found: Rows = {}
    if inputs.prescribed is not None:
        found["prescribed"] = np.stack([inputs.prescribed_at(time) for time in times.tolist()])
    for place, signal in inputs.signals:
        array = _array(found, inputs, place.argument, len(times))
        if place.argument == "prescribed":
            array[:, :, place.index[0]] = np.stack(signal.with_rates(times), axis=-1)
        else:
            array[place.elements] += signal({"t": times})
    for place, table, column in inputs.columns:
        _array(found, inputs, place.argument, len(times))[place.elements] += table.over(column, times, inside)
    return found


def _array(found: Rows, inputs: Inputs, argument: str, count: int) -> Doubles:
    """Return the array of an argument, which is made of zeros where it is not there yet."""
    if argument not in found:
        found[argument] = np.zeros((count, *inputs.shape(argument)))
    return found[argument]
