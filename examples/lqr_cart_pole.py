"""Balance a pole on a cart by a linear-quadratic regulator, from several angles up to where it no longer can.

    python examples/lqr_cart_pole.py [lqr_cart_pole.svg]

The gain comes from the exact linear model at the upright equilibrium (`kg.linearize`) and the Riccati
equation (SciPy). The motions are those of the nonlinear equations, with a force of at most 20 N.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are

import kanegen as kg

Array = NDArray[np.float64]

MODEL = Path(__file__).parents[1] / "models" / "cart_pole.toml"

LARGEST_FORCE = 20.0
"""Largest force on the cart (N)."""

ANGLES = (0.3, 0.6, 0.75, 0.9)
"""Angles of the pole at the start, from upright (rad)."""

WEIGHTS = {"x.pole": 10.0, "x.cart_position": 10.0, "y.pole": 1.0, "y.cart_position": 1.0}
"""Weights of the squares of states; that of the force is 0.1."""


def gain(system: kg.System) -> Array:
    """Return (1, 4) the gain of the regulator at the upright equilibrium, force by state."""
    model = kg.linearize(system, {"pole": 0.0}, inputs=["cart_position"])
    cost = np.diag([WEIGHTS[name] for name in model.state_names])
    solution = solve_continuous_are(model.A, model.B, cost, [[0.1]])
    return model.B.T @ solution / 0.1


def motion(system: kg.System, feedback: Array, angle: float) -> kg.Trajectory:
    """Return four seconds of the nonlinear motion under the regulator, from rest at an angle (rad)."""
    cart = system.freedom_names.index("cart_position")

    def effort(t: float, x: Array, y: Array) -> Array:
        tau = np.zeros(2)
        tau[cart] = force(feedback, x, y)
        return tau

    return kg.simulate(system, {"pole": angle}, times=np.linspace(0.0, 4.0, 201), step=2e-3, effort=effort)


def force(feedback: Array, x: Array, y: Array) -> Array:
    """Return the force on the cart in a state, or in many (N)."""
    state = np.concatenate([x, y], axis=-1)
    return np.clip(-state @ feedback[0], -LARGEST_FORCE, LARGEST_FORCE)


def draw(motions: dict[float, kg.Trajectory], feedback: Array, file: Path) -> None:
    """Write a picture of angles, positions of the cart and forces over time."""
    figure, axes = plt.subplots(3, 1, figsize=(7, 6.5), sharex=True, layout="constrained")
    for angle, found in motions.items():
        pole, cart = found.x[:, 0], found.x[:, 1]
        for axis, values in zip(axes, (pole, cart, force(feedback, found.x, found.y)), strict=True):
            axis.plot(found.times, values, label=f"from {angle} rad")
    for axis, label, limits in zip(
        axes, ("pole, rad", "cart, m", "force, N"), ((-1, 2), (-1, 3), (-22, 22)), strict=True
    ):
        axis.set(ylabel=label, ylim=limits)
        axis.grid(alpha=0.3)
    for side in (-LARGEST_FORCE, LARGEST_FORCE):
        axes[2].axhline(side, color="grey", linewidth=0.8, linestyle="--")
    axes[0].text(0.95, -0.85, "from 0.9 rad the pole falls: its lines leave the panels", color="C3")
    axes[0].legend(ncols=2)
    axes[2].set(xlabel="time, s", xlim=(0, 4))
    figure.savefig(file)


def main(file: Path) -> None:
    """Follow the motions from all angles, print how they end, and draw them."""
    system = kg.load(MODEL)
    feedback = gain(system)
    print("gain", np.round(feedback[0], 2))
    motions = {angle: motion(system, feedback, angle) for angle in ANGLES}
    for angle, found in motions.items():
        print(f"from {angle} rad: {'upright' if abs(found.x[-1, 0]) < 0.05 else 'fallen'} after 4 s")
    draw(motions, feedback, file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "lqr_cart_pole.svg"))
