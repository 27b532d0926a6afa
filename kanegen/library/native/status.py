"""The status that a C function returns: what it means, and how a library reports it.

A status other than 0 becomes a `StatusReport`, which says in words what is wrong, in which state, and where.
One rule, `report`, turns it into a warning, an error or nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kanegen.c import ModelDescription
from kanegen.c.interface import PREPARE, Function
from kanegen.choices import require_one
from kanegen.errors import LONGEST_MESSAGE, OptionError, SingularError, StatusError, excerpt, warn
from kanegen.model.arguments import Floats
from kanegen.program.ir import Array, RowCondition

ON_STATUS = ("warn", "raise", "ignore")
"""What a library may do where a result is missing, not finite or not accurate."""

States = NDArray[np.intp]
"""Numbers of states in a batch."""

MISSING = "missing"
"""A state has no result, such as accelerations where [A] is singular: its numbers are NaN."""

NOT_FINITE = "not finite"
"""A number in a result is infinite or NaN."""

NOT_CONVERGED = "not converged"
"""The iteration that finds a result does not converge, as in an implicit step that is too long: it is NaN."""

INACCURATE = "inaccurate"
"""A result is finite, but its errors may be large."""

_KINDS = (MISSING, NOT_CONVERGED, NOT_FINITE, INACCURATE)

NO_CONVERGENCE = "the iteration for the step does not converge"
TOO_LONG = (
    "the step is too long for the method. Take a shorter step, or linearly_implicit for a stiff system."
)
"""What is wrong where an iteration does not converge, and the usual cause with what helps."""

_WITHOUT_RESULT = (MISSING, NOT_CONVERGED)
"""Kinds of statuses of states that have no result."""


@dataclass(frozen=True)
class StatusReport:
    """What is wrong with the results of one call.

    Attributes:
        message: One or two sentences with the function, the first state concerned, and the freedom or the
            element of the result.
        kind: `MISSING`, `NOT_CONVERGED`, `NOT_FINITE` or `INACCURATE`; the first of these that occurs in a
            batch.
        is_alone: Whether the call was for one state, and not for a batch.
        states: Number of states concerned.
        of_step: For a function that makes steps the sentence without its name and the time of the step; ""
            for others.
    """

    message: str
    kind: str
    is_alone: bool
    states: int = 1
    of_step: str = ""

    @property
    def error(self) -> StatusError:
        """The error that this report becomes where errors are asked for."""
        return (SingularError if self.kind == MISSING else StatusError)(self.message)


OnStatus = str | Callable[[StatusReport], object]
"""One of `ON_STATUS`, or a function that takes every report."""


def checked_on_status(value: OnStatus) -> OnStatus:
    """Return a value of the option `on_status`, after a check.

    Raises:
        OptionError: If the value is neither one of `ON_STATUS` nor a function.
    """
    if not callable(value):
        try:
            require_one("on_status", value, ON_STATUS)
        except OptionError as error:
            raise OptionError(f"{error} A function that takes a StatusReport fits, too.") from None
    return value


def report(found: StatusReport, on_status: OnStatus) -> None:
    """Report what is wrong with the results of a call: the one rule for all functions of a library.

    "raise" raises an error. "warn" gives one `KanegenWarning` for the call, at the line outside kanegen that
    made it; but where the only state that was asked for has no result, there is nothing to return and it
    raises too. A function is called with the report.

    Raises:
        StatusError: If errors are asked for; a `SingularError` where a result is missing.
    """
    if callable(on_status):
        on_status(found)
    elif on_status == "raise" or (on_status == "warn" and found.kind in _WITHOUT_RESULT and found.is_alone):
        raise found.error
    elif on_status == "warn":
        warn(found.message)


def naming(changed: Mapping[str, float], on_status: OnStatus) -> OnStatus:
    """Return a rule whose reports also name the run-time parameters that were set, if there are any."""
    if not changed or on_status == "ignore":
        return on_status
    values = excerpt(
        ", ".join(f"{name} = {value:g}" for name, value in changed.items()), LONGEST_MESSAGE // 4
    )

    def rule(found: StatusReport) -> None:
        further = f" The parameters set were {values}."
        of_step = found.of_step and found.of_step + further
        report(replace(found, message=found.message + further, of_step=of_step), on_status)

    return rule


@dataclass(frozen=True)
class Status:
    """The meanings of the statuses of one C function.

    Attributes:
        name: Name of the function.
        freedoms: For each freedom its name, and the name of the speed where the speed is no rate.
        bodies: For each freedom the name of its body.
        quantity: Name of the quantity that is positive where a result exists.
        failure: Clause on the state where the quantity is not positive, such as "[A] is singular".
        outputs: Arrays of the results.
        force_elements: One line of text for each force element that is undefined in some state.
        rows: Names of the rows of outputs with a condition for each row, in the order of their places.
        row_conditions: The conditions for rows of the outputs.
        not_converged: The status of an iteration that does not converge; None for a function without one.
        remedy: Clause on what helps where most digits are lost at a freedom.
        homogeneous: For each orientation by homogeneous coordinates, such as a quaternion, the names of these
            coordinates by their places in {x}.
    """

    name: str
    freedoms: tuple[str, ...]
    bodies: tuple[str, ...]
    quantity: str
    failure: str
    outputs: tuple[Array, ...]
    force_elements: tuple[str, ...]
    remedy: str = ""
    homogeneous: tuple[Mapping[int, str], ...] = ()
    rows: tuple[str, ...] = ()
    row_conditions: tuple[RowCondition, ...] = ()
    not_converged: int | None = None

    @classmethod
    def of(cls, function: Function, model: ModelDescription) -> Status:
        """Return the meanings of the statuses of `function`."""
        pairs = zip(model.freedom_names, model.speeds, strict=True)
        return cls(
            name=function.name,
            freedoms=tuple(f"{name}, {speed}" if speed else name for name, speed in pairs),
            bodies=model.freedom_bodies,
            quantity=function.quantity,
            failure=function.failure,
            remedy=next((condition.remedy for condition in function.conditions), ""),
            outputs=function.outputs,
            force_elements=() if function.name == PREPARE else model.undefined_somewhere,
            homogeneous=tuple(
                {place: model.coordinate_names[place] for place in places} for places in model.homogeneous
            ),
            rows=model.rows,
            row_conditions=function.row_conditions,
            not_converged=model.not_converged if function.may_not_converge else None,
        )

    def of_state(self, status: int, inputs: Mapping[str, Floats], results: Sequence[Floats]) -> StatusReport:
        """Return the report of a single state.

        Args:
            status: Status other than 0 that the C function returned.
            inputs: Arrays that it has read, by name.
            results: Arrays that it has filled.
        """
        clause = self.clause(status, inputs, results)
        if status < 0:
            clause = f"the result is not accurate in this state. {clause[0].upper()}{clause[1:]}"
        message = f"{self.name}: {clause}"
        return StatusReport(message, self.kind(status), is_alone=True)

    def of_batch(
        self,
        failed: int,
        inputs: Mapping[str, Floats],
        results: Sequence[Floats],
        status_of: Callable[[States], int],
    ) -> StatusReport:
        """Return the report of a batch, with the first state of each kind.

        Args:
            failed: Number of states with a status other than 0.
            inputs: Arrays that were read, by name, each with an axis for the states.
            results: Arrays that were filled.
            status_of: Function that returns the status of a state, or of several how many have another
                status than 0.
        """
        rows = [np.isfinite(array.reshape(len(array), -1)).all(axis=1) for array in results]
        finite = np.logical_and.reduce(rows)
        bad, good = np.flatnonzero(~finite), np.flatnonzero(finite)
        found = [("does not exist or is not finite", len(bad), bad[:1])] if len(bad) else []
        if failed > len(bad):
            found.append(("is not accurate", failed - len(bad), _first(good, status_of)))
        sentences, kinds = [], []
        for words, count, first in found:
            status, state = status_of(first), int(first[0])
            here = {name: array[state] for name, array in inputs.items()}
            clause = self.clause(status, here, [array[state] for array in results])
            sentences.append(
                f"in {count} of {len(finite)} states the result {words}; in state {state} {clause}"
            )
            kinds.append(self.kind(status))
        message = f"{self.name}: {' Also '.join(sentences)}"
        return StatusReport(message, min(kinds, key=_KINDS.index), is_alone=False, states=failed)

    def kind(self, status: int) -> str:
        """Return the kind of a status other than 0."""
        if status < 0:
            return INACCURATE
        if status == self.not_converged:
            return NOT_CONVERGED
        return NOT_FINITE if status == len(self.freedoms) + 1 else MISSING

    def clause(self, status: int, inputs: Mapping[str, Floats], results: Sequence[Floats]) -> str:
        """Return the sentences on a state, without a capital letter at the beginning."""
        if status == self.not_converged:
            cause = self.bad_input(inputs)
            return f"{NO_CONVERGENCE}: {cause}." if cause else f"{NO_CONVERGENCE}: {TOO_LONG}"
        row, condition = self._row(status)
        if self.kind(status) == MISSING:
            quantity, failure = self.quantity, self.failure
            if condition:
                quantity, failure = condition.quantity, condition.failure
            return (
                f"the {quantity} at {row or self._freedom(status - 1)} is not positive or is NaN: "
                f"{self.bad_input(inputs) or failure + ' in this state'}."
            )
        if status < 0 and condition:
            return f"most digits are lost at {row}: {condition.loss}; a higher precision helps."
        if status < 0:
            return f"most digits are lost at {self._freedom(-status - 1)}; {self.remedy}."
        return self._not_finite(inputs, results)

    def _not_finite(self, inputs: Mapping[str, Floats], results: Sequence[Floats]) -> str:
        """Return the sentences on a state one of whose results is infinite or NaN."""
        for array, values in zip(self.outputs, results, strict=True):
            place = _first_infinite(values)
            if place is not None:
                where = f", at {self._freedom(place[0])}" if array.of_freedoms else ""
                cause = self.bad_input(inputs)
                reason = f", because {cause}." if cause else self._hint()
                return f"{_element(array.name, values, place)}{where}{reason}"
        return "a result is not finite."

    def bad_input(self, inputs: Mapping[str, Floats]) -> str:
        """Return the clause on an input that has no results in any model: "" if there is none.

        Such an input is infinite or NaN, or a quaternion without a length.
        """
        if clause := _unless_finite(inputs):
            return clause
        for names in self.homogeneous if "x" in inputs else ():
            values = inputs["x"][list(names)]
            if values.ndim > 1:  # pairs of doubles; the first one is the number to double precision
                values = values[:, 0]
            with np.errstate(all="ignore"):
                square = (values * values).sum()
            first, *_, last = names.values()
            if square == 0 or not np.isfinite(square):
                size = "length 0" if not values.any() else f"a length whose square is {square}"
                return f"x has a quaternion of {size}, which is no orientation: {first!r} to {last!r}"
        return ""

    def _hint(self) -> str:
        """Return the end of a sentence on a result that is not finite although all inputs are."""
        if not self.force_elements:
            return ", although every input is finite: a number overflows, or something is divided by 0."
        return (
            ", although every input is finite. A force element may be undefined in this state: "
            f"{'; '.join(self.force_elements)}."
        )

    def _row(self, status: int) -> tuple[str, RowCondition | None]:
        """Return the name and the condition of the row that a status is about; "" and None for a freedom."""
        place = abs(status) - len(self.freedoms) - 2
        if place < 0:
            return "", None
        condition = max((one for one in self.row_conditions if one.first <= place), key=lambda one: one.first)
        return f"row {self.rows[place]}", condition

    def _freedom(self, place: int) -> str:
        """Return the name of a freedom, from 0, and of its body."""
        body = f" of body {self.bodies[place]!r}" if self.bodies else ""
        return f"freedom {self.freedoms[place]!r}{body}"


def _first(states: States, status_of: Callable[[States], int]) -> States:
    """Return the first of some states that has another status than 0, by halving the states in question."""
    while len(states) > 1:
        half = states[: len(states) // 2]
        states = half if status_of(half) else states[len(half) :]
    return states


def _first_infinite(values: Floats) -> tuple[int, ...] | None:
    """Return the place of the first number that is infinite or NaN, None if there is none."""
    places = np.argwhere(~np.isfinite(values))
    return tuple(map(int, places[0])) if len(places) else None


def _unless_finite(inputs: Mapping[str, Floats]) -> str:
    """Return the clause on the first input that is infinite or NaN, "" if there is none."""
    for name, values in inputs.items():
        place = _first_infinite(values)
        if place is not None:
            return _element(name, values, place)
    return ""


def _element(name: str, values: Floats, place: tuple[int, ...]) -> str:
    """Return a clause such as "x[2] is nan"."""
    return f"{name}{list(place) if place else ''} is {values[place]}"
