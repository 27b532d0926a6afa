"""Hints: the known name that a word misspells, never one that means something else."""

from __future__ import annotations

import pytest

from kanegen.choices import did_you_mean
from kanegen.model.coordinates import FREEDOMS, SEQUENCES
from kanegen.recursion.outputs import OUTPUTS


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("mas_matrix", "mass_matrix"),
        ("massmatrix", "mass_matrix"),
        ("Forcing", "forcing"),
        ("forcing_derivative", "forcing_derivatives"),
        ("inverse-dynamics", "inverse_dynamics"),
        ("point_velocity", "point_velocities"),
        ("kinetic", "kinetic_energy"),
        ("poses", "body_poses"),
    ],
)
def test_misspelt_outputs(word: str, meant: str) -> None:
    assert did_you_mean(word, OUTPUTS) == f"Did you mean {meant!r}?"


@pytest.mark.parametrize(
    ("word", "known"),
    [
        ("tanh", ["tan2", "cos"]),
        ("theta4", FREEDOMS),
        ("s4", FREEDOMS),
        ("3-3-1", SEQUENCES),
        ("arm.theta2", ["arm.theta1", "arm.s2"]),
        ("left_knee_joint", ["right_knee_joint", "left_hip_joint", "left_ankle_joint"]),
        ("panda_hand", ["panda_link7", "panda_link8"]),
        ("x", ["y", "z"]),
        ("rotor_x", ["rotor_y"]),
        ("aa", ["a", "b"]),
        ("energy", OUTPUTS),
        ("dynamics", OUTPUTS),
        ("forward_energy", OUTPUTS),
        ("forward_dynamics_derivative", ["forcing_derivatives", "inverse_dynamics_derivatives"]),
        ("potential_momentum", OUTPUTS),
        ("", ["a"]),
        ("__", ["_", "a"]),
        ("x" * 300, ["x" * 299]),
    ],
)
def test_other_quantities_are_not_proposed(word: str, known: list[str]) -> None:
    """Numbers, sides, axes and kinds of quantities tell things apart; all known ones are listed instead."""
    assert did_you_mean(word, known).startswith("Known are ")


def test_the_nearest_is_proposed() -> None:
    assert did_you_mean("shouldr_pan", ["shoulder_pan", "shoulder_pin"]) == "Did you mean 'shoulder_pan'?"
    assert did_you_mean("forcing_vpj", OUTPUTS) == "Did you mean 'forcing_jvp' or 'forcing_vjp'?"
    assert did_you_mean("pen", ["pan", "pin", "pot"]) == "Did you mean 'pan' or 'pin'?"
    assert did_you_mean("knee", ["left.knee", "left.hip"]) == "Did you mean 'left.knee'?"
    assert did_you_mean("ellbow", []) == "None is known."
