"""The page: a handle that turns over and over, computed by three formulations at once, beside a reference."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

import kanegen as kg
from kanegen.browser.page import Competitor, Formulation, Start, WebPage, reference_of
from kanegen.browser.starts import State
from kanegen.model.system import System
from kanegen.options import STRICT, Progress, quiet
from kanegen.viewer.making import scene_of

MODEL = Path(__file__).parent / "t_handle.toml"

SPIN = 6.0
"""Speed about the stem (rad/s)."""

DISTURBANCES = (1e-3, 1e-2, 1e-1)
"""Speeds about the bar over that about the stem: the smaller, the nearer the axes come to gimbal lock."""

STEP = 1e-3
"""Length of a step (s)."""

QUARTER_TURN = 0.4
"""Time in which the handle passes gimbal lock for the first time (s)."""

FORMULATIONS = {
    "angle rates": (
        "angles",
        "angle_rates",
        "Three angles and their rates: [A] is singular in gimbal lock, and accelerations have no bound near "
        "it.",
    ),
    "angular velocity": (
        "angles",
        "angular_velocity",
        "Three angles and the components of the angular velocity: accelerations stay small, but the rates of "
        "the angles have no bound near gimbal lock.",
    ),
    "quaternion": (
        "quaternion",
        "angular_velocity",
        "A quaternion and the components of the angular velocity: no orientation is special.",
    ),
}
"""Coordinates, speeds and one sentence by the name of a formulation; the last one is the reference's."""

NOTES = (
    "A handle in the shape of a T turns about its stem, the axis of middle inertia. It turns over again and "
    "again. Twice a turn it takes the middle one of the 1-2-3 angles to a right angle, where two of "
    "their axes coincide: gimbal lock.",
    "The three motions begin in one state and make the same steps of the classical Runge-Kutta method, in "
    "double precision. They differ in nothing but coordinates and speeds. What computes them is C that "
    "kanegen generates, compiled to WebAssembly.",
    "The error is the largest angle (rad) or distance (m) between a body and where the reference has it: a "
    "motion with a quaternion, in double-double arithmetic and in shorter steps.",
)


def gimbal_lock(progress: Progress = quiet) -> WebPage:
    """Return the page of the demonstration."""
    system = kg.load(MODEL)
    systems = [_formulated(system, *choices) for *choices, _ in FORMULATIONS.values()]
    formulations, competitors = [], []
    for place, (name, one) in enumerate(zip(FORMULATIONS, systems, strict=True)):
        progress(name)
        formulations.append(Formulation.of(one, scene_of(one)))
        competitors.append(Competitor.of(name, FORMULATIONS[name][-1], place, one, STRICT))
    progress("double-double")
    return WebPage(
        title="Passing gimbal lock",
        subtitle="One motion of a T-handle in three formulations, computed in this page",
        formulations=formulations,
        competitors=competitors,
        reference=(len(systems) - 1, reference_of(systems[-1])),
        substeps=4,
        starts=[_start(systems, disturbance) for disturbance in DISTURBANCES],
        start_title="First passage",
        pictures=range(len(systems)),
        step=STEP,
        notes=NOTES,
    )


def _formulated(system: System, coordinates: str, speeds: str) -> System:
    """Return a system in other coordinates and speeds."""
    found = system if coordinates == "angles" else system.with_coordinates(coordinates)
    return found if coordinates == "quaternion" else found.with_speeds(speeds)


def _start(systems: list[System], disturbance: float) -> Start:
    """Return the start with a disturbance: all angles are zero, so the speeds are the same for everyone."""
    y = [disturbance * SPIN, SPIN, 0.0]
    states = [State([float(value) for value in system.neutral_coordinates], y) for system in systems]
    nearest = math.degrees(_nearest(systems[-1], states[-1]))
    return Start(f"{nearest:.2g}° from gimbal lock", states)


def _nearest(system: System, state: State) -> float:
    """Return how near the middle angle comes to a right angle in the first quarter of a turn (rad)."""
    library = kg.build(system, ("rollout_rk4", "body_poses"))
    rollout = library.rollout(state.x, state.y, steps=round(QUARTER_TURN / STEP), step=STEP)
    sines = np.abs(library.body_poses(rollout.x)[:, 0, 2, 0])
    return float(math.pi / 2 - np.arcsin(np.minimum(sines, 1.0)).max())
