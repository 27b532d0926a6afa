"""Conditioning: how much accuracy a problem costs every program that solves it.

- kappa_s: condition number of [A] after scaling to a diagonal of ones, in the 2-norm. Rows and columns in
  other units, or bodies of other sizes, do not count as ill conditioned.
- chi: cancellation. For forward dynamics it is that of the right-hand side, as accelerations: loads, gravity,
  speeds and {tau} would each accelerate the tree by themselves, and chi is the sum of the norms of these
  accelerations over the norm of their sum. Near an equilibrium it has no limit. For an output that is a sum
  itself it is the norm of the magnitudes of its terms over the norm of the output.
- formation: cancellation inside [A] and {f}. A program rounds the terms whose sums are the entries, and the
  terms may be larger than the sums: a heavy body folds back onto an axis, or slides across its weight.
  Formation is the larger of two ratios of terms to sums, in the 2-norm and scaled as for kappa_s: the ratio
  of [A], and the ratio of the parts that chi adds.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kanegen.measure.truth.balls import arb_mat, beside, column, ctx, inverse
from kanegen.measure.truth.certify import Truth
from kanegen.measure.truth.enclosure import enclosure
from kanegen.model.arrays import Floats
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import (
    forcing_magnitude,
    mass_matrix_magnitude,
    path_maxima,
    rotor_forcing_magnitude,
)
from kanegen.reference.matrices import apply, length


@dataclass(frozen=True)
class Conditioning:
    """The conditioning of forward dynamics in one state.

    Attributes:
        kappa_s: Scaled condition number of [A]; infinite where [A] is singular.
        chi: Cancellation of the right-hand side; infinite where its parts sum to zero.
        formation: Cancellation inside [A] and {f}; infinite where [A] is singular.
        terms: Sum of the norms of the accelerations that loads, gravity, speeds and {tau} would each cause by
            themselves, after the units are taken away (m/s^2); chi is `terms` over the norm of {ydot}.
    """

    kappa_s: float
    chi: float
    formation: float
    terms: float


def conditioning(truth: Truth) -> Conditioning:
    """Return the conditioning of forward dynamics in the state of `truth`.

    Example:
        >>> truth.conditioning(truth.truth(system, x, y)).kappa_s
    """
    equations = truth.equations
    with ctx.workprec(truth.bits):
        inverted, tau = inverse(equations.A), column(truth.state.tau)
        parts = beside([equations.loads, equations.gravity, equations.velocity, tau])
        accelerations = _midpoints(inverted * parts)
        total = _midpoints(inverted * (equations.f + tau))
        kappa = scaled_condition_number(equations.A, inverted)
    scale = truth.units.acceleration[:, None]
    single, size = length(accelerations * scale, axis=0), float(length(total * scale, axis=0)[0])
    terms = float(single.sum())
    chi = terms / size if size > 0 else math.inf
    return Conditioning(kappa, chi, _formation(truth) if kappa < math.inf else math.inf, terms)


def scaled_condition_number(matrix: arb_mat, inverted: arb_mat) -> float:
    """Return kappa_s of a symmetric matrix; infinity where it may be singular.

    The largest eigenvalues of the matrix and of its inverse are found in doubles, which is accurate to
    rounding however small the smallest eigenvalue is.

    Args:
        matrix: (n, n) enclosure of the matrix.
        inverted: (n, n) enclosure of its inverse.
    """
    diagonal = [matrix[i, i] for i in range(matrix.nrows())]
    if not all(entry > 0 for entry in diagonal) or not all(e.is_finite() for e in inverted.entries()):
        return math.inf
    roots = [entry.sqrt() for entry in diagonal]
    n = len(roots)
    pairs = [(i, j) for i in range(n) for j in range(n)]
    scaled = _midpoints(arb_mat(n, n, [matrix[i, j] / (roots[i] * roots[j]) for i, j in pairs]))
    back = _midpoints(arb_mat(n, n, [inverted[i, j] * (roots[i] * roots[j]) for i, j in pairs]))
    return float(np.linalg.eigvalsh(scaled)[-1] * np.linalg.eigvalsh(back)[-1])


def term_norms(truth: Truth) -> dict[str, float]:
    """Return the norm of the magnitudes of the terms of every output that is a sum, without units."""
    magnitudes = term_magnitudes(truth)
    return {
        name: _norm(magnitudes[name] * truth.units.of(name)) for name in truth.outputs if name in magnitudes
    }


def cancellation(truth: Truth, terms: Mapping[str, float]) -> dict[str, float]:
    """Return chi of every output that is a sum, from its `term_norms`; infinity where the output is zero."""
    sizes = {name: _norm(truth[name].value * truth.units.of(name)) for name in terms}
    return {name: terms[name] / size if size > 0 else math.inf for name, size in sizes.items()}


def term_magnitudes(truth: Truth) -> dict[str, Floats]:
    """Return the magnitudes of the terms of [A], {f} and inverse dynamics, each in the output's shape.

    They are those of `kanegen.reference.magnitudes`, computed in doubles: bounds rest on them, exact results
    do not.
    """
    arrays, state = truth.system.values(), truth.state
    maxima = path_maxima(arrays, kinematics(arrays, state.x, state.y), state.y)
    matrix = mass_matrix_magnitude(arrays, maxima)
    forcing = forcing_magnitude(arrays, maxima, state.force, state.torque)
    forcing = forcing + rotor_forcing_magnitude(arrays, maxima, state.y)
    inverse = apply(matrix, np.abs(state.ydot)) + forcing
    return {"mass_matrix": matrix, "forcing": forcing, "inverse_dynamics": inverse}


def _formation(truth: Truth) -> float:
    """Return the formation of a regular [A] and its right-hand side; at least 1."""
    equations, terms = truth.equations, term_magnitudes(truth)
    matrix, tau = _midpoints(equations.A), np.abs(truth.state.tau)
    scale = 1 / np.sqrt(matrix.diagonal())
    scales = np.outer(scale, scale)
    in_matrix = np.linalg.norm(terms["mass_matrix"] * scales, 2) / np.linalg.norm(matrix * scales, 2)
    parts = np.abs(_midpoints(beside([equations.loads, equations.gravity, equations.velocity]))).sum(axis=1)
    rest = float(length((parts + tau) * scale))
    in_forcing = float(length((terms["forcing"] + tau) * scale)) / rest if rest > 0 else 1.0
    return max(1.0, float(in_matrix), in_forcing)


def _midpoints(matrix: arb_mat) -> Floats:
    """Return the midpoints of a matrix of balls as doubles."""
    return enclosure(matrix, (matrix.nrows(), matrix.ncols())).value


def _norm(values: Floats) -> float:
    """Return the Euclidean norm of all entries."""
    return float(length(values.ravel()))
