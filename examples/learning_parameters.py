"""Learn the masses of a double pendulum from noisy angles, by gradients through its simulated motion in JAX.

    python examples/learning_parameters.py [learning_parameters.svg]

Known torques move the pendulum, and both angles are measured with noise. Adam follows the gradient of the
squared differences between measured and simulated angles, from many wrong masses at once. The gradient has no
error but rounding: every step of the simulation and its derivatives are generated C.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import kanegen as kg
import kanegen.interop.jax

STEP, STEPS, NOISE = 0.01, 300, 0.02  # s, number, standard deviation of measured angles in rad
STARTS, ITERATIONS, RATE = 12, 250, 0.05  # first guesses, iterations of Adam, its learning rate at the start

jax.config.update("jax_enable_x64", True)
model = kg.load(Path(__file__).parents[1] / "models" / "double_pendulum.toml")
pendulum = kanegen.interop.jax.functions(model, ("step_rk4",))


def torques() -> NDArray[np.float64]:
    """Return (STEPS, 2) known torques at the joints (N m): without them only the ratio of masses shows."""
    t = STEP * np.arange(STEPS)[:, None]
    return np.hstack([4.0 * np.sin(3.0 * t), 1.5 * np.cos(5.0 * t)])


def angles(logarithms: Any) -> Any:
    """Return (STEPS + 1, 2) angles (rad) of the motion from rest, by the logarithms of m1 and m2."""
    rest, masses = np.zeros(2), dict(zip(("m1", "m2"), jnp.exp(logarithms), strict=True))
    return pendulum.rollout(rest, rest, torques(), steps=STEPS, step=STEP, parameters=masses)[0]


def learned(start: Any, measured: NDArray[np.float64]) -> Any:
    """Return (ITERATIONS, 2) masses (kg), from the start on, by Adam (Kingma and Ba 2015) from logarithms."""

    def cost(logarithms: Any) -> Any:
        return ((angles(logarithms) - measured) ** 2).mean() / NOISE**2

    def iteration(carry: Any, k: Any) -> Any:
        now, mean, square = carry
        slope = jax.grad(cost)(now)
        mean, square = 0.9 * mean + 0.1 * slope, 0.99 * square + 0.01 * slope**2
        size = (1 - 0.9**k) * (jnp.sqrt(square / (1 - 0.99**k)) + 1e-8)
        after = now - RATE * (1 - k / ITERATIONS) * mean / size
        return (after, mean, square), jnp.exp(now)

    return jax.lax.scan(iteration, (start, 0 * start, 0 * start), jnp.arange(1, ITERATIONS + 1))[1]


def standard_errors(masses: Any) -> NDArray[np.float64]:
    """Return the standard errors (kg) that the noise leaves in the masses, from the slopes of all angles."""
    slopes = jax.jacfwd(lambda m: angles(jnp.log(m)).ravel())(masses)
    return NOISE * np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))


def draw(paths: Any, measured: Any, true: Any, file: Path) -> None:
    """Write a picture of the paths of the masses, and of measured and simulated angles."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    left.plot(*paths.T, "C0", lw=0.6)
    left.plot(*paths[:, 0].T, "k.", label="first guesses")
    left.plot(*true, "C3*", ms=11, label="true masses")
    t = STEP * np.arange(STEPS + 1)
    for masses, line, name in ((paths[0, 0], "--", "first guess"), (paths[0, -1], "-", "learned")):
        for k, values in enumerate(angles(jnp.log(masses)).T):
            right.plot(t, values, f"C{k}{line}", lw=1, label=f"angle {k + 1}, {name}")
    right.plot(t[::8], measured[::8], "k.", ms=3, label=["measured", ""])
    for axis, across, up in ((left, "m1, kg", "m2, kg"), (right, "time, s", "angle, rad")):
        axis.set(xlabel=across, ylabel=up)
        axis.grid(alpha=0.3)
        axis.legend(ncols=3, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0))
    figure.savefig(file)


def main(file: Path) -> None:
    """Measure a motion, learn the masses from it, and print and draw them."""
    rng, true = np.random.default_rng(0), np.array([1.0, 0.5])
    measured = angles(np.log(true)) + NOISE * rng.standard_normal((STEPS + 1, 2))
    starts = np.log(true * rng.uniform(0.4, 2.5, (STARTS, 2)))
    paths = np.asarray(jax.jit(jax.vmap(learned, (0, None)))(starts, measured))
    end = paths[0, -1]
    for name, *row in zip(("m1", "m2"), end, standard_errors(end), true, strict=True):
        print("{} = {:.4f} kg with a standard error of {:.4f} kg; true is {} kg".format(name, *row))
    print(f"{STARTS} first guesses end within {np.ptp(paths[:, -1], axis=0).max():.1e} kg")
    draw(paths, measured, true, file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "learning_parameters.svg"))
