"""Conservation of energy and momentum: where a motion must keep them, and by how much they drift."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kanegen.c import Source
from kanegen.errors import OptionError
from kanegen.model.arguments import Floats
from kanegen.model.arrays import Floats as Doubles
from kanegen.model.force_elements import ForceElement, JointSpring, Potential, Spring
from kanegen.model.numbers import value_of
from kanegen.simulation.accuracy import Drift, drift


def energy_drift(times: Doubles, kinetic: Doubles, potential: Doubles, work: Floats) -> Drift:
    """Return the drift of the energy less the work of the efforts, see `Trajectory.energy_drift`.

    Args:
        times: (T,) times, s.
        kinetic: (T,) or (T, B) kinetic energy, J.
        potential: Potential energy of the same shape, J.
        work: Work of the efforts of the same shape, J.

    Raises:
        OptionError: If nothing has moved.
    """
    scale = max(float(np.ptp(kinetic)), float(np.ptp(potential)), float(np.abs(kinetic[0]).max()))
    if scale == 0.0:
        raise OptionError("energy drift: nothing has moved, so there is no energy to compare it with.")
    return drift(times, kinetic + potential - work, scale)


def momentum_drifts(
    times: Doubles, momentum: Doubles, linear: float | None, angular: float | None
) -> tuple[Drift, Drift]:
    """Return the drifts of linear and angular momentum, see `Trajectory.momentum_drift`.

    Args:
        times: (T,) times, s.
        momentum: (T, 6) or (T, B, 6) linear momentum, kg m/s, and angular momentum, kg m^2/s.
        linear: Linear momentum that counts as one, kg m/s; None for the largest on the way.
        angular: Angular momentum that counts as one, kg m^2/s; None for the largest on the way.

    Raises:
        OptionError: If nothing has moved and no scale is given.
    """
    drifts = []
    for part, scale in ((momentum[..., :3], linear), (momentum[..., 3:], angular)):
        largest = float(np.linalg.norm(part, axis=-1).max())
        drifts.append(drift(times, part, largest if scale is None else scale))
    return drifts[0], drifts[1]


def keeps_energy(source: Source, inputs: Mapping[str, Floats]) -> bool:
    """Return whether the energy less the work of the efforts is constant.

    Args:
        source: The code that computes the motion.
        inputs: What acted, see `Trajectory`.
    """
    system = source.system
    driven = "prescribed" in inputs and "prescribed_efforts" not in source.outputs
    return (
        system is not None
        and not driven
        and not system.depends_on_time
        and inputs.keys() <= {"tau", "prescribed"}
        and all(map(stores_energy, system.force_elements))
    )


def keeps_momentum(source: Source, inputs: Mapping[str, Floats]) -> bool:
    """Return whether nothing from outside acts on the bodies, so that their momentum is constant.

    Args:
        source: The code that computes the motion.
        inputs: What acted, see `Trajectory`.
    """
    system = source.system
    return (
        system is not None
        and not inputs
        and not any(map(value_of, system.gravity))
        and all(all(body.joint.free) for body in system.bodies if not body.lower)
    )


def stores_energy(element: ForceElement) -> bool:
    """Return whether a force element stores all energy that it takes: a spring without damping, a potential.

    Example:
        stores_energy(kg.JointSpring("elbow.theta3", stiffness=40.0))  # True
    """
    match element:
        case JointSpring(damping=damping) | Spring(damping=damping):
            return value_of(damping) == 0
    return isinstance(element, Potential)
