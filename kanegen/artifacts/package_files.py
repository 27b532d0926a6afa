"""The artifacts "cmake", "pkg-config" and "readme": the code as an installable, documented library."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePosixPath
from textwrap import wrap

from kanegen.c.context import Context, context
from kanegen.c.layout import WIDTH
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.program.triangle import LOWER, PACKED, SPARSE

_PLACES = {
    LOWER: "what row i has in column j <= i, from 0, is element {n}*i + j. The elements above the diagonal "
    "are left as they are",
    PACKED: "what row i has in column j <= i, from 0, is element i*(i + 1)/2 + j. The macros "
    "`{prefix}_{array}_ROW_STARTS` and `{prefix}_{array}_COLUMNS` have the same places",
    SPARSE: "its elements by rows, without those that are zero in every state. The macro "
    "`{prefix}_{array}_ROW_STARTS` says where each row begins, `{prefix}_{array}_COLUMNS` the column of each",
}
"""Where elements of a lower triangle stand, by the form of the matrix."""

_CONTENTS = {
    "kanegen_sincos": "sine and cosine",
    "kanegen_elementary": "exp, log, tanh, atan2 and comparisons",
}
"""What headers have that the device functions use, by the beginning of their names."""


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
        "matrix": _about_matrix(source),
        "pieces": source.pieces,
        "next_steps": list(source.next_steps.items()),
        "integrators": [(name, described[name]) for name in source.integrators],
        "elementary": [name for name in source.files if name.startswith("kanegen_elementary")],
        "parameters_by_state": source.parameters_by_state,
        "footprints": source.footprints,
        "stack": source.render_input.batch_stack if source.render_input else 0,
        "device_headers": {name: _content(name) for name in source.code if name.startswith("kanegen_")},
        "headers": [name for files in source.beside.values() for name in files if _is_header(name)],
        "beside": [(_shown(files), purpose.rstrip(".")) for purpose, files in source.beside.items()],
    }


def _content(header: str) -> str:
    """Return what a header of kanegen has, by its name."""
    return next(
        (text for start, text in _CONTENTS.items() if header.startswith(start)), "arrays of one state"
    )


def _about_matrix(source: Source) -> list[str]:
    """Return lines on the part of [A] that functions fill, and where; [] where they fill the whole."""
    arrays = (array for function in source.functions for array in function.outputs)
    found = next((array for array in arrays if array.form in _PLACES), None)
    if found is None:
        return []
    places = _PLACES[found.form].format(array=found.name, n=found.row, prefix=source.model.prefix)
    text = f"`{found.name}` holds only the lower triangle of [A], which is symmetric: {places}."
    return wrap(text, WIDTH)


def _is_header(name: str) -> bool:
    """Return whether a file is a header that programs include beside that of the model."""
    return name.endswith((".h", ".hpp")) and "/" not in name


def _shown(files: Iterable[str]) -> str:
    """Return the names of files for a table; of files in a folder, the name of the folder."""
    first = (PurePosixPath(name).parts for name in files)
    return ", ".join(dict.fromkeys(f"`{top}{'/' if below else ''}`" for top, *below in first))
