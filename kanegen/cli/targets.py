"""The targets of `--for`: artifacts and products by their names, and hints for names that are neither."""

from __future__ import annotations

from kanegen.choices import several
from kanegen.cli.loading import names_of
from kanegen.errors import OptionError, quoted

WITHOUT_FILES = {
    "jax": "kanegen.interop.jax",
    "numba": "Library.address",
    "numpy": "Library.bind",
    "python": "kanegen.build",
    "scipy": "Library.rhs",
    "torch": "kanegen.interop.torch",
}
"""What programs in Python use instead of files, by the names that users may give."""

OTHER_NAMES = {
    "acados": "casadi",
    "c++": "cpp",
    "cc": "cpp",
    "cxx": "cpp",
    "embedded": "arduino",
    "esp-idf": "arduino",
    "esp32": "arduino",
    "javascript": "wasm",
    "js": "wasm",
    "matlab": "octave",
    "mcu": "arduino",
    "mex": "octave",
    "microcontroller": "arduino",
    "microcontrollers": "arduino",
    "node": "wasm",
    "nodejs": "wasm",
    "platformio": "arduino",
    "pytorch": "torch",
    "ts": "wasm",
    "typescript": "wasm",
    "webassembly": "wasm",
    "zephyr": "arduino",
}
"""Targets by other names of theirs, for which messages propose the right one."""

HINTS = {
    "cuda": "Code for GPUs is written with --target cuda.",
    "gpu": "Code for GPUs is written with --target cuda.",
    "nvidia": "Code for GPUs is written with --target cuda.",
    "c": "The C is written without --for; 'description' adds names, units and structures to it.",
    "fmi": "Did you mean 'fmi2' or 'fmi3'?",
    "fmu": "Did you mean 'fmi2' or 'fmi3'?",
}
"""What messages say of names that stand for no target or for two."""


def chosen_targets(texts: list[str] | None, platforms: list[str] | None) -> tuple[list[str], list[str]]:
    """Return the names of artifacts and of products that --for names; one name may be that of both.

    Args:
        texts: Texts of the option, each a name or several names separated by commas.
        platforms: Names of the platforms for products that have some.

    Raises:
        OptionError: If there is no such target or platform, or no target has platforms.
        BuildError: If a tool for a product is missing.
    """
    from kanegen.artifacts import ARTIFACTS
    from kanegen.products import PRODUCTS, require_tools

    typed = names_of("--for", texts)
    for name in typed:
        _require_files(name)
    names = several("--for", "target", typed, tuple(dict.fromkeys((*ARTIFACTS, *PRODUCTS))))
    compiled = [name for name in names if name in PRODUCTS]
    if platforms and not any(PRODUCTS[name].has_platforms for name in compiled):
        raise OptionError(
            "--platform: no target has platforms. Leave it out, or add --for fmi3, for example."
        )
    require_tools(compiled, platforms)
    return [name for name in names if name in ARTIFACTS], compiled


def _require_files(name: str) -> None:
    """Make sure that a name is that of no program without files and no other name of a target.

    Raises:
        OptionError: If it is one; the message names what there is instead.
    """
    target = OTHER_NAMES.get(name.lower(), name.lower())
    if target in WITHOUT_FILES:
        raise OptionError(f"--for {name}: it needs no files. Use {WITHOUT_FILES[target]} in Python.")
    if name.lower() in HINTS:
        raise OptionError(f"unknown target {quoted(name)}. {HINTS[name.lower()]}")
    if name.lower() in OTHER_NAMES:
        raise OptionError(f"unknown target {quoted(name)}. Did you mean {quoted(target)}?")
