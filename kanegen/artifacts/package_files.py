"""The artifacts "cmake", "pkg-config" and "readme": the code as an installable, documented library."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePosixPath

from kanegen.c.context import Context, context
from kanegen.c.source import Source
from kanegen.c.templates import fill


def cmake(source: Source) -> dict[str, str]:
    """Return `CMakeLists.txt`, which builds and installs the code."""
    return {"CMakeLists.txt": fill("artifacts/CMakeLists.txt", **_variables(source))}


def pkg_config(source: Source) -> dict[str, str]:
    """Return `<model>.pc.in`, from which CMake makes the file for pkg-config."""
    return {f"{source.model.name}.pc.in": fill("artifacts/model.pc.in", **_variables(source))}


def readme(source: Source) -> dict[str, str]:
    """Return `README.md`, which describes files, arrays, parameters, costs and accuracy."""
    folder = "cuda" if source.target == "cuda" else "artifacts"
    return {"README.md": fill(f"{folder}/README.md", **_variables(source))}


def _variables(source: Source) -> Context:
    outputs, steps = (*source.outputs, *source.integrators), [one.step for one in source.rollouts]
    variables = context(source.model, source.functions, outputs, source.operations, source.variant, steps)
    described = {one.name: one.doc for one in source.functions}
    described |= {one.name: one.doc for one in source.rollouts}
    return variables | {
        "pieces": source.pieces,
        "next_steps": list(source.next_steps.items()),
        "integrators": [(name, described[name]) for name in source.integrators],
        "elementary": [name for name in source.files if name.startswith("kanegen_elementary")],
        "parameters_by_state": source.parameters_by_state,
        "footprints": source.footprints,
        "stack": source.render_input.batch_stack if source.render_input else 0,
        "device_headers": [name for name in source.code if name.startswith("kanegen_")],
        "headers": [name for files in source.beside.values() for name in files if _is_header(name)],
        "beside": [(_shown(files), purpose.rstrip(".")) for purpose, files in source.beside.items()],
    }


def _is_header(name: str) -> bool:
    """Return whether a file is a header that programs include beside that of the model."""
    return name.endswith((".h", ".hpp")) and "/" not in name


def _shown(files: Iterable[str]) -> str:
    """Return the names of files for a table; of files in a folder, the name of the folder."""
    first = (PurePosixPath(name).parts for name in files)
    return ", ".join(dict.fromkeys(f"`{top}{'/' if below else ''}`" for top, *below in first))
