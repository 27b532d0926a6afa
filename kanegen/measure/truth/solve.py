"""Certified solutions of [A]{ydot} = {f} + {tau}."""

from __future__ import annotations

from kanegen.measure.truth.balls import arb_mat, diagonal


def solution(matrix: arb_mat, right: arb_mat) -> arb_mat:
    """Enclosures of the solutions for every column of `right`; NaN where `matrix` may be singular."""
    return matrix.solve(right, nonstop=True)


def inverse(matrix: arb_mat) -> arb_mat:
    """Enclosure of the inverse; NaN where `matrix` may be singular."""
    return solution(matrix, diagonal(matrix.nrows()))
