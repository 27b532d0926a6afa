"""Steps and rollouts: motions that the compiled code follows by itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import flag, known_spelling, require_one
from kanegen.errors import ModelError, OptionError, quoted
from kanegen.library.compiled import CompiledModel
from kanegen.library.native.rollouts import HOLDS, Counts, Course
from kanegen.model.arguments import Floats, NamedInputs
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.numbers import finite
from kanegen.program.semantics import SEMANTICS
from kanegen.recursion.outputs import METHODS

MOST_STEPS = 2**53
"""Steps of a rollout: more have no times of their own in doubles."""


@dataclass(frozen=True, repr=False)
class Rollout:
    """The motion of a model from one state, or from B states at once, as a rollout has stored it.

    Attributes:
        times: (T,) times of the stored states, s; the first is the argument `t` where that is one number,
            else 0.
        x: (T, m) or (B, T, m) coordinates, rad, m or 1; the first are those of the start.
        y: (T, n) or (B, T, n) generalized speeds, rad/s and m/s.
        made: () or (B,) number of steps before the first after which the state is missing or not finite, or
            else before the first that may be inaccurate; the number of all steps where there is none.

    Example:
        rollout = library.rollout(x, y, steps=1000, step=1e-3, every=10)
        last = rollout.x[..., -1, :]
    """

    times: Doubles
    x: Floats
    y: Floats
    made: Counts

    def __repr__(self) -> str:
        span = f"{len(self.times)} times from {self.times[0]:g} to {self.times[-1]:g} s"
        return f"<Rollout: {span}, x {self.x.shape}, y {self.y.shape}>"


class Rollouts(CompiledModel):
    """Methods that follow a motion by steps of fixed length in C."""

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods for which the library has steps or rollouts, such as "rk4"."""
        own = self.source.integrators
        return tuple(name for name, method in METHODS.items() if {*method.every_function}.intersection(own))

    def step(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        *,
        step: ArrayLike,
        method: str | None = None,
        **inputs: Unpack[NamedInputs],
    ) -> tuple[Floats, Floats]:
        """Return the state after one step, over which all inputs are constant.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`.
            force: Forces on the bodies, as in `forcing`.
            torque: Torques on the bodies, as in `forcing`.
            step: () or (B,) length of the step, s; negative for a step back.
            method: Name of the method; by default the only one that the library has.
            inputs: Inputs that only some systems have, as in `forcing`; `t` is the time before the step.

        Returns:
            (m,) or (B, m) coordinates and (n,) or (B, n) speeds after the step. Quaternions keep their
            lengths.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without the output `step_<method>`, or the method is not
                named and the library has several.
            StatusError: As `forward_dynamics`.

        Example:
            library = kg.build(system, outputs=("step_rk4",))
            x, y = library.step(x, y, step=1e-3)
        """
        name = METHODS[self._method(method)].functions[0]
        following, speeds = self._run(name, (x, y, tau, force, torque, step), inputs)
        return following, speeds

    def rollout(
        self,
        x: ArrayLike,
        y: ArrayLike,
        tau: ArrayLike | None = None,
        force: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        *,
        steps: int,
        step: float,
        every: int = 1,
        method: str | None = None,
        hold: str = "zero",
        compensated: bool = False,
        **inputs: Unpack[NamedInputs],
    ) -> Rollout:
        """Return states along a motion, computed in C from one state or from many at once.

        Generalized forces and loads are constant, such as (n,), or have a row for each place that `hold`
        names, such as (S, n); for B states (B, n), (S, n) and (B, S, n) are possible, and (B, 1, n) and
        (1, S, n) where B is S.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces beside loads and gravity, N m and N; None is zero.
            force: Forces on the bodies at their mass centres, N, (N, 3) for one place; None is zero.
            torque: Torques on the bodies, N m, (N, 3) for one place; None is zero.
            steps: Number S of steps.
            step: Length of a step, s; negative to go back in time.
            every: Number of steps k from one stored state to the next. Where k does not divide S, the
                state after step S is not stored; that after step k (S // k) is the last.
            method: Name of the method; by default the only one that the library has.
            hold: How rows of inputs are held over steps: "zero" has a row for each step, constant over it;
                "linear" has S + 1 rows, with straight lines between the ends of the steps; "quadratic" has
                2 S + 1 rows, for the start, the middle and the end of each step.
            compensated: Whether rounding errors of the additions to the state are added later (Kahan), which
                makes long motions more accurate, above all in single precision.
            inputs: Inputs that only some systems have, as in `forcing`; `t` is the time of the start.

        Returns:
            T = S // k + 1 states, the start first. From the first state on that is missing or not finite,
            all numbers are NaN.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without the output `rollout_<method>`, the method is not
                named and the library has several, or another option does not fit.
            StatusError: See `with_on_status`; by default what is missing, not finite or not accurate gives a
                warning with the step and the time.

        Example:
            library = kg.build(system, outputs=("rollout_rk4",))
            rollout = library.rollout(x, y, steps=1000, step=1e-3, every=10)
        """
        name = METHODS[self._method(method)].functions[1]
        call = self._native.rollouts.get(name)
        if call is None:
            raise self._absent(name)
        course = self._course(steps, step, every, hold, compensated)
        parameters = inputs.get("parameters")
        values = (x, y, tau, force, torque, None, *self._in_order(name, inputs))
        bound = partial(call, course=course)
        if parameters is None:
            found = bound(self._constants, values, self._on_status)
        else:
            found = self._with_sets(bound, parameters, values)
        start = np.asarray(inputs.get("t", 0.0))
        first = 0.0 if start.ndim else float(start)
        times: Doubles = first + course.step * np.arange(0, course.steps + 1, course.every, dtype=np.float64)
        return Rollout(times, *found)

    def _method(self, method: str | None) -> str:
        """Return the name of the method, by default the only one.

        Raises:
            OptionError: If there is no such method, or none or several to choose from.
        """
        if method is not None:
            name: str = known_spelling(method, METHODS)
            require_one("method", name, METHODS)
            return name
        if len(self.methods) == 1:
            return self.methods[0]
        if not self.methods:
            raise self._absent(METHODS["rk4"].functions[1])
        raise OptionError(
            f"method: system {quoted(self.name)} was built with {', '.join(self.methods)}. Name one."
        )

    def _course(self, steps: int, step: float, every: int, hold: str, compensated: bool) -> Course:
        """Return the checked course of a rollout.

        Raises:
            OptionError: If an option does not fit, or compensation would be lost.
        """
        try:
            length = finite(step, "step")
        except ModelError as error:
            raise OptionError(str(error)) from None
        if length == 0.0:
            raise OptionError("step: a step needs a length other than 0 s.")
        require_one("hold", hold, HOLDS)
        numbers = {"steps": number_of_steps("steps", steps, 0), "every": number_of_steps("every", every, 1)}
        is_compensated = flag("compensated", compensated)
        if is_compensated and any("order of sums" in SEMANTICS[s].lost_properties for s in self._semantics):
            raise OptionError(
                "compensated: the compiler may reorder sums with the semantics "
                f"{', '.join(self._semantics)}, and drop the compensation. Build with strict semantics."
            )
        return Course(length, numbers["steps"], numbers["every"], hold, is_compensated)

    @property
    def _semantics(self) -> tuple[str, ...]:
        return self.source.variant.semantics


def number_of_steps(name: str, value: object, least: int) -> int:
    """Return a number of steps that a caller passes.

    Args:
        name: Name of the argument, used in error messages.
        value: Its value.
        least: Least number.

    Raises:
        OptionError: If it is no whole number, less than `least`, or more than `MOST_STEPS`.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise OptionError(f"{name}: {quoted(value)} is no whole number from {least} on.")
    if value > MOST_STEPS:
        raise OptionError(f"{name}: {quoted(value)} is more than 2^53, up to which doubles tell times apart.")
    return int(value)
