"""The modules of kanegen that a new kind of joint changes."""

from __future__ import annotations

JOINT_KINDS = {
    "model/coordinates.py": "the kinds of rotations and their coordinates",
    "symbolic/literal/orientation.py": "rotation matrix and rates, literally",
    "recursion/turns.py": "rotation matrix and rates, by recursion",
    "recursion/meanings.py": "what the names in generated code mean",
    "reference/matrices.py": "rotation matrix in NumPy",
    "reference/kinematics.py": "its place among the equations of the notes",
    "measure/truth/tree.py": "the state of a joint, and rotations by the first algorithm",
    "measure/truth/newton_euler.py": "rotations by the second algorithm",
    "viewer/joints.py": "which coordinates turn a body, for the script of pages",
    "studies/tradeoff/evaluator.py": "the same orientation in other coordinates",
}
"""Modules, below `kanegen/`, that a new kind of joint changes, with what they say about one."""
