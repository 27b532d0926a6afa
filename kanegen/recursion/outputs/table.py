"""The table of outputs: one entry per output, in the order of the generated C.

The entries about motion alone stand in `kinematics`, those of derivatives in `derivatives`.
"""

from __future__ import annotations

from collections import ChainMap

from kanegen.model.identification.base_parameters import base_parameters
from kanegen.model.system import System
from kanegen.program.ir import INVERTIBLE, Array, Condition
from kanegen.recursion.centroidal import centroidal_momentum_bias, centroidal_momentum_matrix
from kanegen.recursion.coriolis import coriolis_matrix
from kanegen.recursion.energy_and_momentum import kinetic_energy, mass_center, momentum, potential_energy
from kanegen.recursion.gravity import gravity_forces
from kanegen.recursion.inverse_dynamics import (
    forcing,
    inverse_dynamics,
    prescribed_efforts,
    velocity_forces,
)
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.recursion.outputs.contacts import HELD
from kanegen.recursion.outputs.derivatives import PARTS, derivatives_of
from kanegen.recursion.outputs.differentiated import Derivative, Differentiated, Product, SecondDerivative
from kanegen.recursion.outputs.inputs import LOADS
from kanegen.recursion.outputs.kinematics import KINEMATICS
from kanegen.recursion.outputs.operational import OPERATIONAL
from kanegen.recursion.outputs.output import ErrorBound, OfSolution, Output, Recursion, Subject
from kanegen.recursion.outputs.products import products_of
from kanegen.recursion.outputs.second_derivatives import second_derivatives_of
from kanegen.recursion.reactions import reaction_loads
from kanegen.recursion.regressor import base_regressor, regressor
from kanegen.recursion.solution import Solution

REACTIONS = Subject(
    lambda system: system.reaction_rows,
    "has no locked directions, all joints move freely. Lock some, or ask for inverse_dynamics.",
)

PRESCRIBED = Subject(
    lambda system: system.prescribed,
    'has no prescribed freedoms. Prescribe some in the model file, such as prescribed = ["theta1"] in a '
    "joint, or use System.with_prescribed.",
)

MASSES = Subject(
    lambda system: [body for body in system.bodies if body.mass != 0],
    "has no body with mass, so there is no mass centre.",
)


def _n(system: System) -> int:
    """Return the number of freedoms n."""
    return len(system.freedoms)


def _reactions_doc(system: System) -> str:
    """Return the documentation of `reaction_loads`, which may hold locked directions and loads in frames."""
    in_frames = [bool(row.frame) for row in system.reaction_rows]
    directions = (
        "what holds locked directions, beside loads and gravity: for an angle the moment about O_K and "
        "its axis, for a translation the force along it"
    )
    loads = (
        "what the lower body exerts on a body through its joint, efforts on freedoms included: the moment "
        "about the origin of a frame of the body, and the force, in components of the frame"
    )
    return "; ".join([directions] * (not all(in_frames)) + [loads] * any(in_frames))


