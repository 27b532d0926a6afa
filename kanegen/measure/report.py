"""What a comparison found, for people and as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

Row = tuple[float, ...]


@dataclass(frozen=True)
class Evaluation:
    """One entry in one state, with all that is needed to compute it again; floats print with all digits.

    Attributes:
        state: Number of the state, from 0.
        entry: The entry, by the names of its freedoms.
        value: What the library gave.
        reference: What the reference gave.
        x: (n,) coordinates (rad, m).
        y: (n,) generalized speeds (rad/s, m/s).
        force: (N, 3) forces (N), or None.
        torque: (N, 3) torques (N m), or None.
        given: What only some systems read, by name of the argument.
    """

    state: int
    entry: str
    value: float
    reference: float
    x: Row
    y: Row
    force: tuple[Row, ...] | None
    torque: tuple[Row, ...] | None
    given: Mapping[str, Any]


@dataclass(frozen=True)
class Accuracy:
    """The error of one output over all states; see `compare` for the definitions.

    Attributes:
        output: Its name.
        normwise: Largest normwise error.
        normwise_median: Median over the states.
        componentwise: Largest componentwise error; this is what `bound` limits.
        componentwise_median: Median over the states.
        cancellation: Largest ratio of the terms' norm to the norm of their sum.
        bound: What the componentwise error may be.
        not_finite: Number of states in which the library gave NaN or infinity; their errors are infinite.
        worst: The entry with the largest componentwise error.
    """

    output: str
    normwise: float
    normwise_median: float
    componentwise: float
    componentwise_median: float
    cancellation: float
    bound: float
    not_finite: int
    worst: Evaluation

    @property
    def passed(self) -> bool:
        """Whether every entry in every state is finite and within the bound."""
        return self.not_finite == 0 and self.componentwise <= self.bound


@dataclass(frozen=True)
class Report:
    """A library against the reference.

    Attributes:
        system: Name of the system.
        states: How many random states.
        seed: Of the states.
        accuracies: One for each compared output.
        reason: Where the bound comes from.
    """

    system: str
    states: int
    seed: int
    accuracies: tuple[Accuracy, ...]
    reason: str

    @property
    def max_error(self) -> float:
        """The largest normwise error over all outputs and states; infinite where one was not finite."""
        return max(accuracy.normwise for accuracy in self.accuracies)

    @property
    def passed(self) -> bool:
        """Whether every entry of every output is finite and within its bound in every state."""
        return all(accuracy.passed for accuracy in self.accuracies)

    def table(self) -> str:
        """The errors as a table for people."""
        head = ("output", "normwise max", "median", "componentwise max", "median", "bound", "")
        rows = [head, *(_row(accuracy) for accuracy in self.accuracies)]
        widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
        return "\n".join(
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in rows
        )

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain data for JSON; NaN and infinity become strings, which strict JSON needs."""
        data = asdict(self)
        for row, accuracy in zip(data["accuracies"], self.accuracies, strict=True):
            row["passed"] = accuracy.passed
        data.update(max_error=self.max_error, passed=self.passed)
        plain: dict[str, Any] = _plain(data)
        return plain

    def __str__(self) -> str:
        """Verdict, table, the worst entry of what failed, and the reason of the bound."""
        verdict = "passed" if self.passed else "FAILED"
        lines = [
            f"{self.system}: {verdict} over {self.states} random states (seed {self.seed})",
            self.table(),
        ]
        lines += [_failure(accuracy) for accuracy in self.accuracies if not accuracy.passed]
        return "\n".join([*lines, self.reason])


def _row(accuracy: Accuracy) -> tuple[str, ...]:
    errors = (
        accuracy.normwise,
        accuracy.normwise_median,
        accuracy.componentwise,
        accuracy.componentwise_median,
        accuracy.bound,
    )
    verdict = "ok" if accuracy.passed else "FAILED"
    return (accuracy.output, *(f"{error:.1e}" for error in errors), verdict)


def _failure(accuracy: Accuracy) -> str:
    worst = accuracy.worst
    bad = accuracy.not_finite
    counted = f"{accuracy.output}: {bad} state{' is' if bad == 1 else 's are'} not finite\n" if bad else ""
    given = "" if worst.force is None else f"\n  force = {worst.force!r}\n  torque = {worst.torque!r}"
    given += "".join(f"\n  {name} = {value!r}" for name, value in worst.given.items())
    return (
        f"{counted}{accuracy.output}: worst in state {worst.state}, entry {worst.entry}: "
        f"{worst.value!r} instead of {worst.reference!r}\n  x = {worst.x!r}\n  y = {worst.y!r}{given}"
    )


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not abs(value) < float("inf"):
        return repr(value)
    return value
