"""Interop: states, forces and matrices between kanegen and other programs of rigid-body dynamics.

Each program has a module whose `state_map` compares its model with a system, by the names of joints and
bodies, and returns a `StateMap`, which converts both ways. `docs/conventions.md` has the conventions side by
side. A module here may import the model and the reference, and no other program: it reads models that a
caller passes.
"""

from __future__ import annotations

from kanegen.interop import mujoco, pinocchio

__all__ = ["mujoco", "pinocchio"]