_ENTRIES = (
    Output(
        "mass_matrix",
        lambda system: Array(
            "A",
            (_n(system),) * 2,
            "kg m^2, kg m, kg",
            "[A], the generalized mass matrix, Eq. (43)",
            of_freedoms=True,
        ),
        ("x",),
        Recursion("composite bodies", mass_matrix),
    ),
    Output(
        "forcing",
        lambda system: Array(
            "f",
            (_n(system),),
            "N m, N",
            "{f}, the right side of [A]{ydot} = {f}, Eq. (44)",
            of_freedoms=True,
        ),
        ("x", "y", *LOADS),
        Recursion("recursion of forces", forcing),
    ),
    Output(
        "gravity_forces",
        lambda system: Array(
            "gravity_forces",
            (_n(system),),
            "N m, N",
            "the part of {f} that gravity causes, the sum of [v_G,y]^T m {g}, Eq. (44)",
            of_freedoms=True,
        ),
        ("x",),
        Recursion("first moments of mass", gravity_forces),
    ),
    Output(
        "velocity_forces",
        lambda system: Array(
            "velocity_forces",
            (_n(system),),
            "N m, N",
            "the part of {f} that {y} and prescribed motion cause, without gravity, loads and force elements",
            of_freedoms=True,
        ),
        ("x", "y"),
        Recursion("recursion of forces", velocity_forces),
    ),
    Output(
        "coriolis_matrix",
        lambda system: Array(
            "C",
            (_n(system),) * 2,
            "kg m^2/s, kg m/s, kg/s",
            "[C], the sum of m [v_P,y]^T [dv_P,y/dt] over all particles; [C]{y} is minus velocity_forces",
            of_freedoms=True,
        ),
        ("x", "y"),
        Recursion("composite bodies", coriolis_matrix),
    ),
    Output(
        "inverse_dynamics",
        lambda system: Array(
            "generalized_force",
            (_n(system),),
            "N m, N",
            "[A]{ydot} - {f}, the generalized forces that {ydot} needs beside loads and gravity",
            of_freedoms=True,
        ),
        ("x", "y", "ydot", *LOADS),
        Recursion("recursion of forces", inverse_dynamics),
    ),
    Output(
        "reaction_loads",
        lambda system: Array(
            "reaction_loads",
            (len(system.reaction_rows),),
            "N m, N",
            _reactions_doc(system),
        ),
        ("x", "y", "ydot", *LOADS),
        Recursion("recursion of forces", reaction_loads),
        REACTIONS,
    ),
    Output(
        "forward_dynamics",
        lambda system: Array(
            "acceleration",
            (_n(system),),
            "rad/s^2, m/s^2",
            "{ydot} of [A]{ydot} = {f} + {tau}, Eq. (42)",
            of_freedoms=True,
        ),
        ("x", "y", "tau", *LOADS),
        OfSolution(Solution.forward_dynamics, is_refined=True),
    ),
    Output(
        "error_estimate",
        lambda system: Array(
            "error_estimate",
            (_n(system),),
            "rad/s^2, m/s^2",
            "about the error of each entry of {ydot} before refinement: how much a first step changes it",
            of_freedoms=True,
        ),
        ("x", "y", "tau", *LOADS),
        OfSolution(Solution.error_estimate, is_accurate=False),
    ),
    Output(
        "error_bound",
        lambda system: Array(
            "error_bound",
            (_n(system),),
            "rad/s^2, m/s^2",
            "proven bound on the error of each entry of the given {ydot} as the solution of "
            "[A]{ydot} = {f} + {tau}, whatever computed it; by running errors of inverse dynamics",
            Condition("pivot of [A] less twice its error", "no bound is proven"),
        ),
        ("x", "y", "ydot", "tau", *LOADS),
        ErrorBound(),
    ),
    Output(
        "regularity",
        lambda system: Array(
            "regularity",
            (_n(system),),
            "1",
            "for each freedom what is left of its inertia where freedoms that are eliminated before it may "
            "move; 1 is all, 0 singular",
            of_freedoms=True,
        ),
        ("x",),
        OfSolution(Solution.regularity, is_accurate=False),
    ),
    Output(
        "mass_matrix_inverse",
        lambda system: Array(
            "A_inverse",
            (_n(system),) * 2,
            "1/(kg m^2), 1/(kg m), 1/kg",
            "[A]^-1, what unit generalized forces add to {ydot}, column by column",
            INVERTIBLE,
            of_freedoms=True,
        ),
        ("x",),
        OfSolution(Solution.mass_matrix_inverse),
    ),
    *HELD,
    Output(
        "kinetic_energy",
        lambda system: Array(
            "kinetic_energy", (), "J", "the sum of m v_G^2 / 2 + {omega}^T [I_G] {omega} / 2, Eqs. (18), (31)"
        ),
        ("x", "y"),
        Recursion("velocities of the bodies", kinetic_energy),
    ),
    Output(
        "potential_energy",
        lambda system: Array(
            "potential_energy",
            (),
            "J",
            "of gravity, minus the sum of m g . p_G, zero where all mass centres are at the inertial origin",
        ),
        ("x",),
        Recursion("first moments of mass", potential_energy),
    ),
    Output(
        "momentum",
        lambda system: Array(
            "momentum",
            (6,),
            "kg m/s, kg m^2/s",
            "the sum of m {v_G}, then the sum of [I_G] {omega} + ({p_G} - {p_C}) x m {v_G} about the mass "
            "centre C of all bodies, inertial components",
        ),
        ("x", "y"),
        Recursion("velocities of the bodies", momentum),
    ),
    Output(
        "centroidal_momentum_matrix",
        lambda system: Array(
            "centroidal_momentum_matrix",
            (6, _n(system)),
            "kg m, kg; kg m^2, kg m",
            "[A_G], the momentum by {y}: rows of linear momentum, then of angular momentum about the mass "
            "centre of all bodies, inertial components; armature has none (Orin, Goswami and Lee 2013)",
        ),
        ("x",),
        Recursion("composite bodies", centroidal_momentum_matrix),
    ),
    Output(
        "centroidal_momentum_bias",
        lambda system: Array(
            "centroidal_momentum_bias",
            (6,),
            "N, N m",
            "the rate of the momentum for {ydot} = 0, d/dt of [A_G] times {y}, prescribed motion included: "
            "linear, then angular about the mass centre of all bodies, inertial components (Orin, Goswami, "
            "Lee 2013)",
        ),
        ("x", "y"),
        Recursion("recursion of forces", centroidal_momentum_bias),
    ),
    Output(
        "mass_center",
        lambda system: Array(
            "mass_center",
            (3,),
            "m",
            "{p_C}, the sum of m {p_G}, Eq. (23), over the sum of m, inertial components",
        ),
        ("x",),
        Recursion("first moments of mass", mass_center),
        MASSES,
    ),
    *KINEMATICS,
    *OPERATIONAL,
    Output(
        "regressor",
        lambda system: Array(
            "regressor",
            (_n(system), 10 * system.number_of_bodies),
            "N m, N over the units of the parameters",
            "[Y] of [A]{ydot} - {f} = [Y]{pi} without loads, force elements and motors: for each body the "
            "columns of its mass, first moment (x, y, z) and inertia (xx, xy, yy, xz, yz, zz) about the "
            "origin of its frame (Atkeson, An and Hollerbach 1986)",
        ),
        ("x", "y", "ydot"),
        Recursion("partial velocities of the bodies", regressor),
    ),
    Output(
        "base_regressor",
        lambda system: Array(
            "base_regressor",
            (_n(system), len(base_parameters(system))),
            "N m, N over the units of the parameters",
            "[Y_b] of [Y]{pi} = [Y_b]{beta} for the base parameters {beta}: the columns of [Y] that are "
            "independent over all motions (Gautier and Khalil 1990)",
        ),
        ("x", "y", "ydot"),
        Recursion("partial velocities of the bodies", base_regressor),
    ),
    Output(
        "prescribed_efforts",
        lambda system: Array(
            "prescribed_efforts",
            (len(system.prescribed),),
            "N m, N",
            "generalized forces that act at the prescribed freedoms, beside loads and gravity",
        ),
        ("x", "y", "ydot", *LOADS),
        Recursion("recursion of forces", prescribed_efforts),
        PRESCRIBED,
    ),
)

