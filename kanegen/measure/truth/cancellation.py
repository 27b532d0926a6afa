"""Cancellation in the outputs that are sums: the magnitudes of their terms over what is left of them."""

from __future__ import annotations

import math

import numpy as np

from kanegen.measure.truth.certify import Truth
from kanegen.model.arrays import Floats
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import forcing_magnitude, mass_matrix_magnitude, reaches
from kanegen.reference.matrices import apply, length


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
