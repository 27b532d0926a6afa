"""What inputs can reach and what outputs show: the controllable and the observable part of the states.

The staircase algorithm (Van Dooren 1981) collects the directions [B], [A][B], [A]^2[B], ... one after another
as an orthonormal basis, so that no power of [A] is formed. What is left has eigenvalues that no input moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kanegen.linear.eigenvalues import Floats

SMALLEST = 1e-10
"""Size of a direction, as a share of [A] or [B] in like units, below which it counts as rounding errors."""


@dataclass(frozen=True)
class Subspace:
    """The part of the states that inputs reach, or that outputs show.

    Attributes:
        states: Number N of states.
        dimension: Dimension of the part.
        basis: (N, dimension) orthonormal basis of it.
        remaining: Eigenvalues of [A] that inputs cannot move, or that outputs do not show (1/s).
    """

    states: int
    dimension: int
    basis: Floats
    remaining: tuple[complex, ...]

    @property
    def is_complete(self) -> bool:
        """Whether the part is everything."""
        return self.dimension == self.states

    def words(self, whole: str, part: str) -> str:
        """Return the result as a clause.

        Args:
            whole: Adjective, such as "controllable".
            part: Verb phrase for what is left, such as "no input moves".
        """
        if self.is_complete:
            return f"{whole} (rank {self.dimension} of {self.states})"
        left = ", ".join(f"{value:.4g}" for value in _readable(self.remaining))
        return f"not {whole}: rank {self.dimension} of {self.states}; {part} the eigenvalues {left} 1/s"


def controllable(A: Floats, B: Floats) -> Subspace:
    """Return the part of the states that inputs reach.

    Args:
        A: (N, N) matrix of the states.
        B: (N, r) matrix of the inputs.
    """
    sizes = np.linalg.norm(B, axis=0)
    basis = new = _directions(B[:, sizes > 0] / sizes[sizes > 0], 1.0, np.zeros((len(A), 0)))
    largest = float(np.linalg.norm(A, 2))
    while new.shape[1] and basis.shape[1] < len(A):
        new = _directions(A @ new, largest, basis)
        basis = np.concatenate([basis, new], axis=1)
    full, _ = np.linalg.qr(basis, mode="complete") if basis.shape[1] else (np.eye(len(A)), None)
    rest = full[:, basis.shape[1] :]
    remaining = np.linalg.eigvals(rest.T @ A @ rest) if rest.shape[1] else np.zeros(0)
    return Subspace(len(A), basis.shape[1], basis, tuple(complex(value) for value in remaining))


def observable(A: Floats, C: Floats) -> Subspace:
    """Return the part of the states that outputs show: the controllable part of the transposed matrices."""
    return controllable(np.ascontiguousarray(A.T), np.ascontiguousarray(C.T))


def _directions(vectors: Floats, size: float, basis: Floats) -> Floats:
    """Return an orthonormal basis of what vectors add to a basis, without what is small beside `size`."""
    for _ in range(2):  # the second time removes what rounding has left
        vectors = vectors - basis @ (basis.T @ vectors)
    left, sizes, _ = np.linalg.svd(vectors, full_matrices=False)
    found: Floats = left[:, sizes > SMALLEST * size]
    return found


def _readable(values: tuple[complex, ...]) -> list[complex | float]:
    """Return eigenvalues with rounding errors of zero left out."""
    largest = max(map(abs, values), default=0.0)

    def clean(part: float) -> float:
        return 0.0 if abs(part) <= SMALLEST * max(1.0, largest) else part

    cleaned = [complex(clean(value.real), clean(value.imag)) for value in values]
    return [value if value.imag else value.real for value in cleaned]
