"""The ten inertial parameters of each body: mass, first moment, and inertia about the origin of its frame.

They are those on which [A]{ydot} - {f} depends linearly (Atkeson, An and Hollerbach 1986), in the order of
Pinocchio's `Inertia.toDynamicParameters`. The frame is the one that users of the body see, see `Frame`: for a
robot file the frame of the link.
"""

from __future__ import annotations

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.description import require_system
from kanegen.model.system import System

INERTIAL_PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
"""Names of the ten parameters of a body: mass (kg), first moment of mass (kg m), inertia (kg m^2)."""

UPPER = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))
"""Row and column of the six entries of the inertia, in the order of `INERTIAL_PARAMETERS`."""


def inertial_parameter_names(system: System) -> tuple[str, ...]:
    """Return the (10 N,) names of the inertial parameters, such as Ixx_2 of body 2, body after body.

    Example:
        inertial_parameter_names(system)[:2]  # ("m_1", "mx_1")
    """
    numbers = range(1, system.number_of_bodies + 1)
    return tuple(f"{name}_{k}" for k in numbers for name in INERTIAL_PARAMETERS)


def inertial_parameters(system: System) -> Floats:
    """Return the inertial parameters {pi} of all bodies, which the regressor multiplies, body after body.

    Those of a body are m, m {r} and the entries xx, xy, yy, xz, yz, zz of the inertia matrix about the origin
    of the frame that users of the body see, in its components.

    Args:
        system: The tree; run-time parameters stand at their defaults.

    Returns:
        (10 N,), kg, kg m and kg m^2.

    Raises:
        OptionError: If `system` is no `System`.

    Example:
        system = kg.load("models/double_pendulum.toml")
        pi = kg.inertial_parameters(system)
        library = kg.build(system, "regressor")
        tau = library.regressor(x, y, ydot) @ pi
    """
    require_system(system)
    arrays, found = system.values(), []
    for k, body in enumerate(system.bodies):
        frame = arrays.frames[body.name]
        arm = frame.rotation @ (arrays.mass_center[k] - frame.position)
        mass, central = arrays.mass[k], frame.rotation @ arrays.inertia[k] @ frame.rotation.T
        inertia = central + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        found.append([mass, *(mass * arm), *(inertia[place] for place in UPPER)])
    return np.ravel(np.array(found, dtype=np.float64))
