"""What only some systems read, passed by name."""

from __future__ import annotations

from typing import TypedDict

from numpy.typing import ArrayLike


class Given(TypedDict, total=False):
    """One of each may serve all states of a batch.

    Attributes:
        point_force: (P, 3) or (B, P, 3) force on each point that takes loads, inertial components, N; None is
            zero.
        point_moment: The same for the moment on its body, N m.
        t: () or (B,) the time, s, where a force element depends on it.
    """

    point_force: ArrayLike | None
    point_moment: ArrayLike | None
    t: ArrayLike
