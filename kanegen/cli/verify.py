"""`kanegen verify`: the claims of a certificate, checked by generating, compiling and measuring again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.loading import load_system
from kanegen.cli.options import (
    AS_WRITTEN,
    Coordinates,
    FloatingBase,
    JointDynamics,
    Lock,
    RightAngles,
    Speeds,
)
from kanegen.cli.terminal import FAILED, progress
from kanegen.extras import require
from kanegen.studies.tradeoff import EXTRA, NEEDS


def verify(
    certificate: Annotated[
        Path,
        typer.Argument(
            metavar="CERTIFICATE", help="The certificate, a .json file beside the C.", show_default=False
        ),
    ],
    model: Annotated[
        Path | None,
        typer.Option(
            "--model", metavar="MODEL", help="Model that the C should be for, .toml, .urdf or .xml."
        ),
    ] = None,
    states: Annotated[
        int | None,
        typer.Option(min=1, help="Number of fresh states; by default that of the certificate's validation."),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the fresh states.")] = 1,
    floating_base: FloatingBase = False,
    joint_dynamics: JointDynamics = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
    lock: Lock = None,
) -> None:
    """Check the CERTIFICATE that `kanegen generate` wrote with a budget.

    Generates and compiles the variant again, compares the C, its results and its worst states with those of
    the certificate, and measures its error in fresh states. Times are not measured again. The exit status is
    1 if a claim does not hold. Needs `pip install 'kanegen[study]'`.
    """
    for package in NEEDS:
        require(package, EXTRA)
    from kanegen.cli import budget

    system = (
        None
        if model is None
        else load_system(model, floating_base, right_angles, speeds, coordinates, lock, joint_dynamics)
    )
    with progress() as report:
        found = budget.verify(certificate, system, states, seed, report)
    budget.show_verification(certificate, found)
    if not found.passed:
        raise typer.Exit(FAILED)
