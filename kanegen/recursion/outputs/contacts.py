"""The part of the table of outputs about the motion of a system whose contacts hold."""

from __future__ import annotations

from kanegen.model.system import System
from kanegen.program.ir import Array, RowCondition
from kanegen.recursion.outputs.inputs import LOADS
from kanegen.recursion.outputs.output import OfSolution, Output, Subject
from kanegen.recursion.solution import Solution

CONTACTS = Subject(
    lambda system: system.contacts,
    'has no contacts. Give it some in the model file, such as [[contact]] with frame = "foot", or choose '
    "them by --contacts or System.with_contacts.",
)


def _independent(system: System) -> RowCondition:
    """Return the condition under which the loads of contacts exist."""
    return RowCondition(
        "pivot of the contacts",
        "rows before it hold this direction already",
        "rows before it nearly hold this direction, so that a damping of the contact helps",
        "held directions of contacts",
        len(system.rows_of_frames),
    )


HELD = (
    Output(
        "contact_dynamics",
        lambda system: Array(
            "contact_acceleration",
            (len(system.freedoms),),
            "rad/s^2, m/s^2",
            "{ydot} where all contacts hold, so that what they hold does not accelerate",
            of_freedoms=True,
            row_condition=_independent(system),
        ),
        ("x", "y", "tau", *LOADS),
        OfSolution(Solution.contact_dynamics, is_refined=True),
        CONTACTS,
    ),
    Output(
        "contact_forces",
        lambda system: Array(
            "contact_force",
            (len(system.contact_rows),),
            "N m, N",
            "what contacts exert on the bodies to hold them: moments about held origins, then forces, "
            "inertial components",
            row_condition=_independent(system),
        ),
        ("x", "y", "tau", *LOADS),
        OfSolution(Solution.contact_forces, is_refined=True),
        CONTACTS,
    ),
)
"""The entries about contacts, in the order of the generated C."""

OF_CONTACTS = (*(output.name for output in HELD), "contact_dynamics_derivatives")
"""The outputs that need the loads of contacts."""
