"""The errors of all programs on the same states: their table, the worst state of each, and their picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kanegen.choices import require_one
from kanegen.measure.compared import OUTPUTS, term_magnitudes
from kanegen.measure.errors import quotient
from kanegen.measure.evaluation import Evaluation, evaluation
from kanegen.measure.programs.picture import Drawn, draw
from kanegen.measure.programs.program import (
    Program,
    of_reference,
    symbolic_programs,
    with_accelerations,
)
from kanegen.measure.programs.program_errors import ProgramErrors
from kanegen.measure.programs.yardstick import Yardstick, states_near_and_far, yardstick
from kanegen.model.arrays import Flags, Floats
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.pictures import html
from kanegen.pictures.picture import Picture
from kanegen.reference.states import States

_HEAD = ("program", "[A] max", "{f} max", "{ydot} max", "worst entry of {f}", "state")
"""Headings of the table of errors."""


@dataclass(frozen=True)
class Programs:
    """Programs that compute the equations of one system, measured in the same states.

    Attributes:
        system: The system.
        states: The B states; their numbers are those of single precision.
        truth: What the errors are measured against.
        programs: The errors of each program.
        notes: Sentences on what is absent, and why.

    Example:
        >>> programs = kg.compare(kg.load("models/double_pendulum.toml"), states=100).programs()
        >>> print(programs)
        >>> programs.worst("forcing", "C in single precision").x
        >>> programs.plot().write("programs.svg")
    """

    system: System
    states: States
    truth: Yardstick
    programs: tuple[ProgramErrors, ...]
    notes: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the programs."""
        return tuple(program.name for program in self.programs)

    def errors(self, program: str) -> ProgramErrors:
        """Return the errors of one program by its name.

        Raises:
            OptionError: If there is no such program.

        Example:
            >>> programs.errors("reference").entries["mass_matrix"].max()
        """
        require_one("program", program, self.names)
        return self.programs[self.names.index(program)]

    def worst(self, output: str = "forcing", program: str | None = None) -> Evaluation:
        """Return the entry with the largest error, and the state in which it occurs, to compute it again.

        Args:
            output: "mass_matrix" or "forcing".
            program: Name of a program; by default the one with the largest error of all.

        Raises:
            OptionError: If there is no such output or program.

        Example:
            >>> worst = programs.worst("mass_matrix")
            >>> worst.entry, worst.x, worst.y
        """
        require_one("output", output, OUTPUTS)
        if program is None:
            program = max(self.programs, key=lambda one: one.entries[output].max()).name
        one = self.errors(program)
        state, *entry = np.unravel_index(one.entries[output].argmax(), one.entries[output].shape)
        place = (state, *entry)
        return evaluation(
            self.system.speed_names,
            self.states,
            state=int(state),
            entry=tuple(map(int, entry)),
            value=float(one.values[output][place]),
            reference=float(self.truth.values[output][place]),
        )

    def plot(self) -> Picture:
        """Return the picture of all errors: entry by entry, and against the distance from singular states.

        Raises:
            MissingError: If matplotlib is not installed.

        Example:
            >>> programs.plot().write("programs.svg")
        """
        return draw(Drawn(self.system, self.states, self.truth.distances, self.programs))

    def __str__(self) -> str:
        """Return a table of the largest errors, a line for each program, and what is absent."""
        rows = [_HEAD, *map(self._row, self.programs)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        table = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in rows
        ]
        return "\n".join([f"{self.system.name}: {self._summary}", *table, *self.notes])

    def __repr__(self) -> str:
        """Name of the system and the names of the programs; `print` shows the table."""
        return f"<Programs of {self.system.name}: {', '.join(self.names)}>"

    def _repr_html_(self) -> str:
        """The table of the largest errors, and what is absent, for a notebook."""
        return html.shown(
            html.sentence("{}", self._summary, strong=self.system.name),
            html.table(_HEAD, map(self._row, self.programs), "print(programs)"),
            *(html.sentence("{}", note) for note in self.notes),
            html.sentence("{} shows the errors of every entry.", html.python("programs.plot()")),
        )

    @property
    def _summary(self) -> str:
        """What is measured, in words."""
        count = f"errors of {len(self.programs)} programs in {len(self.states)} states"
        return f"{count}, measured against {self.truth.words}"

    def _row(self, one: ProgramErrors) -> tuple[str, ...]:
        """Return the cells of the table's row for one program."""
        worst = self.worst("forcing", one.name)
        known = one.accelerations[~np.isnan(one.accelerations)]
        largest = f"{known.max():.1e}" if known.size else "-"
        sizes = [f"{one.entries[output].max():.1e}" for output in OUTPUTS]
        return (one.name, *sizes, largest, worst.entry, str(worst.state))


def measure_programs(
    system: System,
    compiled: Sequence[Program],
    states: int = 128,
    seed: int = 0,
    progress: Progress = quiet,
) -> Programs:
    """Measure the closed form, the definitions, the reference and compiled programs in the same states.

    Half of the states approach gimbal lock, if the system has one where [A] is singular. The reference is
    left out where errors are measured against it.

    Args:
        system: The system.
        compiled: Programs from compiled C.
        states: Number of states B.
        seed: Seed of the states.
        progress: Function that is called with the name of each stage.
    """
    notes: list[str] = []
    progress("writing symbolic programs")
    symbolic = list(symbolic_programs(system, notes))
    sample = states_near_and_far(system, states, seed)
    defined: Flags = np.all(np.isfinite(of_reference(system).results(sample)["forcing"]), axis=1)
    if defined.any() and not defined.all():
        left_out = int(np.count_nonzero(~defined))
        notes.append(f"{left_out} of {states} states are left out, because {{f}} is undefined there.")
        sample = sample.chosen(defined)
    progress("computing certified truth")
    truth = yardstick(system, sample)
    notes += [truth.note] if truth.note else []
    sizes = term_magnitudes(system.values(), sample)
    progress("measuring")
    reference = [of_reference(system)] if truth.certified else []
    every = [*symbolic, *reference, *compiled]
    measured = [_errors(program, sample, truth, sizes) for program in every]
    return Programs(system, sample, truth, tuple(measured), tuple(notes))


def _errors(program: Program, states: States, truth: Yardstick, sizes: Mapping[str, Floats]) -> ProgramErrors:
    """Return the errors of one program."""
    results = with_accelerations(program.results(states))
    entries = {
        output: quotient(truth.differences(output, results[output]), sizes[output]) for output in OUTPUTS
    }
    accelerations = truth.acceleration_errors(results["forward_dynamics"])
    return ProgramErrors(program.name, {name: results[name] for name in OUTPUTS}, entries, accelerations)
