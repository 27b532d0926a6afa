"""Expressions of parameters in symbolic equations: fractions stay fractions, sines of known angles exact."""

from __future__ import annotations

import numpy as np
import sympy

import kanegen as kg

m, length, g = (sympy.Symbol(name, real=True) for name in ("m", "l", "g"))
M, L, G = kg.Parameter("m", 2.0), kg.Parameter("l", 0.5), kg.Parameter("g", 9.81)


def hinged_rod(angle: float | kg.Expression = 0.0) -> kg.System:
    """Return a uniform rod that hangs from a hinge about axis 1, whose frame is turned about this axis."""
    hinge = kg.Joint(orientation=(angle, 0, 0), free=(True, False, False, False, False, False))
    inertia = np.diag([M * L**2 / 12, M * L**2 / 12, 0])
    return kg.System("rod", (kg.Body("rod", 0, M, inertia, (0, 0, -L / 2), hinge),), gravity=(0, 0, -G))


def test_a_rod_has_a_third_of_m_l_squared() -> None:
    equations = kg.derive(hinged_rod())
    theta = equations.x[0]
    closed = equations.closed_form()
    assert closed.A[0, 0] == m * length**2 / 3
    assert sympy.simplify(closed.f[0] + m * g * length * sympy.sin(theta) / 2) == 0
    assert not closed.A[0, 0].atoms(sympy.Float)


def test_known_angles_have_exact_sines() -> None:
    tilted = hinged_rod(kg.parse("pi/6"))
    f = kg.derive(tilted).closed_form().f[0]
    theta = kg.derive(tilted).x[0]
    expected = -m * g * length / 2 * sympy.sin(theta + sympy.pi / 6)
    assert not f.atoms(sympy.Float)
    assert sympy.simplify(sympy.expand_trig(f - expected)) == 0
    values = {m: 2.0, length: 0.5, g: 9.81, theta: 0.3}
    reference = float(kg.build(tilted, ("forcing",)).forcing([0.3], [0.0])[0])
    assert np.isclose(float(f.subs(values)), reference, rtol=1e-14)
