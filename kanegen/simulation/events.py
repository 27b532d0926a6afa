"""Events: times at which an expression of the motion crosses zero, located to the rounding of the time."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.errors import ModelError, OptionError, StatusError, quoted
from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.grammar import syntax_tree
from kanegen.recursion.outputs import OUTPUTS
from kanegen.simulation.elements import elements
from kanegen.simulation.motion import Motion, speeds_are_rates
from kanegen.simulation.sampled_inputs import sampled
from kanegen.simulation.signals import Signal, state_variables
from kanegen.simulation.stretches import Integrator, Stretch

RISING, FALLING, BOTH = "rising", "falling", "both"
"""Directions of a crossing: from below zero to zero or above, from above to zero or below."""

_INSIDE = (0.2, 0.4, 0.6, 0.8)
"""Shares of a step at which an event is looked for beside the ends, so that two crossings are not missed."""

_DIRECTIONS: dict[type[ast.cmpop], str] = {
    ast.Gt: RISING,
    ast.GtE: RISING,
    ast.Lt: FALLING,
    ast.LtE: FALLING,
}


@dataclass(frozen=True)
class Event:
    """A condition whose beginning is an event, such as "x.pole > pi/2"; or an expression that crosses zero.

    Attributes:
        condition: A comparison of two expressions, which happens when it begins to hold; or one expression,
            which happens when it crosses zero in either direction. Expressions have variables t,
            x.<coordinate>, y.<speed> and elements of outputs, such as point_positions.tip.z. One that holds
            at the start, or whose sides are equal there, must first stop to hold.
        terminal: Whether the motion ends with the event.

    Example:
        kg.Event("point_positions.tip.z < 0", terminal=True)
    """

    condition: str
    terminal: bool = False


@dataclass(frozen=True)
class Occurrence:
    """An event that has happened.

    Attributes:
        condition: The condition of the event.
        time: Its time, s.
        direction: "rising" or "falling": how the expression, or the left side less the right side, crosses
            zero.
        x: (m,) coordinates at this time.
        y: (n,) generalized speeds at this time.
        terminal: Whether the motion ended with it.
    """

    condition: str
    time: float
    direction: str
    x: Floats
    y: Floats
    terminal: bool = False

    def __str__(self) -> str:
        return f"t = {self.time:.10g} s: {self.condition}"


@dataclass(frozen=True)
class Crossing:
    """A signal whose crossings of zero are events.

    Attributes:
        event: The event.
        signal: The signal that crosses zero.
        direction: "rising", "falling" or "both".
    """

    event: Event
    signal: Signal
    direction: str

    @classmethod
    def of(cls, event: Event | str, library: Library) -> Crossing:
        """Return the crossing of an event.

        Raises:
            OptionError: If the condition is neither an expression nor a comparison of two, or has a name that
                is not known.
        """
        event = Event(event) if isinstance(event, str) else event
        if not isinstance(event, Event) or not isinstance(event.condition, str):
            raise OptionError(f"events: {quoted(event)} is no event. Give a text such as 'x.pole > 1'.")
        text, direction = _difference(event.condition)
        return cls(event, Signal.of("event", text, library), direction)


def conditions(events: Sequence[Event | str]) -> list[str]:
    """Return the texts of events, before they are read."""
    return [event.condition if isinstance(event, Event) else str(event) for event in events]


def _difference(condition: str) -> tuple[str, str]:
    """Return the text of what crosses zero, and the direction.

    Raises:
        OptionError: If the condition compares more than two numbers, or is joined of several.
    """
    text = condition.strip()
    try:
        found = syntax_tree(text)
    except ModelError:
        return condition, BOTH  # which the grammar refuses, with the place
    if isinstance(found, ast.BoolOp) or (isinstance(found, ast.Compare) and len(found.ops) > 1):
        raise OptionError(f"event: {quoted(condition)} has several comparisons. Give each as an own event.")
    if not isinstance(found, ast.Compare):
        return condition, BOTH
    if type(found.ops[0]) not in _DIRECTIONS:
        raise OptionError(f"event: {quoted(condition)} compares by another sign than < <= > >=.")
    left, right = (ast.get_source_segment(text, side) for side in (found.left, found.comparators[0]))
    return f"({left}) - ({right})", _DIRECTIONS[type(found.ops[0])]


@dataclass(frozen=True)
class Watch:
    """Looks for events in the stretches of a motion.

    Attributes:
        motion: Right side of the equations of motion.
        integrator: The method, which integrates parts of a step again.
        crossings: What is looked for.
    """

    motion: Motion
    integrator: Integrator
    crossings: Sequence[Crossing]

    def found(self, stretch: Stretch) -> list[tuple[Occurrence, Floats]]:
        """Return the events of a stretch in the order of their times, each with the whole state."""
        points = self._points(stretch)
        times, states = points
        found = []
        for crossing in self.crossings:
            values = self._values(crossing, times, states)
            for place in self._changes(crossing, times, values):
                located = self._located(crossing, stretch, times, place, np.sign(values[place]))
                if located is not None:
                    found.append(located)
        return sorted(found, key=lambda one: one[0].time)

    def _points(self, stretch: Stretch) -> tuple[Doubles, Floats]:
        """Return times and states of a stretch, with points inside of each step by cubic interpolation."""
        rates = self._rates(stretch)
        lengths = np.diff(stretch.times)[:, None]
        parts = [stretch.states[:-1]]
        for share in _INSIDE:
            parts.append(_hermite(share, lengths, stretch.states, rates))
        shares = np.array([0.0, *_INSIDE])
        times = (stretch.times[:-1, None] + shares * lengths).reshape(-1)
        states = np.stack(parts, axis=1).reshape(-1, stretch.states.shape[-1])
        return np.append(times, stretch.times[-1]), np.concatenate([states, stretch.states[-1:]])

    def _rates(self, stretch: Stretch) -> Floats:
        """Return the rates of all states of a stretch."""
        if not self.motion.inputs.depend_on_state:
            return self._rates_at_once(stretch.times, stretch.states)
        rows = []
        for k, time in enumerate(stretch.times.tolist()):
            ends = stretch.times[max(k - 1, 0)], stretch.times[min(k + 1, len(stretch.times) - 1)]
            self.motion.interval = float(ends[0]), float(ends[1])
            rows.append(self.motion(time, stretch.states[k]))
        return np.stack(rows)

    def _rates_at_once(self, times: Doubles, states: Floats) -> Floats:
        """Return the rates of (T, k) states in one call, where what acts depends on the time alone.

        The rate of the work is left at 0, since no event looks at it.
        """
        motion, layout = self.motion, self.motion.state
        x, y = layout.x(states), layout.y(states)
        library = motion.library_at(float(times[0]), x[0], y[0])
        rows = sampled(motion.inputs, times, times) | self._time(times)
        given: dict[str, Any] = {name: values.astype(y.dtype) for name, values in rows.items()}
        motion.evaluations += len(times)
        accelerations = library.forward_dynamics(x, y, **given)
        named = {name: given[name] for name in library.further_inputs if name in given}
        rates = y if speeds_are_rates(library) else library.coordinate_rates(x, y, **named)
        return layout.join(rates, accelerations, np.zeros(len(times), y.dtype))

    def _values(self, crossing: Crossing, times: Doubles, states: Floats) -> Doubles:
        """Return the values of what crosses zero in many states.

        Raises:
            StatusError: If one is not defined.
        """
        library, layout = self.motion.library, self.motion.state
        x, y = layout.x(states), layout.y(states)
        variables: dict[str, Any] = {"t": times, **state_variables(library, x, y)}
        for name in crossing.signal.outputs:
            variables |= self._elements(name, times, x, y)
        values = np.broadcast_to(crossing.signal(variables), times.shape)
        if not np.isfinite(values).all():
            at = times[~np.isfinite(values)][0]
            raise StatusError(f"at t = {at:.9g} s: event {crossing.event.condition!r} has no finite value.")
        return np.asarray(values, np.float64)

    def _elements(self, output: str, times: Doubles, x: Floats, y: Floats) -> dict[str, Floats]:
        """Return the elements of an output in many states, by name."""
        library = self.motion.library
        given: dict[str, Any] = {"x": x, "y": y}
        if not self.motion.inputs.are_absent:
            given |= self.motion.inputs.over(times, x, y)
        if "ydot" in OUTPUTS[output].inputs or output == "forward_dynamics":
            taken = ("tau", "force", "torque", *library.further_inputs)
            forces = {name: given[name] for name in taken if name in given}
            given["ydot"] = library.forward_dynamics(x, y, **forces, **self._time(times))
        arguments = {name: given[name] for name in OUTPUTS[output].arguments if name in given}
        named = {name: given[name] for name in library.further_inputs if name in given}
        values = getattr(library, output)(**arguments, **named, **self._time(times))
        flat = values.reshape(len(times), -1)
        return {one.name: flat[:, k] for k, one in enumerate(elements(library.source, output))}

    def _time(self, times: Doubles) -> dict[str, Doubles]:
        """Return the times as an argument, where the library takes them."""
        return {"t": times} if "t" in self.motion.library.further_inputs else {}

    def _changes(self, crossing: Crossing, times: Doubles, values: Doubles) -> Iterator[int]:
        """Yield the places behind which a crossing in the direction of an event lies."""
        signs = np.sign(values)
        leaves = (signs[:-1] != 0) & (signs[1:] != signs[:-1])
        if crossing.direction != BOTH:
            leaves &= signs[:-1] == (-1 if crossing.direction == RISING else 1)
        yield from np.flatnonzero(leaves).tolist()

    def _located(
        self, crossing: Crossing, stretch: Stretch, times: Doubles, place: int, sign: float
    ) -> tuple[Occurrence, Floats] | None:
        """Return an event, by bisection on parts of the step that are integrated again.

        Returns None if the interpolation has shown a crossing that the integration does not confirm.

        Args:
            crossing: What crosses zero.
            stretch: The stretch with the step.
            times: Times of the points at which the event was looked for.
            place: Place of the last point before the crossing.
            sign: Sign at that point.
        """
        step = place // (len(_INSIDE) + 1)
        begin, state = float(stretch.times[step]), stretch.states[step]

        def at(time: float) -> Floats:
            """Return the state at a time of the step."""
            return state if time == begin else self.integrator.advance(begin, state, time)

        def is_after(time: float) -> bool:
            """Return whether the crossing lies before a time of the step, or at it."""
            return bool(np.sign(self._values(crossing, np.array([time]), at(time)[None])[0]) != sign)

        for low, high in (times[place : place + 2].tolist(), stretch.times[step : step + 2].tolist()):
            if not is_after(low) and is_after(high):
                time = _first(is_after, low, high)
                break
        else:
            return None
        whole, layout = at(time), self.motion.state
        direction = RISING if sign < 0 else FALLING
        event = crossing.event
        return (
            Occurrence(event.condition, time, direction, layout.x(whole), layout.y(whole), event.terminal),
            whole,
        )


def _hermite(share: float, lengths: Doubles, states: Floats, rates: Floats) -> Floats:
    """Return states at a share of each step, by the cubic through the ends with their rates."""
    s, r = share, 1 - share
    ends = r * r * (1 + 2 * s) * states[:-1] + s * s * (3 - 2 * s) * states[1:]
    found: Floats = ends + lengths * (r * r * s * rates[:-1] - s * s * r * rates[1:])
    return found


def _first(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Return the first time at which a condition holds, of which no double lies between it and a time before.

    Args:
        holds: The condition, which does not hold at `low` and holds at `high`.
        low: Time before.
        high: Time after.
    """
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def require_events(events: object) -> tuple[Event | str, ...]:
    """Return one or several events as a tuple.

    Raises:
        OptionError: If `events` is neither.
    """
    if isinstance(events, (str, Event)):
        return (events,)
    try:
        return tuple(events)  # type: ignore[arg-type]
    except TypeError:
        raise OptionError(
            f"events: {quoted(events)} is no event. Give a text such as 'x.pole > 1'."
        ) from None
