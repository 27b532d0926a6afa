"""PyTorch: calls of operators, without and with gradients."""

from __future__ import annotations

from typing import Any

import numpy as np

import kanegen as kg
from benchmarks.embedding import arm
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import Row, in_turns, turn_of
from kanegen.extras import TORCH, module

STATES = 1000
"""States of a batch."""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm, and a gradient beside the C of both.

    Raises:
        MissingError: If PyTorch is not installed.
    """
    torch = module("torch", extra=TORCH)
    panda = module("kanegen.interop.torch").functions(kg.load("models/panda_arm.toml"))
    source, versions = panda.library.source, f"PyTorch {torch.__version__}"
    one, many = arm.states(), arm.states(STATES)
    tensors = [torch.tensor(value) for value in one.values()]
    at_once = [torch.tensor(value) for value in many.values()]
    moving = [tensor.clone().requires_grad_() for tensor in tensors]

    def gradient() -> Any:
        return torch.autograd.grad(panda.forward_dynamics(*moving).sum(), moving)

    alone = in_c(source, "forward_dynamics", one)
    batch = in_c(source, "forward_dynamics", many, states=STATES)
    both = [alone, in_c(source, "forward_dynamics_vjp", {**one, "weights": np.ones(panda.library.n)})]
    turns = {
        f"operator, {arm.WHAT}": (alone, lambda: turn_of(lambda: panda.forward_dynamics(*tensors))),
        f"operator, {STATES} states, {arm.WHAT}": (
            batch,
            lambda: turn_of(lambda: panda.forward_dynamics(*at_once)),
        ),
        f"gradient, {arm.WHAT} and `forward_dynamics_vjp`": (
            lambda: sum(turn() for turn in both),
            lambda: turn_of(gradient),
        ),
    }
    return [Row("PyTorch", what, *in_turns(*pair), versions) for what, pair in turns.items()]
