"""The stability of an equilibrium: by eigenvalues, or at rest by a minimum of the potential energy.

Whether a force may do work, jump or change with the time is read from the structure of the force elements.
Numbers alone do not show it: an effort 2 y**3 vanishes at rest as a force without work does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kanegen.library.equilibria.balance import Balance
from kanegen.library.equilibria.families import Families
from kanegen.linear import LinearModel, Stability
from kanegen.model.force_elements import Drive, ForceElement, JointFriction, JointSpring, Potential, Spring
from kanegen.model.nodes import COMPARISONS, TIME
from kanegen.model.numbers import value_of

Floats = NDArray[np.float64]

KINKED = frozenset(("abs", "sign", "min", "max", "atan2", *COMPARISONS))
"""Operators with a kink or a jump."""

BESIDE = 1e-7
"""Distance of the states on both sides of a state between which a kink is looked for (rad, m, rad/s, m/s)."""


@dataclass(frozen=True)
class Judgement:
    """What decides on the stability of the equilibria of a system.

    Attributes:
        families: The forces that vanish in equilibria.
        elements: The force elements of the system.
    """

    families: Families
    elements: Sequence[ForceElement]

    def stability(self, x: Floats, model: LinearModel, free: int) -> Stability:
        """Return what is known of the stability of a state.

        Where forces have a kink at the state, or depend on the time, the linear model does not describe the
        motion beside it, and the verdict is "undecided" whatever its eigenvalues are.

        Args:
            x: (m,) coordinates of the equilibrium.
            model: Linear model of small deviations.
            free: Number of directions along which the state stays in equilibrium.
        """
        found, balance = model.stability, self.families.balance
        if any(TIME in expression.variables for one in self.elements for expression in one.expressions()):
            time = float(np.asarray(balance.inputs.get("t", 0.0), np.float64))
            return Stability(
                "undecided", f"forces depend on the time, and balance in this state at t = {time:g} s"
            )
        if self._has_kinks and _is_kink(balance, self.families.scale, x):
            return Stability("undecided", "forces have a kink or a jump there, so that no linear model holds")
        if found.verdict != "undecided" or balance.y.any() or not _is_conservative(self.families, x):
            return found
        stiffness = -balance.slopes(x[None])[0] @ balance.rate_maps(x[None])[0]
        values = np.linalg.eigvalsh((stiffness + stiffness.T) / 2)
        positive = int((values > 1e-9 * max(float(np.abs(values).max()), 1e-300)).sum())
        if not 0 < positive == len(values) - free:
            return found
        if active := next((one for one in self.elements if not gains_no_energy(one)), None):
            what = f"{_named(active)} may do work in a motion"
            return Stability(
                "undecided", f"{found.reason}; a minimum of the potential energy does not decide, as {what}"
            )
        where = " across the free directions, along which it drifts" if free else ""
        return Stability("stable", f"the potential energy has a minimum{where} (Lagrange and Dirichlet)")

    @property
    def _has_kinks(self) -> bool:
        """Whether the expression of some force has a kink in some state."""
        return any(
            operation.operator in KINKED
            for one in self.elements
            for expression in one.expressions()
            for operation in expression.operations()
        )


def gains_no_energy(element: ForceElement) -> bool:
    """Return whether no motion gains energy by an element beside what the element stores.

    A spring without negative damping, friction and a potential gain none, parameters at their defaults. Of a
    drive or a load on a point it is not known: their expressions may have any values.

    Example:
        gains_no_energy(kg.JointSpring("elbow.theta3", damping=0.5))  # True
    """
    match element:
        case JointSpring(damping=damping) | Spring(damping=damping):
            return value_of(damping) >= 0
        case JointFriction() | Potential():
            return True
    return False


def _named(element: ForceElement) -> str:
    """Return an element in words: its kind and the freedom on which it acts."""
    kind = f"a {element.KEY.replace('_', ' ')}"
    return f"{kind} on '{element.freedom}'" if isinstance(element, Drive | JointSpring) else kind


def _is_kink(balance: Balance, scale: Floats, x: Floats) -> bool:
    """Return whether forces or their slopes jump between two sides of a state, along axes or between them."""
    library, m = balance.library, len(x)
    state = np.concatenate([x, balance.y])
    steps = np.concatenate([np.eye(len(state)), np.random.default_rng(0).uniform(-1, 1, (8, len(state)))])
    forces, slopes = [], []
    columns = library.derivative_columns("forcing_derivatives")
    for side in (BESIDE, -BESIDE):
        near = state + side * steps
        at = near[:, :m].copy(), near[:, m:].copy()
        forces.append(np.asarray(library.forcing(*at, **balance.inputs), np.float64))
        by = np.asarray(library.forcing_derivatives(*at, **balance.inputs), np.float64)
        slopes.append(np.concatenate([by[:, :, columns["x"]], by[:, :, columns["y"]]], axis=2))
    largest = max(float(np.nanmax(np.abs(by), initial=0.0)) for by in slopes)
    jumps = np.abs(forces[0] - forces[1]) > 4 * len(state) * BESIDE * largest + 1e-9 * scale
    size = np.maximum(np.abs(slopes[0]), np.abs(slopes[1]))
    turns = np.abs(slopes[0] - slopes[1]) > 1e-3 * size + 1e-5 * largest
    return bool(jumps.any() or turns.any())


def _is_conservative(families: Families, x: Floats) -> bool:
    """Return whether forces at rest are the slopes of the potential energy, near a state."""
    rng = np.random.default_rng(0)
    near = x + 0.1 * rng.uniform(-1, 1, (8, len(x)))
    forces, potential = families.balance.forces(near), families.balance.potential_forces(near)
    return bool(np.nanmax(np.abs(forces - potential) / families.scale) < 1e-9)
