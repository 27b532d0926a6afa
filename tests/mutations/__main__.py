"""Runs the faults of the table and prints the score.

python -m tests.mutations [--only TEXT ...] [--every N] [--processes N] [--results FILE]
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue

from tests.mutations.faults import Fault, faults
from tests.mutations.runner import copy, is_seen, require_sound


def main() -> None:
    options = _options()
    chosen = [f for f in faults() if not options.only or any(text in f.file for text in options.only)]
    chosen = chosen[:: options.every]
    known = _known(options.results)
    with tempfile.TemporaryDirectory() as name:
        folders: Queue[Path] = Queue()
        for k in range(options.processes):
            folders.put(copy(Path(name) / str(k)))
        open_faults = [fault for fault in chosen if _key(fault) not in known]
        require_sound(sorted({test for fault in open_faults for test in fault.tests}), Path(name) / "0")
        with ThreadPoolExecutor(options.processes) as pool:
            tried = pool.map(lambda fault: _tried(fault, folders, options.results), open_faults)
            known |= {_key(fault): seen for fault, seen in zip(open_faults, tried, strict=True)}
    found = [known[_key(fault)] for fault in chosen]
    counted = [(fault, seen) for fault, seen in zip(chosen, found, strict=True) if not fault.harmless]
    for package, number in sorted(Counter(fault.package for fault, _ in counted).items()):
        seen = sum(seen for fault, seen in counted if fault.package == package)
        print(f"| `{package}` | {number} | {seen} |")
    total = sum(seen for _, seen in counted)
    print(f"{total} of {len(counted)} seen, {100 * total / max(1, len(counted)):.1f} %")


def _key(fault: Fault) -> str:
    return json.dumps([fault.file, fault.text, fault.replacement])


def _known(results: Path | None) -> dict[str, bool]:
    """Return which faults of an interrupted run of the same revision were seen."""
    if results is None or not results.exists():
        return {}
    return {key: seen for key, seen in map(json.loads, results.read_text(encoding="utf-8").splitlines())}


def _tried(fault: Fault, folders: Queue[Path], results: Path | None) -> bool:
    folder, start = folders.get(), time.monotonic()
    try:
        seen = is_seen(fault, folder)
    finally:
        folders.put(folder)
    kind = "seen" if seen else "harmless" if fault.harmless else "UNSEEN"
    text = f"{kind}, {time.monotonic() - start:.0f} s, {fault.file}: {fault.text} -> {fault.replacement}"
    print(" ".join(text.split()), flush=True)
    if results is not None:
        with results.open("a", encoding="utf-8") as file:
            print(json.dumps([_key(fault), seen]), file=file)
    return seen


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", help="run the faults of files whose path contains one of these")
    parser.add_argument("--every", type=int, default=1, help="run every Nth fault")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1, help="tests at the same time")
    parser.add_argument(
        "--results", type=Path, help="file of outcomes; faults that it has already are not run again"
    )
    return parser.parse_args()


if __name__ == "__main__":
    main()
