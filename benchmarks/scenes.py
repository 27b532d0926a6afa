"""Five scenes and what they do without: writes docs/scenes.md.

python -m benchmarks.scenes [--rounds R] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks import models
from kanegen import compiler
from kanegen.bench import machine
from kanegen.c import render
from kanegen.files import write_whole
from kanegen.library import load
from kanegen.receipt import Receipt, receipt
from kanegen.receipt.general import steps
from kanegen.receipt.tables import heads, rows
from kanegen.variant import TIERS

DOCS = Path(__file__).parents[1] / "docs"
MODELS = Path(__file__).parents[1] / "models"
FAST = TIERS["fast"]
STATES = 256
"""Of a batch, whose evaluation is timed."""

FIXED = (False,) * 6

INTRODUCTION = """\
Written by `python -m benchmarks.scenes`; nobody edits it by hand. `kanegen explain MODEL` says the same of
one model. *once*: operations that depend on parameters alone. *compiling*: of the functions for one state, at
-O2. Times are those of a state in a batch of the tier *fast*, general and specialised code taking turns."""


@dataclass(frozen=True)
class Scene:
    """A model and what is wanted of it.

    Attributes:
        title: Of its section.
        words: What it is.
        system: Makes it.
        outputs: What is wanted.
    """

    title: str
    words: str
    system: Callable[[], kg.System]
    outputs: tuple[str, ...]


def panda() -> kg.System:
    """The arm with both fingers locked and a point between them."""
    arm = models.system("panda")
    fingers = tuple(
        replace(body, joint=replace(body.joint, free=FIXED)) if "finger" in body.name else body
        for body in arm.bodies
    )
    return replace(arm, bodies=fingers).with_points({"tool": ("panda_link7", (0.0, 0.0, 0.21))})


def pendulum() -> kg.System:
    """Two rods that hang on three-axis joints, locked to a plane: axis 1 points down, axis 3 out of it."""
    free = np.zeros((2, 6), dtype=bool)
    free[:, 2] = True
    return kg.System.from_arrays(
        connection=(0, 1),
        mass=(1.2, 0.8),
        inertia=[np.diag([0.001, 0.04, 0.04]), np.diag([0.0006, 0.02, 0.02])],
        mass_center=[(0.3, 0.0, 0.0), (0.25, 0.0, 0.0)],
        joint_position=[(0.0, 0.0, 0.0), (0.6, 0.0, 0.0)],
        free=free,
        gravity=(9.81, 0.0, 0.0),
        name="planar_pendulum",
    )


def front() -> kg.System:
    """The eight bodies of the notes, of which 4 to 8 are welded."""
    eight = models.system("eight_body")
    welded = tuple(replace(body, joint=replace(body.joint, free=FIXED)) for body in eight.bodies[3:])
    return replace(eight, bodies=(*eight.bodies[:3], *welded), name="front_of_eight")


EQUATIONS = ("mass_matrix", "forcing")

SCENES = (
    Scene(
        "A gantry crane with a swinging load",
        "Bridge, trolley, a rope with two angles of swing, and a load that is hoisted along it.",
        lambda: kg.load(MODELS / "gantry_crane.toml"),
        EQUATIONS,
    ),
    Scene(
        "A satellite with two hinged panels",
        "No gravity; only energy and momentum are wanted.",
        lambda: kg.load(MODELS / "satellite.toml"),
        ("kinetic_energy", "momentum"),
    ),
    Scene(
        "The Panda arm with a locked gripper and one tool point",
        "Forward dynamics, and where the tool is.",
        panda,
        ("forward_dynamics", "point_positions"),
    ),
    Scene(
        "A planar double pendulum",
        "Two rods on three-axis joints, locked to a plane.",
        pendulum,
        EQUATIONS,
    ),
    Scene(
        "The eight bodies of the notes, of which three move",
        "Bodies 4 to 8 are welded to those that carry them.",
        front,
        EQUATIONS,
    ),
)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scenes", description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--docs", type=Path, default=DOCS)
    options = parser.parse_args()
    parts = [
        "# What scenes do without",
        INTRODUCTION,
    ]
    for scene in SCENES:
        print(scene.title, flush=True)
        parts += _section(scene, options.rounds)
    parts += ["## Machine", "\n".join(f"- {line}" for line in machine.description())]
    write_whole(options.docs / "scenes.md", "\n\n".join(parts) + "\n")


def _section(scene: Scene, rounds: int) -> list[str]:
    system = scene.system()
    found = receipt(system, scene.outputs, timed=True)
    (_, general), *_ = steps(system)
    slow, fast = _times([general, system], scene.outputs, rounds)
    before, after = found.steps[0].total, found.steps[-1].total
    return [
        f"## {scene.title}",
        f"{scene.words} Outputs: {', '.join(scene.outputs)}.",
        _table(heads(found), rows(found)),
        f"{after} operations where the general program of the same tree takes {before}: 1/{found.ratio:.1f}. "
        f"A state takes {fast:.0f} ns where it takes {slow:.0f}: 1/{slow / fast:.1f}.",
        _bodies(found),
    ]


def _bodies(found: Receipt) -> str:
    names = {0: "all", **{k: body.name for k, body in enumerate(found.system.bodies, start=1)}}
    costs = sorted(found.bodies.items(), key=lambda item: -item[1])
    return "Of them go to " + ", ".join(f"{names[k]} {number}" for k, number in costs if number) + "."


def _times(systems: list[kg.System], outputs: tuple[str, ...], rounds: int) -> list[float]:
    """ns of a state in a batch, medians of rounds in which all take turns."""
    libraries = [_library(system, outputs) for system in systems]
    rng = np.random.default_rng(0)
    states = [rng.uniform(-0.5, 0.5, (STATES, len(system.coordinates))) for system in systems]
    speeds = [rng.uniform(-0.5, 0.5, (STATES, len(system.freedoms))) for system in systems]
    taken: list[list[float]] = [[] for _ in systems]
    for _ in range(rounds + 1):
        for library, x, y, times in zip(libraries, states, speeds, taken, strict=True):
            start = time.perf_counter()
            for _ in range(8):
                library.evaluate(x, y)
            times.append((time.perf_counter() - start) / (8 * STATES))
    return [1e9 * float(np.median(times[1:])) for times in taken]


def _library(system: kg.System, outputs: tuple[str, ...]) -> kg.Library:
    """Compiled; the general program may have an [A] that is singular in every state."""
    made = compiler.compile_module(system, outputs, variant=FAST, regular=False)
    words = {"refinement": made.refinement}
    return load(render(compiler.facts(system), made.module, made.operations, FAST, words))


def _table(head: list[str], lines: list[list[str]]) -> str:
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, rule, *lines))


if __name__ == "__main__":
    main()
