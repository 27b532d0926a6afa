"""Equations of motion as books and papers print them, typed from there, in kanegen's symbols.

Every function returns the entries of [A] and of {f}. Where a source has other coordinates or signs, its
docstring says what was changed.
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy import Expr, Rational, cos, sin

from benchmarks.closed_forms.kane import NINE_EIGHT_ONE, reals

Form = tuple[Sequence[Sequence[Expr | int]], Sequence[Expr | int]]
"""Rows of [A], and {f}."""


def babyboot() -> Form:
    """Mitiguy, Advanced Dynamics and Motion Simulation, after Kane: the babyboot.

    The source divides each equation by its inertia.
    """
    g, mA, mB, LA, LB, IAx, IBx, IBy, IBz = reals("g mA mB LA LB IAx IBx IBy IBz")
    qA, qB, uA, uB = reals("qA qB qA_dot qB_dot")
    A = IAx + mA * LA**2 + mB * LB**2 + IBx * cos(qB) ** 2 + IBy * sin(qB) ** 2
    f = 2 * uA * uB * sin(qB) * cos(qB) * (IBx - IBy) - (mA * LA + mB * LB) * g * sin(qA)
    return [[A, 0], [0, IBz]], [f, -(uA**2) * sin(qB) * cos(qB) * (IBx - IBy)]


def spherical_pendulum() -> Form:
    """Landau and Lifshitz, Mechanics (1976), section 14, problem 1, by Lagrange's equations."""
    g, m, length = reals("g m l")
    theta, v, w = reals("theta theta_dot phi_dot")
    moment = m * length**2
    f = [
        -2 * moment * v * w * sin(theta) * cos(theta),
        moment * w**2 * sin(theta) * cos(theta) - m * g * length * sin(theta),
    ]
    return [[moment * sin(theta) ** 2, 0], [0, moment]], f


def furuta_pendulum() -> Form:
    """Cazzolato and Prime, On the dynamics of the Furuta pendulum (2011), the form for slender bodies.

    The pendulum turns about the axis of the arm the other way round, which changes the sign of the coupling,
    and stands upright where its angle is zero.
    """
    arm_inertia, R, m, length, J = reals("arm_inertia arm_length mass length inertia")
    q, u, v = reals("pendulum arm_angle_dot pendulum_dot")
    arm, pendulum = arm_inertia + m * R**2, J + m * length**2
    coupling = -m * R * length * cos(q)
    return [[arm + pendulum * sin(q) ** 2, coupling], [coupling, pendulum]], [
        -m * R * length * sin(q) * v**2 - 2 * u * v * pendulum * sin(q) * cos(q),
        u**2 * pendulum * sin(q) * cos(q) + NINE_EIGHT_ONE * m * length * sin(q),
    ]


def double_pendulum() -> Form:
    """Craig, Introduction to Robotics (2005), section 6.7, the planar arm, with q1 from the vertical."""
    g, m1, m2, l1, l2 = reals("g m1 m2 l1 l2")
    q1, q2, u1, u2 = reals("q1 q2 q1_dot q2_dot")
    coupling = l2**2 * m2 + l1 * l2 * m2 * cos(q2)
    A = l2**2 * m2 + 2 * l1 * l2 * m2 * cos(q2) + l1**2 * (m1 + m2)
    return [[A, coupling], [coupling, l2**2 * m2]], [
        m2 * l1 * l2 * sin(q2) * u2**2
        + 2 * m2 * l1 * l2 * sin(q2) * u1 * u2
        - m2 * l2 * g * sin(q1 + q2)
        - (m1 + m2) * l1 * g * sin(q1),
        -m2 * l1 * l2 * sin(q2) * u1**2 - m2 * l2 * g * sin(q1 + q2),
    ]


