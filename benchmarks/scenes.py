"""Five scenes and the costs that their programs save, written into docs/scenes.md.

python -m benchmarks.scenes [--rounds R] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks import cost_reports
from kanegen import compiler
from kanegen.c import description, render
from kanegen.files import write_whole
from kanegen.library import load
from kanegen.measure.machine import Machine
from kanegen.options import TIERS
from kanegen.studies.explain import cost_report
from kanegen.studies.explain.general_form import steps
from kanegen.studies.explain.tables import bodies, heads, rows
from kanegen.studies.markdown import markdown_table

FAST = TIERS["fast"]
STATES = 256
"""Number of states of the batch that is timed."""

INTRODUCTION = """\
Written by `make scenes` (`python -m benchmarks.scenes`); do not edit it by hand. `kanegen explain MODEL`
prints the same for one model. The first row of a table is the general program of the tree; every further
row leaves out one thing more. *operations* are those of one evaluation; *once* are those that depend on
parameters alone and run once for each set of parameters; *inputs* are the numbers that an evaluation reads;
*compiling* is the time for the functions of one state at -O2. Run times are those of a state in a batch of
the tier *fast*; the general and the specialised program were timed in turns."""


@dataclass(frozen=True)
class Scene:
    """A model of models/ and the text about it.

    Attributes:
        title: Title of the section.
        sentence: Sentence about the scene.
        name: Name of the model.
    """

    title: str
    sentence: str
    name: str

    @property
    def model(self) -> Path:
        """The file of the model."""
        return cost_reports.ROOT / "models" / f"{self.name}.toml"


SCENES = (
    Scene(
        "A gantry crane with a swinging load",
        "Bridge, trolley, a rope with two angles of swing, and a load that is hoisted along it.",
        "gantry_crane",
    ),
    Scene(
        "A satellite with two hinged panels",
        "No gravity; only energy and momentum are wanted.",
        "satellite",
    ),
    Scene(
        "The Panda arm with a locked gripper and one tool point",
        "Forward dynamics, and where the tool is.",
        "panda_arm",
    ),
    Scene(
        "A planar double pendulum",
        "Two rods on three-axis joints, locked to a plane.",
        "planar_pendulum",
    ),
    Scene(
        "The eight bodies of the notes, of which three move",
        "Bodies 4 to 8 are welded to those that carry them.",
        "front_of_eight",
    ),
)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scenes", description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--docs", type=Path, default=cost_reports.ROOT / "docs")
    options = parser.parse_args()
    parts = [
        "# Scenes and what their programs save",
        INTRODUCTION,
    ]
    for scene in SCENES:
        print(scene.title, flush=True)
        parts += _section(scene, options.rounds)
    parts += ["## Machine", "\n".join(f"- {line}" for line in Machine.here().lines())]
    write_whole(options.docs / "scenes.md", "\n\n".join(parts) + "\n")


def _section(scene: Scene, rounds: int) -> list[str]:
    system, wanted = kg.load(scene.model), cost_reports.outputs(scene.model)
    found = cost_report(system, wanted, timed=True)
    (_, general), *_ = steps(system)
    slow, fast = _times([general, system], wanted, rounds)
    before, after = found.steps[0].total, found.steps[-1].total
    return [
        f"## {scene.title}",
        f"{scene.sentence} Outputs: {', '.join(wanted)}. The model is "
        f"[models/{scene.name}.toml](../models/{scene.name}.toml), its cost report "
        f"[models/{scene.name}.md](models/{scene.name}.md).",
        markdown_table(heads(found), rows(found)),
        f"The program takes {after} operations, the general program of the same tree {before}: "
        f"1/{found.ratio:.1f}. "
        f"A state takes {fast:.0f} ns instead of {slow:.0f} ns: 1/{slow / fast:.1f}.",
        f"Operations by body: {', '.join(f'{name} ({cost})' for name, cost in bodies(found))}.",
    ]


def _times(systems: list[kg.System], outputs: tuple[str, ...], rounds: int) -> list[float]:
    """Return nanoseconds of a state in a batch for each system: medians of rounds in which all take turns."""
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
    """Compile the C of a system, also of a general program whose [A] is singular in every state."""
    made = compiler.compile_module(system, outputs, variant=FAST, regular=False)
    words = {"refinement": made.refinement}
    return load(render(description(system), made.module, made.operations, FAST, words))


if __name__ == "__main__":
    main()
