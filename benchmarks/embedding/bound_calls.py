"""NumPy: calls bound to arrays, methods of a library, and broadcasting."""

from __future__ import annotations

import numpy as np

import kanegen as kg
from benchmarks.embedding import arm
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.row import Row, in_turns, turn_of

STATES = 1000
"""States of a batch."""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm and of the double pendulum, whose C takes least."""
    panda, versions = arm.library(), f"NumPy {np.__version__}"
    pendulum = kg.build(kg.load("models/double_pendulum.toml"), ("forward_dynamics",))
    one, many = arm.states(), arm.states(STATES)
    alone = in_c(panda.source, "forward_dynamics", one)
    batch = in_c(panda.source, "forward_dynamics", many, states=STATES)
    small = {name: value[:2] for name, value in one.items()}
    call, of_pendulum = panda.bind("forward_dynamics"), pendulum.bind("forward_dynamics")
    together = panda.bind("forward_dynamics", states=STATES)
    for bound, inputs in ((call, one), (of_pendulum, small), (together, many)):
        for name, value in inputs.items():
            setattr(bound, name, value)
    given, broadcast = tuple(one.values()), panda.ufunc("forward_dynamics")
    c_of_pendulum = in_c(pendulum.source, "forward_dynamics", {**small, "prepared": pendulum.prepared})
    at_once = tuple(many.values())
    turns = {
        f"bound call, {arm.WHAT}": (alone, lambda: turn_of(call)),
        "bound call, forward_dynamics of double_pendulum": (c_of_pendulum, lambda: turn_of(of_pendulum)),
        f"method of a library, {arm.WHAT}": (
            alone,
            lambda: turn_of(lambda: panda.forward_dynamics(*given)),
        ),
        f"bound call of {STATES} states, {arm.WHAT}": (batch, lambda: turn_of(together)),
        f"broadcasting, {STATES} states, {arm.WHAT}": (
            batch,
            lambda: turn_of(lambda: broadcast(*at_once)),
        ),
    }
    return [Row("NumPy", what, *in_turns(*pair), versions) for what, pair in turns.items()]
