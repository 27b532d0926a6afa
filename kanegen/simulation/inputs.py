"""What acts on a system from outside: functions of the caller, expressions, and tables over the time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, call_named, quoted
from kanegen.library import Library
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.components import AXES
from kanegen.simulation.input_tables import InputTable, read_table
from kanegen.simulation.signals import Signal, TimeFunction, require_arguments, state_variables
from kanegen.simulation.tables import TIME
from kanegen.simulation.turning import NO_TURNS, Acting, Sampled, Turns, turns_of

Effort = Callable[[float, Floats, Floats], ArrayLike]
"""Function that returns {tau}, of the shape of {y}, from the time (s), {x} and {y}."""

PrescribedMotion = Callable[[float], ArrayLike]
"""Function of the time (s) that returns (3, p) values, rates and accelerations of the prescribed freedoms."""

Interval = tuple[float, float]
"""Two times (s) between which no input of a table jumps."""

InputSource = Mapping[str, Any] | str | Path
"""Numbers, expressions and functions of the time by name; values over the time by name, with the column "t";
or a file of such."""

_SHAPED = {"force": "body", "torque": "body", "point_force": "point", "point_moment": "point"}


@dataclass(frozen=True)
class Place:
    """Where an input acts.

    Attributes:
        argument: Argument of `Library.forward_dynamics`, such as "tau".
        index: Index in this argument.
    """

    argument: str
    index: tuple[int, ...]

    @property
    def elements(self) -> Any:
        """The index in the argument of one state, or of many."""
        return (..., *self.index)


def places(library: Library) -> dict[str, Place]:
    """Return all inputs of a library by name: freedoms, prescribed freedoms, and components of loads.

    Example:
        places(library)["force.arm.x"]  # Place(argument="force", index=(0, 0))
    """
    model = library.source.model
    found = {name: Place("tau", (k,)) for k, name in enumerate(library.freedom_names)}
    found |= {f"tau.{name}": place for name, place in found.items()}
    found |= {name: Place("prescribed", (k,)) for k, name in enumerate(library.prescribed_names)}
    rows = {"body": zip(model.body_names, model.loaded, strict=True)}
    rows["point"] = zip(library.point_names, model.loaded_points or [False] * len(model.points), strict=True)
    loaded = {kind: [(k, name) for k, (name, takes) in enumerate(of) if takes] for kind, of in rows.items()}
    for argument, kind in _SHAPED.items():
        for row, name in loaded[kind]:
            found |= {f"{argument}.{name}.{axis}": Place(argument, (row, k)) for k, axis in enumerate(AXES)}
    return found


@dataclass(frozen=True)
class Inputs:
    """All that acts from outside on the motion of a library.

    Attributes:
        library: The library.
        effort: Function of the caller that returns {tau}, or None.
        prescribed: Function of the caller that returns the prescribed motion, or None.
        signals: Expressions, and functions of the time, by the places where they act.
        columns: Places of columns of tables over the time, each with its table and its number in it.
        turns: Times to which adaptive steps lead at most, see `with_turns`.
    """

    library: Library
    effort: Effort | None = None
    prescribed: PrescribedMotion | None = None
    signals: tuple[tuple[Place, Signal | TimeFunction], ...] = ()
    columns: tuple[tuple[Place, InputTable, int], ...] = ()
    turns: Turns = NO_TURNS

    @classmethod
    def of(
        cls,
        library: Library,
        effort: Effort | None = None,
        prescribed: PrescribedMotion | None = None,
        sources: InputSource | Sequence[InputSource] | None = None,
        hold: str = "zero",
    ) -> Inputs:
        """Return the inputs that a caller gives, checked.

        Args:
            library: The library.
            effort: Function that returns {tau}.
            prescribed: Function that returns the prescribed motion.
            sources: Expressions, values over the time, and files of such values.
            hold: How values over the time continue to the next one, "zero" or "linear".

        Raises:
            OptionError: If an input does not exist or is given twice, an expression cannot be read, or a
                prescribed freedom has no motion.
            ReadError: If a file cannot be read.
        """
        for label, function, names in (
            ("effort", effort, ("t", "x", "y")),
            ("prescribed", prescribed, ("t",)),
        ):
            if callable(function):
                require_arguments(label, function, names)
        known = places(library)
        signals: list[tuple[Place, Signal | TimeFunction]] = []
        tables = []
        for source in _listed(sources):
            if isinstance(source, Mapping) and TIME not in source:
                signals += [_signal(name, text, known, library) for name, text in source.items()]
            else:
                tables.append(read_table(source, hold, tuple(known), library))
        columns = [(known[name], table, k) for table in tables for k, name in enumerate(table.names)]
        found = cls(library, effort, prescribed, tuple(signals), tuple(columns))
        found._check_once()
        found._check_prescribed()
        return found

    def of_library(self, library: Library) -> Inputs:
        """Return the same inputs for the same model in another precision."""
        return self if library is self.library else replace(self, library=library)

    def with_turns(self, times: Doubles, x: Floats, y: Floats) -> Inputs:
        """Return the inputs with the times at which their expressions, and those of the model, turn.

        Args:
            times: (T,) times of the motion, s.
            x: (..., m) first coordinates.
            y: (..., n) first generalized speeds.
        """
        expressions = [signal.expression for _, signal in self.signals if isinstance(signal, Signal)]
        functions: list[Sampled] = [
            signal.with_rates for _, signal in self.signals if isinstance(signal, TimeFunction)
        ]
        if self.prescribed is not None:
            functions.append(self._prescribed_over)
        acting = Acting(tuple(expressions), tuple(functions), self.effort is not None)
        return replace(self, turns=turns_of(self.library, acting, times, x, y))

    def _prescribed_over(self, times: Doubles) -> tuple[Doubles, ...]:
        """Return the values of the prescribed motion of the caller at (K,) times (s), one row a freedom."""
        return tuple(np.stack([self.prescribed_at(time)[0] for time in times.tolist()]).T)

    def prescribed_at(self, time: float) -> Doubles:
        """Return the (3, p) numbers of the prescribed motion of the caller at a time (s).

        Raises:
            OptionError: If its function returns another shape, or something that is no finite real number, or
                fails.
        """
        motion, shape = self.prescribed, self.shape("prescribed")
        assert motion is not None
        found = call_named("prescribed", lambda moment: np.array(motion(moment)), time)
        if found.dtype.kind not in "iuf" or found.shape != shape:
            raise OptionError(
                f"prescribed: at t = {time:.9g} s it returned {found.dtype} of shape {found.shape}; expected "
                f"real numbers of shape {shape}: values, rates and second derivatives."
            )
        if not np.isfinite(found).all():
            raise OptionError(f"prescribed: at t = {time:.9g} s it returned a number that is not finite.")
        return found if found.dtype.kind == "f" else found.astype(np.float64)

    def _check_once(self) -> None:
        """Make sure that no input is given twice."""
        acting = [place for place, _ in self.signals] + [place for place, *_ in self.columns]
        for k, place in enumerate(acting):
            if place in acting[:k]:
                raise OptionError(f"input {self._name(place)}: it is given twice. Give it once.")

    def _check_prescribed(self) -> None:
        """Make sure that the motion of each prescribed freedom is given exactly once."""
        names = self.library.prescribed_names
        given = {place.index[0] for place, _ in self.signals if place.argument == "prescribed"}
        if any(place.argument == "prescribed" for place, *_ in self.columns):
            raise OptionError(
                "inputs: a table gives no rates and accelerations, which a prescribed freedom needs. Give an "
                f"expression of t, such as {names[0]}=0.1*sin(t)."
            )
        if self.prescribed is not None and not names:
            raise OptionError(
                f"prescribed: no freedom of system {self.library.name!r} is prescribed. Leave it out."
            )
        if self.prescribed is not None and given:
            raise OptionError("prescribed: inputs give the motion of prescribed freedoms, too. Give it once.")
        missing = [name for k, name in enumerate(names) if k not in given]
        if missing and self.prescribed is None:
            raise OptionError(
                f"system {self.library.name!r} has prescribed freedoms ({', '.join(missing)}). Say how they "
                f"move, each by an expression of t: --input '{missing[0]}=0.1*sin(t)', and in Python "
                f"inputs={{{missing[0]!r}: '0.1*sin(t)'}} or a function, prescribed=motion."
            )

    @property
    def are_absent(self) -> bool:
        """Whether nothing acts from outside."""
        return not (self.effort or self.prescribed or self.signals or self.columns)

    @property
    def depend_on_state(self) -> bool:
        """Whether something that acts may depend on anything but the time."""
        return self.effort is not None or any(signal.depends_on_state for _, signal in self.signals)

    @property
    def are_held(self) -> bool:
        """Whether all that acts is constant between the times of tables."""
        others = self.effort or self.prescribed or self.signals
        return not others and all(table.hold == "zero" for table in self._tables)

    @property
    def arguments_given(self) -> set[str]:
        """Names of the arguments of `Library.forward_dynamics` that are not left out."""
        found = {place.argument for place, _ in self.signals} | {place.argument for place, *_ in self.columns}
        found |= {"tau"} if self.effort is not None else set()
        return found | ({"prescribed"} if self.prescribed is not None else set())

    @property
    def jumps(self) -> Doubles:
        """(K,) times (s) at which a column of a table jumps."""
        times = [table.times for table in self._tables if table.hold == "zero"]
        return np.unique(np.concatenate(times)) if times else np.empty(0)

    @property
    def breaks(self) -> Doubles:
        """(K,) times (s) at which a column of a table jumps or bends."""
        times = [table.times for table in self._tables]
        return np.unique(np.concatenate(times)) if times else np.empty(0)

    @property
    def _tables(self) -> list[InputTable]:
        """All tables, each of them once."""
        return list({id(table): table for _, table, _ in self.columns}.values())

    def require_span(self, begin: float, end: float) -> None:
        """Make sure that a table has values from the first time to the last.

        Raises:
            OptionError: If it begins later or ends earlier.
        """
        for table in self._tables:
            table.require_span(begin, end)

    def arguments(self, time: float, x: Floats, y: Floats, interval: Interval) -> dict[str, Floats]:
        """Return what acts at a time (s) as arguments of `Library.forward_dynamics`.

        Args:
            time: The time, s.
            x: (..., m) coordinates.
            y: (..., n) generalized speeds.
            interval: Times between which the step lies, for inputs that jump at its ends.
        """
        found: dict[str, Floats] = {}
        if self.effort is not None:
            found["tau"] = self._efforts(self.effort, time, x, y)
        if self.prescribed is not None:
            found["prescribed"] = self.prescribed_at(time).astype(y.dtype)
        if self.signals:
            self._add_signals(found, time, x, y)
        for place, table, column in self.columns:
            self._array(found, place, y)[place.elements] += table.at(column, time, interval)
        return found

    def _add_signals(self, found: dict[str, Floats], time: float, x: Floats, y: Floats) -> None:
        """Add the values of the signals to the arguments."""
        variables: dict[str, Any] = {"t": np.float64(time)}
        if any(signal.depends_on_state for _, signal in self.signals):
            variables |= state_variables(self.library, x, y)
        for place, signal in self.signals:
            array = self._array(found, place, y)
            if place.argument == "prescribed":
                array[:, place.index[0]] = signal.with_rates(time)
            else:
                array[place.elements] += signal(variables)

    def not_finite_at(self, time: float, x: Floats, y: Floats) -> str:
        """Return the clause on the first expression that is not finite at a time (s): "" if there is none.

        Functions of the time that return such a number are refused when they are called.

        Args:
            time: The time, s.
            x: (..., m) coordinates.
            y: (..., n) generalized speeds.
        """
        variables: dict[str, Any] = {"t": np.float64(time)} | state_variables(self.library, x, y)
        for place, signal in self.signals:
            if isinstance(signal, TimeFunction):
                continue
            values = signal.with_rates(time) if place.argument == "prescribed" else (signal(variables),)
            for words, value in zip(
                ("is", "has the rate", "has the second derivative"), values, strict=False
            ):
                if not (finite := np.isfinite(value)).all():
                    return f"input {self._name(place)}: {signal.text} {words} {value[~finite].flat[0]}"
        return ""

    def _name(self, place: Place) -> str:
        """Return the name by which a caller gives the input that acts at a place."""
        return next(name for name, one in places(self.library).items() if one == place)

    def _array(self, found: dict[str, Floats], place: Place, y: Floats) -> Floats:
        """Return the argument of a place, which is made of zeros where it is not there yet."""
        if place.argument not in found:
            lead = () if place.argument == "prescribed" else y.shape[:-1]
            found[place.argument] = np.zeros((*lead, *self.shape(place.argument)), y.dtype)
        return found[place.argument]

    def shape(self, argument: str) -> tuple[int, ...]:
        """Return the shape of an argument of `Library.forward_dynamics` for one state."""
        if argument == "tau":
            return (self.library.n,)
        if argument == "prescribed":
            return 3, len(self.library.prescribed_names)
        rows = {"body": len(self.library.source.model.body_names), "point": len(self.library.point_names)}
        return rows[_SHAPED[argument]], 3

    def _efforts(self, effort: Effort, time: float, x: Floats, y: Floats) -> Floats:
        """Return the generalized forces of a function, of the type of {y}, after a check of their shape.

        The function gets a copy of the state, since it may compute in place.
        """
        tau = call_named("effort", lambda *given: np.asarray(effort(*given)), time, x.copy(), y.copy())
        if tau.dtype.kind not in "iuf" or tau.shape not in (y.shape, y.shape[-1:]):
            raise OptionError(
                f"effort: at t = {time:.9g} s it returned {tau.dtype} of shape {tau.shape}; expected real "
                f"numbers of shape {y.shape}, one for each speed."
            )
        return np.array(np.broadcast_to(tau, y.shape), y.dtype)

    def over(self, times: Floats, x: Floats, y: Floats) -> dict[str, Floats]:
        """Return what acts at many times, by argument, with a first axis for the times.

        At a jump of a table it is the value that holds from there on; at the last time the one before.
        """
        if self.are_absent:
            return {}
        ends = np.append(times[1:], times[-1])
        before = np.append(times[:1], times[:-1])
        rows = [
            self.arguments(time, x[k], y[k], (time, after) if after > time else (before[k], time))
            for k, (time, after) in enumerate(zip(times.tolist(), ends.tolist(), strict=True))
        ]
        return {name: np.stack([row[name] for row in rows]) for name in rows[0]}


def _listed(sources: InputSource | Sequence[InputSource] | None) -> Sequence[InputSource]:
    """Return one or several sources as a list.

    Raises:
        OptionError: If a source is neither a table nor the name of a file.
    """
    if sources is None:
        return ()
    several = (sources,) if isinstance(sources, Mapping | str | Path) else sources
    for one in several if isinstance(several, Sequence) else (several,):
        if not isinstance(one, Mapping | str | Path):
            raise OptionError(f"inputs: {quoted(one)} is no table by name, and not the name of a file.")
    return several


def _signal(
    name: Any, text: Any, known: Mapping[str, Place], library: Library
) -> tuple[Place, Signal | TimeFunction]:
    """Return the place and the signal of an input."""
    if name not in known:
        raise OptionError(f"inputs: there is no {quoted(name)}. {did_you_mean(name, known)}")
    if callable(text):
        require_arguments(f"input {name}", text, ("t",))
        count = 3 if known[name].argument == "prescribed" else 1
        return known[name], TimeFunction(f"input {name}", text, count)
    place, signal = known[name], Signal.of(f"input {name}", text, library)
    if signal.outputs:
        raise OptionError(f"input {name}: it cannot depend on the output {signal.outputs[0]!r}.")
    if place.argument == "prescribed" and signal.depends_on_state:
        raise OptionError(f"input {name}: a prescribed motion is an expression of t alone.")
    return place, signal
