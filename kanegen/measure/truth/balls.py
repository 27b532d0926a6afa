"""Matrices of real balls: every result encloses the exact one.

`python-flint` brings the arithmetic (Arb, now part of FLINT). Floats enter as the numbers they are. A ball
that is computed from them has a midpoint of as many bits as the working precision allows and a radius that
bounds its error.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kanegen.errors import MissingError

try:
    from flint import arb, arb_mat, ctx
except ImportError:
    raise MissingError(
        "the Python package python-flint is not installed (pip install 'kanegen[truth]')"
    ) from None

__all__ = [
    "arb",
    "arb_mat",
    "beside",
    "column",
    "cross",
    "ctx",
    "identity",
    "inverse",
    "largest_magnitude",
    "nearest_rotation",
    "skew",
    "solution",
    "square",
    "stacked",
    "unit",
    "zeros",
]


def column(values: Iterable[float | arb]) -> arb_mat:
    """Return the (m, 1) matrix of numbers, which are taken exactly."""
    entries = _entries(values)
    return arb_mat(len(entries), 1, entries)


def square(rows: Iterable[Iterable[float | arb]]) -> arb_mat:
    """Return the (m, m) matrix of m rows of numbers, which are taken exactly."""
    table = [_entries(row) for row in rows]
    return arb_mat(len(table), len(table), [entry for row in table for entry in row])


def zeros(rows: int, columns: int) -> arb_mat:
    """Return a (rows, columns) matrix of exact zeros."""
    return arb_mat(rows, columns)


def identity(size: int) -> arb_mat:
    """Return the exact (size, size) identity."""
    return square([1.0 if i == j else 0.0 for j in range(size)] for i in range(size))


def unit(axis: int) -> arb_mat:
    """Return the (3, 1) basis vector with the index 0, 1 or 2."""
    return column(1.0 if i == axis else 0.0 for i in range(3))


def skew(v: arb_mat) -> arb_mat:
    """Return the (3, 3) skew matrix of a (3, 1) vector, whose product with a vector is the cross product."""
    one, two, three = v.entries()
    return square([[0.0, -three, two], [three, 0.0, -one], [-two, one, 0.0]])


def cross(a: arb_mat, b: arb_mat) -> arb_mat:
    """Return the (3, m) cross products of a (3, 1) vector with the columns of a (3, m) matrix."""
    return skew(a) * b


def stacked(matrices: Sequence[arb_mat]) -> arb_mat:
    """Return matrices with the same number of columns on top of each other."""
    entries = [entry for matrix in matrices for entry in matrix.entries()]
    return arb_mat(sum(matrix.nrows() for matrix in matrices), matrices[0].ncols(), entries)


def beside(columns: Sequence[arb_mat]) -> arb_mat:
    """Return columns of the same length beside each other."""
    return stacked([column.transpose() for column in columns]).transpose()


def largest_magnitude(values: Iterable[arb]) -> arb:
    """Return the largest absolute value."""
    largest = arb(0)
    for value in values:
        largest = largest.max(abs(value))
    return largest


def solution(matrix: arb_mat, right: arb_mat) -> arb_mat:
    """Return enclosures of the solutions for every column of `right`; NaN where `matrix` may be singular."""
    return matrix.solve(right, nonstop=True)


def inverse(matrix: arb_mat) -> arb_mat:
    """Return an enclosure of the inverse; NaN where `matrix` may be singular."""
    return solution(matrix, identity(matrix.nrows()))


def nearest_rotation(matrix: arb_mat) -> arb_mat:
    """Return the rotation nearest to a matrix [C] that is one but for rounding: [C] ([C]^T [C])^(-1/2).

    With [E] = [C]^T [C] - [1], the root is the binomial series of ([1] + [E])^(-1/2). Its coefficients are
    at most 1, so the terms that are left out sum to less than |E|^m / (1 - |E|), which goes into the radius.
    Exact rotations, such as those by right angles, stay exact.
    """
    one = identity(3)
    defect = matrix.transpose() * matrix - one
    size = arb(3) * largest_magnitude(defect.entries()).upper()
    if size.is_zero():
        return matrix
    if not size < 1:
        raise ArithmeticError("a matrix that is far from a rotation has got past the validation of models")
    root, power, coefficient, rest = one, one, arb(1), arb(1)
    terms = 0
    while terms < 2 or not rest < arb(2) ** -ctx.prec:
        terms += 1
        coefficient *= arb(1 - 2 * terms) / (2 * terms)
        power = power * defect
        root += power * coefficient
        rest *= size
    left_out = arb(0, (rest * size / (1 - size)).upper())
    return matrix * (root + _where_not_zero(left_out, defect, defect * defect))


def _where_not_zero(value: arb, matrix: arb_mat, squared: arb_mat) -> arb_mat:
    """Return `value` where a (3, 3) matrix or its square is not exactly 0; elsewhere all its powers are 0."""
    pairs = zip(matrix.entries(), squared.entries(), strict=True)
    return arb_mat(3, 3, [arb(0) if a.is_zero() and b.is_zero() else value for a, b in pairs])


def _entries(values: Iterable[float | arb]) -> list[arb]:
    """Return numbers as balls without radius."""
    return [value if isinstance(value, arb) else arb(float(value)) for value in values]
