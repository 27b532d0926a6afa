"""Every sequence of axes as 1-2-3 with other names, so that one written-out form serves all twelve.

Axes a-b-c are 1-2-3 in a frame whose basis vectors have other names; where that frame is left-handed, angles
count the other way round. A sequence a-b-a ends with a turn about a, which is a turn about the third axis
between two quarter turns about b: one joins the middle angle, the other is left at the end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.model.arrays import Floats


@dataclass(frozen=True)
class Renaming:
    """How a sequence follows from 1-2-3.

    With {phi} = `sign` {theta}, and a quarter turn more for phi_2 where `ends_alike`, its rotation is
    [after] [R_123(phi)] [before], and its angle-rate matrix is [after] [P_123(phi)].

    Attributes:
        before: (3, 3) from components before the turns to those of the other names.
        after: (3, 3) back, after the turns and the quarter turn that is left.
        sign: 1 or -1.
        ends_alike: Whether the last axis is the first.
    """

    before: Floats
    after: Floats
    sign: int
    ends_alike: bool


def renaming(axes: tuple[int, ...]) -> Renaming:
    """How the sequence about `axes`, from 0, follows from 1-2-3."""
    first, second, last = axes
    third = 3 - first - second
    names: Floats = np.eye(3)[[first, second, third]]
    sign = round(float(np.linalg.det(names)))
    left = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) if last == first else np.eye(3)
    return Renaming(names, names.T @ left, sign, last == first)
