"""Zeros in a row of an output are stored one by one or by loops: every entry, and no other."""

from __future__ import annotations

import numpy as np
import pytest

import kanegen as kg
from kanegen.c import usage
from tests.support import systems
from tests.support.cases import slow_except


@pytest.mark.parametrize("looped", slow_except((8, 48), 8))
@pytest.mark.parametrize("connection", [[0] * 12, [0, 1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 11]])
def test_the_mass_matrix_of_trees_side_by_side(connection: list[int], looped: int, monkeypatch) -> None:
    """Between hinges that no body carries together [A] is 0; rows have runs of zeros left and right."""
    monkeypatch.setattr(usage, "LOOPED", looped)
    free = systems.flags(12, ["theta3"])
    rng = np.random.default_rng(12)
    system = systems.random_system(rng, 12, connection=connection, free=free, loads=False)
    source = kg.generate(system, ("mass_matrix",))
    assert ("for (int i = " in source.files["tree.c"]) == (looped < 12)
    report = kg.compare(system, states=20)
    assert report.passed, str(report)
    library = kg.build(system, ("mass_matrix",))
    found = library.mass_matrix(rng.uniform(-3, 3, (20, 12)))
    alone = np.array([[_carried_together(connection, a, b) for a in range(12)] for b in range(12)])
    assert (found[:, ~alone] == 0.0).all()
    assert (found[:, alone] != 0.0).all()


def _carried_together(connection: list[int], a: int, b: int) -> bool:
    """Return whether one of two bodies, counted from 0, carries the other."""
    low, high = min(a, b), max(a, b)
    while high > low:
        high = connection[high] - 1
    return high == low
