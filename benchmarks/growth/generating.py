"""The generation of a case in a new process, which measures its memory without that of other cases.

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
    """Generate the C of a case in a new process and write it into `folder`.

    Returns:
        Numbers of operations and freedoms, seconds of the derivation and of the whole generation, bytes of
        memory beyond those of a process that has loaded kanegen and the tree, and bytes of C.
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
    """Return the peak memory of this process (byte).

    On Linux it comes from /proc, since ru_maxrss also counts memory of the parent process before exec.
    """
    try:
        status = Path("/proc/self/status").read_text(encoding="utf-8")
        return 1024.0 * int(re.findall(r"^VmHWM:\s+(\d+) kB", status, flags=re.MULTILINE)[0])
    except (OSError, IndexError):
        unit = 1 if sys.platform == "darwin" else 1024
        return float(unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


if __name__ == "__main__":
    family, output, bodies, folder = sys.argv[1:]
    print(json.dumps(_measured(Case(Curve(family, output), int(bodies)), Path(folder))))
