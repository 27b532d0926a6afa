"""Help and version load neither SymPy nor NumPy, and the help lists every choice."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable

import pytest
import typer

from kanegen import options
from kanegen.artifacts import ARTIFACTS
from kanegen.cli import options as cli_options
from kanegen.cli.app import COMMANDS, app
from kanegen.cli.bench import DEFAULT_PEERS
from kanegen.cli.options import DEFAULT_OUTPUTS
from kanegen.model.coordinates import ORIENTATIONS, SPEEDS
from kanegen.model.right_angles import AS_WRITTEN, FOUR_DECIMALS
from kanegen.products import PRODUCTS
from kanegen.program import passes, precision
from kanegen.recursion.outputs import EQUATIONS, INTEGRATORS, OUTPUTS
from kanegen.studies.bench.peers.registry import PEERS
from kanegen.symbolic.printing import FORMATS

HEAVY = ("sympy", "numpy", "cffi", "jinja2", "matplotlib", "kanegen.compiler")

LOADED = f"""
import sys
from kanegen.cli import main
try:
    main()
except SystemExit as done:
    assert not done.code, done.code
print("loaded", [name for name in {HEAVY} if name in sys.modules])
"""


@pytest.mark.parametrize(
    "arguments", [("--version",), ("--help",), *((command.__name__, "--help") for command in COMMANDS)]
)
def test_help_and_version_load_neither_sympy_nor_numpy(arguments: tuple[str, ...]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *arguments], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "loaded []"


def is_default(name: str) -> bool:
    """Return whether a target is written without being asked for."""
    return name in ARTIFACTS and ARTIFACTS[name].is_default


COMMAND_LINE = typer.main.get_command(app).commands


def help_of(command: str, name: str) -> str:
    """Return the help of an option by the name of its argument."""
    (text,) = [option.help for option in COMMAND_LINE[command].params if option.name == name]
    return text


@pytest.mark.parametrize(
    ("command", "name", "known"),
    [
        ("generate", "output", [*OUTPUTS, *INTEGRATORS]),
        ("generate", "for_", {name for name in (*ARTIFACTS, *PRODUCTS) if not is_default(name)}),
        ("generate", "without", passes.PASS_NAMES),
        ("generate", "precision", precision.PRECISIONS),
        ("generate", "tier", options.TIERS),
        ("generate", "speeds", SPEEDS),
        ("generate", "coordinates", ORIENTATIONS),
        ("equations", "format_", FORMATS),
        ("bench", "peer", PEERS),
    ],
)
def test_help_lists_every_choice(command: str, name: str, known: Iterable[str]) -> None:
    _, _, names = help_of(command, name).rpartition(": ")
    assert sorted(names.rstrip(".").split(", ")) == sorted(known)


def test_defaults_are_those_of_the_compiler() -> None:
    assert tuple(DEFAULT_OUTPUTS) == EQUATIONS
    assert sorted(DEFAULT_PEERS) == sorted(PEERS)
    assert cli_options.AS_WRITTEN == AS_WRITTEN
    assert f"{FOUR_DECIMALS:g}" in help_of("info", "right_angles")