def triple_pendulum() -> Form:
    """The form of Craig, section 6.7, for three links, by Lagrange's equations."""
    g, m1, m2, m3, l1, l2, l3 = reals("g m1 m2 m3 l1 l2 l3")
    q1, q2, q3, u1, u2, u3 = reals("q1 q2 q3 q1_dot q2_dot q3_dot")
    a, b, c = m3 * l1 * l3, m3 * l2 * l3, (m2 + m3) * l1 * l2
    third, second = m3 * l3**2, (m2 + m3) * l2**2
    A12 = second + third + c * cos(q2) + a * cos(q2 + q3) + 2 * b * cos(q3)
    A13 = third + a * cos(q2 + q3) + b * cos(q3)
    A23 = third + b * cos(q3)
    A11 = (m1 + m2 + m3) * l1**2 + second + third + 2 * c * cos(q2) + 2 * a * cos(q2 + q3) + 2 * b * cos(q3)
    bend = b * sin(q3) * u3 * (2 * u1 + 2 * u2 + u3)
    weight = [
        -(m1 + m2 + m3) * g * l1 * sin(q1),
        -(m2 + m3) * g * l2 * sin(q1 + q2),
        -m3 * g * l3 * sin(q1 + q2 + q3),
    ]
    return [[A11, A12, A13], [A12, second + third + 2 * b * cos(q3), A23], [A13, A23, third]], [
        c * sin(q2) * u2 * (2 * u1 + u2)
        + a * sin(q2 + q3) * (u2 + u3) * (2 * u1 + u2 + u3)
        + bend
        + sum(weight),
        -c * sin(q2) * u1**2 - a * sin(q2 + q3) * u1**2 + bend + weight[1] + weight[2],
        -a * sin(q2 + q3) * u1**2 - b * sin(q3) * (u1 + u2) ** 2 + weight[2],
    ]


def euler_top() -> Form:
    """Goldstein, Classical Mechanics (2002), section 5.7, by Lagrange's equations from the energies there.

    The axis of the top points along gravity where theta is zero, which changes the sign of the weight.
    """
    g, m, length, I1, I3 = reals("g m l I1 I3")
    theta, p, n, s = reals("theta psi_dot theta_dot phi_dot")
    tip = I1 + m * length**2
    axial = I3 * cos(theta)
    return [[tip * sin(theta) ** 2 + I3 * cos(theta) ** 2, 0, axial], [0, tip, 0], [axial, 0, I3]], [
        I3 * n * s * sin(theta) - 2 * (tip - I3) * p * n * sin(theta) * cos(theta),
        (tip - I3) * p**2 * sin(theta) * cos(theta) - I3 * p * s * sin(theta) - m * g * length * sin(theta),
        I3 * p * n * sin(theta),
    ]


def gyrostat() -> Form:
    """Hughes, Spacecraft Attitude Dynamics (1986): Euler's equations with the momentum of a wheel."""
    I1, I2, I3, J, K, M1, M2, M3 = reals("I1 I2 I3 J K M_1_1 M_1_2 M_1_3")
    w1, w2, w3, spin = reals("omegahat_1_1 omegahat_1_2 omegahat_1_3 spin_dot")
    axial = I3 + J
    h = J * spin
    return [[I1 + K, 0, 0, 0], [0, I2 + K, 0, 0], [0, 0, axial, J], [0, 0, J, J]], [
        M1 + (I2 + K - axial) * w2 * w3 - h * w2,
        M2 + (axial - I1 - K) * w1 * w3 + h * w1,
        M3 + (I1 - I2) * w1 * w2,
        0,
    ]


def bead_on_hoop() -> Form:
    """Strogatz, Nonlinear Dynamics and Chaos (1994), section 3.5, without friction."""
    g, m, R, theta, spin = reals("g m R theta phi_dot")
    return [[m * R**2]], [m * R**2 * spin**2 * sin(theta) * cos(theta) - m * g * R * sin(theta)]


