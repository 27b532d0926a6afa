"""Speedups and their confidence intervals, from times of programs that take turns."""

from __future__ import annotations

import math

import numpy as np

from kanegen.measure.timing import Times, speedup, tied


def test_a_speedup_is_real_if_its_interval_and_the_fastest_rounds_exceed_a_tie() -> None:
    slow = Times((100.0,) * 9)
    assert speedup(slow, Times((90.0,) * 9)).is_real
    assert not speedup(slow, Times((99.0,) * 9)).is_real
    assert not speedup(slow, Times((90.0,) * 6 + (120.0,) * 3)).is_real  # the interval contains 1
    assert not speedup(Times((100.0,) * 8 + (80.0,)), Times((90.0,) * 9)).is_real  # one fast round
    assert not speedup(Times((100.0,) * 5), Times((50.0,) * 5)).is_real  # too few rounds


def test_the_interval_of_a_ratio_covers_the_median() -> None:
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(1000):
        found = speedup(Times(tuple(rng.lognormal(0, 0.3, 9))), Times((1.0,) * 9))
        covered += found.low <= 1.0 <= found.high
    assert covered >= 950 - 4 * math.sqrt(1000 * 0.05 * 0.95)


def test_programs_are_tied_up_to_two_percent() -> None:
    times = [Times((101.0,) * 3), Times((100.0, 100.0, 150.0)), Times((103.0,) * 3)]
    assert tied(times) == [0, 1]
    assert (times[1].least, times[1].median, times[1].largest) == (100.0, 100.0, 150.0)
