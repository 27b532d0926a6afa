"""Proven bounds of random systems hold: every kind of coordinate, speed, load and parameter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.measure.bounds import InputBox, read_domain
from kanegen.options import Variant
from kanegen.recursion.outputs import available
from tests.support import systems
from tests.support.acting import acted_on
from tests.support.bound_search import MARGIN, Search
from tests.support.cases import slow_except
from tests.support.orientation_trees import mixed, with_quaternions

LEFT_OUT = ("forward_dynamics", "error_estimate", "error_bound", "regularity")
"""Outputs that divide by pivots, which ranges alone rarely prove to be positive."""

KINDS: dict[str, Callable[[int], kg.System]] = {
    "tree": lambda seed: systems.random_system(np.random.default_rng(seed), bodies=1 + seed % 3),
    "mixed": mixed,
    "quaternions": with_quaternions,
    "acted on": lambda seed: acted_on(systems.random_system(np.random.default_rng(seed), bodies=2), seed),
}
CASES = [(kind, seed) for kind in KINDS for seed in range(12)]


def outputs(system: kg.System, rng: np.random.Generator) -> list[str]:
    """Return two random outputs of a system."""
    names = [name for name in available(system) if name not in LEFT_OUT and not name.endswith("derivatives")]
    return [str(name) for name in rng.choice(names, min(2, len(names)), replace=False)]


def random_box(system: kg.System, rng: np.random.Generator, size: float) -> InputBox:
    """Return a box about a random state, `size` times as large as the default one, and 1 % of parameters."""
    box = read_domain(None, system)
    low, high = {}, {}
    for name, first in box.low.items():
        last = box.high[name]
        middle, half = rng.uniform(first, last), size * (last - first) / 2
        if name == "parameters":
            middle, half = first, 0.01 * np.abs(first)
        low[name], high[name] = middle - half, middle + half
    return replace(box, low=low, high=high)


@pytest.mark.parametrize("case", slow_except(CASES, ("tree", 1), ("quaternions", 1)), ids=str)
def test_no_state_breaks_a_bound(case: tuple[str, int]) -> None:
    kind, seed = case
    rng = np.random.default_rng(seed)
    system = KINDS[kind](seed)
    names = outputs(system, rng)
    variant = Variant(precision=("double", "float")[seed % 2])
    library = kg.build(system, names, tier=variant, flags=("-O0", "-ffp-contract=off"))
    found = Search(library, random_box(system, rng, (0.1, 1e-3, 1.0)[seed % 3]))
    bounds = kg.bound(library, found.box)
    for name in names:
        for states in (found.random(150), found.corners(50)):
            assert (found.errors(name, states).max(axis=0) <= MARGIN * bounds[name].ravel()).all()
