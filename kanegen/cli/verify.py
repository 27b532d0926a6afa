"""`kanegen verify`: what a certificate says, made and measured anew."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kanegen.cli.loading import loaded
from kanegen.cli.options import Coordinates, FloatingBase, RightAngles, Speeds
from kanegen.cli.terminal import FAILED, progress, screen
from kanegen.extras import module
from kanegen.model.right_angles import AS_WRITTEN
from kanegen.studies.tradeoff import EXTRA as STUDY
from kanegen.studies.tradeoff import NEEDS


def verify(
    certificate: Annotated[
        Path, typer.Argument(metavar="CERTIFICATE", help="The .json beside the C.", show_default=False)
    ],
    model: Annotated[
        Path | None, typer.Option("--model", metavar="MODEL", help="What it should be of, .toml or .urdf.")
    ] = None,
    states: Annotated[
        int | None, typer.Option(min=1, help="Fresh states; by default as many as it was validated by.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of the fresh states.")] = 1,
    floating_base: FloatingBase = False,
    right_angles: RightAngles = AS_WRITTEN,
    speeds: Speeds = None,
    coordinates: Coordinates = None,
) -> None:
    """Make and measure anew what a CERTIFICATE of `generate` says; status 1 if something does not hold.

    Generates and compiles the variant, compares the C, its results and its worst states, and measures its
    error in states of its own. Times are not measured again. Needs `pip install 'kanegen[study]'`.
    """
    command = module("kanegen.cli.budget", *NEEDS, extra=STUDY)
    system = None if model is None else loaded(model, floating_base, right_angles, speeds, coordinates)
    with progress() as report:
        found = command.verify(certificate, system, states, seed, report)
    command.show_verification(certificate, found, screen)
    if not found.passed:
        raise typer.Exit(FAILED)
