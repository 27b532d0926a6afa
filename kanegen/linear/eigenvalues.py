"""Eigenvalues and eigenvectors of [A], each with a bound on its error.

An eigenvalue that is alone moves by at most the size of the error of [A] over the cosine of the angle between
its left and its right eigenvector (Golub and Van Loan 2013, section 7.2.2). Where two coincide and have one
eigenvector, as those of a body that slides freely, this cosine is zero, and an error of one roundoff moves
them by the root of a roundoff. What entries of [A] are uncertain by beyond a roundoff of the whole, such as a
cosine of pi/2 that rounding of the angle keeps from being zero, counts by the absolute values of both
eigenvectors. Two structures of mechanical systems keep such errors away: where nothing
damps, and no force depends on speeds, the squares of the eigenvalues are those of a matrix of half the size;
and what nothing acts on is split off by permutations inside LAPACK, which rounds nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

ROUNDOFF = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Eigenvalues:
    """The eigenvalues of an (N, N) matrix.

    Attributes:
        values: (N,) eigenvalues (1/s).
        vectors: (N, N) eigenvectors, in columns.
        errors: (N,) bounds on the errors of the eigenvalues, for errors of [A] of a few roundoffs and for the
            uncertainty of its entries (1/s).
    """

    values: Complexes
    vectors: Complexes
    errors: Floats


def eigenvalues(A: Floats, second_order: int = 0, uncertainty: Floats | None = None) -> Eigenvalues:
    """Return the eigenvalues of [A] with bounds on their errors.

    Args:
        A: (N, N) matrix (1/s and other units, SI).
        second_order: Number n of freedoms if the states are n coordinates and then their n rates, else 0.
        uncertainty: (N, N) bounds on errors of the entries of [A] beyond its roundoffs; None for zero.
    """
    n = second_order
    entries = np.zeros_like(A) if uncertainty is None else uncertainty
    if n and not A[n:, n:].any() and not A[:n, :n].any() and np.array_equal(A[:n, n:], np.eye(n)):
        return _undamped(A[n:, :n], entries[n:, :n])
    values, vectors = np.linalg.eig(A)
    return Eigenvalues(values.astype(complex), vectors.astype(complex), _errors(A, values, vectors, entries))


def _undamped(K: Floats, entries: Floats) -> Eigenvalues:
    """Return the eigenvalues of [[0, 1], [K, 0]]: both roots of each eigenvalue of the (n, n) matrix [K].

    A square within its error is zero; the error of the eigenvalue is then the root of that of the square.
    """
    squares, shapes = np.linalg.eig(K)
    squares = squares.astype(complex)
    uncertain = _errors(K, squares, shapes, entries)
    squares = np.where(np.abs(squares) <= uncertain, 0.0, squares)
    squares = np.where(np.abs(squares.imag) <= uncertain, squares.real + 0j, squares)
    roots = np.sqrt(squares)
    size = np.abs(roots)
    errors = np.where(size > 0, uncertain / np.where(size > 0, 2 * size, 1.0), np.sqrt(uncertain))
    values = np.concatenate([roots, -roots])
    vectors = np.concatenate([np.tile(shapes, 2), np.tile(shapes, 2) * values], axis=0)
    return Eigenvalues(values, vectors / np.linalg.norm(vectors, axis=0), np.tile(errors, 2))


def _errors(A: Floats, values: NDArray[np.inexact], vectors: NDArray[np.inexact], entries: Floats) -> Floats:
    """Return bounds on the errors of eigenvalues, for two that coincide at most a root of a roundoff."""
    size = len(A)
    slack = 4 * size * ROUNDOFF * float(np.linalg.norm(balanced(A), 2))
    left_values, left = np.linalg.eig(A.T)
    errors = np.empty(size)
    for k, value in enumerate(values):
        match = int(np.argmin(np.abs(left_values - value)))
        a, b = left[:, match], vectors[:, k]
        lengths = np.linalg.norm(a) * np.linalg.norm(b)
        moved = slack + float(np.abs(a) @ entries @ np.abs(b) / lengths)
        errors[k] = moved / max(float(abs(a @ b) / lengths), np.sqrt(4 * size * ROUNDOFF))
    return errors


def balanced(A: Floats) -> Floats:
    """Return [A] in other units of its states, powers of two, in which its rows and columns have like sizes.

    This is Osborne's iteration; eigenvalues stay what they are to the last bit.
    """
    found = np.array(A, np.float64)
    for _ in range(10):
        rows = np.abs(found - np.diag(np.diag(found))).sum(axis=1)
        columns = np.abs(found - np.diag(np.diag(found))).sum(axis=0)
        linked = (rows > 0) & (columns > 0)
        ratio = np.where(linked, rows, 1.0) / np.where(linked, columns, 1.0)
        factors = np.exp2(np.rint(np.log2(ratio) / 4))
        if (factors == 1).all():
            break
        found = found / factors[:, None] * factors
    return found
