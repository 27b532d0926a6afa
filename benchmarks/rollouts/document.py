"""The page of times of rollouts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.rollouts.participants import COMPARED, Length
from kanegen.measure.machine import Machine
from kanegen.model.system import System
from kanegen.studies.bench.table import ns
from kanegen.studies.markdown import markdown_table

HEAD = """# Times of rollouts

`python -m benchmarks.rollouts` writes this page. Every program follows motions of {model} ({n} freedoms)
under constant efforts for {steps} steps of {step} s. *ns a step* is the median time of one step of one
state on one core over {rounds} rounds, in each of which every program has a turn; *range* is that of the
rounds. kanegen follows {states} states, one after the other (*RK4*) and all in one call (*batch*); the
others follow the first {few} of them. *differs by* is the largest difference of x and y from the first row
after {compared} steps, relative to the largest entry: programs with the same method agree to rounding.

In rows with *a parameter* the mass of the last body is open until run time, with one value for all states or
with one *by state*.

kanegen and Pinocchio compute the same four evaluations of forward dynamics a step. MuJoCo's `mj_step`
without contacts, constraints and actuators computes more than accelerations, such as the places of sites
and cameras; with `implicitfast` it evaluates them once a step, by another method, of order 1. SciPy's
DOP853 chooses its own steps for tolerances of 1e-9 and is called from Python; its time is that of the whole
motion over {steps}.
"""


@dataclass(frozen=True)
class Row:
    """One program with one method.

    Attributes:
        program: Name of the program.
        method: Name of the method.
        setting: Name of the compiler setting.
        times: Nanoseconds of a step of a state on one core, in each round.
        difference: Largest relative difference from the first program.
    """

    program: str
    method: str
    setting: str
    times: tuple[float, ...]
    difference: float

    def cells(self, standard: Row) -> list[str]:
        """Return the cells of the row, with the median over that of `standard`."""
        median, first = float(np.median(self.times)), float(np.median(standard.times))
        share = f"1/{first / median:.1f}" if median < first else f"{median / first:.2f}"
        spread = f"{ns(min(self.times))}-{ns(max(self.times))}"
        return [self.program, self.method, self.setting, ns(median), spread, share, f"{self.difference:.0e}"]


def document(
    model: str,
    system: System,
    length: Length,
    states: int,
    few: int,
    rows: Sequence[Row],
    notes: Sequence[str],
    missing: Sequence[str],
    machine: Machine,
) -> str:
    """Return the page.

    Args:
        model: Name of the model.
        system: The model that was timed.
        length: Length of the motions.
        states: Number of states of a batch of kanegen.
        few: Number of states on which the others are timed.
        rows: All programs; ratios are over the first.
        notes: What was changed in the model so that all programs compute it.
        missing: Programs that were left out, with the reasons.
        machine: Where the times were taken.
    """
    head = HEAD.format(
        model=model,
        n=len(system.freedoms),
        steps=length.steps,
        step=length.step,
        rounds=len(rows[0].times),
        states=states,
        few=few,
        compared=min(COMPARED, length.steps),
    )
    columns = ["program", "method", "compiler", "ns a step", "range", f"over {rows[0].program}", "differs by"]
    lines = [head, markdown_table(columns, [row.cells(rows[0]) for row in rows], left=3), ""]
    lines += [f"- {note}." for note in notes]
    lines += [f"- Left out: {one}" for one in missing]
    lines += ["", "## Where", "", *(f"- {line}" for line in machine.lines()), ""]
    return "\n".join(lines)
