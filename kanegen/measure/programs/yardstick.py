"""The states in which programs are measured, and what their errors are measured against."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kanegen.errors import SingularError
from kanegen.extras import is_installed, module
from kanegen.measure.errors import quotient, scaled_norm
from kanegen.model.arrays import Floats
from kanegen.model.system import System
from kanegen.program.precision import FLOAT
from kanegen.reference import equations as reference
from kanegen.reference.states import States, random_states

if TYPE_CHECKING:
    from kanegen.measure.truth.certify import Truth

NEAREST = 6.0
"""Largest number of powers of ten by which an angle approaches gimbal lock."""


@dataclass(frozen=True)
class Yardstick:
    """What errors in B states are measured against.

    Attributes:
        words: What it is, in words.
        distances: (B,) distances from the nearest singular matrix, 1 over the scaled condition number of [A].
        values: Results by output, the nearest doubles where they are exact: (B, n, n) or (B, n).
        certified: Exact results of each state; empty where the reference is the yardstick.
        note: Why the reference is; "" where the results are exact.
    """

    words: str
    distances: Floats
    values: Mapping[str, Floats]
    certified: tuple[Truth, ...] = ()
    note: str = ""

    def differences(self, output: str, values: Floats) -> Floats:
        """Return the magnitudes of the differences of results from the true ones; infinite for a NaN."""
        if self.certified:
            found = np.array(
                [exact[output].distance(value) for exact, value in zip(self.certified, values, strict=True)]
            )
        else:
            found = np.abs(values - self.values[output])
        return np.where(np.isnan(found), np.inf, found)

    def acceleration_errors(self, values: Floats) -> Floats:
        """Return the (B,) normwise errors of {ydot}, (B, n); NaN where there are no exact accelerations."""
        errors = np.full(len(values), np.nan)
        for k, exact in enumerate(self.certified):
            if "forward_dynamics" in exact.outputs:
                scale = exact.units.of("forward_dynamics")[np.newaxis]
                truth = exact["forward_dynamics"]
                sizes = [
                    scaled_norm(one[np.newaxis], scale) for one in (truth.distance(values[k]), truth.value)
                ]
                errors[k] = quotient(*sizes)[0]
        return errors


def states_near_and_far(system: System, count: int, seed: int) -> States:
    """Return random states; in half of them angles approach gimbal lock, where [A] is singular there.

    All numbers are those of single precision, so that every program gets the same ones.
    """
    sample = random_states(system, count, seed, system.limits)
    rng, half = np.random.default_rng((seed, 1)), count // 2
    for place, coordinate in enumerate(system.coordinates):
        vanishing = system.bodies[coordinate.body - 1].joint.mass_matrix_singularity
        if coordinate.index == 1 and not coordinate.is_translation and vanishing:
            offset = 10.0 ** -rng.uniform(0, NEAREST, half) * rng.choice([-1.0, 1.0], half)
            sample.x[:half, place] = offset + (0.0 if vanishing == "sin" else np.pi / 2)
    return sample.rounded(FLOAT)


def yardstick(system: System, states: States) -> Yardstick:
    """Return certified truth in the states, or the reference where there is none and why."""
    unknown = _unknown_to_truth(system)
    if not unknown:
        return _certified(system, states)
    arrays, x, y = system.values(), states.x, states.y
    values = {
        "mass_matrix": reference.mass_matrix(arrays, x, states.prescribed),
        "forcing": reference.forcing(arrays, x, y, states.force, states.torque, **states.inputs),
    }
    note = f"Errors are differences from the reference, which rounds itself: {unknown}."
    return Yardstick("the reference", _distances(values["mass_matrix"]), values, note=note)


def _unknown_to_truth(system: System) -> str:
    """Return why there is no certified truth for a system; "" where there is."""
    if not is_installed("flint"):
        return "certified truth needs python-flint (pip install 'kanegen[study]')"
    kinds = {
        "prescribed freedoms": system.prescribed,
        "force elements": system.force_elements,
        "loads on points": [point for _, point in system.points if point.loads],
    }
    found = [kind for kind, present in kinds.items() if present]
    return f"there is no certified truth with {' and '.join(found)}" if found else ""


def _certified(system: System, states: States) -> Yardstick:
    """Return certified truth in the states."""
    certify, conditioning = (module(f"kanegen.measure.truth.{name}") for name in ("certify", "conditioning"))
    found = []
    for k in range(len(states)):
        force, torque = (None if load is None else load[k] for load in (states.force, states.torque))
        try:
            exact = certify.truth(system, states.x[k], states.y[k], force=force, torque=torque)
        except SingularError:
            names = ("mass_matrix", "forcing")
            exact = certify.truth(system, states.x[k], states.y[k], None, force, torque, outputs=names)
        found.append(exact)
    values = {name: np.array([exact[name].value for exact in found]) for name in ("mass_matrix", "forcing")}
    distances = np.array([1 / conditioning.conditioning(exact).kappa_s for exact in found])
    return Yardstick("certified truth", distances, values, tuple(found))


def _distances(matrices: Floats) -> Floats:
    """Return 1 over the scaled condition numbers of symmetric matrices (B, n, n), to rounding."""
    diagonal = np.einsum("bii->bi", matrices)
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    eigenvalues = np.linalg.eigvalsh(matrices * scale[:, :, None] * scale[:, None, :])
    least, largest = eigenvalues[:, 0], eigenvalues[:, -1]
    distances: Floats = np.maximum(least, 0.0) / largest
    return distances
