"""The motion of `make view`: the arm of the examples stays clear of its stand and above the ground."""

from __future__ import annotations

import re
import shlex
import warnings

import numpy as np

import kanegen as kg
from tests.support.paths import ROOT


def option(words: list[str], name: str) -> str:
    """Return the value of an option of a command line."""
    return words[words.index(name) + 1]


def test_the_arm_of_make_view_stays_clear_of_its_stand_and_within_its_limits() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8").replace("\\\n", " ")
    (line,) = re.findall(r"kanegen (view \S+ --duration .*)", makefile)
    words = shlex.split(line)
    arm = kg.load(ROOT / words[1])
    arm = arm.with_points({"elbow": ("upper_arm", (0.4, 0, 0)), "end": ("tool", (0, 0, 0))})
    speed, _, value = option(words, "--y").partition("=")
    assert option(words, "--path") in arm.frame_names
    library = kg.build(arm, outputs=("forward_dynamics", "point_positions"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of limits that are exceeded
        times = np.linspace(0.0, float(option(words, "--duration")), 601)
        motion = kg.simulate(library, None, {speed: float(value)}, times, method="RK4", step=1e-3)
    elbow, tool = np.moveaxis(library.point_positions(motion.x), 1, 0)
    for place, clearance in ((elbow, 0.05), (tool, 0.03)):  # m, half the thickness of what is there
        assert np.hypot(place[:, 0], place[:, 1]).min() > 0.07 + clearance  # the radius of the stand
        assert place[:, 2].min() > -0.525 + clearance  # the foot of the stand
