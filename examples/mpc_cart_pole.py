"""Swing a pole up on a short rail by model predictive control with CasADi and Ipopt.

    python examples/mpc_cart_pole.py [mpc_cart_pole.svg]

Every 50 ms the controller plans the forces of the next 1.5 s: multiple shooting, where each interval is one
step of the compiled `step_rk4` with exact derivatives. The cart stays on 0.8 m of rail, the force within
10 N. The pole that it moves is a quarter heavier than the one that it plans with.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import casadi as ca
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

import kanegen as kg
from kanegen.interop import casadi

MODEL = Path(__file__).parents[1] / "models" / "cart_pole.toml"
INTERVALS, LENGTH = 30, 0.05  # number of steps of a plan, and their length (s)
LARGEST_FORCE, RAIL = 10.0, 0.4  # N, m to either side
CYCLES = 100
HEAVIER = 1.25  # factor of the mass of the real pole

START = np.array([np.pi, 0.0, 0.0, 0.0])  # pole hanging, cart in the middle: angle, position, their rates
WEIGHTS = ca.DM([0.0, 2.0, 0.1, 0.1])  # of the squares of a state; the pole has 10 (1 - cos)


def step_function(system: kg.System) -> Any:
    """Return the state (4,) after an interval, as a function of state, force and parameters."""
    state, force, parameters = ca.MX.sym("s", 4), ca.MX.sym("u"), ca.MX.sym("p", len(system.parameters))
    one = casadi.function(system, "step_rk4")
    tau = ca.vertcat(*(force if name == "cart_position" else 0 for name in system.freedom_names))
    after = one(x=state[:2], y=state[2:], tau=tau, step=LENGTH, parameters=parameters)
    return ca.Function("step", [state, force, parameters], [ca.vertcat(after["x_next"], after["y_next"])])


def controller(step: Any, parameters: NDArray[np.float64]) -> Any:
    """Return the solver of the problem whose variables are all states and forces of a plan."""
    states, forces = ca.MX.sym("states", 4, INTERVALS + 1), ca.MX.sym("forces", 1, INTERVALS)
    follow = step.map(INTERVALS)(states[:, :-1], forces, ca.repmat(parameters, 1, INTERVALS))
    cost = ca.sum2(10 * (1 - ca.cos(states[0, :])) + WEIGHTS.T @ states**2) + 0.01 * ca.sumsqr(forces)
    last = 30 * (1 - ca.cos(states[0, -1])) + ca.sumsqr(states[2:, -1])
    problem = {"x": ca.veccat(states, forces), "f": cost + last, "g": ca.vec(states[:, 1:] - follow)}
    quiet = {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory", "max_iter": 150}
    return ca.nlpsol("controller", "ipopt", problem, {"print_time": False, "ipopt": quiet})


def motion(cycles: int = CYCLES) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the states (cycles + 1, 4) and forces (cycles,) of the controlled motion."""
    system = kg.load(MODEL)
    planned = np.array([one.value for one in system.parameters])
    real = planned * [HEAVIER if one.name == "pole_mass" else 1.0 for one in system.parameters]
    step = step_function(system)
    solve = controller(step, planned)
    path, plan = np.linspace(START, np.zeros(4), INTERVALS + 1), np.zeros(INTERVALS)
    limits = np.tile([np.inf, RAIL, np.inf, np.inf], INTERVALS + 1)
    bound = np.concatenate([limits, np.full(INTERVALS, LARGEST_FORCE)])
    states, forces = [START], []
    for _ in range(cycles):
        lower, upper = -bound, bound.copy()
        lower[:4] = upper[:4] = states[-1]
        found = solve(x0=[*path.ravel(), *plan], lbx=lower, ubx=upper, lbg=0, ubg=0)["x"].full().ravel()
        path, plan = found[:-INTERVALS].reshape(-1, 4), found[-INTERVALS:]
        states.append(step(states[-1], plan[0], real).full().ravel())
        forces.append(plan[0])
        path, plan = np.vstack([path[1:], path[-1:]]), np.append(plan[1:], 0.0)  # guess of the next plan
    return np.array(states), np.array(forces)


def main(file: Path) -> None:
    """Follow the motion, print how it ends, and draw it."""
    states, forces = motion()
    times = LENGTH * np.arange(len(states))
    upright = np.cos(states[:, 0]) > 0.99
    print(
        f"upright from {times[np.flatnonzero(~upright)[-1] + 1]:.2f} s on" if upright[-1] else "not upright"
    )
    figure, axes = plt.subplots(3, 1, figsize=(7, 6.5), sharex=True, layout="constrained")
    axes[0].plot(times, np.cos(states[:, 0]))
    axes[1].plot(times, states[:, 1])
    axes[2].step(times[:-1], forces, where="post")
    for axis, label in zip(axes, ("cosine of pole's angle", "cart, m", "force, N"), strict=True):
        axis.set(ylabel=label)
        axis.grid(alpha=0.3)
    for axis, limit in ((axes[1], RAIL), (axes[2], LARGEST_FORCE)):
        for side in (-limit, limit):
            axis.axhline(side, color="grey", linewidth=0.8, linestyle="--")
    axes[2].set(xlabel="time, s", xlim=(0, times[-1]))
    figure.savefig(file)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "mpc_cart_pole.svg"))
