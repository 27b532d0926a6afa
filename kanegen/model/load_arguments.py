"""What only some systems read, passed by name."""

from __future__ import annotations

from typing import TypedDict

from numpy.typing import ArrayLike


class GivenLoads(TypedDict, total=False):
    """Of force elements and points; one of each may serve all states of a batch.

    Attributes:
        point_force: (P, 3) or (B, P, 3) force on each point that takes loads, inertial components, N; None is
            zero.
        point_moment: The same for the moment on its body, N m.
        t: () or (B,) the time, s, where a force element depends on it.
    """

    point_force: ArrayLike | None
    point_moment: ArrayLike | None
    t: ArrayLike


class Given(GivenLoads, total=False):
    """And of prescribed freedoms.

    Attributes:
        prescribed: (3, p) or (B, 3, p) values (rad, m), rates and second derivatives of the prescribed
            freedoms, in the order of `prescribed_names`.
    """

    prescribed: ArrayLike
