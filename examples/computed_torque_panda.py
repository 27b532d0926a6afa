"""Let the Panda arm follow a motion by computed torque, and by springs and dampers with gravity compensation.

    python examples/computed_torque_panda.py [computed_torque_panda.svg]

Computed torque makes every joint a linear oscillator: the inverse dynamics of the model gives the efforts for
the wanted accelerations and a correction. Steps of 1 ms move the arm. It is pushed, and in the third motion
it carries a load of 1 kg of which the controller does not know.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import kanegen as kg

Array = NDArray[np.float64]
Controller = Callable[[float, Array, Array], Array]

MODEL = Path(__file__).parents[1] / "models" / "panda_arm.toml"
HOME = np.array([0.0, -0.4, 0.0, -2.2, 0.0, 1.8, 0.8])
SWING = np.array([0.9, 0.5, -0.6, 0.5, 0.8, 0.6, 1.0])
STEP, STEPS, RATE = 1e-3, 4000, np.pi  # s, number, rad/s
SPRINGS = np.array([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0])  # N m/rad
DAMPERS = np.array([30.0, 30.0, 20.0, 20.0, 4.0, 3.0, 1.0])  # N m s/rad


def build() -> kg.Library:
    """Return the compiled arm, in which the mass of the hand is open until run time and loads act on it."""
    system = kg.load(MODEL)
    hand = system.bodies[6]
    open_hand = replace(hand, mass=kg.Parameter("hand_mass", hand.mass))
    system = replace(system, bodies=(*system.bodies[:6], open_hand, *system.bodies[7:]))
    outputs = ("inverse_dynamics", "gravity_forces", "step_rk4")
    return kg.build(system.with_loads(["panda_link7"]), outputs)


def wanted(t: float) -> tuple[Array, Array, Array]:
    """Return the wanted coordinates, speeds and accelerations at a time (rad, rad/s, rad/s^2)."""
    sine, cosine = np.sin(RATE * t), np.cos(RATE * t)
    return HOME + SWING * (1 - cosine) / 2, SWING * RATE * sine / 2, SWING * RATE**2 * cosine / 2


def follow(arm: kg.Library, controller: Controller) -> Array:
    """Return (STEPS, 7) errors of the joints under a controller that holds its efforts for a step (rad)."""
    x, y, _ = wanted(0.0)
    errors = np.empty((STEPS, 7))
    for k in range(STEPS):
        t = k * STEP
        push = np.zeros((9, 3))
        push[6, 1] = 8.0 if 2.5 <= t < 2.7 else 0.0  # N, along axis 2 of the hand
        errors[k] = x - wanted(t)[0]
        x, y = arm.step(x, y, controller(t, x, y), force=push, step=STEP)
    return errors


def motions() -> dict[str, Array]:
    """Return the errors of all motions by name."""
    arm = build()

    def with_gravity(t: float, x: Array, y: Array) -> Array:
        position, speed, _ = wanted(t)
        return arm.gravity_forces(x) + SPRINGS * (position - x) + DAMPERS * (speed - y)

    def computed_torque(t: float, x: Array, y: Array) -> Array:
        position, speed, acceleration = wanted(t)
        return arm.inverse_dynamics(x, y, acceleration + 400 * (position - x) + 40 * (speed - y))

    loaded = arm.with_parameters({"hand_mass": arm.parameters["hand_mass"] + 1.0})
    return {
        "gravity compensation": follow(arm, with_gravity),
        "computed torque": follow(arm, computed_torque),
        "computed torque, 1 kg unknown": follow(loaded, computed_torque),
    }


def main(file: Path) -> None:
    """Follow all motions, print their largest errors, and draw the largest error of a joint over time."""
    figure, axis = plt.subplots(figsize=(7, 3.8), layout="constrained")
    for name, errors in motions().items():
        largest = 1e3 * np.abs(errors).max(axis=1)
        print(f"{name}: {largest[:2500].max():.3g} mrad, after the push {largest[2500:].max():.3g} mrad")
        axis.semilogy(STEP * np.arange(0, STEPS, 10), largest[::10], label=name)
    axis.axvspan(2.5, 2.7, color="0.9", label="push of 8 N")
    axis.set(xlabel="time, s", ylabel="largest error of a joint, mrad", xlim=(0, 4), ylim=(1e-2, 3e2))
    axis.grid(alpha=0.3)
    figure.legend(ncols=2, loc="outside upper center")
    figure.savefig(file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "computed_torque_panda.svg"))
