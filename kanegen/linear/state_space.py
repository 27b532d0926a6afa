"""`StateSpace`: the matrices of small deviations from a state, with names, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from kanegen.linear.controllability import Subspace, controllable, observable
from kanegen.linear.eigenvalues import Eigenvalues, Floats, eigenvalues
from kanegen.linear.modes import Mode, Stability, modes_of, stability_of


@dataclass(frozen=True, eq=False, repr=False)
class StateSpace:
    """Small deviations from a state: d/dt {xi} = [A]{xi} + [B]{u}, {eta} = [C]{xi} + [D]{u}.

    The states {xi} are deviations of the coordinates {x} and then of the speeds {y}, the inputs {u} those of
    generalized forces. Prescribed motions, loads and the time are held at their values. Where the rates
    {xdot} and {ydot} are not zero, the model holds next to a motion: as it is if neither depends on what
    changes, as for a top that spins about its axis of symmetry; else only for a short time.

    Attributes:
        name: Name of the system.
        state_names: N names: "x.<coordinate>", then "y.<speed>".
        input_names: r names: "tau.<freedom>".
        output_names: q names of the outputs.
        A: (N, N) derivatives of {xdot} and {ydot} with respect to {x} and {y}.
        B: (N, r) derivatives of {xdot} and {ydot} with respect to the inputs.
        C: (q, N) derivatives of the outputs with respect to {x} and {y}.
        D: (q, r) derivatives of the outputs with respect to the inputs.
        x: (m,) coordinates of the state (rad, m, 1).
        y: (n,) generalized speeds of the state (rad/s, m/s).
        tau: (n,) generalized forces in the state (N m, N).
        xdot: (m,) rates of the coordinates in the state.
        ydot: (n,) rates of the speeds in the state (rad/s^2, m/s^2); zero in an equilibrium.
        rate_map: (m, n) matrix [H] of {xdot} = [H]{y}, Eq. (9); the identity where speeds are rates.
        rate_map_rate: (m, n) time derivative of [H] in the state.
        uncertainty: (N, N) bounds on the errors of the entries of [A] that rounding of the state causes; None
            for entries that are exact but for a roundoff.
    """

    name: str
    state_names: tuple[str, ...]
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    A: Floats
    B: Floats
    C: Floats
    D: Floats
    x: Floats
    y: Floats
    tau: Floats
    xdot: Floats
    ydot: Floats
    rate_map: Floats
    rate_map_rate: Floats
    uncertainty: Floats | None = None

    @property
    def is_minimal(self) -> bool:
        """Whether there are as many coordinates as speeds; a quaternion has one coordinate more."""
        return len(self.x) == len(self.y)

    @cached_property
    def minimal(self) -> Self:
        """The same model in 2n states: small displacements {phi} along the speeds, then {y}.

        The deviations of the coordinates are [H]{phi}, so that {phi} are the coordinates themselves where
        speeds are rates, and small rotations about the axes of a body where they are its angular velocity.
        This leaves out the length of a quaternion, which has no meaning: it would be a state that nothing
        depends on. Between rotating axes the components of {phi} turn, which [H]^+ d[H]/dt contains.
        """
        if np.array_equal(self.rate_map, np.eye(len(self.x), len(self.y))):
            return self
        m, n, H = len(self.x), len(self.y), self.rate_map
        inverse = np.linalg.pinv(H)
        old, new = np.zeros((m + n, 2 * n)), np.zeros((2 * n, m + n))
        old[:m, :n], old[m:, n:] = H, np.eye(n)
        new[:n, :m], new[n:, m:] = inverse, np.eye(n)
        A = new @ self.A @ old
        A[:n, :n] -= inverse @ self.rate_map_rate
        A[:n, n:] = np.eye(n)
        names = tuple(f"phi.{name.removeprefix('y.')}" for name in self.state_names[m:])
        return replace(
            self,
            state_names=(*names, *self.state_names[m:]),
            A=A,
            B=new @ self.B,
            C=self.C @ old,
            x=np.zeros(n),
            xdot=self.y,
            rate_map=np.eye(n),
            rate_map_rate=np.zeros((n, n)),
            uncertainty=None if self.uncertainty is None else abs(new) @ self.uncertainty @ abs(old),
        )

    @cached_property
    def _eigenvalues(self) -> Eigenvalues:
        """The eigenvalues of the minimal model."""
        return eigenvalues(self.minimal.A, len(self.y), self.minimal.uncertainty)

    @cached_property
    def eigenvalues(self) -> tuple[complex, ...]:
        """(2n) eigenvalues of [A] of the minimal model (1/s); a conjugate pair has both of its members."""
        return tuple(complex(value) for value in self._eigenvalues.values)

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Modes with frequency, damping and shape, growing ones first, then by frequency."""
        n = len(self.y)
        names = [name.partition(".")[2] for name in self.minimal.state_names[:n]]
        return modes_of(self._eigenvalues, names, slice(0, n))

    @property
    def stability(self) -> Stability:
        """What the eigenvalues say about stability, in words.

        Example:
            model.stability.verdict  # "unstable"
        """
        return stability_of(self.modes)

    @cached_property
    def controllability(self) -> Subspace:
        """The part of the states that the inputs reach.

        Example:
            model.controllability.dimension
        """
        return controllable(self.minimal.A, self.minimal.B)

    @cached_property
    def observability(self) -> Subspace:
        """The part of the states that the outputs show."""
        return observable(self.minimal.A, self.minimal.C)

    @property
    def is_equilibrium(self) -> bool:
        """Whether the state is at rest: rates and accelerations are below 1e-9 in SI units."""
        return bool(max(np.abs(self.xdot).max(), np.abs(self.ydot).max()) <= 1e-9)
