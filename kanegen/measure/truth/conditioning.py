"""How much of the accuracy of forward dynamics the problem itself can cost.

- kappa_s: condition number of [A] after scaling to a diagonal of ones, in the 2-norm. Rows and columns in
  other units, or bodies of other sizes, do not count as ill conditioned.
- chi: cancellation of the right-hand side, as accelerations. Loads, gravity, speeds and {tau} would each
  accelerate the tree by themselves; chi is the sum of the norms of these over the norm of their sum. Near an
  equilibrium it has no limit.
- formation: cancellation inside [A] and {f}. A program rounds the terms that it sums their entries from, and
  these may be larger than what is left: a heavy body folds back onto an axis, or slides across its weight.
  The larger of two ratios of the terms to what is left, in the 2-norm and scaled as for kappa_s: of [A], and
  of the parts that chi adds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from kanegen.measure.truth.balls import arb_mat, beside, column, ctx, inverse
from kanegen.measure.truth.certify import Truth
from kanegen.measure.truth.enclosure import enclosure
from kanegen.model.arrays import Floats
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import forcing_magnitude, mass_matrix_magnitude, reaches
from kanegen.reference.matrices import apply, length


@dataclass(frozen=True)
class Conditioning:
    """The conditioning in one state; infinite where [A] is singular or the sum is zero."""

    kappa_s: float
    chi: float
    formation: float


def conditioning(truth: Truth) -> Conditioning:
    """The conditioning of forward dynamics in the state of `truth`."""
    equations = truth.equations
    with ctx.workprec(truth.bits):
        inverted, tau = inverse(equations.A), column(truth.state.tau)
        parts = beside([equations.loads, equations.gravity, equations.velocity, tau])
        accelerations = _floats(inverted * parts)
        total = _floats(inverted * (equations.f + tau))
        kappa = scaled_condition(equations.A, inverted)
    scale = truth.units.acceleration[:, None]
    single, size = length(accelerations * scale, axis=0), float(length(total * scale, axis=0)[0])
    chi = float(single.sum()) / size if size > 0 else math.inf
    return Conditioning(kappa, chi, _formation(truth) if kappa < math.inf else math.inf)


def _formation(truth: Truth) -> float:
    equations, terms = truth.equations, sizes(truth)
    matrix, tau = _floats(equations.A), np.abs(truth.state.tau)
    scale = 1 / np.sqrt(matrix.diagonal())
    scales = np.outer(scale, scale)
    in_matrix = np.linalg.norm(terms["mass_matrix"] * scales, 2) / np.linalg.norm(matrix * scales, 2)
    parts = np.abs(_floats(beside([equations.loads, equations.gravity, equations.velocity]))).sum(axis=1)
    rest = float(length((parts + tau) * scale))
    in_forcing = float(length((terms["forcing"] + tau) * scale)) / rest if rest > 0 else 1.0
    return max(1.0, float(in_matrix), in_forcing)


def scaled_condition(matrix: arb_mat, inverted: arb_mat) -> float:
    """kappa_s of a matrix and its inverse.

    The largest eigenvalue of each is found in doubles, which is accurate to rounding however small the
    smallest one is.
    """
    diagonal = [matrix[i, i] for i in range(matrix.nrows())]
    if not all(entry > 0 for entry in diagonal) or not all(e.is_finite() for e in inverted.entries()):
        return math.inf
    roots = [entry.sqrt() for entry in diagonal]
    n = len(roots)
    pairs = [(i, j) for i in range(n) for j in range(n)]
    scaled = _floats(arb_mat(n, n, [matrix[i, j] / (roots[i] * roots[j]) for i, j in pairs]))
    back = _floats(arb_mat(n, n, [inverted[i, j] * (roots[i] * roots[j]) for i, j in pairs]))
    return float(np.linalg.eigvalsh(scaled)[-1] * np.linalg.eigvalsh(back)[-1])


def _floats(matrix: arb_mat) -> Floats:
    return enclosure(matrix, (matrix.nrows(), matrix.ncols())).value


def cancellation(truth: Truth) -> dict[str, float]:
    """chi of every output of `truth` but forward dynamics; infinite where the output is zero.

    The norms are those of the normwise error; the magnitudes are those of `kanegen.reference.magnitudes`.
    """
    magnitudes = sizes(truth)
    found = {}
    for name, output in truth.outputs.items():
        if name in magnitudes:
            scale = truth.units.of(name)
            size, rest = _norm(magnitudes[name] * scale), _norm(output.value * scale)
            found[name] = size / rest if rest > 0 else math.inf
    return found


def sizes(truth: Truth) -> dict[str, Floats]:
    """Magnitudes of the terms of each output that is a sum, asked for or not, in its shape."""
    arrays, state = truth.system.values(), truth.state
    reach = reaches(arrays, kinematics(arrays, state.x, state.y), state.y)
    matrix = mass_matrix_magnitude(arrays, reach)
    forcing = forcing_magnitude(arrays, reach, state.force, state.torque)
    inverse = apply(matrix, np.abs(state.ydot)) + forcing
    return {"mass_matrix": matrix, "forcing": forcing, "inverse_dynamics": inverse}


def _norm(values: Floats) -> float:
    return float(length(values.ravel()))
