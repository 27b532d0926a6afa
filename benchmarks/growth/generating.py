"""One generation in a process of its own, so that its memory and its caches are its own.

python -m benchmarks.growth.generating FAMILY OUTPUT BODIES FOLDER
"""

from __future__ import annotations

import json
import re
import resource
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import kanegen as kg
from benchmarks.growth.cases import Case, Curve

ROOT = Path(__file__).parents[2]


def generated(case: Case, folder: Path) -> dict[str, float]:
    """Generate `case` in a new process, its files into `folder`.

    Returns:
        Operations, freedoms, seconds of derivation and of the whole, bytes of memory beyond those of a
        process that has loaded kanegen and the tree, bytes of C.
    """
    command = [sys.executable, "-m", __name__, case.curve.family, case.curve.output, str(case.bodies)]
    done = subprocess.run([*command, str(folder)], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    measured: dict[str, float] = json.loads(done.stdout)
    return measured


def _measured(case: Case, folder: Path) -> dict[str, float]:
    system = case.system()
    before = _peak_memory()
    stages: list[tuple[str, float]] = []
    start = time.perf_counter()
    source = kg.generate(
        system, (case.curve.output,), progress=lambda stage: stages.append((stage, time.perf_counter()))
    )
    stages.append(("", time.perf_counter()))
    memory = _peak_memory() - before
    source.write(folder, force=True)
    return {
        "freedoms": len(system.freedoms),
        "operations": sum(source.operations.values()),
        "derive": sum(end - begin for (stage, begin), (_, end) in pairwise(stages) if stage == "deriving"),
        "generate": stages[-1][1] - start,
        "memory": memory,
        "code": len(source.files[f"{system.name}.c"].encode()),
        "code batch": len(source.files[f"{system.name}_batch.c"].encode()),
    }


def _peak_memory() -> float:
    """Bytes; Linux counts what the parent had before exec into ru_maxrss, so its own record comes first."""
    try:
        status = Path("/proc/self/status").read_text(encoding="utf-8")
        return 1024.0 * int(re.findall(r"^VmHWM:\s+(\d+) kB", status, flags=re.MULTILINE)[0])
    except (OSError, IndexError):
        unit = 1 if sys.platform == "darwin" else 1024
        return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


if __name__ == "__main__":
    family, output, bodies, folder = sys.argv[1:]
    print(json.dumps(_measured(Case(Curve(family, output), int(bodies)), Path(folder))))
