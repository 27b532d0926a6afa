"""JAX: calls of compiled functions from Python, inside of a compiled loop, and of many states at once."""

from __future__ import annotations

from typing import Any

import numpy as np

import kanegen as kg
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import Row, in_turns, turn_of
from kanegen.extras import JAX, module

LENGTH = 1000
"""Calls inside of a compiled loop, and states of a batch."""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm.

    Raises:
        MissingError: If JAX is not installed.
    """
    jax = module("jax", "jaxlib", extra=JAX)
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    try:
        return _rows(jax)
    finally:
        jax.config.update("jax_enable_x64", before)


def _rows(jax: Any) -> list[Row]:
    functions = module("kanegen.interop.jax").functions
    arm = functions(kg.load("models/panda_arm.toml"), derivatives=False)
    source, versions = arm.library.source, f"jax {jax.__version__}"
    rng = np.random.default_rng(1)
    inputs = {name: rng.uniform(-1, 1, (LENGTH, 7)) for name in ("x", "y", "tau")}
    first = {name: value[0] for name, value in inputs.items()}
    call, many = jax.jit(arm.forward_dynamics), jax.jit(jax.vmap(arm.forward_dynamics))

    @jax.jit
    def loop(x: Any, y: Any, tau: Any) -> Any:
        def one(_: Any, ydot: Any) -> Any:
            return arm.forward_dynamics(x, ydot * 1e-9 + y, tau)

        return jax.lax.fori_loop(0, LENGTH, one, y)

    alone = in_c(source, "forward_dynamics", first)
    batch = in_c(source, "forward_dynamics", inputs, states=LENGTH)
    at_once = [jax.numpy.asarray(value) for value in inputs.values()]
    one = [jax.numpy.asarray(value) for value in first.values()]
    what = "forward_dynamics of panda_arm"
    return [
        Row(
            "JAX",
            f"jit, {what}",
            *in_turns(alone, lambda: turn_of(lambda: call(*one).block_until_ready())),
            versions,
        ),
        Row(
            "JAX",
            f"in a compiled loop, {what}",
            *in_turns(alone, lambda: turn_of(lambda: loop(*one).block_until_ready()) / LENGTH),
            versions,
        ),
        Row(
            "JAX",
            f"vmap, {LENGTH} states, each, {what}",
            *in_turns(
                lambda: batch() / LENGTH,
                lambda: turn_of(lambda: many(*at_once).block_until_ready()) / LENGTH,
            ),
            versions,
        ),
    ]
