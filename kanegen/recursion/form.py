"""Derives the outputs that are asked for, one recursion each, on shared definitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from kanegen.recursion import factorisation, forward_dynamics
from kanegen.recursion.derived import Derived
from kanegen.recursion.first_moment import mass_center, potential_energy
from kanegen.recursion.forcing import forcing, inverse_dynamics
from kanegen.recursion.mass_matrix import mass_matrix
from kanegen.recursion.momentum import kinetic_energy, momentum
from kanegen.recursion.poses import body_poses
from kanegen.recursion.tree import Tree, tree
from kanegen.symbolic.definitions import Definition
from kanegen.system import System

Recursion = Callable[[Tree], Derived]

RECURSIONS: dict[str, dict[str, Recursion]] = {
    "mass_matrix": {"composite bodies": mass_matrix},
    "forcing": {"recursion of forces": forcing},
    "inverse_dynamics": {"recursion of forces": inverse_dynamics},
    "forward_dynamics": {
        "articulated bodies": forward_dynamics.forward_dynamics,
        "factorisation": factorisation.forward_dynamics,
    },
    "kinetic_energy": {"velocities of the bodies": kinetic_energy},
    "potential_energy": {"first moments of mass": potential_energy},
    "momentum": {"velocities of the bodies": momentum},
    "mass_center": {"first moments of mass": mass_center},
    "body_poses": {"turns of the joints": body_poses},
}
"""The ways to derive each output, by name."""

Methods = Mapping[str, str]
"""For every output the way that is taken."""


@dataclass(frozen=True)
class RecursiveForm:
    """Outputs in terms of definitions.

    Attributes:
        system: What was derived.
        methods: How.
        definitions: In order of evaluation; every expression is small.
        outputs: By name of output.
    """

    system: System
    methods: Methods
    definitions: tuple[Definition, ...]
    outputs: dict[str, Derived]


def methods(system: System, outputs: Sequence[str], solver: str = "cheapest") -> tuple[Methods, ...]:
    """The ways to derive `outputs` among which the operation count may choose.

    Args:
        system: The tree.
        outputs: Names of outputs.
        solver: The way to {ydot}, or "cheapest" for any that loses no accuracy.
    """
    first = {name: next(iter(RECURSIONS[name])) for name in outputs}
    if "forward_dynamics" not in outputs:
        return (first,)
    if solver in RECURSIONS["forward_dynamics"]:
        return ({**first, "forward_dynamics": solver},)
    if factorisation.worth_trying(system):
        return first, {**first, "forward_dynamics": "factorisation"}
    return (first,)


def recursive_form(system: System, methods: Methods) -> RecursiveForm:
    """Derive outputs together, sharing every intermediate.

    Args:
        system: The tree.
        methods: The outputs, and how to derive each: keys of `RECURSIONS`.
    """
    prepared = tree(system)
    outputs = {name: RECURSIONS[name][way](prepared) for name, way in methods.items()}
    return RecursiveForm(system, methods, prepared.definitions.listed(), outputs)
