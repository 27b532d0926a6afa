"""Derivatives of a step: the discrete linear model for model predictive control and shooting methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Unpack

from numpy.typing import ArrayLike

from kanegen.errors import OptionError, quoted
from kanegen.library.rollouts import Rollouts
from kanegen.model.arguments import Floats, NamedInputs
from kanegen.recursion.outputs import METHODS


@dataclass(frozen=True, repr=False)
class LinearStep:
    """A step, and how its end changes with its start, with generalized forces and with parameters.

    Small changes of the start and of what is constant over the step change its end by
    [A] {dx, dy} + [B] {dtau} + [P] {dp}.

    Attributes:
        x: (m,) or (B, m) coordinates after the step, rad, m or 1.
        y: (n,) or (B, n) generalized speeds after the step, rad/s and m/s.
        A: (m + n, m + n) or (B, m + n, m + n) derivatives of {x} and {y} after the step (rows) by {x} and
            {y} before it.
        B: (m + n, n) or (B, m + n, n) their derivatives by {tau}, over the units of N m and N.
        P: (m + n, P) or (B, m + n, P) their derivatives by the run-time parameters.

    Example:
        one = library.step_derivatives(x, y, tau, step=0.01)
        cost = scipy.linalg.solve_discrete_are(one.A, one.B, Q, R)
    """

    x: Floats
    y: Floats
    A: Floats
    B: Floats
    P: Floats

    def __repr__(self) -> str:
        shapes = ", ".join(f"{name} {getattr(self, name).shape}" for name in ("x", "y", "A", "B", "P"))
        return f"<LinearStep: {shapes}>"


class StepDerivatives(Rollouts):
    """The method for the derivatives of a step."""

    def step_derivatives(
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
    ) -> LinearStep:
        """Return the state after one step, and its derivatives by state, {tau} and parameters.

        The derivatives are those of the method itself, by the chain rule through its stages, and not those of
        the exact motion; they have no error but rounding. The four elements of a quaternion count as free
        numbers before the step, and keep their length over it. So a change along the quaternion before the
        step is one along it after the step, and changes nothing else; with the matrix [H] of
        {xdot} = [H]{y}, `coordinate_rates_derivatives` by {y}, `A[:, :m] @ H` is by small turns instead.

        Args:
            x: (m,) or (B, m) coordinates, rad, m or 1.
            y: (n,) or (B, n) generalized speeds, rad/s and m/s.
            tau: Generalized forces, as in `forward_dynamics`, constant over the step.
            force: Forces on the bodies, as in `forcing`, constant over the step.
            torque: Torques on the bodies, as in `forcing`, constant over the step.
            step: () or (B,) length of the step, s.
            method: Name of the method; by default the only one that the library has.
            inputs: Inputs that only some systems have, as in `forcing`; `t` is the time before the step.

        Raises:
            ArrayError: If an argument has the wrong shape or type, or a body that takes no loads gets one.
            OptionError: If the library was built without the output `step_<method>_derivatives`, or the
                method is not named and the library has several.
            StatusError: As `forward_dynamics`.

        Example:
            library = kg.build(system, outputs=("step_rk4_derivatives",))
            one = library.step_derivatives(x, y, step=0.01)
            change = one.A @ np.array([0.01, 0.0, 0.0, 0.0]) + one.B @ np.array([0.0, 0.1])
        """
        chosen = METHODS[self._method(method)]
        if not chosen.has_derivatives:
            known = ", ".join(one.name for one in METHODS.values() if one.has_derivatives)
            raise OptionError(f"method {quoted(chosen.name)}: no derivatives of its steps. Take {known}.")
        found = self._run(chosen.derivatives, (x, y, tau, force, torque, step), inputs)
        following, speeds, slopes = found
        n = self.n
        state = len(self.coordinate_names) + n
        by = slopes[..., :state], slopes[..., state : state + n], slopes[..., state + n :]
        return LinearStep(following, speeds, *by)
