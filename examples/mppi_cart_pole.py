"""Swing a pole up and balance it by sampling: model predictive path integral control with rollouts in C.

    python examples/mppi_cart_pole.py [mppi_cart_pole.svg]

Every 20 ms the controller follows 512 motions over the next second, each with other forces near those that it
had planned, and plans their average, weighted by how well each motion goes (Williams, Aldrich, Theodorou,
Journal of Guidance, Control, and Dynamics 40(2), 2017). One call of the C follows all of them.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import kanegen as kg

Array = NDArray[np.float64]

MODEL = Path(__file__).parents[1] / "models" / "cart_pole.toml"
STEP, HORIZON, SAMPLES, CYCLES = 0.02, 50, 512, 250  # s, steps, motions, steps of 20 ms
LARGEST_FORCE, SPREAD, TEMPERATURE = 10.0, 4.0, 10.0  # N, N, 1


@dataclass
class Controller:
    """The plan of forces on the cart, which every call improves and shifts by a step.

    Attributes:
        model: The compiled cart with its pole.
        random: Source of the samples.
        plan: (HORIZON,) forces on the cart over the next steps (N).
    """

    model: kg.Library
    random: np.random.Generator
    plan: Array

    def force(self, x: Array, y: Array) -> float:
        """Return the force for the next step from a state (N)."""
        spread = self.random.normal(0.0, SPREAD, (SAMPLES, HORIZON))
        forces = np.clip(self.plan + spread, -LARGEST_FORCE, LARGEST_FORCE)
        tau = np.zeros((SAMPLES, HORIZON, 2))
        tau[:, :, 1] = forces
        starts = np.tile(x, (SAMPLES, 1)), np.tile(y, (SAMPLES, 1))
        found = self.model.rollout(*starts, tau, steps=HORIZON, step=STEP)
        costs = cost(found.x, found.y) + 1e-3 * (forces**2).sum(axis=1)
        weights = np.exp(-(costs - costs.min()) / TEMPERATURE)
        self.plan = weights @ forces / weights.sum()
        first, self.plan = self.plan[0], np.append(self.plan[1:], 0.0)
        return float(first)


def cost(x: Array, y: Array) -> Array:
    """Return (B,) how far motions stay from the upright pole in the middle of the rail."""
    pole, cart = x[..., 0], x[..., 1]
    each = 10 * (1 - np.cos(pole)) + cart**2 + 0.1 * y[..., 0] ** 2 + 0.05 * y[..., 1] ** 2
    return each.sum(axis=1) + 10 * each[:, -1]


def motion() -> tuple[Array, Array]:
    """Return (CYCLES + 1, 4) states {x, y} from the hanging pole under the controller, and its forces (N)."""
    model = kg.build(kg.load(MODEL), ("step_rk4", "rollout_rk4"))
    controller = Controller(model, np.random.default_rng(7), np.zeros(HORIZON))
    x, y = np.array([np.pi, 0.0]), np.zeros(2)
    states, forces = [np.concatenate([x, y])], []
    for _ in range(CYCLES):
        forces.append(controller.force(x, y))
        x, y = model.step(x, y, np.array([0.0, forces[-1]]), step=STEP)
        states.append(np.concatenate([x, y]))
    return np.array(states), np.array(forces)


def main(file: Path) -> None:
    """Follow the motion, print where it ends, and draw it."""
    states, forces = motion()
    print(
        f"after {CYCLES * STEP:g} s: cos(pole) = {np.cos(states[-1, 0]):.4f}, cart at {states[-1, 1]:.2f} m"
    )
    times = STEP * np.arange(CYCLES + 1)
    figure, axes = plt.subplots(3, 1, figsize=(7, 6), sharex=True, layout="constrained")
    axes[0].plot(times, np.cos(states[:, 0]))
    axes[1].plot(times, states[:, 1])
    axes[2].step(times[:-1], forces, where="post")
    for axis, label in zip(axes, ("cosine of pole's angle", "cart, m", "force, N"), strict=True):
        axis.set(ylabel=label)
        axis.grid(alpha=0.3)
    for side in (-LARGEST_FORCE, LARGEST_FORCE):
        axes[2].axhline(side, color="grey", linewidth=0.8, linestyle="--")
    axes[2].set(xlabel="time, s", xlim=(0, times[-1]))
    figure.savefig(file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "mppi_cart_pole.svg"))
