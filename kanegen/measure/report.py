"""The outcome of a comparison with the reference: as a table, as text and as plain data."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from kanegen.errors import OptionError, quoted
from kanegen.measure.evaluation import Evaluation
from kanegen.measure.report_html import report_html
from kanegen.options import Progress, quiet

if TYPE_CHECKING:
    from kanegen.measure.programs.measured import Programs
    from kanegen.pictures.picture import Picture


@dataclass(frozen=True)
class Accuracy:
    """The errors of one output over all states; `comparison` defines them.

    Attributes:
        output: Name of the output.
        normwise: Largest normwise error.
        normwise_median: Median of the normwise errors.
        normwise_bound: Bound on the normwise error in the state where it is the largest: `bound` times the
            norm of the terms over the norm of the output there.
        componentwise: Largest componentwise error, which `bound` limits.
        componentwise_median: Median of the componentwise errors.
        cancellation: Largest ratio of the norm of the terms to the norm of their sum.
        bound: Largest componentwise error that is allowed.
        not_finite: Number of states in which the library gave NaN or infinity; their errors are infinite.
        worst: The entry with the largest componentwise error.
    """

    output: str
    normwise: float
    normwise_median: float
    normwise_bound: float
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
    """The comparison of a library with the reference.

    Attributes:
        system: Name of the system.
        states: Number of random states.
        seed: Seed of the random states.
        accuracies: The errors of each compared output.
        reason: Sentence that says where the bound comes from.
        limits: How many coordinates and speeds stay within limits of the model; "" if it has no limits.
        special: How many further states were compared, at rest, at the origin and at kinks of expressions.
        undefined: Sentences on random states in which a force element is undefined; "" for none.
        measure: Function that measures all programs of the system for `programs`; `kg.compare` gives it.

    Example:
        >>> report = kg.compare(kg.load("models/double_pendulum.toml"), states=100)
        >>> report.passed
        True
        >>> print(report)
        >>> report.plot().write("programs.svg")
    """

    system: str
    states: int
    seed: int
    accuracies: tuple[Accuracy, ...]
    reason: str
    limits: str = ""
    special: str = ""
    undefined: str = ""
    measure: Callable[..., Programs] | None = field(default=None, repr=False, compare=False)

    @property
    def max_error(self) -> float:
        """Largest normwise error of all outputs and states; infinite where a result is not finite."""
        return max(accuracy.normwise for accuracy in self.accuracies)

    @property
    def passed(self) -> bool:
        """Whether every entry of every output is finite and within its bound in every state."""
        return all(accuracy.passed for accuracy in self.accuracies)

    def programs(self, states: int = 128, progress: Progress = quiet) -> Programs:
        """Measure all programs that compute these equations, in the same states, against certified truth.

        They are the closed form and the definitions in NumPy, the reference, and C in double and in single
        precision. Half of the states approach gimbal lock, where the system has one. The seed is that of the
        report.

        Args:
            states: Number of states.
            progress: Function that is called with the name of each stage.

        Raises:
            OptionError: If the report does not come from `kg.compare`, or there are fewer than 2 states.

        Example:
            >>> programs = report.programs()
            >>> programs.worst("forcing", "C in single precision").x
        """
        if self.measure is None:
            raise OptionError("this report knows no system. Only a report of kg.compare measures programs.")
        if states < 2:
            raise OptionError(
                f"states is {quoted(states)}; two are the fewest that programs are measured in."
            )
        return self.measure(states=states, seed=self.seed, progress=progress)

    def plot(self, states: int = 128) -> Picture:
        """Return the picture of `programs`: errors of entries, and against distances from singular states.

        Raises:
            OptionError: As `programs`.
            MissingError: If matplotlib is not installed (extra `study`).

        Example:
            >>> report.plot().write("programs.svg")
        """
        return self.programs(states).plot()

    def table(self) -> str:
        """Return the errors as a table: for each output a row of componentwise and one of normwise errors.

        Each row has the bound on its own kind of error. Medians are those of the random states.

        Example:
            >>> print(kg.compare(kg.load("models/double_pendulum.toml"), states=100).table())
        """
        head = ("output", "error", "max", "median", "bound", "")
        rows = [head, *(row for accuracy in self.accuracies for row in _rows(accuracy))]
        widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
        return "\n".join(
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in rows
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain data for JSON, with NaN and infinity as strings.

        Example:
            >>> json.dumps(kg.compare(kg.load("models/double_pendulum.toml"), states=100).as_dict())
        """
        data = asdict(replace(self, measure=None))
        del data["measure"]
        for row, accuracy in zip(data["accuracies"], self.accuracies, strict=True):
            row["passed"] = accuracy.passed
            row["worst"]["given"] = row["worst"].pop("inputs")
        data.update(max_error=self.max_error, passed=self.passed)
        plain: dict[str, Any] = _plain(data)
        return plain

    def __repr__(self) -> str:
        """Name of the system, the verdict and the largest error; `print` shows the table."""
        verdict = "passed" if self.passed else "FAILED"
        return f"<Report of {self.system}: {verdict}, largest error {self.max_error:.1e}>"

    def _repr_html_(self) -> str:
        """The verdict, the errors and the worst entries, for a notebook."""
        rows = [row for accuracy in self.accuracies for row in _rows(accuracy)]
        worst = [(accuracy.output, accuracy.worst) for accuracy in self.accuracies]
        notes = [f"{self.states} random states, seed {self.seed}.", *self._notes, self.reason]
        return report_html(self.system, self.passed, rows, notes, worst)

    @property
    def _notes(self) -> list[str]:
        """Sentences on the states that were compared."""
        lines = [f"The states stay within the limits of the model, on {self.limits}."] if self.limits else []
        lines += [f"Further states: {self.special}."] if self.special else []
        return lines + ([self.undefined] if self.undefined else [])

    def __str__(self) -> str:
        """Return the verdict, the table, the worst entry of every output that failed, and the reason."""
        verdict = "passed" if self.passed else "FAILED"
        lines = [
            f"{self.system}: {verdict} over {self.states} random states (seed {self.seed})",
            self.table(),
        ]
        lines += self._notes
        lines += [_failure(accuracy) for accuracy in self.accuracies if not accuracy.passed]
        return "\n".join([*lines, self.reason])


