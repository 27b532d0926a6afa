"""The model and the states that all programs compute, and the file from which drivers read the states."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from kanegen.model.numbers import value_of
from kanegen.model.system import System
from kanegen.reference.states import ActuatedStates


def write_states(states: ActuatedStates, path: Path) -> Path:
    """Write the states into a file, in the format of drivers/driver.h, and return its path."""
    with path.open("wb") as file:
        np.array([*states.x.shape, states.y.shape[1]], dtype=np.int64).tofile(file)
        for values in (states.x, states.y, states.tau):
            np.ascontiguousarray(values).tofile(file)
    return path


def read_states(path: Path) -> ActuatedStates:
    """Read states from a file that `write_states` wrote."""
    count, m, n = np.fromfile(path, dtype=np.int64, count=3)
    x, y, tau = np.split(np.fromfile(path, offset=24), [count * m, count * (m + n)])
    return ActuatedStates(x.reshape(count, m), y.reshape(count, n), tau=tau.reshape(count, n))


def without_loads_and_parameters(system: System) -> tuple[System, tuple[str, ...]]:
    """Return the system without loads, force elements, rotors and run-time parameters, and notes on this.

    Not every peer takes loads, none takes run-time parameters as kanegen does, and none has the spin of
    rotors: they count as armature.
    """
    notes = []
    if any(body.loads for body in system.bodies):
        notes.append("loads are switched off: not everything that is timed takes them")
    if system.force_elements or any(point.loads for _, point in system.points):
        notes.append("force elements and loads on points are left out: not everything that is timed has them")
    if system.rotors:
        notes.append("rotors count as armature: their gyroscopic part is left out, which no peer has")
    if system.parameters:
        names = ", ".join(parameter.name for parameter in system.parameters)
        notes.append(f"run-time parameters are constants, at their defaults: {names}")
    fixed = with_armature_for_rotors(system.map_numbers(value_of))
    bodies = tuple(body.without_loads() for body in fixed.bodies)
    return replace(fixed, bodies=bodies, force_elements=()), tuple(notes)


def without_couplings(system: System) -> tuple[System, tuple[str, ...]]:
    """Return the system with its coupled freedoms free, and a note on this; no peer has couplings."""
    if not system.couplings:
        return system, ()
    names = ", ".join(system.coupled_names)
    note = f"couplings are left out, which peers do not have: these freedoms move by themselves: {names}"
    return replace(system, couplings=()), (note,)


def limits_note(system: System) -> tuple[str, ...]:
    """Return a note that states stay within the limits of a system; none if it has no limits."""
    words = system.limits.words
    return (f"states stay within the limits of the model, on {words}",) if words else ()


def with_armature_for_rotors(system: System) -> System:
    """Return a system without parameters in which armature J n^2 replaces rotors."""
    bodies = list(system.bodies)
    for one in system.mounted_rotors:
        joint = bodies[one.freedom.body - 1].joint
        armature = list(map(value_of, joint.armature))
        armature[one.freedom.index] += value_of(one.rotor.inertia) * value_of(one.rotor.ratio) ** 2
        joint = replace(joint, armature=tuple(armature))
        bodies[one.freedom.body - 1] = replace(bodies[one.freedom.body - 1], joint=joint)
    return replace(system, bodies=tuple(bodies), rotors=())
