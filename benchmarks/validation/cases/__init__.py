"""The cases, one module each with a function `case`, in the order of the document."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from benchmarks.validation.case import Case
from benchmarks.validation.cases import (
    floating_base,
    flyball_governor,
    free_rigid_body,
    furuta_pendulum,
    heavy_top,
    hinged_panels,
    plate_pendulum,
    puma560,
    simple_pendulum,
    simple_tree,
    space_station,
    tumbling_brick,
)


@dataclass(frozen=True)
class Study:
    """How a case is computed.

    Attributes:
        full: Function for the whole case.
        quick: Function for a part of it that takes at most a few seconds.
    """

    full: Callable[[], Case]
    quick: Callable[[], Case]


CASES = {
    "plate_pendulum": Study(plate_pendulum.case, partial(plate_pendulum.case, certain=False)),
    "heavy_top": Study(heavy_top.case, partial(heavy_top.case, certain=False)),
    "puma560": Study(puma560.case, puma560.case),
    "simple_tree": Study(simple_tree.case, simple_tree.case),
    "floating_base": Study(floating_base.case, floating_base.case),
    "furuta_pendulum": Study(furuta_pendulum.case, furuta_pendulum.case),
    "simple_pendulum": Study(simple_pendulum.case, partial(simple_pendulum.case, seconds=50.0)),
    "flyball_governor": Study(flyball_governor.case, partial(flyball_governor.case, last=1.0)),
    "free_rigid_body": Study(free_rigid_body.case, free_rigid_body.case),
    "tumbling_brick": Study(tumbling_brick.case, tumbling_brick.case),
    "hinged_panels": Study(hinged_panels.case, hinged_panels.case),
    "space_station": Study(space_station.case, space_station.case),
}
"""Every case by its name."""