def _rows(accuracy: Accuracy) -> Iterator[tuple[str, ...]]:
    """Yield the cells of the table's rows for one output."""
    one = accuracy
    kinds = {
        "componentwise": (one.componentwise, one.componentwise_median, one.bound),
        "normwise": (one.normwise, one.normwise_median, one.normwise_bound),
    }
    for kind, (largest, median, bound) in kinds.items():
        verdict = "ok" if largest <= bound else "FAILED"
        output = accuracy.output if kind == "componentwise" else ""
        yield (output, kind, f"{largest:.1e}", f"{median:.1e}", f"{bound:.1e}", verdict)


def _failure(accuracy: Accuracy) -> str:
    """Return the lines that show the worst entry of an output and how to compute it again."""
    worst = accuracy.worst
    bad = accuracy.not_finite
    counted = f"{accuracy.output}: {bad} state{' is' if bad == 1 else 's are'} not finite\n" if bad else ""
    loads = "" if worst.force is None else f"\n  force = {worst.force!r}\n  torque = {worst.torque!r}"
    loads += "".join(f"\n  {name} = {value!r}" for name, value in worst.inputs.items())
    return (
        f"{counted}{accuracy.output}: worst in state {worst.state}, entry {worst.entry}: "
        f"{worst.value!r} instead of {worst.reference!r}\n  x = {worst.x!r}\n  y = {worst.y!r}{loads}"
    )


def _plain(value: Any) -> Any:
    """Return `value` made of lists, dictionaries, strings and finite numbers alone."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not abs(value) < float("inf"):
        return repr(value)
    return value
