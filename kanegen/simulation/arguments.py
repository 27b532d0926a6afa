"""Checks of the arguments of `simulate`: states, times, the error, and what the library must have."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, OptionError, quoted
from kanegen.library import Library
from kanegen.linear.names import names_of
from kanegen.model import arguments
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.values_by_name import finite_in_order
from kanegen.program import precision as precisions
from kanegen.simulation.methods import Method
from kanegen.simulation.motion import speeds_are_rates

OF_MOTION = ("forward_dynamics", "coordinate_rates")
"""Outputs that a simulation needs; tables and files contain the others."""

OF_DRIFTS = ("kinetic_energy", "potential_energy", "momentum")
"""Outputs whose drifts tell about the accuracy of a simulation; every table that can contains them."""

SMALLEST_ERROR, LARGEST_ERROR = 1e-15, 0.1
"""Errors that may be asked for."""

ROWS = 200
"""Number of intervals between the states of a motion of which only the duration is given."""

MOST_ROWS = 10_000_000
"""Largest number of states that a duration and an interval may ask for."""

MOST_STEPS = 1e15
"""Largest number of steps of a motion, which no computer gets through."""


def first_state(library: Library, x: Any, y: Any) -> tuple[Floats, Floats]:
    """Return the coordinates and speeds at the first time in the precision of the library's arrays.

    Raises:
        ArrayError: If `x` or `y` has the wrong shape or type, or is not finite.
        OptionError: If there is no coordinate or speed of a name.
    """
    dtype = precisions.precision_named(library.storage).dtype
    if x is None or isinstance(x, Mapping):
        neutral = list(library.source.model.neutral_coordinates)
        x = finite_in_order("x", x, library.coordinate_names, neutral)
    if y is None or isinstance(y, Mapping):
        y = finite_in_order("y", y, library.speed_names, [0.0] * library.n)
        batch = np.shape(x)[:-1]
        y = np.broadcast_to(y, (*batch, library.n))
    first = arguments.state("x", x, (len(library.coordinate_names),), dtype)
    second = arguments.companion("y", y, (library.n,), first.shape[:-1], dtype, "x")
    for name, array in (("x", first), ("y", second)):
        if not np.isfinite(array).all():
            raise ArrayError(f"{name}: the first state is not finite.")
    return first, second


def times_of(times: ArrayLike | None, every: float | None, step: float | None) -> Doubles:
    """Return the times at which states are wanted, as (T,) doubles.

    Raises:
        ArrayError: If there are fewer than two, or they are not finite and increasing.
        OptionError: If there are none, a duration is not positive, or there are more than `MOST_STEPS` steps.
    """
    if times is None:
        raise OptionError("times: give a duration in s, or times, such as np.linspace(0, 10, 101).")
    if np.ndim(times) == 0:
        duration = _positive("duration", times)
        _require_countable(duration, step)
        return _equal_times(duration, every or _usual_interval(duration, step))
    if every is not None:
        raise OptionError("every: it goes with a duration. With times, leave it out.")
    moments: Doubles = np.asarray(arguments.floats("times", times, np.dtype(np.float64)), np.float64)
    if moments.ndim != 1 or len(moments) < 2:
        raise ArrayError(f"times: expected at least two in one row, got shape {moments.shape}.")
    if not (np.isfinite(moments).all() and (np.diff(moments) > 0).all()):
        raise ArrayError("times: they must be finite and increase from each to the next.")
    _require_countable(float(moments[-1] - moments[0]), step)
    return moments


def _require_countable(span: float, step: float | None) -> None:
    """Make sure that the number of fixed steps is no larger than `MOST_STEPS`."""
    if step is not None and span > MOST_STEPS * step:
        raise OptionError(
            f"step: {step!r} s makes more than {MOST_STEPS:g} steps in {span!r} s. Take a longer step."
        )


def _usual_interval(duration: float, step: float | None) -> float:
    """Return the interval (s) between states where none is given: whole steps, or a share of the duration."""
    return duration / ROWS if step is None else step * max(1, round(duration / step / ROWS))


def _equal_times(duration: float, every: float) -> Doubles:
    """Return times from 0 to a duration (s) at equal intervals; the last one may be shorter."""
    interval = _positive("every", every)
    count = duration / interval
    if count > MOST_ROWS:
        raise OptionError(
            f"every: {interval!r} s makes more than {MOST_ROWS} states in {duration!r} s. Take a longer "
            "interval."
        )
    whole = round(count) if abs(count - round(count)) < 1e-9 * count else math.floor(count)
    found: Doubles = interval * np.arange(whole + 1.0)
    if whole >= count * (1 - 1e-9):
        found[-1] = duration if whole else 0.0
    return found if found[-1] == duration else np.append(found, duration)


def _positive(name: str, value: Any) -> float:
    """Return a number of seconds.

    Raises:
        OptionError: If it is not positive and finite.
    """
    is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not is_number or not 0 < value < math.inf:
        raise OptionError(f"{name}: {quoted(value)} is no positive number of seconds.")
    return float(value)


def open_method(error: float, *given: object) -> Method:
    """Return the method whose steps a library must have where the method is chosen later.

    Raises:
        OptionError: If the error is no number in its range, or another choice is given beside it.
    """
    if any(one not in (None, False) for one in given):
        raise OptionError("error: it chooses method, step and precision. Leave the others out, or the error.")
    is_number = isinstance(error, int | float | np.number) and not isinstance(error, bool)
    if not is_number or not SMALLEST_ERROR <= error <= LARGEST_ERROR:
        raise OptionError(f"error: {quoted(error)} is not between {SMALLEST_ERROR:g} and {LARGEST_ERROR:g}.")
    return Method("RK4", 1.0)


def recorded_outputs(
    library: Library, outputs: Iterable[str] | str | None, is_built: bool
) -> tuple[str, ...]:
    """Return the outputs that tables and files of the trajectory contain: those asked for, and energies."""
    if outputs is not None:
        names = names_of("outputs", outputs)
        for name in names:
            if name not in library.source.outputs:
                raise OptionError(
                    f"system {library.name!r} was built without the output {quoted(name)}. It has "
                    f"{', '.join(library.source.outputs)}; ask for more with outputs=(...)."
                )
        drifting = [name for name in OF_DRIFTS if name in library.source.outputs]
        return tuple(dict.fromkeys((*drifting, *names)))
    for_itself = (*OF_MOTION, *(("prescribed_efforts",) if is_built else ()))
    return tuple(name for name in library.source.outputs if name not in for_itself)


def require_fitting(library: Library, method: Method) -> None:
    """Make sure that the library has the outputs and the precision that the method needs."""
    if "forward_dynamics" not in library.source.outputs:
        raise OptionError(
            f"system {library.name!r} was built without the output 'forward_dynamics'. It has "
            f"{', '.join(library.source.outputs)}; ask for more with outputs=(...)."
        )
    if not speeds_are_rates(library):
        if method.name == "leapfrog":
            raise OptionError("method 'leapfrog' is for speeds that are rates of coordinates. Take 'RK4'.")
        if "coordinate_rates" not in library.source.outputs:
            raise OptionError(
                f"system {library.name!r} has speeds that are no rates of coordinates, and was built without "
                "the output 'coordinate_rates'. Ask for it with outputs=(...)."
            )
    if library.storage == "double-double":
        raise OptionError(
            f"the arrays of system {library.name!r} hold double-double numbers. Build it with "
            'storage="double".'
        )
    if method.is_adaptive and library.storage != "double":
        raise OptionError(
            f"method {method.name!r} computes with doubles, but the arrays of system {library.name!r} are "
            f'{library.storage!r}. Build it with storage="double", or take fixed steps.'
        )
