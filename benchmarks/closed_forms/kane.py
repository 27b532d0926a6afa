"""The systems of `cases` by SymPy's KanesMethod, as its users write them; kanegen has no part in it.

Parameters and loads are symbols with the names that kanegen gives them. Decimal numbers are exact, because
`simplify` finds no common factors among floats.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from sympy import Expr, Matrix, Rational, Symbol, pi
from sympy.physics.mechanics import (
    KanesMethod,
    Particle,
    Point,
    ReferenceFrame,
    RigidBody,
    Vector,
    dynamicsymbols,
    inertia,
)

NINE_EIGHT_ONE = Rational("9.81")
"""Gravitational acceleration of models that have it as a number (m/s^2)."""


def reals(names: str) -> list[Symbol]:
    """Return real symbols by their names, separated by spaces."""
    return [Symbol(name, real=True) for name in names.split()]


@dataclass
class Scene:
    """What the equations of one system are made of.

    Attributes:
        names: Names of the coordinates.
        speeds: Names of the speeds; by default those of the rates of the coordinates.
        given: Names of coordinates whose motion is prescribed.
    """

    names: Sequence[str]
    speeds: Sequence[str] = ()
    given: Sequence[str] = ()
    N: ReferenceFrame = field(default_factory=lambda: ReferenceFrame("N"))
    O: Point = field(default_factory=lambda: Point("O"))  # noqa: E741
    bodies: list[Any] = field(default_factory=list)
    loads: list[tuple[Any, Vector]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.speeds = self.speeds or [f"{name}_dot" for name in self.names]
        self.O.set_vel(self.N, 0)
        self.q = [dynamicsymbols(name) for name in self.names]
        self.u = [dynamicsymbols(name) for name in self.speeds]

    def turned(self, parent: ReferenceFrame, angle: Expr, rate: Expr, axis: Vector) -> ReferenceFrame:
        """Return a frame that turns in `parent` about one of its axes."""
        frame = parent.orientnew(f"F{len(self.bodies)}_{angle}", "Axis", [angle, axis])
        frame.set_ang_vel(parent, rate * axis)
        return frame

    def point(self, origin: Point, offset: Vector, frame: ReferenceFrame) -> Point:
        """Return a point fixed in `frame`, in which `origin` is fixed as well."""
        point = origin.locatenew(f"P{len(self.bodies)}_{len(self.loads)}", offset)
        point.v2pt_theory(origin, self.N, frame)
        return point

    def mass(self, point: Point, mass: Expr, weight: Vector | None = None) -> None:
        """Add a point mass and its weight (N)."""
        self.bodies.append(Particle(f"particle{len(self.bodies)}", point, mass))
        self._weigh(point, weight)

    def body(
        self,
        center: Point,
        frame: ReferenceFrame,
        mass: Expr,
        moments: tuple[Any, Any, Any],
        weight: Vector | None = None,
    ) -> None:
        """Add a rigid body with principal moments of inertia in its frame, and its weight (N)."""
        about_center = (inertia(frame, *moments), center)
        self.bodies.append(RigidBody(f"body{len(self.bodies)}", center, frame, mass, about_center))
        self._weigh(center, weight)

    def _weigh(self, point: Point, weight: Vector | None) -> None:
        if weight is not None:
            self.loads.append((point, weight))

    def derived(self, kinematics: list[Expr] | None = None) -> tuple[Matrix, Matrix]:
        """Return mass matrix and forcing of KanesMethod, in functions of time."""
        kinematics = kinematics or [q.diff() - u for q, u in zip(self.q, self.u, strict=True)]
        method = KanesMethod(self.N, self.q, self.u, kinematics)
        method.kanes_equations(self.bodies, self.loads)
        return method.mass_matrix, method.forcing

    def symbols(self) -> dict[Expr, Symbol]:
        """Return the symbols of kanegen by functions of time and their derivatives, second ones first."""
        found: dict[Expr, Symbol] = {}
        for name in self.given:
            f = dynamicsymbols(name)
            found |= {f.diff().diff(): _real(f"{name}_ddot"), f.diff(): _real(f"{name}_dot"), f: _real(name)}
        for name, f in zip((*self.names, *self.speeds), (*self.q, *self.u), strict=True):
            found[f] = _real(name)
        return found


def _real(name: str) -> Symbol:
    """Return the real symbol of that name."""
    return Symbol(name, real=True)


def babyboot() -> tuple[Scene, Matrix, Matrix]:
    """A rod on a horizontal hinge with a plate that turns about it."""
    g, mA, mB, LA, LB, IAx, IBx, IBy, IBz = reals("g mA mB LA LB IAx IBx IBy IBz")
    s = Scene(["qA", "qB"])
    (qA, qB), (uA, uB) = s.q, s.u
    A = s.turned(s.N, qA, uA, s.N.x)
    B = s.turned(A, qB, uB, A.z)
    s.body(s.point(s.O, LA * A.z, A), A, mA, (IAx, IAx, 0), mA * g * s.N.z)
    s.body(s.point(s.O, LB * A.z, A), B, mB, (IBx, IBy, IBz), mB * g * s.N.z)
    return s, *s.derived()


def spherical_pendulum() -> tuple[Scene, Matrix, Matrix]:
    """A point mass on a rod in spherical coordinates."""
    g, m, length = reals("g m l")
    s = Scene(["phi", "theta"])
    A = s.turned(s.N, s.q[0], s.u[0], s.N.z)
    B = s.turned(A, s.q[1], s.u[1], A.x)
    s.mass(s.point(s.O, length * B.z, B), m, m * g * s.N.z)
    return s, *s.derived()


def furuta_pendulum() -> tuple[Scene, Matrix, Matrix]:
    """An arm about the vertical with a pendulum about it."""
    arm_inertia, arm_length, mass, length, J = reals("arm_inertia arm_length mass length inertia")
    s = Scene(["arm_angle", "pendulum"])
    A = s.turned(s.N, s.q[0], s.u[0], s.N.z)
    B = s.turned(A, s.q[1], s.u[1], A.x)
    s.body(s.O, A, 0, (0, arm_inertia, arm_inertia))
    hinge = s.point(s.O, arm_length * A.x, A)
    s.body(s.point(hinge, length * B.z, B), B, mass, (J, J, 0), -mass * NINE_EIGHT_ONE * s.N.z)
    return s, *s.derived()


def double_pendulum() -> tuple[Scene, Matrix, Matrix]:
    """Two point masses on rods in a plane."""
    return _pendulum(2)


def triple_pendulum() -> tuple[Scene, Matrix, Matrix]:
    """Three point masses on rods in a plane."""
    return _pendulum(3)


def _pendulum(links: int) -> tuple[Scene, Matrix, Matrix]:
    """A chain of point masses on rods in a plane, with relative angles."""
    (g,) = reals("g")
    s = Scene([f"q{i}" for i in range(1, links + 1)])
    frame, point = s.N, s.O
    for i, (q, u) in enumerate(zip(s.q, s.u, strict=True), start=1):
        m, length = reals(f"m{i} l{i}")
        frame = s.turned(frame, q, u, frame.z)
        point = s.point(point, length * frame.x, frame)
        s.mass(point, m, m * g * s.N.x)
    return s, *s.derived()


def euler_top() -> tuple[Scene, Matrix, Matrix]:
    """A symmetrical top on a fixed point in the angles of Euler."""
    g, m, length, I1, I3 = reals("g m l I1 I3")
    s = Scene(["psi", "theta", "phi"])
    A = s.turned(s.N, s.q[0], s.u[0], s.N.z)
    B = s.turned(A, s.q[1], s.u[1], A.x)
    C = s.turned(B, s.q[2], s.u[2], B.z)
    s.body(s.point(s.O, length * C.z, C), C, m, (I1, I1, I3), m * g * s.N.z)
    return s, *s.derived()


def gyrostat() -> tuple[Scene, Matrix, Matrix]:
    """A body about its mass centre with a rotor, in components of the angular velocity."""
    I1, I2, I3, J, K, M1, M2, M3 = reals("I1 I2 I3 J K M_1_1 M_1_2 M_1_3")
    omega = [f"omegahat_1_{i}" for i in (1, 2, 3)]
    s = Scene([*(f"theta_1_{i}" for i in (1, 2, 3)), "spin"], [*omega, "spin_dot"])
    B = s.N.orientnew("B", "Body", s.q[:3], "XYZ")
    kinematics = [B.ang_vel_in(s.N).dot(axis) - u for axis, u in zip((B.x, B.y, B.z), s.u[:3], strict=True)]
    B.set_ang_vel(s.N, s.u[0] * B.x + s.u[1] * B.y + s.u[2] * B.z)
    C = s.turned(B, s.q[3], s.u[3], B.z)
    s.body(s.O, B, 0, (I1, I2, I3))
    s.body(s.O, C, 0, (K, K, J))
    s.loads.append((B, M1 * B.x + M2 * B.y + M3 * B.z))
    return s, *s.derived([*kinematics, s.q[3].diff() - s.u[3]])


def bead_on_hoop() -> tuple[Scene, Matrix, Matrix]:
    """A bead on a hoop whose rotation about the vertical is prescribed."""
    g, m, R = reals("g m R")
    s = Scene(["theta"], given=["phi"])
    phi = dynamicsymbols("phi")
    A = s.turned(s.N, phi, phi.diff(), s.N.z)
    B = s.turned(A, s.q[0], s.u[0], A.y)
    s.mass(s.point(s.O, R * B.z, B), m, m * g * s.N.z)
    return s, *s.derived()


def cart_two_poles() -> tuple[Scene, Matrix, Matrix]:
    """A cart on a rail with two poles."""
    (M,) = reals("M")
    s = Scene(["q1", "q2", "position"])
    cart = s.O.locatenew("cart", s.q[2] * s.N.x)
    cart.set_vel(s.N, s.u[2] * s.N.x)
    s.mass(cart, M)
    for i in (1, 2):
        m, length, J = reals(f"m{i} l{i} I{i}")
        A = s.turned(s.N, s.q[i - 1], s.u[i - 1], s.N.y)
        s.body(s.point(cart, length * A.z, A), A, m, (J, J, 0), -m * NINE_EIGHT_ONE * s.N.z)
    return s, *s.derived()


def quarter_car() -> tuple[Scene, Matrix, Matrix]:
    """Wheel and chassis above a road, with linear springs and a skyhook."""
    stiffness, damping, gain = reals("stiffness damping gain")
    s = Scene(["hub", "ride"], given=["height"])
    (hub, ride), (hub_rate, ride_rate), road = s.q, s.u, dynamicsymbols("height")
    tyre = 160000 * (hub - road) + 50 * (hub_rate - road.diff())
    suspension = stiffness * (ride - hub) + damping * (ride_rate - hub_rate)
    g = NINE_EIGHT_ONE
    efforts = (-40 * g - tyre + suspension + gain * ride_rate, -300 * g - suspension - gain * ride_rate)
    for mass, q, u, effort in zip((40, 300), s.q, s.u, efforts, strict=True):
        point = s.O.locatenew(f"P{mass}", q * s.N.z)
        point.set_vel(s.N, u * s.N.z)
        s.mass(point, mass, effort * s.N.z)
    return s, *s.derived()


def gantry_crane() -> tuple[Scene, Matrix, Matrix]:
    """Bridge, trolley and a load on a rope of variable length, with forces on each."""
    bridge_mass, trolley_mass, load_mass = reals("bridge_mass trolley_mass load_mass")
    s = Scene(
        ["theta_3_1", "theta_3_2", "bridge_travel", "trolley_travel", "rope_length"],
        ["thetadot_3_1", "thetadot_3_2", "bridge_travel_dot", "trolley_travel_dot", "rope_length_dot"],
    )
    (a, b, x, y, rope), (ua, ub, ux, uy, urope) = s.q, s.u
    bridge = s.O.locatenew("bridge", x * s.N.x)
    bridge.set_vel(s.N, ux * s.N.x)
    trolley = bridge.locatenew("trolley", y * s.N.y)
    trolley.set_vel(s.N, ux * s.N.x + uy * s.N.y)
    down = s.turned(s.N, pi, 0, s.N.x)
    swung = s.turned(down, a, ua, down.x)
    frame = s.turned(swung, b, ub, swung.y)
    load = trolley.locatenew("load", (rope + Rational("1.6")) * frame.z)
    trolley.set_vel(frame, 0)
    load.set_vel(frame, urope * frame.z)
    load.v1pt_theory(trolley, s.N, frame)
    F11, F21, F22, F41, F42, F43, M41, M42, M43 = reals(
        "F_1_1 F_2_1 F_2_2 F_4_1 F_4_2 F_4_3 M_4_1 M_4_2 M_4_3"
    )
    s.mass(bridge, bridge_mass, F11 * s.N.x)
    s.mass(trolley, trolley_mass, F21 * s.N.x + F22 * s.N.y)
    force = F41 * frame.x + F42 * frame.y + F43 * frame.z - load_mass * NINE_EIGHT_ONE * s.N.z
    s.body(load, frame, load_mass, (43000, 12500, 42000), force)
    s.loads.append((frame, M41 * frame.x + M42 * frame.y + M43 * frame.z))
    return s, *s.derived()
