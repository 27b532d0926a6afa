"""The part of the table of outputs about the operational inertia of the frames that a system selects."""

from __future__ import annotations

from kanegen.errors import quoted
from kanegen.model.system import System
from kanegen.program.ir import INVERTIBLE, Array, RowCondition
from kanegen.recursion.outputs.inputs import LOADS
from kanegen.recursion.outputs.kinematics import MOTIONS_OF_FRAMES
from kanegen.recursion.outputs.output import OfSolution, Output, Subject
from kanegen.recursion.solution import Solution
from kanegen.reference.operational import frame_without_six

SIX_DIRECTIONS = RowCondition(
    "pivot of J [A]^-1 J^T",
    "the frame cannot accelerate in this direction where it is held in those after it",
    "the frame is near a state in which it cannot accelerate in six independent directions",
    "six moments and forces on each frame",
)
"""The condition under which operational inertias exist."""


def _frames_with_six(system: System) -> tuple[str, ...]:
    """Return the frames that the system selects, if all of them can accelerate in six directions."""
    return () if frame_without_six(system) else system.pose_names


def _why_fewer(system: System) -> str:
    """Return the end of the error message for a system with a frame that cannot."""
    name, rank = frame_without_six(system) or ("", 0)
    return (
        f"has no operational inertia for frame {quoted(name)}, which accelerates in {rank} of six "
        "directions. Select other frames, with System.with_poses or --frames, or ask for "
        "operational_inertia_inverse."
    )


SIX = Subject(_frames_with_six, _why_fewer)

ANGULAR_FIRST = "angular rows, then those of its origin, inertial components"


def _matrices(system: System, name: str, unit: str, doc: str, condition: RowCondition | None = None) -> Array:
    """Return the array of an output with a matrix of six rows for each frame."""
    return Array(name, (len(system.pose_names), 6, 6), unit, doc, INVERTIBLE, row_condition=condition)


OPERATIONAL = (
    Output(
        "operational_inertia",
        lambda system: _matrices(
            system,
            "operational_inertia",
            "kg m^2, kg m, kg",
            "for each frame [Lambda] = (J [A]^-1 J^T)^-1, the wrench on it for a unit acceleration beside "
            f"its operational bias: {ANGULAR_FIRST}",
            SIX_DIRECTIONS,
        ),
        ("x",),
        OfSolution(Solution.operational_inertia),
        SIX,
    ),
    Output(
        "operational_inertia_inverse",
        lambda system: _matrices(
            system,
            "operational_inertia_inverse",
            "1/(kg m^2), 1/(kg m), 1/kg",
            "for each frame J [A]^-1 J^T, the acceleration that a unit wrench on it adds, with its J of "
            f"frame_jacobians: {ANGULAR_FIRST}",
        ),
        ("x",),
        OfSolution(Solution.operational_inertia_inverse),
    ),
    Output(
        "operational_bias",
        lambda system: Array(
            "operational_bias",
            (len(system.pose_names), 6),
            "N m, N",
            "for each frame the wrench that keeps it from accelerating, {w} of [Lambda]{a} + {bias} = {w} "
            f"for {{a}} = {{0}}, under {{tau}}, loads, gravity and {{y}}: {ANGULAR_FIRST}",
            condition=INVERTIBLE,
            row_condition=SIX_DIRECTIONS,
        ),
        ("x", "y", "tau", *LOADS),
        OfSolution(Solution.operational_bias),
        SIX,
    ),
)
"""The entries about operational inertia, in the order of the generated C."""

OPERATIONAL_NAMES = tuple(output.name for output in OPERATIONAL)
"""The names of these outputs."""

OF_FRAMES = (*MOTIONS_OF_FRAMES, *OPERATIONAL_NAMES)
"""The outputs with rows for each frame that the system selects."""
