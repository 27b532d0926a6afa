"""Closed forms are equal to the equations of textbooks, and as short.

The expected expressions are typed from the usual derivations (Lagrange's equations, Euler's equations); none
of them comes from kanegen.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
import sympy
from sympy import Expr, Matrix, cos, sin

from kanegen import Parameter, System
from kanegen.errors import OptionError
from kanegen.model.coordinates import FREEDOMS
from kanegen.reference import equations as reference
from kanegen.symbolic import derive
from kanegen.symbolic.closed.form import ClosedForm
from kanegen.symbolic.symbols import coordinate, real, speed, torque
from tests.support.cases import slow_except
from tests.support.systems import flags, random_system

NOTHING = np.zeros((3, 3))


def parameters(names: str) -> tuple[Parameter, ...]:
    return tuple(Parameter(name, 1.0 + i / 8) for i, name in enumerate(names.split()))


def names(text: str) -> tuple[Expr, ...]:
    return tuple(real(name) for name in text.split())


def free(bodies: int, *pairs: tuple[int, str]) -> Any:
    found = np.zeros((bodies, 6), bool)
    for body, name in pairs:
        found[body - 1, FREEDOMS.index(name)] = True
    return found


def operations(entries: Iterable[Expr]) -> int:
    return sum(int(entry.count_ops()) for entry in entries)


def check(form: ClosedForm, A: Any, f: Any, shortness: tuple[int, int]) -> None:
    """Require a form equal to the textbook's, with at most `shortness` operations in [A] and {f}."""
    assert sympy.simplify(form.A - Matrix(A)) == sympy.zeros(*form.A.shape)
    assert sympy.simplify(form.f - Matrix(f)) == sympy.zeros(*form.f.shape)
    assert form.A == form.A.T
    assert operations(form.A) <= shortness[0], form.A
    assert operations(form.f) <= shortness[1], form.f


def test_double_pendulum() -> None:
    m1, m2, l1, l2, g = parameters("m1 m2 l1 l2 g")
    system = System.from_arrays(
        connection=(0, 1),
        mass=[m1, m2],
        inertia=[NOTHING, NOTHING],
        mass_center=[[l1, 0, 0], [l2, 0, 0]],
        joint_position=[[0, 0, 0], [l1, 0, 0]],
        free=free(2, (1, "theta3"), (2, "theta3")),
        gravity=(g, 0, 0),  # axis 1 points down
    )
    M1, M2, L1, L2, G = names("m1 m2 l1 l2 g")
    q1, q2 = coordinate(1, 2), coordinate(2, 2)
    u1, u2 = speed(1, 2), speed(2, 2)
    coupling = M2 * L2**2 + M2 * L1 * L2 * cos(q2)
    A = [
        [(M1 + M2) * L1**2 + M2 * L2**2 + 2 * M2 * L1 * L2 * cos(q2), coupling],
        [coupling, M2 * L2**2],
    ]
    f = [
        M2 * L1 * L2 * (2 * u1 * u2 + u2**2) * sin(q2)
        - (M1 + M2) * G * L1 * sin(q1)
        - M2 * G * L2 * sin(q1 + q2),
        -M2 * L1 * L2 * u1**2 * sin(q2) - M2 * G * L2 * sin(q1 + q2),
    ]
    form = derive(system).closed_form()
    check(form, A, f, shortness=(26, 34))
    assert form.A[0, 0] == L1**2 * (M1 + M2) + 2 * L1 * L2 * M2 * cos(q2) + L2**2 * M2


def test_spherical_pendulum() -> None:
    m, length, g = parameters("m l g")
    system = System.from_arrays(
        connection=(0,),
        mass=[m],
        inertia=[NOTHING],
        mass_center=[[0, 0, length]],
        joint_position=[[0, 0, 0]],
        free=free(1, (1, "theta1"), (1, "theta2")),
        gravity=(0, 0, g),  # axis 3 points down
    )
    M, L, G = names("m l g")
    q1, q2 = coordinate(1, 0), coordinate(1, 1)
    u1, u2 = speed(1, 0), speed(1, 1)
    A = [[M * L**2 * cos(q2) ** 2, 0], [0, M * L**2]]
    f = [
        2 * M * L**2 * u1 * u2 * sin(q2) * cos(q2) - M * G * L * sin(q1) * cos(q2),
        -M * L**2 * u1**2 * sin(q2) * cos(q2) - M * G * L * cos(q1) * sin(q2),
    ]
    check(derive(system).closed_form(), A, f, shortness=(8, 26))


def test_cart_pole() -> None:
    cart, m, length, g = parameters("cart m l g")
    system = System.from_arrays(
        connection=(0, 1),
        mass=[cart, m],
        inertia=[NOTHING, NOTHING],
        mass_center=[[0, 0, 0], [0, 0, length]],
        joint_position=[[0, 0, 0], [0, 0, 0]],
        free=free(2, (1, "s1"), (2, "theta2")),
        gravity=(0, 0, g),
        loads=[True, False],
    )
    M, m_, L, G = names("cart m l g")
    q, u, push = coordinate(2, 1), speed(2, 1), real("F_1_1")
    A = [[m_ * L**2, m_ * L * cos(q)], [m_ * L * cos(q), M + m_]]
    f = [-m_ * G * L * sin(q), push + m_ * L * u**2 * sin(q)]
    check(derive(system).closed_form(), A, f, shortness=(12, 12))


