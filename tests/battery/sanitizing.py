"""What sanitizers say about the generated C of every scene: X33."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import kanegen as kg
from kanegen.library.native.commands import CommandError
from kanegen.program.precision import Precision
from kanegen.reference.states import random_states
from tests.battery import scenes
from tests.battery.drivers import efforts_for, printed
from tests.battery.measuring import PRECISIONS
from tests.battery.rows import Row, Size, count, subject

STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-g", "-ffp-contract=off")
SANITIZERS = "address,undefined,float-divide-by-zero,float-cast-overflow"
FLAGS = (*STRICT, f"-fsanitize={SANITIZERS}", "-fno-sanitize-recover=all")


@subject("X33", "Sanitizers on the C of every scene")
def sanitizers(size: Size) -> Iterator[Row]:
    """No byte outside an array, no undefined operation, no warning; one state and odd batches."""
    trees = _scenes(size)
    for precision in PRECISIONS:
        said = {name: _objection(system, precision) for name, system in trees.items()}
        objections = [f"{name}: {words}" for name, words in said.items() if words]
        over = f"{', '.join(trees)}; {SANITIZERS.replace(',', ', ')}; {' '.join(STRICT[:5])}"
        yield count(precision.name, objections, "; ".join([over, *objections]), "no objection")


def _scenes(size: Size) -> dict[str, kg.System]:
    """The shapes of the other subjects, few bodies each."""
    rng = np.random.default_rng(33)
    free = np.eye(6, dtype=bool)[rng.integers(0, 6, 7)]
    free[0] = True
    quick = {
        "straight chain": scenes.straight(6),
        "hinges and slides": scenes.mixed(3),
    }
    full = {name: scenes.tree(rng, connect(7), free) for name, connect in scenes.SHAPES.items()}
    full["bodies with six freedoms"] = scenes.tree(rng, range(4), np.ones((4, 6), dtype=bool))
    full["64 rods"] = scenes.straight(64)
    full["heavier outward"] = scenes.planar([10.0**i for i in range(8)])
    full["crane and gripper"] = scenes.planar([1e6, 1.0, 1e-9], [1e3, 1.0, 1e-6])
    return size.pick(quick, quick | full)


def _objection(system: kg.System, precision: Precision) -> str:
    """The first line that a compiler or a sanitizer prints; nothing if they agree to the code."""
    states = random_states(system, 37, 33).rounded(precision)
    try:
        wrong = printed("sanitized.c", system, precision, states, efforts_for(states, 33), FLAGS)
    except CommandError as error:
        return error.reason
    return "" if int(wrong) == 0 else "a regular state is refused"
