"""What the names of definitions mean, for those who read them in the generated code."""

from kanegen.model.coordinates import QuaternionRotation
from kanegen.model.system import System

LEGEND = (
    ("theta_K_i, s_K_i", "coordinates of body K, thetadot and sdot their rates; S, C sine and cosine"),
    ("o_K", "from O_K to the point of K that serves as its origin"),
    ("d_K, u_K_i", "from the origin of J to that of K and the directions of the translations, in J"),
    ("omega, alpha, a", "angular velocity, and the accelerations of body and origin where {ydot} = 0"),
    ("v, w, ww, W", "sliding velocity, 2 omega, products omega_i omega_j, [alpha~] + [omega~][omega~]"),
    (
        "h, I; mc, hc, Ic",
        "first moment and inertia about the origin; those of a composite body, with its mass",
    ),
    ("F, M, c", "force and moment about the origin; the point through which a force acts"),
    ("B, Z; Q", "moment about O_J by angular velocity and axes of angles, in J; shares of other forces"),
    ("E, Kh", "basis vectors of the frame at home, where long columns of [A] stay; of K, seen from there"),
    ("K, Kaj, Kaju, Kcj", "in body K; in the frame below its angle j, above it; below its constant turn j"),
    ("Kj, Ksn", "in the lower body of K; of its translation at place n of {x}"),
    ("SI, SH, SM, pF, pN", "articulated body: force and moment by acceleration; what bodies need"),
    ("D, g, e, n, L, b", "pivots, gains and solutions of an elimination; factors of [A]"),
    ("T, q", "torques and accelerations on the way to {ydot}"),
    (
        "r, dy; yy, dd, ll, dm",
        "of a refinement: accelerations, correction; squares, a length, what is allowed",
    ),
    ("vo, vr, vv, hv", "velocity of the origin, that past the origin of J; vo squared, h x vo"),
    ("KE, P, L; mass, c_0", "kinetic energy; momentum, linear and angular; mass and mass centre of all"),
    ("NX, NY, NZ; pO", "inertial basis vectors seen from K; O_K from the inertial origin"),
    ("p_name", "a run-time parameter"),
)
"""Names and meanings; x, y, z are components."""

SPINS = (
    ("omegahat_K_i", "speeds of body K: components in K of its angular velocity on the lower body"),
    ("R_K; RC_K", "after 1, 2, 3 turns the rotation by the angles; the same with the constant turns"),
    ("Ka, Kau, Kt, Ktu", "in the frame below all angles, above them; the same with the constant turns"),
)
"""Names that are new where such speeds are."""


QUATERNIONS = (
    (
        "epsilon_K_i",
        "quaternion that turns body K in its joint frame, of any length; epsilondot its rates",
    ),
    ("eh_K, es_K, ee_K", "2 over its squared length, by its products with the scalar, of the vector"),
)
"""Names that are new where quaternions are."""


FORCES = (
    ("fe_K_i; te", "effort of force elements on freedom i of body K; with {tau}, by place in {y}"),
    ("kw, kwd, kq, kl", "of a spring: the way between its ends, its rate, squared length and length"),
    (
        "kr, ku, kd, kv, kf, kF",
        "of a spring: what its force is made of; kx its stretch, ks its force outward",
    ),
    ("knav, kna, knbv, knb", "the two ends of spring n on the way inward, and how they move"),
    ("FP_P_i, MP_P_i; pl, pi", "loads on point P; by elements and by the caller, on the way to their body"),
)
"""Names that are new where force elements or loads on points are."""


def legend(system: System) -> tuple[tuple[str, str], ...]:
    """Names in the code for `system`, and meanings."""
    quaternions = (
        QUATERNIONS
        if any(isinstance(body.joint.rotation, QuaternionRotation) for body in system.bodies)
        else ()
    )
    spins = () if system.speeds_are_rates else SPINS
    is_acted_on = system.force_elements or any(point.loads for _, point in system.points)
    return (*quaternions, *spins, *LEGEND, *(FORCES if is_acted_on else ()))
