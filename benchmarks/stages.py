"""Times of the stages from a model to a loaded library.

python -m benchmarks.stages [--outputs NAME,... | --derivatives] [--profile FILE] [--shared] [MODEL ...]

Every model is compiled in a new process with an empty cache. The command prints the seconds on the clock of
every stage and those that all processors spent, compilers included. The models are those of
`benchmarks.models`, with "g1" and "chain256". With --profile it writes what Python did, for `pstats`.
With --shared it then compiles code for models that differ in the numbers of their bodies, and prints what one
more of them costs.
"""

from __future__ import annotations

import argparse
import cProfile
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import kanegen as kg
from benchmarks import models
from kanegen.library.native import cache
from kanegen.model.numbers import map_numbers

EQUATIONS = ("mass_matrix", "forcing", "forward_dynamics")
DERIVATIVES = ("inverse_dynamics_derivatives", "forward_dynamics_derivatives")


def main() -> None:
    options = _arguments()
    for name in options.models:
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-c", "from benchmarks import stages; stages.measure()"]
            arguments = [
                name,
                ",".join(options.outputs),
                str(options.profile or ""),
                "shared" * options.shared,
            ]
            subprocess.run([*command, *arguments], check=True, env={**os.environ, cache.VARIABLE: folder})


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.stages", description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=["talos_reduced", "g1"], metavar="MODEL")
    parser.add_argument("--outputs", type=lambda text: tuple(text.split(",")), default=EQUATIONS)
    parser.add_argument("--derivatives", action="store_const", const=DERIVATIVES, dest="outputs")
    parser.add_argument("--profile", type=Path, metavar="FILE")
    parser.add_argument("--shared", action="store_true")
    return parser.parse_args()


def measure() -> None:
    """Print the times of the model and the outputs that the arguments of this process name."""
    name, outputs, profile, shared = sys.argv[1:]
    system = models.system(name)
    profiler = cProfile.Profile()
    if profile:
        profiler.enable()
    _build(name, system, outputs)
    if profile:
        profiler.disable()
        profiler.dump_stats(profile)
    if shared:
        _build_shared(name, system, outputs)


def _build(name: str, system: kg.System, outputs: str) -> kg.Library:
    """Build a library and print the times of the stages."""
    clock = Stages()
    library = kg.build(system, tuple(outputs.split(",")), progress=clock.begin)
    clock.begin("")
    counts = dict(library.source.operations)
    prepared = counts.pop("prepare")
    print(f"{name}, {outputs}: {sum(counts.values())} operations" + f", {prepared} once" * (prepared > 0))
    for stage in clock.elapsed:
        _print(stage, clock.elapsed[stage], clock.used[stage])
    _print("all", sum(clock.elapsed.values()), sum(clock.used.values()))
    return library


def _build_shared(name: str, system: kg.System, outputs: str) -> None:
    """Build a library for a system and others with other numbers of bodies, and print what another costs."""
    other = replace(system, bodies=tuple(map(_with_other_numbers, system.bodies)))
    shared = system.with_parameters_for(other)
    library = _build(f"{name} and others with other numbers", shared, outputs)
    clock = Stages("another")
    library.with_parameters(shared.parameters_for(other))
    clock.begin("")
    _print("another", clock.elapsed["another"], clock.used["another"])


def _with_other_numbers(body: kg.Body) -> kg.Body:
    """Return a body that is heavier and longer: every number of it that is not zero is another one."""
    position = map_numbers(body.joint.position, lambda length: 1.125 * length)
    return replace(
        body,
        mass=1.5 * body.mass,
        inertia=map_numbers(body.inertia, lambda moment: 2.0 * moment),
        mass_center=map_numbers(body.mass_center, lambda length: 1.125 * length),
        joint=replace(body.joint, position=position),
    )


class Stages:
    """Seconds of stages that follow each other, on the clock in `elapsed` and of processors in `used`."""

    def __init__(self, first: str = "conditioning") -> None:
        self.elapsed: defaultdict[str, float] = defaultdict(float)
        self.used: defaultdict[str, float] = defaultdict(float)
        self._stage, self._start, self._spent = first, time.perf_counter(), _spent()

    def begin(self, stage: str) -> None:
        """End the stage before, and begin another one."""
        now, spent = time.perf_counter(), _spent()
        self.elapsed[self._stage] += now - self._start
        self.used[self._stage] += spent - self._spent
        self._stage, self._start, self._spent = stage, now, spent


def _spent() -> float:
    """Return the seconds that processors spent for this process and for those that it has waited for."""
    return sum(os.times()[:4])


def _print(stage: str, elapsed: float, used: float) -> None:
    print(f"  {stage:12} {elapsed:8.2f} s on the clock, {used:8.2f} s of processors", flush=True)


if __name__ == "__main__":
    main()
