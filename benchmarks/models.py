"""The standard models of the benchmarks."""

from __future__ import annotations

import warnings
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np

import kanegen as kg

EIGHT_BODY = Path(__file__).parents[1] / "models" / "eight_body.toml"
ROBOTS = {"ur5": "ur5_robot", "panda": "panda", "baxter": "baxter"}
FLOATING = {"hyq": "hyq_no_sensors", "talos_reduced": "talos_reduced"}

FURTHER = {"g1": "g1_29dof_rev_1_0", "go2": "go2"}
"""Floating robots that studies take by name alone."""

NAMES = (*ROBOTS, *FLOATING, "eight_body", "chain64")


def system(name: str) -> kg.System:
    """Return the system `name`, one of `NAMES` or `FURTHER`, without loads, which not every peer takes.

    A chain may have any number of links, as in "chain256".
    """
    if name == "eight_body":
        loaded = kg.load(EIGHT_BODY)
        return replace(loaded, bodies=tuple(replace(body, loads=False) for body in loaded.bodies))
    if name.startswith("chain"):
        return revolute_chain(int(name.removeprefix("chain")))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", kg.KanegenWarning)
        if stem := (FLOATING | FURTHER).get(name):
            return replace(kg.load(_urdf(stem), floating_base=True), name=name)
        return replace(kg.load(_urdf(ROBOTS[name])), name=name)


def revolute_chain(links: int) -> kg.System:
    """Return a chain of hinges about axes 1, 2, 3, 1, ... in turn, with asymmetrical links."""
    rng = np.random.default_rng(links)
    points = rng.uniform(-0.1, 0.1, (links, 6, 3))
    points -= points.mean(axis=1, keepdims=True)
    second = np.einsum("kpi,kpj->kij", points, points) / 6
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    free = np.zeros((links, 6), dtype=bool)
    free[np.arange(links), np.arange(links) % 3] = True
    return kg.System.from_arrays(
        connection=range(links),
        mass=np.ones(links),
        inertia=inertia,
        mass_center=rng.uniform(-0.1, 0.1, (links, 3)),
        joint_position=rng.uniform(-0.2, 0.2, (links, 3)),
        free=free,
        name=f"chain{links}",
    )


def _urdf(stem: str) -> Path:
    files = metadata.files("example-robot-data") or []
    (file,) = [file for file in files if file.name == f"{stem}.urdf"]
    return Path(str(file.locate()))
