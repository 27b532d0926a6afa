"""A free rigid body beside the exact solution of Euler's equations by Jacobi's elliptic functions."""

from __future__ import annotations

import mpmath
import numpy as np

import kanegen as kg
from benchmarks.validation.case import Case, build, exact_row

INERTIA = (1.0, 2.0, 3.0)
"""Principal moments of inertia of the model, kg m^2."""

START = (0.1, 1.0, 0.15)
"""Components of the first angular velocity, rad/s: nearly about the middle axis, so the body turns over."""

TIMES = (0.0, 10.0, 60.0)
"""Times of the results, s."""

DIGITS = 20
"""Digits of the exact solution."""

ERROR = 1e-10
"""Error of the integration that is allowed, rad/s or in entries of a rotation."""


def case() -> Case:
    """Return the case: angular velocity and orientation after 10 s and a minute."""
    library = build("free_rigid_body", "forward_dynamics", "coordinate_rates", "body_poses")
    run = kg.simulate(library, [1.0, 0.0, 0.0, 0.0], START, TIMES, method="DOP853", tolerance=1e-13)
    solution = Euler(INERTIA, START)
    rows = []
    for time, x, y in zip(TIMES[1:], run.x[1:], run.y[1:], strict=True):
        rows.append(exact_row(f"angular velocity at {time:g} s", "rad/s", solution.omega(time), y, ERROR))
        rotation = library.body_poses(x)[0, :3]
        for i, expected in enumerate(solution.rotation(time)):
            rows.append(exact_row(f"row {i + 1} of [R] at {time:g} s", "1", expected, rotation[i], ERROR))
    return Case(
        title="The free rigid body",
        model="free_rigid_body",
        source="L. D. Landau and E. M. Lifshitz, *Mechanics*, third edition, §37: the asymmetrical top.",
        problem=(
            "Moments of inertia 1, 2 and 3 kg m², first about an axis near the middle one, so that the body "
            "turns over again and again (Dzhanibekov). `forward_dynamics`, `coordinate_rates` and "
            "`body_poses` in C, integrated by DOP853 with the tolerance 1e-13. The exact solution has "
            "Jacobi's functions for the angular velocity; the orientation follows from the constant angular "
            f"momentum, and its turn about it from a quadrature, both with {DIGITS} digits by mpmath."
        ),
        allowance=f"A formula has no digits; the integration may err by {ERROR:g}.",
        rows=tuple(rows),
    )


class Euler:
    """The exact motion of a free body that starts with its axes along the inertial ones.

    Moments of inertia I1 < I2 < I3 and an angular momentum M with M^2 > 2 E I2, where E is the energy; in the
    textbook this is the solution by cn, sn and dn.
    """

    def __init__(self, inertia: tuple[float, ...], start: tuple[float, ...]) -> None:
        self.inertia = i1, i2, i3 = tuple(mpmath.mpf(value) for value in inertia)
        self.start = tuple(mpmath.mpf(value) for value in start)
        with mpmath.workdps(DIGITS):
            energy = sum(i * w**2 for i, w in zip(self.inertia, self.start, strict=True))  # 2 E
            self.square = square = sum((i * w) ** 2 for i, w in zip(self.inertia, self.start, strict=True))
            if not square > energy * i2:
                raise ValueError("the body turns about its first axis; exchange axes 1 and 3.")
            self.amplitudes = (
                mpmath.sqrt((energy * i3 - square) / (i1 * (i3 - i1))),
                mpmath.sqrt((energy * i3 - square) / (i2 * (i3 - i2))),
                mpmath.sqrt((square - energy * i1) / (i3 * (i3 - i1))),
            )
            self.rate = mpmath.sqrt((i3 - i2) * (square - energy * i1) / (i1 * i2 * i3))
            self.m = (i2 - i1) * (energy * i3 - square) / ((i3 - i2) * (square - energy * i1))
            sine = self.start[1] / self.amplitudes[1]
            self.phase = mpmath.ellipf(mpmath.asin(sine), self.m)
            if self.start[0] < 0 or self.start[2] < 0:
                raise ValueError("components 1 and 3 of the first angular velocity must not be negative.")

    def omega(self, time: float) -> tuple[mpmath.mpf, ...]:
        """Return the (3,) angular velocity in the body, rad/s."""
        with mpmath.workdps(DIGITS):
            u = self.phase + self.rate * mpmath.mpf(time)
            functions = (mpmath.ellipfun(kind, u, m=self.m) for kind in ("cn", "sn", "dn"))
            return tuple(a * function for a, function in zip(self.amplitudes, functions, strict=True))

    def rotation(self, time: float) -> np.ndarray:
        """Return the (3, 3) rotation that takes inertial components to those in the body.

        The angular momentum is constant, and its components in the body are known. They fix the orientation
        but for a turn about it, whose rate follows from the angular velocity.
        """
        with mpmath.workdps(DIGITS):
            first, last = self._frame(0.0), self._frame(time)
            turned = self._turn(time)
            cosine, sine = mpmath.cos(turned), mpmath.sin(turned)
            about = mpmath.matrix([[cosine, sine, 0], [-sine, cosine, 0], [0, 0, 1]])
            return np.array((last.T * about * first).tolist(), dtype=float)

    def _frame(self, time: float) -> mpmath.matrix:
        """Return the rotation from the body to a frame whose axis 3 is along M, and axis 1 across theirs."""
        m1, m2, m3 = (i * w for i, w in zip(self.inertia, self.omega(time), strict=True))
        size, across = mpmath.sqrt(self.square), mpmath.sqrt(m1**2 + m2**2)
        return mpmath.matrix(
            [
                [m2 / across, -m1 / across, 0],
                [m1 * m3 / (across * size), m2 * m3 / (across * size), -across / size],
                [m1 / size, m2 / size, m3 / size],
            ]
        )

    def _turn(self, time: float) -> mpmath.mpf:
        """Return the turn of that frame about M since the first time, by a quadrature."""
        i1, i2, _ = self.inertia
        size = mpmath.sqrt(self.square)

        def slope(t: mpmath.mpf) -> mpmath.mpf:
            w1, w2, _ = self.omega(t)
            return size * (i1 * w1**2 + i2 * w2**2) / ((i1 * w1) ** 2 + (i2 * w2) ** 2)

        period = 4 * mpmath.ellipk(self.m) / self.rate
        pieces = max(1, int(mpmath.ceil(8 * time / period)))
        return mpmath.quad(slope, mpmath.linspace(0, time, pieces + 1), method="gauss-legendre")
