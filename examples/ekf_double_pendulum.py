"""Estimate the state of a double pendulum from its first angle, by a filter in C as microcontrollers run it.

    python examples/ekf_double_pendulum.py [ekf_double_pendulum.svg]

The extended Kalman filter is examples/ekf_double_pendulum.c, in single precision; the generated step and its
derivatives are its model. This program writes the measurements, compiles the filter for this machine, and
draws its estimates. `make embed-microcontrollers` runs it on a Cortex-M4F in QEMU, with the same bits.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import kanegen as kg

Array = NDArray[np.float64]

HERE = Path(__file__).parent
MODEL = HERE.parent / "models" / "double_pendulum.toml"
FILTER = HERE / "ekf_double_pendulum.c"

TIMES = np.arange(800) * 0.01
"""When the angle is measured (s)."""

NOISE = 0.02
"""Standard deviation of a measurement (rad)."""


def truth(system: kg.System) -> Array:
    """Return (800, 4) the angles and speeds of the true motion."""
    motion = kg.simulate(system, [1.2, -0.4], [0.0, 0.0], TIMES, step=1e-3)
    return np.concatenate([motion.x, motion.y], axis=1)


def write_sources(system: kg.System, states: Array, folder: Path) -> list[str]:
    """Write the generated code, the measurements and the filter, and return the names of the sources."""
    kg.generate(system, ["step_rk4_derivatives"], precision="float", batches=False).write(folder)
    measured = states[:, 0] + np.random.default_rng(0).normal(0.0, NOISE, len(states))
    lines = ",\n".join(f"    {float(np.float32(angle)).hex()}f" for angle in measured)
    text = f"enum {{ MEASUREMENTS = {len(measured)} }};\nstatic const float measured[] = {{\n{lines}\n}};\n"
    (folder / "measurements.h").write_text(text)
    (folder / FILTER.name).write_text(FILTER.read_text())
    return [FILTER.name, "double_pendulum.c"]


def estimates(printed: str) -> Array:
    """Return (800, 5) what the filter prints: angles, speeds, and the variance of the second angle."""
    return np.array([line.split() for line in printed.splitlines()], dtype=float)


def run_here(folder: Path, sources: list[str]) -> str:
    """Compile the filter for this machine, run it, and return what it prints."""
    compiler = ["cc", "-std=c99", "-O2", "-ffp-contract=off", *sources, "-lm", "-o", "filter"]
    subprocess.run(compiler, cwd=folder, check=True)
    return subprocess.run([folder / "filter"], capture_output=True, text=True, check=True).stdout


def draw(states: Array, found: Array, file: Path) -> None:
    """Write a picture of every fourth true and estimated angle, and of the errors."""
    times, states, found = TIMES[::4], states[::4], found[::4]
    figure, axes = plt.subplots(3, 1, figsize=(7, 6.5), sharex=True, layout="constrained")
    for k, name in enumerate(("first angle, rad", "second angle, rad")):
        axes[k].plot(times, states[:, k], label="truth")
        axes[k].plot(times, found[:, k], "--", label="estimate")
        axes[k].set(ylabel=name)
    axes[0].legend(ncols=2)
    limit = 3 * np.sqrt(found[:, 4])
    axes[2].fill_between(times, -limit, limit, alpha=0.25, label="three standard deviations")
    axes[2].plot(times, found[:, 1] - states[:, 1], label="error of the second angle")
    axes[2].set(xlabel="time, s", ylabel="error, rad", ylim=(-0.3, 0.3), xlim=(0, TIMES[-1]))
    axes[2].legend(ncols=2)
    for axis in axes:
        axis.grid(alpha=0.3)
    figure.savefig(file)


def main(file: Path) -> None:
    """Run the filter, print its errors after two seconds, and draw them."""
    system = kg.load(MODEL)
    states = truth(system)
    with tempfile.TemporaryDirectory() as folder:
        found = estimates(run_here(Path(folder), write_sources(system, states, Path(folder))))
    errors = np.sqrt(np.mean((found[200:, :4] - states[200:]) ** 2, axis=0))
    print("root mean square errors of angles (rad) and speeds (rad/s) after 2 s:", np.round(errors, 4))
    draw(states, found, file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "ekf_double_pendulum.svg"))
