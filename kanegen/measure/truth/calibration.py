"""The calibration of the bounds: their fit to generated code, over states of many kinds.

Half of the right-hand sides are ordinary. In the other half {tau} almost balances {f}, up to one part in ten
millions, so that cancellation ranges over many powers of ten.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from kanegen.measure.truth.bounds import Fit, fit
from kanegen.measure.truth.measurement import MeasuredLibrary, Measurement, measure
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states

CLOSEST = 7
"""Number of powers of ten up to which {tau} may cancel {f}."""


def calibrate(
    pairs: Iterable[tuple[System, MeasuredLibrary]], states: int = 10, seed: int = 0
) -> dict[str, Fit]:
    """Return how the bounds fit the errors of libraries, by output.

    Args:
        pairs: Systems, each with a library that was built from it; all of one precision.
        states: Number of random states of each system.
        seed: Seed of the random states.

    Raises:
        OptionError: If an output has no state in which its bound promises anything.

    Example:
        >>> fits = truth.calibrate([(system, kg.build(system, ("forward_dynamics",)))])
        >>> fits["forward_dynamics"].holds
        True
    """
    found: dict[str, list[Measurement]] = {}
    for system, library in pairs:
        sample = random_states(system, states, seed)
        tau, ydot = _efforts(system, sample, np.random.default_rng(seed))
        for name, measured in measure(system, library, sample, tau, ydot).items():
            found.setdefault(name, []).append(measured)
    return {
        name: fit(
            np.concatenate([measured.normwise for measured in several]),
            np.concatenate([measured.bound for measured in several]),
        )
        for name, several in found.items()
    }


def _efforts(system: System, states: States, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return (B, n) random {tau} of the size of {f}, and {ydot} of the size of the accelerations."""
    f = reference.forcing(system, states.x, states.y, states.force, states.torque)
    a = reference.mass_matrix(system, states.x)
    ydot = np.array([np.linalg.lstsq(a, f, rcond=None)[0] for a, f in zip(a, f, strict=True)])
    near = 10.0 ** -rng.uniform(0, CLOSEST, (len(states), 1))
    ordinary = rng.random((len(states), 1)) < 0.5
    tau = np.where(ordinary, rng.uniform(-1, 1, f.shape), near * rng.uniform(-1, 1, f.shape) - 1) * f
    return tau, ydot * rng.uniform(-1, 1, f.shape)
