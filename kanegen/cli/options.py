"""Arguments and options that several commands share.

Names that a user chooses among are written out here, since importing the modules that define them would load
SymPy and NumPy, and `kanegen COMMAND --help` loads neither. A test compares these names with the modules.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.loading import names_of
from kanegen.errors import OptionError
from kanegen.extras import BENCH, require
from kanegen.model.coordinates import ORIENTATIONS, SPEEDS

DEFAULT_OUTPUTS = ["mass_matrix", "forcing"]
"""The outputs that are computed where the command line names none."""

AS_WRITTEN = 0.0
"""The tolerance (rad) that leaves every angle of a model as it is written."""

Model = Annotated[
    Path,
    typer.Argument(metavar="MODEL", help="The model file, .toml, .urdf or .xml (MJCF).", show_default=False),
]
Page = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="FILE.html",
        help="The page; by default the name of the model in the current folder.",
        show_default=False,
    ),
]
FloatingBase = Annotated[
    bool, typer.Option("--floating-base", help="Give the root link of a .urdf file six freedoms.")
]
JointDynamics = Annotated[
    bool,
    typer.Option("--joint-dynamics", help="Read damping and friction of the joints of a .urdf or .xml file."),
]
RightAngles = Annotated[
    float,
    typer.Option(
        "--right-angles",
        metavar="TOL",
        help="Take an angle within TOL (rad) of a multiple of pi/2 for that multiple; 5e-05 takes 1.5708 "
        "for pi/2.",
    ),
]


def _outputs(texts: list[str]) -> list[str]:
    """Return the names of outputs, each text one name or several."""
    return names_of("--output", texts)


Outputs = Annotated[
    list[str],
    typer.Option(
        "--output",
        metavar="NAMES",
        callback=_outputs,
        help="Compute these outputs, one name or several separated by commas (repeatable): "
        "mass_matrix, forcing, gravity_forces, velocity_forces, coriolis_matrix, "
        "inverse_dynamics, reaction_loads, forward_dynamics, error_estimate, error_bound, "
        "regularity, mass_matrix_inverse, contact_dynamics, contact_forces, kinetic_energy, "
        "potential_energy, momentum, centroidal_momentum_matrix, centroidal_momentum_bias, "
        "mass_center, body_poses, frame_velocities, frame_accelerations, "
        "frame_bias_accelerations, frame_jacobians, coordinate_rates, point_positions, "
        "point_velocities, point_accelerations, point_jacobians, operational_inertia, "
        "operational_inertia_inverse, operational_bias, regressor, base_regressor, "
        "prescribed_efforts, forcing_derivatives, gravity_forces_derivatives, "
        "inverse_dynamics_derivatives, forward_dynamics_derivatives, "
        "contact_dynamics_derivatives, coordinate_rates_derivatives, point_positions_derivatives, "
        "point_velocities_derivatives, point_accelerations_derivatives, "
        "kinetic_energy_derivatives, potential_energy_derivatives, momentum_derivatives, "
        "centroidal_momentum_bias_derivatives, mass_center_derivatives, "
        "forcing_input_derivatives, inverse_dynamics_input_derivatives, "
        "forward_dynamics_input_derivatives, forcing_jvp, forcing_vjp, forcing_hvp, "
        "inverse_dynamics_jvp, inverse_dynamics_vjp, inverse_dynamics_hvp, forward_dynamics_jvp, "
        "forward_dynamics_vjp, forward_dynamics_hvp, inverse_dynamics_second_derivatives, "
        "forward_dynamics_second_derivatives, step_euler, rollout_euler, step_euler_derivatives, "
        "step_semi_implicit_euler, rollout_semi_implicit_euler, "
        "step_semi_implicit_euler_derivatives, step_rk4, rollout_rk4, step_rk4_derivatives, "
        "step_implicit_midpoint, rollout_implicit_midpoint, step_implicit_midpoint_derivatives, "
        "step_variational_midpoint, rollout_variational_midpoint, step_linearly_implicit, "
        "rollout_linearly_implicit.",
    ),
]
TARGETS = (
    "cpp",
    "description",
    "reanchoring",
    "certificate",
    "arduino",
    "casadi",
    "octave",
    "rust",
    "fmi2",
    "fmi3",
    "self-test",
    "simulink",
    "wasm",
)
"""Names of the artifacts and products that `kanegen generate` writes where they are asked for, one a line."""

For = Annotated[
    list[str] | None,
    typer.Option(
        "--for",
        metavar="NAMES",
        help="Also write files for other languages and programs, one name or several separated by commas "
        "(repeatable). Unless --output names outputs, there are those that they call, mass_matrix, "
        "forcing, and for most targets forward_dynamics, contact_dynamics where contacts hold, and "
        f"coordinate_rates where speeds are no rates of coordinates: {', '.join(TARGETS)}.",
        show_default=False,
    ),
]
LANGUAGES = ("c99", "cuda")
"""Names of the targets, the languages of the code."""

Target = Annotated[
    str,
    typer.Option(
        "--target",
        metavar="NAME",
        help=f"Language of the code: {', '.join(LANGUAGES)}. cuda writes kernels for GPUs, with a thread for "
        "each state.",
    ),
]
PLATFORM_NAMES = (
    "x86_64-linux",
    "aarch64-linux",
    "x86_64-windows",
    "aarch64-windows",
    "x86_64-darwin",
    "aarch64-darwin",
)
"""Names of the platforms for which `kanegen.products` compiles."""

Platforms = Annotated[
    list[str] | None,
    typer.Option(
        "--platform",
        metavar="NAMES",
        help="Platforms of an FMU, one name or several separated by commas (repeatable); by default this "
        f"machine's. Others need `pip install ziglang`: {', '.join(PLATFORM_NAMES)}.",
        show_default=False,
    ),
]
MATRIX_FORMS = ("full", "lower", "packed", "sparse")
"""Forms in which functions fill the mass matrix."""

MassMatrix = Annotated[
    str,
    typer.Option(
        "--mass-matrix",
        metavar="FORM",
        help="Fill the mass matrix in this form: full; lower, only the lower triangle of the whole array; "
        "packed, an array of the lower triangle by rows; or sparse, the same without what is zero in every "
        "state.",
    ),
]
Functions = Annotated[
    list[str] | None,
    typer.Option(
        "--function",
        metavar="NAME",
        help="Print only this function (repeatable): the name of an output, or evaluate for all outputs "
        "together, which is the same where there is one. By default all of them are printed.",
        show_default=False,
    ),
]
Frames = Annotated[
    str | None,
    typer.Option(
        "--frames",
        "--poses",
        metavar="NAMES",
        help="Frames and bodies in the rows of body_poses, frame_jacobians, frame_velocities and other "
        "outputs about frames, such as tool,base.",
    ),
]
Points = Annotated[
    list[str] | None,
    typer.Option(
        "--points",
        metavar="NAME=FRAME:X,Y,Z",
        help="Add a point at x, y, z (m) of a frame or body (repeatable), such as tip=hand:0,0,0.1.",
    ),
]
Loads = Annotated[
    str | None,
    typer.Option(
        "--loads",
        metavar="NAMES",
        help="Points, bodies and frames on which a force and a moment are inputs, such as tool,tip.",
    ),
]
Contacts = Annotated[
    str | None,
    typer.Option(
        "--contacts",
        metavar="NAMES",
        help="Contacts that hold, instead of those of the model: contacts of the model, points, frames and "
        "bodies, such as left_foot,toe; a point is held in three directions, a frame in six, or in those "
        "that follow its name, such as toe:force1+force3.",
    ),
]
Reactions = Annotated[
    str | None,
    typer.Option(
        "--reactions",
        metavar="NAMES",
        help="Loads that reaction_loads gives: along locked directions such as arm.theta2, or all six in a "
        "frame such as tool.",
    ),
]
Without = Annotated[
    list[str] | None,
    typer.Option(
        "--without", metavar="PASS", help="Leave out this optimiser pass (repeatable): fold, prune, factor."
    ),
]
Precision = Annotated[
    str | None,
    typer.Option(
        "--precision",
        metavar="NAME",
        help="Arithmetic of the C, by default that of the tier, which is double for strict; float is single "
        "precision: double, float, long double, double-double.",
        show_default=False,
    ),
]
Storage = Annotated[
    str | None,
    typer.Option(
        "--storage",
        metavar="NAME",
        help="Precision of the arrays of the C, where it is not that of its arithmetic.",
    ),
]
Sincos = Annotated[
    str | None,
    typer.Option(
        "--sincos",
        metavar="NAME",
        help="Implementation of sine and cosine: shared, libm, or polynomial-5 to polynomial-15.",
    ),
]
Machine = Annotated[
    str | None,
    typer.Option(
        "--machine",
        metavar="NAME",
        help="Processors that the C is for: portable, all of the architecture; multiversioned, all of it, by "
        "versions of every function for SSE2, AVX2 and AVX-512, of which a program runs the widest it can; "
        "native, those like this one, with flags in the build files; auto, portable where the C is written "
        "and native where it is compiled and run here. By default that of the tier, auto for strict.",
        show_default=False,
    ),
]
Tier = Annotated[
    str,
    typer.Option(
        "--tier",
        metavar="NAME",
        help="Choices between speed and accuracy: strict, fast, single, exact.",
    ),
]
Speeds = Annotated[
    str | None,
    typer.Option(
        "--speeds",
        metavar="NAME",
        help=f"Generalized speeds of joints with three free angles: {', '.join(SPEEDS)}.",
    ),
]
Coordinates = Annotated[
    str | None,
    typer.Option(
        "--coordinates",
        metavar="NAME",
        help=f"Coordinates of joints with three free angles: {', '.join(ORIENTATIONS)}.",
    ),
]
Lock = Annotated[
    list[str] | None,
    typer.Option(
        "--lock",
        metavar="NAME=VALUE",
        help="Lock this freedom at VALUE in rad or m (repeatable), such as elbow=0.3 or elbow=pi/4; a ball "
        "joint by its four numbers, as in wrist=1,0,0,0.",
        show_default=False,
    ),
]
Reanchoring = Annotated[
    bool,
    typer.Option(
        "--reanchoring",
        help="Add a C header that turns joint frames at run time, where their angles are parameters.",
    ),
]
ParametersByState = Annotated[
    bool,
    typer.Option(
        "--parameters-by-state",
        help="Let each state of a batch have its own run-time parameters, a row of the array `prepared`.",
    ),
]
NoBatches = Annotated[
    bool,
    typer.Option(
        "--no-batches",
        help="Leave out the functions for many states at once, as on a microcontroller.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
JsonFile = Annotated[
    Path | None,
    typer.Option("--json", metavar="FILE", help="Write all numbers and the machine as JSON."),
]
Plot = Annotated[Path | None, typer.Option("--plot", metavar="FILE.svg", help="Draw the times as SVG.")]


def require_plot(path: Path | None, extra: str = BENCH) -> None:
    """Check, before minutes of measurement, that a plot can be drawn into `path`.

    Raises:
        OptionError: If the name of the file does not end in .svg.
        MissingError: If matplotlib is not installed; the message names the `extra` that brings it.
    """
    if path is not None:
        if path.suffix != ".svg":
            raise OptionError(f"--plot: {path} does not end in .svg.")
        require("matplotlib", extra)
