"""Signals: expressions of the time, the state and outputs, whose value at many times is wanted."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ModelError, OptionError, call_named
from kanegen.library import Library
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.expression import Expression, Parameter
from kanegen.model.grammar import parse_signal
from kanegen.model.nodes import TIME
from kanegen.reference.arithmetics import Dual
from kanegen.reference.expressions import evaluate
from kanegen.simulation.elements import elements

Variables = Mapping[str, np.floating | np.ndarray]
"""Values of variables by name, such as "t" and "x.pole"."""


@dataclass(frozen=True)
class Signal:
    """An expression of the time, the state and elements of outputs.

    Attributes:
        text: The expression as it was given.
        expression: The expression, with numbers in place of parameters.
    """

    text: str
    expression: Expression

    @classmethod
    def of(cls, label: str, text: object, library: Library) -> Signal:
        """Return the signal of a text.

        Args:
            label: What the signal is for, with which errors begin.
            text: The text, or a number.
            library: The library whose states, outputs and parameters the text may name.

        Raises:
            OptionError: If the text is no expression, or has a name that is not known.
        """
        parameters = library.parameters
        known = [Parameter(name, value) for name, value in parameters.items()]
        try:
            found = parse_signal(text, known, variable_names(library))
        except ModelError as error:
            raise OptionError(f"{label}: {error}") from None
        return cls(str(text), found.map_numbers(float_of))

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs, among whose elements the signal has variables."""
        groups = (name.partition(".")[0] for name in self.expression.variables)
        return tuple(dict.fromkeys(group for group in groups if group not in (TIME, "x", "y")))

    @property
    def depends_on_state(self) -> bool:
        """Whether the signal depends on anything but the time."""
        return any(name != TIME for name in self.expression.variables)

    def __call__(self, variables: Variables) -> np.ndarray:
        """Return the value for values of the variables, of their shape."""
        with np.errstate(all="ignore"):
            return np.asarray(evaluate(self.expression, variables, np.float64))

    def with_rates(self, times: ArrayLike) -> tuple[Doubles, Doubles, Doubles]:
        """Return value, rate and second derivative at a time or at many (s) of a signal of the time alone.

        The derivatives are exact: dual numbers of dual numbers carry them along.
        """
        one, zero = np.float64(1.0), np.float64(0.0)
        now = Dual(Dual(np.asarray(times, np.float64), one), Dual(one, zero))
        still = Dual(zero, zero)
        with np.errstate(all="ignore"):
            found = evaluate(self.expression, {TIME: now}, lambda c: Dual(Dual(np.float64(c), zero), still))
        parts = found.value.value, found.value.slope, found.slope.slope
        value, rate, second = (np.broadcast_to(part, np.shape(times)) for part in parts)
        return value, rate, second


@dataclass(frozen=True)
class TimeFunction:
    """A function of the caller of the time alone, in place of an expression.

    It returns a number or, for a prescribed freedom, its value, rate and second derivative. It is called at
    any times, also several times at one, so it must not remember calls.

    Attributes:
        label: What it is for, with which errors begin.
        function: The function.
        count: How many numbers it returns, 1 or 3.
    """

    label: str
    function: Callable[[float], ArrayLike]
    count: int = 1

    outputs: ClassVar[tuple[str, ...]] = ()
    depends_on_state: ClassVar[bool] = False

    def __call__(self, variables: Variables) -> np.ndarray:
        """Return the value at the time or the times of the variables, of their shape."""
        return self.with_rates(variables[TIME])[0]

    def with_rates(self, times: ArrayLike) -> tuple[Doubles, ...]:
        """Return the value, and rate and second derivative where there are such, at a time or at many (s)."""
        moments = np.asarray(times, np.float64)
        rows = np.array([self._at(time) for time in moments.ravel().tolist()]).reshape(-1, self.count)
        return tuple(column.reshape(moments.shape) for column in rows.T)

    def _at(self, time: float) -> Doubles:
        """Return the numbers at a time (s).

        Raises:
            OptionError: If there is another number of them, one is no finite real number, or the function
                fails.
        """
        found = call_named(self.label, lambda moment: np.array(self.function(moment)), time)
        if found.dtype.kind not in "iuf" or found.shape not in (
            (self.count,),
            () if self.count == 1 else (3,),
        ):
            expected = "a real number" if self.count == 1 else "value, rate and second derivative"
            raise OptionError(
                f"{self.label}: at t = {time:.9g} s the function returned {found.dtype} of shape "
                f"{found.shape}; expected {expected}."
            )
        if not np.isfinite(found).all():
            raise OptionError(
                f"{self.label}: at t = {time:.9g} s the function returned {found.tolist()}; expected finite "
                "numbers."
            )
        return np.asarray(found, np.float64).reshape(self.count)


def require_arguments(label: str, function: Callable[..., Any], names: tuple[str, ...]) -> None:
    """Make sure that a function of the caller takes as many arguments as it will get.

    Functions that do not say what they take, such as some of C, pass.

    Raises:
        OptionError: If it takes fewer or needs more.
    """
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return
    try:
        signature.bind(*names)
    except TypeError:
        hint = " A force that depends on the state is `effort`." if label.startswith("input ") else ""
        raise OptionError(
            f"{label}: the function takes {signature}; expected ({', '.join(names)}).{hint}"
        ) from None


def float_of(number: float | Parameter) -> float:
    """Return a number of an expression, the value of a parameter."""
    return number.value if isinstance(number, Parameter) else number


def variable_names(library: Library) -> tuple[str, ...]:
    """Return all names that a signal may have: t, x.<coordinate>, y.<speed>, elements of outputs."""
    states = [f"x.{name}" for name in library.coordinate_names] + [
        f"y.{name}" for name in library.speed_names
    ]
    of_outputs = [one.name for name in library.source.outputs for one in elements(library.source, name)]
    return (TIME, *states, *of_outputs)


def state_variables(library: Library, x: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
    """Return the values of states by name, from (..., m) coordinates and (..., n) speeds."""
    found = {f"x.{name}": x[..., k] for k, name in enumerate(library.coordinate_names)}
    return found | {f"y.{name}": y[..., k] for k, name in enumerate(library.speed_names)}


def outputs_in(texts: Sequence[object], known: Sequence[str]) -> tuple[str, ...]:
    """Return the outputs of which texts seem to name elements, before a library that has them is built."""
    words = {word for text in texts for word in re.findall(r"\w+", str(text))}
    return tuple(name for name in known if name in words)