@pytest.mark.slow
def test_free_rigid_body_obeys_eulers_equations() -> None:
    a, b, c, m = parameters("a b c m")
    system = System.from_arrays(
        connection=(0,),
        mass=[m],
        inertia=[[[a, 0, 0], [0, b, 0], [0, 0, c]]],
        mass_center=[[0, 0, 0]],
        joint_position=[[0, 0, 0]],
        gravity=(0, 0, 0),
        loads=True,
    )
    equations = derive(system)
    form, body = equations.closed_form(), equations.bodies[0]
    A, B, C, mass = names("a b c m")
    q1, q2, q3 = (coordinate(1, i) for i in range(3))
    rates = Matrix([speed(1, i) for i in range(3)])
    # Body-fixed rates of the 1-2-3 angles, typed from the definition of the angles.
    P = Matrix([[cos(q2) * cos(q3), sin(q3), 0], [-cos(q2) * sin(q3), cos(q3), 0], [sin(q2), 0, 1]])
    w1, w2, w3 = P * rates
    accelerations = equations.ydot[:3, 0]
    Pdot = sum((P.diff(q) * u for q, u in zip((q1, q2, q3), rates, strict=True)), sympy.zeros(3, 3))
    d1, d2, d3 = P * accelerations + Pdot * rates
    M = [torque(1, axis) for axis in range(3)]
    euler = Matrix(
        [
            A * d1 - (B - C) * w2 * w3 - M[0],
            B * d2 - (C - A) * w3 * w1 - M[1],
            C * d3 - (A - B) * w1 * w2 - M[2],
        ]
    )
    residual = (form.A * equations.ydot - form.f)[:3, 0]
    assert sympy.simplify(residual - P.T * euler) == sympy.zeros(3, 1)
    assert form.A[3:, 3:] == mass * sympy.eye(3)
    assert form.A[:3, 3:] == sympy.zeros(3, 3)
    F = Matrix([real(f"F_1_{i}") for i in (1, 2, 3)])
    assert sympy.simplify(form.f[3:, 0] - body.rotation.T * F) == sympy.zeros(3, 1)
    assert operations(form.A) <= 45
    assert operations(form.f) <= 200


def test_spinning_top() -> None:
    """A symmetric top on its tip: angle 1 turns about the vertical, angle 3 about the axis of symmetry."""
    m, h, I1, I3, g = parameters("m h I1 I3 g")
    system = System.from_arrays(
        connection=(0,),
        mass=[m],
        inertia=[[[I1, 0, 0], [0, I1, 0], [0, 0, I3]]],
        mass_center=[[0, 0, h]],
        joint_position=[[0, 0, 0]],
        free=free(1, *((1, name) for name in FREEDOMS[:3])),
        gravity=(g, 0, 0),
    )
    M, H, J, K, G = names("m h I1 I3 g")
    q2 = coordinate(1, 1)
    u1, u2, u3 = (speed(1, i) for i in range(3))
    tip = J + M * H**2  # about the tip
    spin = K * (u3 + u1 * sin(q2))  # angular momentum about the axis of symmetry
    A = [
        [tip * cos(q2) ** 2 + K * sin(q2) ** 2, 0, K * sin(q2)],
        [0, tip, 0],
        [K * sin(q2), 0, K],
    ]
    f = [
        2 * (tip - K) * u1 * u2 * sin(q2) * cos(q2) - K * u2 * u3 * cos(q2),
        -tip * u1**2 * sin(q2) * cos(q2) + spin * u1 * cos(q2) + M * G * H * cos(q2),
        -K * u1 * u2 * cos(q2),
    ]
    check(derive(system).closed_form(), A, f, shortness=(18, 40))


def test_planar_chain_has_sums_of_angles() -> None:
    system = System.from_arrays(
        connection=(0, 1, 2, 3),
        mass=[1, 1, 1, 1],
        inertia=[NOTHING] * 4,
        mass_center=[[0.5, 0, 0]] * 4,
        joint_position=[[0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0]],
        free=flags(4, ["theta3"]),
        gravity=(10, 0, 0),
    )
    form = derive(system).closed_form()
    q1, q2, q3, q4 = (coordinate(k, 2) for k in (1, 2, 3, 4))
    links = [7 * sin(q1), 5 * sin(q1 + q2), 3 * sin(q1 + q2 + q3), sin(q1 + q2 + q3 + q4)]
    weight = form.f.xreplace({speed(k, 2): 0 for k in (1, 2, 3, 4)})
    assert weight == Matrix([sympy.expand(-5 * sum(links[k:])) for k in range(4)])


@pytest.mark.parametrize("seed", slow_except(range(5), 3))
def test_closed_forms_of_random_systems_equal_the_reference(seed: int) -> None:
    """Simplification keeps the values of systems with numbers of 17 digits and turned joint frames."""
    rng = np.random.default_rng(seed)
    mask = np.zeros((3, 6), bool)
    mask[np.unravel_index(rng.choice(18, 4, replace=False), (3, 6))] = True
    system = random_system(rng, 3, connection=(0, 1, 1), free=mask, loads=False)
    equations = derive(system)
    form = equations.closed_form()
    assert (form.A.free_symbols | form.f.free_symbols) <= {*equations.x, *equations.y}
    x, y = rng.uniform(-1, 1, (2, 4))
    state = dict(zip((*equations.x, *equations.y), (*x, *y), strict=True))
    for found, expected in (
        (form.A, reference.mass_matrix(system, x)),
        (form.f, reference.forcing(system, x, y)[:, None]),
    ):
        actual = np.array(found.xreplace(state).evalf(20), dtype=float)
        assert np.abs(actual - expected).max() <= 1e-12 * np.abs(expected).max()


def test_a_form_that_is_too_long_is_refused() -> None:
    arm = random_system(
        np.random.default_rng(0), 6, connection=range(6), free=flags(6, ["theta1"]), orientations=True
    )
    with pytest.raises(OptionError, match="more than 500 terms"):
        derive(arm).closed_form()
