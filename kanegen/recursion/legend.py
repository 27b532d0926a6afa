"""The legend of the names in generated code: patterns of names with their meanings.

A name consists of a quantity and an object, such as `hc_2a3_x`: the first moment `hc` of a composite body,
below the turn by angle 3 of body 2, component x. `NAMES` lists the names that derivations give to their
intermediates, `PLACES` and `FREEDOMS` the values of the placeholders `P` and `L`. Braces enclose
placeholders; a legend shows the pattern without braces.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property

PLACES = (
    ("{K}", "body K, about its origin and in its frame"),
    ("{K}j", "body K, about the origin of its lower body J and in the frame of J"),
    ("{K}o", "body K, about O_K and in its frame"),
    ("{K}a{i}", "below the turn by angle i of body K"),
    ("{K}a{i}u", "above the turn by angle i of body K"),
    ("{K}c{i}", "below constant turn i of the joint of body K"),
    ("{K}c{i}u", "above constant turn i of the joint of body K"),
    ("{K}a", "below the rotation of body K in its joint frame"),
    ("{K}au", "above the rotation of body K in its joint frame"),
    ("{K}t", "below all turns of the joint of body K"),
    ("{K}tu", "above all turns of the joint of body K"),
)
"""Frames and origins, for the placeholder P."""

FREEDOMS = (
    ("{K}a{i}", "angle i of body K"),
    ("{K}s{n}", "the translation of body K at place n of {y}"),
    ("{K}t{i}", "translation i of body K, which is coupled"),
    ("{K}w{i}", "component i of the relative angular velocity of body K"),
    ("{K}y{n}", "all freedoms outward of body K that the entry of {y} at place n moves"),
    ("{K}r{n}", "the spin of rotors in body K that the freedom at place n of {y} drives"),
)
"""Freedoms whose unit acceleration is meant, for the placeholder L."""

NAMES = (
    # Arguments
    ("theta_{K}_{i}", "angle i of body K (rad)"),
    ("thetadot_{K}_{i}", "rate of theta_K_i"),
    ("thetaddot_{K}_{i}", "second derivative of theta_K_i"),
    ("thetaddot_{K}_{i}p", "the part of it that prescribed motion causes"),
    ("s_{K}_{i}", "translation i of body K (m)"),
    ("sdot_{K}_{i}", "rate of s_K_i"),
    ("sddot_{K}_{i}", "second derivative of s_K_i"),
    ("sddot_{K}_{i}p", "the part of it that prescribed motion causes"),
    ("epsilon_{K}_{i}", "element i of the quaternion of body K, of any length"),
    ("omegahat_{K}_{i}", "component i in K of the angular velocity of body K relative to its lower body"),
    ("omegahatdot_{K}_{i}", "derivative of omegahat_K_i"),
    ("tau_{K}_{i}", "generalized force on freedom i of body K"),
    ("F_{K}_{i}", "component i of the force on body K, in K (N)"),
    ("M_{K}_{i}", "component i of the torque on body K, in K (N m)"),
    ("FP_{n}_{i}", "component i of point_force on point n (N)"),
    ("MP_{n}_{i}", "component i of point_moment on the body of point n (N m)"),
    ("t", "time (s)"),
    ("p_{name}", "a run-time parameter"),
    ("c_{n}", "the prepared constant at place n, counted from 1"),
    # Joints
    ("S_{K}_{i}", "sine of theta_K_i"),
    ("C_{K}_{i}", "cosine of theta_K_i"),
    ("S_{K}_c{i}", "sine of orientation angle i of joint K"),
    ("C_{K}_c{i}", "cosine of orientation angle i of joint K"),
    ("C2_{K}_{i}", "twice C_K_i"),
    ("H_{K}_{i}", "sine of half theta_K_i"),
    ("V_{K}_{i}", "1 - C_K_i"),
    ("C2_{K}_c{i}", "twice C_K_ci"),
    ("eq_{K}", "squared length of the quaternion of body K"),
    ("ei_{K}", "1 over eq_K"),
    ("en_{K}", "eq_K ei_K: 1, or NaN where eq_K is infinite"),
    ("eh_{K}", "2 over the squared length of the quaternion of body K"),
    ("eh_{K}_{i}", "eh_K epsilon_K_i"),
    ("es_{K}_{i}", "eh_K_i epsilon_K_0"),
    ("ee_{K}_{ij}", "eh_K_i epsilon_K_j"),
    ("R_{K}_{x}_{y}", "rotation from the joint frame to body K, row by row"),
    ("R_{K}_{i}_{x}_{y}", "rotation by angles 1 to i of body K, row by row"),
    ("RC_{K}_{i}_{x}_{y}", "rotation by the first i turns of the joint of body K, row by row"),
    ("S_{K}_f{i}", "sine of orientation angle i of a frame of body K"),
    ("C_{K}_f{i}", "cosine of orientation angle i of a frame of body K"),
    ("fb_{K}_{i}_{x}", "basis vector i of a frame of body K, in K"),
    ("fo_{K}_{x}", "origin of a frame of body K from O_K, in K (m)"),
    ("fp_{K}_{x}", "a point of body K that is given in a frame, from O_K, in K (m)"),
    ("Fl_{K}_{x}", "force on body K, in K (N)"),
    ("Ml_{K}_{x}", "torque on body K, in K (N m)"),
    ("u_{K}_{i}_{x}", "direction of translation i of body K, in J"),
    ("u_{n}_{P}_{x}", "direction of the translation at place n of {y}, in P"),
    ("u_{n}h_{x}", "direction of the translation at place n of {y}, in the fixed frame"),
    ("q_{K}_{x}", "O_K from O_J, in J (m)"),
    ("o_{K}_{x}", "the point that serves as the origin of body K, from O_K, in K (m)"),
    ("d_{K}_{x}", "origin of body K from the origin of J, in J (m)"),
    ("d_{K}h_{x}", "d_K in the fixed frame"),
    # Inertia
    ("r_{K}_{x}", "mass centre of body K from its origin, in K (m)"),
    ("r_{K}l_{x}", "a loaded point of body K from its origin, in K (m)"),
    ("r_{K}p{n}_{x}", "point n of body K from its origin, in K (m)"),
    ("r_{K}f{n}_{x}", "origin of frame n of body K from the origin of K, in K (m)"),
    ("h_{K}_{x}", "first moment of mass of body K about its origin (kg m)"),
    ("hr_{K}_{x}", "first moment times position of the mass centre of body K (kg m^2)"),
    ("I_{K}_{xx}", "inertia of body K about its origin (kg m^2)"),
    ("Im_{K}_{xx}", "inertia of body K about its origin, less the part that moves as J does (kg m^2)"),
    ("I_{K}_h{x}", "half of a diagonal entry of I_K"),
    ("I_{K}_d{i}", "difference of the diagonal entries of I_K after entry i, from 0"),
    ("m_{K}h", "half the mass of body K (kg)"),
    ("mass", "mass of all bodies (kg)"),
    ("mc_{J}r{K}", "mass of J with what joint K makes move as J does (kg)"),
    ("hc_{J}r{K}_{x}", "first moment of J with what joint K makes move as J does (kg m)"),
    ("Ic_{J}r{K}_{xx}", "inertia of J with what joint K makes move as J does (kg m^2)"),
    ("hc_{K}r{P}_{x}", "first moment, in P, of the part of body K that moves as J does (kg m)"),
    ("Ic_{K}r{P}_{xx}", "inertia, in P, of the part of body K that moves as J does (kg m^2)"),
    ("hc_{K}r_{x}", "first moment, about the origin of J, of the part of body K that moves as J does (kg m)"),
    ("Ic_{K}r_{xx}", "inertia, about the origin of J, of the part of body K that moves as J does (kg m^2)"),
    ("mc_{K}", "mass of body K and all that it carries (kg)"),
    ("hc_{0}g_{x}", "first moment of what does not move (kg m)"),
    ("hc_{P}_{x}", "first moment of body K and all that it carries (kg m)"),
    ("Ic_{P}_{xx}", "inertia of body K and all that it carries (kg m^2)"),
    ("dh_{P}_{x}", "product of offset and first moments, part of the shift of an inertia (kg m^2)"),
    ("dh_{P}s_{x}", "sum of two dh_P (kg m^2)"),
    ("hd_{P}_{x}", "product of first moment and offset (kg m^2)"),
    ("hd_{P}s_{x}", "sum of two hd_P (kg m^2)"),
    (
        "dh_{K}r_{x}",
        "product of offset and first moments in the shift of Ic_KrP (kg m^2)",
    ),
    ("dh_{K}rs_{x}", "sum of two dh_Kr (kg m^2)"),
    # Mass matrix
    ("B_{P}_{x}_{y}", "moment about the origin of J by angular velocity of body K, row by row (kg m^2)"),
    ("Z_{P}_{x}", "axis of the turn above P, in J"),
    ("Z_{K}_{i}_{x}", "basis vector i of K, in J"),
    ("c_{0}_{x}", "mass centre of all bodies (m)"),
    ("c_{0}h_{x}", "mass centre of all bodies from the origin of the first (m)"),
    ("c_{K}_{x}", "mass centre of body K and all that it carries, from the origin of J, in J (m)"),
    ("c_{K}_{P}_{x}", "the same mass centre in P (m)"),
    ("F_{L}_{x}", "force for unit acceleration of L (kg)"),
    ("F_{L}_{P}_{x}", "force for unit acceleration of L, in P (kg, kg m)"),
    ("F_{L}_{K}h_{x}", "force for unit acceleration of L, in the fixed frame"),
    ("F_{L}_{K}q_{x}", "force for unit acceleration of L, combined from those of three translations"),
    ("M_{L}_{P}_{x}", "moment for unit acceleration of L, in P (kg m, kg m^2)"),
    ("M_{L}_{K}h_{x}", "moment for unit acceleration of L about the origin of K, in the fixed frame"),
    ("M_{L}_{n}_{i}", "component i, from 0, of the moment for unit acceleration of L"),
    ("Q_{L}_{x}", "shares of the forces of three translations in the force of L"),
    ("E_{P}_{i}_{x}", "basis vector i of the fixed frame, in P"),
    ("A_{n}_{m}", "entry of [A]"),
    ("Ac_{n}_{m}", "term of entries of [A]: component along freedom m of the force for freedom n"),
    ("A_{n}_{m}_{i}", "entry of [A] after the elimination of the freedom at place i"),
    # Motion and forces
    ("omega_{P}_{x}", "angular velocity (rad/s)"),
    ("alpha_{P}_{x}", "angular acceleration, {ydot} = 0 unless given (rad/s^2)"),
    (
        "a_{P}_{x}",
        "acceleration of the origin less gravity, {ydot} = 0 unless given (m/s^2)",
    ),
    ("w_{K}_{x}", "twice omega_K"),
    ("v_{K}_{x}", "velocity by the translations of joint K, in J (m/s)"),
    ("ww_{K}_{xx}", "products of components of omega_K"),
    ("ww_{K}_d{i}", "difference of two squares in ww_K"),
    ("W_{K}_{x}_{y}", "[alpha~] + [omega~][omega~] of body K, row by row"),
    ("F_{K}own_{x}", "force that body K needs for its own motion, less its loads (N)"),
    ("M_{K}own_{x}", "moment that body K needs for its own motion, less its loads (N m)"),
    ("F_{K}s_{x}", "sum of the forces that bodies K and before need of their lower body (N)"),
    ("M_{K}s_{x}", "sum of the moments that bodies K and before need of their lower body (N m)"),
    ("F_{K}l{i}", "force that joint K carries along its locked translation i (N)"),
    ("M_{P}o_{x}", "moment that joint K carries about O_K, in P (N m)"),
    ("M_{K}f_{x}", "moment that joint K carries about the origin of a frame of body K, in K (N m)"),
    ("F_{P}_{x}", "force that body K and all that it carries need (N)"),
    ("M_{P}_{x}", "moment that body K and all that it carries need (N m)"),
    ("fn_{n}", "generalized force on freedom n, which couplings name, with its force elements"),
    ("f_{n}", "force that body K and all that it carries need along the translation at place n (N)"),
    # Velocities, energy, momentum, poses
    ("vo_{P}_{x}", "velocity of the origin (m/s)"),
    ("vr_{K}_{x}", "velocity of the origin of body K past the origin of J, in J (m/s)"),
    ("vv_{K}", "square of the velocity of the origin of body K (m^2/s^2)"),
    ("hv_{K}_{x}", "h_K x vo_K (kg m^2/s)"),
    ("L_{K}h_{x}", "[I_K] omega_K / 2 + h_K x vo_K (kg m^2/s)"),
    ("KE_{K}", "kinetic energy of body K (J)"),
    ("KE_{K}s", "kinetic energy of bodies 1 to K (J)"),
    ("mm_{n}", "half the armature of the freedom at place n"),
    ("ym_{n}", "square of the speed of the freedom at place n"),
    ("KM_{n}", "kinetic energy of all bodies, and of motors up to that of the freedom at place n (J)"),
    ("P_{P}_{x}", "linear momentum of body K and all that it carries, as seen from its origin (kg m/s)"),
    ("L_{P}_{x}", "angular momentum of body K and all that it carries, as seen from its origin (kg m^2/s)"),
    ("NX_{P}_{x}", "inertial basis vector x, in P"),
    ("NY_{P}_{x}", "inertial basis vector y, in P"),
    ("NZ_{P}_{x}", "inertial basis vector z, in P"),
    ("pO_{K}_{x}", "O_K from the inertial origin, inertial (m)"),
    ("pP_{n}_{x}", "point n from the inertial origin, inertial (m)"),
    ("pp_{n}_{P}_{x}", "point n, in P (m)"),
    ("vP_{n}_{x}", "velocity of point n, in its body (m/s)"),
    ("vP_{n}_{P}_{x}", "velocity of point n, in P (m/s)"),
    ("aP_{n}_{x}", "acceleration of point n, in its body (m/s^2)"),
    ("aP_{n}_{P}_{x}", "acceleration of point n, in P (m/s^2)"),
    ("rP_{n}_{K}_{x}", "point n from O_K, inertial (m)"),
    ("pf_{n}_{x}", "origin of frame n from the inertial origin, inertial (m)"),
    ("wf_{n}_{x}", "angular velocity of frame n, in its body (rad/s)"),
    ("wf_{n}_{P}_{x}", "angular velocity of frame n, in P (rad/s)"),
    ("vf_{n}_{x}", "velocity of the origin of frame n, in its body (m/s)"),
    ("vf_{n}_{P}_{x}", "velocity of the origin of frame n, in P (m/s)"),
    ("ef_{n}_{x}", "angular acceleration of frame n, in its body (rad/s^2)"),
    ("ef_{n}_{P}_{x}", "angular acceleration of frame n, in P (rad/s^2)"),
    ("af_{n}_{x}", "acceleration of the origin of frame n, in its body (m/s^2)"),
    ("af_{n}_{P}_{x}", "acceleration of the origin of frame n, in P (m/s^2)"),
    ("rf_{n}_{K}_{x}", "origin of frame n from O_K, inertial (m)"),
    ("n_{P}_{x}", "axis of the turn above P, inertial"),
    ("xdot_{n}", "rate of the coordinate at place n of {x}"),
    ("Ci_{P}", "1 over the function of the middle angle that is 0 at gimbal lock"),
    ("Cq_{K}", "square of the function of the middle angle that is 0 at gimbal lock"),
    ("qq_{K}", "component of the angular velocity along the axis that gives the first rate"),
    # Force elements
    ("ex_{n}", "part of the expression of a force element, or of its derivatives"),
    ("fe_{K}_{i}", "generalized force of force elements on freedom i of body K"),
    ("ar_{K}_{i}", "armature of freedom i of body K, with the reflected inertia of its rotors"),
    ("ar_{n}", "the same at place n, with what rotors add that its own body carries"),
    ("rh_{n}_{x}", "angular momentum of rotor n for unit rate of its freedom, in its carrier"),
    ("rc_{n}_{x}", "the same for the rotors of the freedom at place n, in the frame of its axis"),
    ("fm_{n}", "generalized force that accelerates the armature of the freedom at place n"),
    ("fr_{n}", "fm_n, and what turns rotors along with their carriers"),
    ("kw_{n}_{x}", "second end of spring n from its first (m)"),
    ("kwd_{n}_{x}", "rate of kw_n (m/s)"),
    ("kq_{n}", "squared length of spring n (m^2)"),
    ("kl_{n}", "length of spring n (m)"),
    ("kx", "stretch of a joint spring"),
    ("kx_{n}", "stretch of spring n (m)"),
    ("kr_{n}", "rest length of spring n over its length"),
    ("ku_{n}", "1 - kr_n"),
    ("kd_{n}", "kw_n . kwd_n"),
    ("kv_{n}", "kd_n / kq_n"),
    ("kf_{n}", "force of spring n over its length (N/m)"),
    ("kF_{n}_{x}", "force of spring n on its first end (N)"),
    ("k{n}a_{P}_{x}", "first end of spring n, in P (m)"),
    ("k{n}ad_{P}_{x}", "displacement of the first end of spring n from its place at {x} = {0}, in P (m)"),
    ("k{n}av_{P}_{x}", "velocity of the first end of spring n, in P (m/s)"),
    ("k{n}b_{P}_{x}", "second end of spring n, in P (m)"),
    ("k{n}bd_{P}_{x}", "displacement of the second end of spring n from its place at {x} = {0}, in P (m)"),
    ("k{n}bv_{P}_{x}", "velocity of the second end of spring n, in P (m/s)"),
    ("ks_{n}_{P}_{x}", "force of spring n, in P (N)"),
    ("pl_{n}F_{P}_{x}", "force of load element n, in P (N)"),
    ("pl_{n}M_{P}_{x}", "moment of load element n, in P (N m)"),
    ("pi_{n}F_{P}_{x}", "force on point n, in P (N)"),
    ("pi_{n}M_{P}_{x}", "moment on the body of point n, in P (N m)"),
    # Forward dynamics
    ("SI_{P}_{xx}", "articulated body P, or what is left without freedom P: moment by angular acceleration"),
    ("SH_{P}_{x}_{y}", "the same, moment by acceleration of the origin"),
    ("SHr_{P}_{x}_{y}", "SH on its way through a turn"),
    ("SM_{P}_{xx}", "the same, force by acceleration of the origin"),
    ("pF_{P}_{x}", "force that articulated body P needs, or what is left without freedom P (N)"),
    ("pN_{P}_{x}", "moment that articulated body P needs, or what is left without freedom P (N m)"),
    ("pF_{K}own_{x}", "force that body K needs for the solution (N)"),
    ("pN_{K}own_{x}", "moment that body K needs for the solution (N m)"),
    ("D_{n}", "pivot of the freedom at place n"),
    ("D_{n}i", "1 over the pivot of the freedom at place n"),
    ("Dc_{K}", "pivot of body K times the square that is 0 at gimbal lock"),
    ("Dl_{n}", "lower bound of D_n in every state"),
    ("Dm_{n}", "margin of D_n: positive where the pivot keeps enough digits"),
    (
        "U_{n}",
        "bound of the inertias that the freedom at place n carries, often over the largest loss of its pivot",
    ),
    ("Ut_{n}", "U_n with the translations of the state"),
    ("Us_{n}", "what a mass at a distance that translations change adds to U_n"),
    ("hs_{n}", "its mass times the distance (kg m)"),
    ("cs", "component of the position of a mass centre that translations change (m)"),
    ("dw", "largest distance of a mass centre from an axis (m)"),
    ("cw_{x}", "mass centre of a body from an origin, where translations are 0 (m)"),
    ("g_{n}_{i}", "gain: what the freedom at place n takes per unit of acceleration i"),
    ("sr_{n}_{i}", "row i of the freedom at place n, with the spin of its rotors"),
    ("gk_{n}", "share of its row that the motor of the freedom at place n keeps inward"),
    ("e_{n}", "generalized force left for the freedom at place n"),
    ("n_{n}", "acceleration of the freedom at place n if all others were 0"),
    (
        "yN_{n}_{P}_{x}",
        "moment that articulated body P needs per unit of entry n of {ydot}, which couples freedoms",
    ),
    ("yF_{n}_{P}_{x}", "the same, force"),
    ("yD_{n}_{m}", "generalized force that entry n of {y} needs per unit of entry m of {ydot}"),
    ("ycN_{n}_{P}_{x}", "moment that composite body P needs per unit of entry n of {ydot}"),
    ("ycF_{n}_{P}_{x}", "the same, force"),
    ("ycD_{n}_{m}", "yD_n_m with all other freedoms locked"),
    ("gy_{n}_{m}", "gain: what the freedom at place n takes per unit of entry m of {ydot}"),
    ("er_{n}_{m}", "generalized force that entry m of {y} needs for what is outward of body or freedom n"),
    ("te_{n}", "generalized force of {tau} and force elements at place n"),
    ("tF_{P}_{x}", "force of {tau} along free translations, in P (N)"),
    ("T_{K}_{x}", "torque of {tau} about free angles, in K (N m)"),
    ("T_{K}_q", "component of T_K between the turns by its second and third angle"),
    ("qw_{P}_{x}", "angular acceleration of the solution (rad/s^2)"),
    ("qa_{P}_{x}", "acceleration of the origin of the solution (m/s^2)"),
    ("qs_{P}_{x}", "acceleration of O_K along free translations, in P (m/s^2)"),
    ("qr_{K}_{x}", "angular acceleration of body K relative to its lower body, in K (rad/s^2)"),
    ("q_{n}", "component of the acceleration at the freedom at place n"),
    ("qo_{n}", "q_n where component n of the acceleration below the joint is zero"),
    ("L_{n}_{m}", "entry of the factor [L] of [A]"),
    ("b_{n}", "right side of the elimination at place n"),
    ("bd_{n}", "b_n over the pivot"),
    ("ydot_{n}", "entry of {ydot}, or the component of the acceleration of the body in its place"),
    ("r_{n}", "component of the acceleration that a body has with the freedom at place n"),
    # Refinement
    ("dy_{n}", "correction of ydot_n"),
    ("de_{n}", "square of dy_n"),
    ("yy", "size of the solution squared"),
    ("yy_{n}", "square of ydot_n"),
    ("yyw_{n}", "yy_n in the unit of the sizes"),
    ("dd_{n}", "square of dy_n"),
    ("ddw_{n}", "dd_n in the unit of the sizes"),
    ("yy_all", "sum of yy and yy_least"),
    ("yy_i", "1 over yy_all"),
    ("yy_one", "1 where yy_all is finite, else NaN"),
    ("yy_least", "smallest size that counts, squared"),
    ("dm", "share of the size that is allowed for every correction"),
    ("dr_{n}", "dm less ddw_n"),
    ("dm_{n}", "margin of the correction at place n: positive where it is small enough"),
    ("ps", "sum of the pivots of translations"),
    ("pa", "sum of the pivots of angles"),
    ("pm", "ps over the number of translations, times that of angles"),
    ("ll", "square of the length that compares angles with translations (m^2)"),
)
"""Names of intermediates and their meanings; the first pattern that fits a name counts."""

MARKS = (
    ("_d{n}", "at the end of a name: derivative by element n of what is differentiated by"),
    ("_s", "at the end of a name: the value at the solution {ydot}"),
    ("_", "at the end of a name: another value of the same kind"),
)
"""Meanings of the endings of names."""

_TURNED = ("Ic_{P}", "Ic_{K}r{P}", "SI_{P}", "SM_{P}")
"""Symmetric matrices that pass turns."""

_STEPS = (
    ("_d", "difference of the two diagonal entries of {0} that the turn mixes"),
    ("_p", "sine times {0}_d, less twice the cosine times the entry between the two"),
    ("_t", "sine times {0}_p"),
    ("_a_{x}", "product of {0} above and column x of the turn"),
    ("_b_{x}", "product of {0} above and column y of the turn"),
    ("_c_{x}", "product of {0} above and column z of the turn"),
)
"""Intermediates of a turn, where {0} is the matrix."""


def _turning() -> Iterator[tuple[str, str]]:
    """Yield the intermediates of turns of symmetric matrices."""
    for matrix in _TURNED:
        parts = (f"{matrix}_{{i}}", f"{matrix}_{{i}}_{{i}}")
        for part in parts:
            yield f"{part}_{{xx}}", f"{shown(matrix)} on its way through several turns, below turn i"
        for name in (matrix, *parts):
            for ending, meaning in _STEPS:
                yield f"{name}{ending}", meaning.replace("{0}", shown(name))


_PLACE = r"\d+(?:j|o|a\d?u?|c\du?|tu?)?"
_FREEDOM = r"\d+(?:a\d|s\d+|t\d|w\d|r\d+|y\d+)"
_PLACEHOLDERS = {
    "{K}": r"\d+",
    "{J}": r"\d+",
    "{n}": r"\d+",
    "{m}": r"\d+",
    "{0}": "0",
    "{i}": r"\d",
    "{ij}": r"\d\d",
    "{P}": f"(?P<place>{_PLACE})",
    "{L}": f"(?P<freedom>{_FREEDOM})",
    "{x}": "[xyz]",
    "{y}": "[xyz]",
    "{xx}": "(?:xx|yy|zz|xy|xz|yz)",
    "{name}": r"\w+",
}
"""Regular expression of each placeholder."""


def shown(pattern: str) -> str:
    """Return a pattern as a legend shows it, without braces."""
    return pattern.replace("{", "").replace("}", "")


def expression(pattern: str) -> re.Pattern[str]:
    """Return the regular expression of a pattern."""
    parts = re.split(r"(\{\w+\})", pattern)
    return re.compile("".join(_PLACEHOLDERS.get(part, re.escape(part)) for part in parts))


@dataclass(frozen=True)
class Entry:
    """One line of a legend.

    Attributes:
        pattern: Pattern of names, with placeholders in braces.
        meaning: What the names mean.
    """

    pattern: str
    meaning: str

    @cached_property
    def regex(self) -> re.Pattern[str]:
        """The regular expression of the names."""
        return expression(self.pattern)

    @property
    def line(self) -> tuple[str, str]:
        """The line as a legend shows it."""
        return shown(self.pattern), self.meaning


@dataclass(frozen=True)
class Legend:
    """The meanings of the names in some code; every line applies to at least one name.

    Attributes:
        names: Patterns of names and meanings.
        places: Patterns of the values of P, and meanings.
        freedoms: Patterns of the values of L, and meanings.
        unknown: Names that no pattern fits.
    """

    names: tuple[tuple[str, str], ...]
    places: tuple[tuple[str, str], ...]
    freedoms: tuple[tuple[str, str], ...]
    unknown: tuple[str, ...]


@cache
def entries() -> tuple[Entry, ...]:
    """Return every entry of names, in the order in which they are tried."""
    after = [pattern for pattern, _ in NAMES].index("Ic_{P}_{xx}") + 1
    return tuple(Entry(*entry) for entry in (*NAMES[:after], *_turning(), *NAMES[after:]))


_PLACE_ENTRIES = tuple(Entry(*entry) for entry in PLACES)
_FREEDOM_ENTRIES = tuple(Entry(*entry) for entry in FREEDOMS)
_MARKS = tuple((Entry(*entry), re.compile(f"_*{expression(entry[0]).pattern}$")) for entry in MARKS)


def legend(names: Iterable[str]) -> Legend:
    """Return the legend of the names that occur in some code."""
    used: set[Entry] = set()
    unknown: list[str] = []
    for name in sorted(set(names)):
        found = _explained(name)
        used.update(found)
        if not found:
            unknown.append(name)

    def lines(among: Iterable[Entry]) -> tuple[tuple[str, str], ...]:
        return tuple(entry.line for entry in among if entry in used)

    marks = (mark for mark, _ in _MARKS)
    return Legend(
        (*lines(entries()), *lines(marks)), lines(_PLACE_ENTRIES), lines(_FREEDOM_ENTRIES), tuple(unknown)
    )


def meaning_at_places(name: str) -> str:
    """Return the meaning of a name that says at which places its freedoms are, with their numbers; or "".

    Example:
        meaning_at_places("D_3i")  # "1 over the pivot of the freedom at place 3"
    """
    entry = next((entry for entry in entries() if entry.regex.fullmatch(name)), None)
    if entry is None or "at place" not in entry.meaning:
        return ""
    letters, numbers = re.findall(r"{(\w+)}", entry.pattern), re.findall(r"\d+", name)
    places = dict(zip(letters, numbers, strict=False))
    return re.sub(r"at place (\w)\b", lambda m: f"at place {places.get(m[1], m[1])}", entry.meaning)


def _explained(name: str) -> list[Entry]:
    """Return the entries that explain a name, its place and its marks; [] if there is none."""
    for entry in entries():
        if match := entry.regex.fullmatch(name):
            found = [entry]
            parts = match.groupdict()
            for group, among in (("place", _PLACE_ENTRIES), ("freedom", _FREEDOM_ENTRIES)):
                part = parts.get(group)
                found += [one for one in among if part and one.regex.fullmatch(part)]
            return found
    for mark, ending in _MARKS:
        if (match := ending.search(name)) and match.start() > 0:
            inner = _explained(name[: match.start()])
            if inner:
                return [*inner, mark]
    return []
