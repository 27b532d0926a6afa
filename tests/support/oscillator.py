"""A mass on a spring, whose steps and motions are known in closed form."""

from __future__ import annotations

import numpy as np

import kanegen as kg


def oscillator(stiffness: float = 1.0) -> kg.System:
    """Return the system "slider": 1 kg on a spring (N/m), or on none, along axis 1, without gravity."""
    joint = kg.Joint(free=(False, False, False, True, False, False))
    springs = (kg.JointSpring("slider.s1", stiffness=stiffness),) if stiffness else ()
    body = kg.Body("slider", 0, 1.0, np.eye(3), joint=joint)
    return kg.System("slider", (body,), gravity=(0, 0, 0), force_elements=springs)
