"""Where the checkout keeps what tests read."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[2]
"""The checkout."""

MODELS = ROOT / "models"
"""The model files, of which `generated/` holds the C."""

MODEL_FILES = sorted(MODELS.glob("*.toml"))
"""Every model file."""

PENDULUM = str(MODELS / "double_pendulum.toml")
"""The model file of a planar double pendulum, as an argument of a command."""

GENERATED = ROOT / "generated"
"""The committed C, a folder for each model."""

EVERY_JOINT = ROOT / "tests" / "readers" / "data" / "every_joint.urdf"
"""A URDF robot with a joint of every kind."""

FROM_REPORTS = ROOT / "tests" / "readers" / "data" / "from_reports"
"""Small robot files made from public bug reports about programs that read URDF."""
