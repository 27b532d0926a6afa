"""Interop: other programs of rigid-body dynamics, and programs that call the generated code.

A program of rigid-body dynamics has a module whose `state_map` compares its model with a system, by the names
of joints and bodies, and returns a `StateMap`, which converts both ways. `docs/conventions.md` has the
conventions side by side. Such a module may import the model and the reference, and no other program: it reads
models that a caller passes.

A program that calls the generated code, such as CasADi or JAX, has a module which compiles that code with an
interface that this program knows. It is imported by its own name, such as `kanegen.interop.casadi`.
"""

from __future__ import annotations

from kanegen.interop import mujoco, pinocchio

__all__ = ["mujoco", "pinocchio"]
