"""The driver of frax, a library for JAX: results and times of compiled functions that are called from Python.

python -m kanegen.studies.bench.frax_driver results|times STATES OUT|SECONDS URDF CACHE

URDF is the model; the name of a joint is the index of its coordinate in {x}. CACHE is the folder in which JAX
keeps what it compiled, so that later processes do not compile it again. drivers/driver.h describes the rest.
"""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from kanegen.extras import module
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.python_driver import mean
from kanegen.studies.bench.results import DYNAMICS, EQUATIONS, Results, write
from kanegen.studies.bench.states import read_states

Functions = dict[str, Callable[..., Any]]
"""Compiled functions of one state, and of all states at once, by name of the task."""


def main() -> None:
    """Write results or print times, as the command line asks."""
    mode, file, last, urdf, cache = sys.argv[1:]
    jax = _jax(cache)
    states = read_states(Path(file))
    functions, order = _functions(jax, urdf)
    ours = _in_order(states, order)
    if mode == "results":
        write(Path(last), results(functions, ours, order))
    else:
        for task, value in times(jax, functions, ours, float(last)).items():
            print(task, f"{value:.6g}")


def _jax(cache: str) -> Any:
    """Import JAX in double precision on one core, with a folder for what it compiles."""
    if hasattr(os, "sched_setaffinity"):  # JAX has a thread for each core that it may use
        os.sched_setaffinity(0, {os.getpid() % (os.cpu_count() or 1)})
    os.environ |= {
        "JAX_PLATFORMS": "cpu",
        "JAX_ENABLE_X64": "1",
        "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false",
        "JAX_COMPILATION_CACHE_DIR": cache,
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
    return module("jax")


def _functions(jax: Any, urdf: str) -> tuple[Functions, list[int]]:
    """Return the functions of a model, and the index in {x} of each of its coordinates."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # advice about versions and settings
        robot = module("frax").Robot(urdf)

    def equations(q: Any, v: Any) -> Any:
        """Return the mass matrix and the forces that no acceleration requires."""
        return robot.mass_matrix(q), robot.nonlinear_bias(q, v)

    def dynamics(q: Any, v: Any, tau: Any) -> Any:
        """Return the accelerations for generalized forces."""
        return robot.forward_dynamics(q, v, tau, None)

    single = {EQUATIONS: equations, DYNAMICS: dynamics}
    several = {f"{name} batch": jax.vmap(function) for name, function in single.items()}
    compiled = {name: jax.jit(function) for name, function in (single | several).items()}
    return compiled, [int(name) for name in robot.joint_names]


def _in_order(states: ActuatedStates, order: list[int]) -> ActuatedStates:
    """Return states in the order of the coordinates of the model."""
    return ActuatedStates(states.x[:, order], states.y[:, order], tau=states.tau[:, order])


def results(functions: Functions, states: ActuatedStates, order: list[int]) -> Results:
    """Compute all states, one in each call and all in one call."""
    back = np.argsort(order)
    rows = list(zip(states.x, states.y, states.tau, strict=True))
    alone = [functions[EQUATIONS](x, y) for x, y, _ in rows]
    matrices, biases = (np.array([np.asarray(one[k]) for one in alone]) for k in range(2))
    accelerations = np.array([np.asarray(functions[DYNAMICS](*row)) for row in rows])
    together = functions[f"{EQUATIONS} batch"](states.x, states.y)
    batch = np.asarray(functions[f"{DYNAMICS} batch"](states.x, states.y, states.tau))
    every = {
        EQUATIONS: _joined(matrices, biases, back),
        DYNAMICS: accelerations[:, None, back],
        f"{EQUATIONS} batch": _joined(np.asarray(together[0]), np.asarray(together[1]), back),
        f"{DYNAMICS} batch": batch[:, None, back],
    }
    return every


def _joined(matrix: Any, bias: Any, back: Any) -> Any:
    """Return [A] with {f} below it, in the order of {x}."""
    return np.concatenate([matrix[:, back][:, :, back], -bias[:, None, back]], axis=1)


def times(jax: Any, functions: Functions, states: ActuatedStates, seconds: float) -> dict[str, float]:
    """Time all tasks; returns nanoseconds of one state by name of the task."""
    count = len(states.x)
    rows = [tuple(map(jax.numpy.asarray, row)) for row in zip(states.x, states.y, states.tau, strict=True)]
    x, y, tau = map(jax.numpy.asarray, (states.x, states.y, states.tau))
    arguments = {EQUATIONS: 2, DYNAMICS: 3}

    def one_by_one(task: str) -> None:
        """Compute all states, and wait for each result."""
        for row in rows:
            jax.block_until_ready(functions[task](*row[: arguments[task]]))

    def together(task: str) -> None:
        """Compute all states in one call."""
        jax.block_until_ready(functions[f"{task} batch"](*(x, y, tau)[: arguments[task]]))

    alone = {task: mean(partial(one_by_one, task), seconds) / count for task in arguments}
    batches = {f"{task} batch": mean(partial(together, task), seconds) / count for task in arguments}
    return alone | batches


if __name__ == "__main__":
    main()
