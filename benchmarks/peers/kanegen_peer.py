"""kanegen's own C in three settings of the compiler."""

from __future__ import annotations

from pathlib import Path

import kanegen as kg
from benchmarks.peers.building import Setting, compiled, driver

OUTPUTS = {"equations": ("mass_matrix", "forcing"), "dynamics": ("forward_dynamics",)}


def code(system: kg.System) -> dict[str, str]:
    """Source files of the equations and, under other names, of forward dynamics."""
    files = {}
    for prefix, outputs in OUTPUTS.items():
        source = kg.generate(system, outputs)
        for name in (f"{system.name}.c", f"{system.name}_batch.c"):
            files[f"{prefix}_{name}"] = source.files[name].replace(
                f'#include "{system.name}.h"', f'#include "{prefix}_{system.name}.h"'
            )
        files[f"{prefix}_{system.name}.h"] = source.files[f"{system.name}.h"]
        files["kanegen_lanes.h"] = source.files["kanegen_lanes.h"]
    return files


def program(system: kg.System, files: dict[str, str], setting: Setting) -> Path:
    """The driver with `files` in it."""
    texts = {"driver.c": driver("kanegen.c"), **files}
    return compiled(f"kanegen_{system.name}", texts, (*setting.flags, f"-DMODEL={system.name}"))
