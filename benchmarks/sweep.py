"""Times a sweep on threads and on Dask beside bare calls of its C, and writes docs/sweep-times.md.

    python -m benchmarks.sweep [--rows R] [--duration S] [--workers W] [--rounds N] [--file FILE]

Run it on a quiet machine. The full sweep takes about 40 s on each of two cores, three times a round.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from distributed import Client, LocalCluster

import kanegen as kg
from kanegen.files import write_whole
from kanegen.measure.machine import Machine
from kanegen.studies.markdown import markdown_table
from kanegen.sweeps.design import read_design
from kanegen.sweeps.plan import Plan, make_plan

ROOT = Path(__file__).parents[1]
MODEL = ROOT / "models" / "double_pendulum.toml"
STEP = 1e-3
AXES = {
    "m2": {"uniform": [0.25, 1.0]},
    "x.q1": {"uniform": [-3.0, 3.0]},
    "x.q2": {"uniform": [-3.0, 3.0]},
}

HEAD = """# Times of a sweep

`python -m benchmarks.sweep` writes this page: {rows} runs of the double pendulum of {duration:g} s in steps
of 1 ms by RK4, each with a mass and an initial state of its own, on {workers} cores. *C alone* calls
`library.rollout` for the same chunks on as many threads, and keeps nothing. The others are `kg.sweep` as a
user calls it: it generates the code, finds it compiled in the cache, and keeps the last states in Parquet
files. *scheduling* is the share of the time that *C alone* does not need. Times are medians of {rounds}
rounds, in each of which everything has a turn; *range* is that of the rounds.
"""


def main() -> None:
    """Time everything in turns, print the page, and write it."""
    options = _options()
    system = kg.load(MODEL)
    job = kg.RolloutJob(options.duration, STEP)
    samples = kg.Sampling(options.rows, "random")
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(
            n_workers=options.workers, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        Client(cluster) as client,
    ):
        target = Path(folder)
        plan = make_plan(system, read_design(system, AXES, samples), job, "parquet")

        def swept(executor: Any, count: kg.Sampling) -> Callable[[], None]:
            def run() -> None:
                place = Path(tempfile.mkdtemp(dir=target)) / "sweep"
                workers = options.workers if executor is None else None
                kg.sweep(system, AXES, job, executor, samples=count, folder=place, workers=workers)

            return run

        participants = {
            "C alone": lambda: _bare(plan, options.workers),
            f"`kg.sweep`, {options.workers} threads": swept(None, samples),
            f"`kg.sweep`, Dask, {options.workers} processes": swept(client, samples),
        }
        swept(
            client, kg.Sampling(4 * plan.manifest["chunk_rows"], "random")
        )()  # the workers load the library
        times = _in_turns(participants, options.rounds)
    page = _document(times, options, plan)
    print(page)
    write_whole(options.file, page)


def _bare(plan: Plan, workers: int) -> None:
    """Call the C for all chunks on some threads."""
    program, rows = plan.programs[0], plan.manifest["chunk_rows"]
    steps = program.job.count_of_steps()

    def call(first: int) -> None:
        columns = plan.design.columns(first, min(first + rows, plan.design.rows))
        x, y = program.inputs.first_state(columns, len(columns["m2"]))
        program.library.rollout(
            x, y, steps=steps, step=STEP, every=steps, parameters=program.inputs.parameter_sets(columns)
        )

    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(call, range(0, plan.design.rows, rows)))


def _in_turns(participants: Mapping[str, Callable[[], None]], rounds: int) -> dict[str, list[float]]:
    """Return the seconds of each participant in every round."""
    times: dict[str, list[float]] = {name: [] for name in participants}
    for number in range(rounds):
        for name, run in participants.items():
            print(f"round {number + 1} of {rounds}: {name}", file=sys.stderr, flush=True)
            start = time.perf_counter()
            run()
            times[name].append(time.perf_counter() - start)
    return times


def _document(times: Mapping[str, list[float]], options: argparse.Namespace, plan: Plan) -> str:
    """Return the page."""
    machine = Machine.here()
    steps = plan.programs[0].job.count_of_steps()
    bare = statistics.median(times["C alone"])
    rows = []
    for name, found in times.items():
        median = statistics.median(found)
        spread = f"{min(found):.2f}-{max(found):.2f}"
        share = "" if median is bare else f"{100 * (1 - bare / median):.1f} %"
        of_a_step = 1e9 * median * options.workers / (options.rows * steps)
        rows.append(
            [name, f"{median:.2f}", spread, f"{options.rows / median:.0f}", f"{of_a_step:.1f}", share]
        )
    head = ["", "s", "range", "rows/s", "ns a step on a core", "scheduling"]
    text = HEAD.format(
        rows=options.rows, duration=options.duration, workers=options.workers, rounds=options.rounds
    )
    chunk = plan.manifest["chunk_rows"]
    count = -(-options.rows // chunk)
    end = "\n".join([f"{count} chunks of {chunk} rows each.", *machine.lines()])
    return f"{text}\n{markdown_table(head, rows)}\n\n{end}\n"


def _options() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.sweep", description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=100_000)
    parser.add_argument("--duration", type=float, default=10.0, help="simulated time of a row, s")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--file", type=Path, default=ROOT / "docs" / "sweep-times.md")
    return parser.parse_args()


if __name__ == "__main__":
    main()