def cart_two_poles() -> Form:
    """Wieland, Evolving neural network controllers for unstable systems (1991), without friction."""
    M, m1, m2, l1, l2, I1, I2 = reals("M m1 m2 l1 l2 I1 I2")
    q1, q2, u1, u2 = reals("q1 q2 q1_dot q2_dot")
    a, b, g = m1 * l1, m2 * l2, NINE_EIGHT_ONE
    A = [
        [I1 + m1 * l1**2, 0, a * cos(q1)],
        [0, I2 + m2 * l2**2, b * cos(q2)],
        [a * cos(q1), b * cos(q2), M + m1 + m2],
    ]
    return A, [a * g * sin(q1), b * g * sin(q2), a * u1**2 * sin(q1) + b * u2**2 * sin(q2)]


def quarter_car() -> Form:
    """Rajamani, Vehicle Dynamics and Control (2012), chapter 11, with weight, a damped tyre and a skyhook."""
    k, c, gain, z = reals("stiffness damping gain height")
    h, r, dh, dr, dz = reals("hub ride hub_dot ride_dot height_dot")
    g = NINE_EIGHT_ONE
    suspension = k * (r - h) + c * (dr - dh)
    tyre = 160000 * (h - z) + 50 * (dh - dz)
    return [[40, 0], [0, 300]], [
        suspension - tyre + gain * dr - 40 * g,
        -suspension - gain * dr - 300 * g,
    ]


def gantry_crane() -> Form:
    """Lee, Modeling and control of a three-dimensional overhead crane (1998), for a rigid body as load.

    Lagrange's equations in the angles of the model, with forces and a torque on the load in its own axes.
    """
    bridge, trolley, m = reals("bridge_mass trolley_mass load_mass")
    a, b, rope, ua, ub, v = reals("theta_3_1 theta_3_2 rope_length thetadot_3_1 thetadot_3_2 rope_length_dot")
    F11, F21, F22, F41, F42, F43 = reals("F_1_1 F_2_1 F_2_2 F_4_1 F_4_2 F_4_3")
    M41, M42, M43 = reals("M_4_1 M_4_2 M_4_3")
    r, g = rope + Rational("1.6"), NINE_EIGHT_ONE
    swing = m * r * cos(a) * cos(b), m * r * cos(b), -m * r * sin(a) * sin(b)
    A = [
        [m * r**2 * cos(b) ** 2 + 43000 * cos(b) ** 2 + 42000 * sin(b) ** 2, 0, 0, swing[0], 0],
        [0, m * r**2 + 12500, swing[1], swing[2], 0],
        [0, swing[1], bridge + trolley + m, 0, m * sin(b)],
        [swing[0], swing[2], 0, trolley + m, m * sin(a) * cos(b)],
        [0, 0, m * sin(b), m * sin(a) * cos(b), m],
    ]
    return A, [
        M41 * cos(b)
        + M43 * sin(b)
        - F42 * r * cos(b)
        - 2 * m * r * v * ua * cos(b) ** 2
        + 2 * (m * r**2 + 1000) * ua * ub * sin(b) * cos(b)
        - m * g * r * sin(a) * cos(b),
        M42
        + F41 * r
        - 2 * m * r * v * ub
        - (m * r**2 + 1000) * ua**2 * sin(b) * cos(b)
        - m * g * r * cos(a) * sin(b),
        F11 + F21 + F41 * cos(b) + F43 * sin(b) - m * (2 * v * ub * cos(b) - r * ub**2 * sin(b)),
        F22
        - F42 * cos(a)
        - F41 * sin(a) * sin(b)
        + F43 * sin(a) * cos(b)
        - 2 * m * v * (ua * cos(a) * cos(b) - ub * sin(a) * sin(b))
        + m * r * (2 * ua * ub * cos(a) * sin(b) + (ua**2 + ub**2) * sin(a) * cos(b)),
        F43 + m * r * (ub**2 + ua**2 * cos(b) ** 2) + m * g * cos(a) * cos(b),
    ]
