"""The system that a command is about: a model file, and what options say beside it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from kanegen import compiler
from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.readers import load


def loaded(
    model: Path, floating_base: bool, right_angles: float, speeds: str | None, coordinates: str | None
) -> System:
    """The system of a model file, with other speeds and coordinates if so wished.

    Raises:
        ModelError: If the file cannot be read, or describes what cannot exist.
        OptionError: If an option does not fit it.
    """
    return compiler.described(load(model, floating_base, right_angles), speeds, coordinates)


def reporting(system: System, outputs: Sequence[str], poses: str | None, reactions: str | None) -> System:
    """The system with the bodies of `body_poses` and the directions of `reaction_loads` that are given.

    Args:
        system: The tree.
        outputs: What is asked for.
        poses: Names with commas between them; None leaves what the model says.
        reactions: Likewise.

    Raises:
        OptionError: If an option is about an output that is not asked for.
        ModelError: If a name is none of the system's.
    """
    if poses is not None:
        _require("--poses", "body_poses", outputs)
        system = system.with_poses(_names(poses))
    if reactions is not None:
        _require("--reactions", "reaction_loads", outputs)
        system = system.with_reactions(_names(reactions))
    return system


def _require(option: str, output: str, outputs: Sequence[str]) -> None:
    if output not in outputs:
        raise OptionError(f"{option}: only with --output {output}. Add that, or leave {option} out.")


def _names(text: str) -> list[str]:
    return [name for word in text.split(",") if (name := word.strip())]
