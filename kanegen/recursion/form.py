"""Derives the outputs that are asked for, one recursion each, on shared definitions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sympy import Expr

from kanegen.recursion.forcing import forcing
from kanegen.recursion.joints import JointMotion, joint_motion
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.symbolic.definitions import Definition, Definitions
from kanegen.system import System

Recursion = Callable[[System, tuple[JointMotion, ...], Definitions], list[Expr]]

RECURSIONS: dict[str, Recursion] = {"mass_matrix": mass_matrix, "forcing": forcing}
"""How each output is derived."""


@dataclass(frozen=True)
class RecursiveForm:
    """Outputs in terms of definitions.

    Attributes:
        system: What was derived.
        definitions: In order of evaluation; every expression is small.
        outputs: Row-major entries by name of output.
    """

    system: System
    definitions: tuple[Definition, ...]
    outputs: dict[str, tuple[Expr, ...]]


def recursive_form(system: System, outputs: Sequence[str]) -> RecursiveForm:
    """Derive the named outputs together, sharing every intermediate.

    Args:
        system: The tree.
        outputs: Keys of `RECURSIONS`.
    """
    definitions = Definitions(taken=[parameter.name for parameter in system.parameters])
    motions = tuple(joint_motion(system, k, definitions) for k in range(1, system.number_of_bodies + 1))
    results = {name: tuple(RECURSIONS[name](system, motions, definitions)) for name in outputs}
    return RecursiveForm(system, definitions.listed(), results)
