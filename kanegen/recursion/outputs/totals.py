"""Outputs that are sums over all bodies: energies, momentum, the common mass centre."""

from __future__ import annotations

from kanegen.model.system import System
from kanegen.program.ir import Array
from kanegen.recursion.outputs.kind import OutputKind


def _kinetic_energy(system: System) -> Array:
    doc = "the sum of m v_G^2 / 2 + {omega}^T [I_G] {omega} / 2, Eqs. (18), (31)"
    return Array("kinetic_energy", (), "J", doc)


def _potential_energy(system: System) -> Array:
    doc = "of gravity, minus the sum of m g . p_G, zero where all mass centres are at the inertial origin"
    return Array("potential_energy", (), "J", doc)


def _momentum(system: System) -> Array:
    doc = (
        "the sum of m {v_G}, then the sum of [I_G] {omega} + ({p_G} - {p_C}) x m {v_G} about the mass centre "
        "C of all bodies, inertial components"
    )
    return Array("momentum", (6,), "kg m/s, kg m^2/s", doc)


def _mass_center(system: System) -> Array:
    doc = "{p_C}, the sum of m {p_G}, Eq. (23), over the sum of m, inertial components"
    return Array("mass_center", (3,), "m", doc)


TOTALS = {
    "kinetic_energy": OutputKind(_kinetic_energy, ("x", "y")),
    "potential_energy": OutputKind(_potential_energy, ("x",)),
    "momentum": OutputKind(_momentum, ("x", "y")),
    "mass_center": OutputKind(_mass_center, ("x",)),
}