OUTPUTS: dict[str, Output] = {
    output.name: output
    for output in (
        *_ENTRIES,
        *derivatives_of(_ENTRIES),
        *products_of(_ENTRIES),
        *second_derivatives_of(_ENTRIES),
    )
}
"""The outputs by name."""

DERIVED = ChainMap(OUTPUTS, PARTS)
"""Everything that can be derived, by name: the outputs, and parts of them."""

EQUATIONS = ("mass_matrix", "forcing")
"""The outputs that are computed unless others are asked for: [A] and {f} of Eq. (42)."""

ERROR_BOUNDS = {
    name: output.derivation for name, output in OUTPUTS.items() if isinstance(output.derivation, ErrorBound)
}
"""The derivations of the outputs that bound errors, by name."""

DERIVATIVES = {
    name: output.derivation for name, output in OUTPUTS.items() if isinstance(output.derivation, Derivative)
}
"""The derivations of the outputs that are derivatives of other outputs, by name."""

DIFFERENTIATED: dict[str, Differentiated] = {
    name: output.derivation
    for name, output in OUTPUTS.items()
    if isinstance(output.derivation, Differentiated)
}
"""The derivations of all outputs that are made by differentiating others, by name."""

PRODUCTS = {
    name: output.derivation for name, output in OUTPUTS.items() if isinstance(output.derivation, Product)
}
"""The derivations of the outputs that are products with derivatives of other outputs, by name."""

SECOND_DERIVATIVES = {
    name: output.derivation
    for name, output in OUTPUTS.items()
    if isinstance(output.derivation, SecondDerivative)
}
"""The derivations of the outputs that are second derivatives of other outputs, by name."""
