"""The system that a command works on: a model file and the options that change it."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kanegen.errors import OptionError, quoted

if TYPE_CHECKING:
    from kanegen.model.system import System


def load_system(
    model: Path,
    floating_base: bool = False,
    right_angles: float = 0.0,
    speeds: str | None = None,
    coordinates: str | None = None,
    lock: Sequence[str] | None = None,
    joint_dynamics: bool = False,
) -> System:
    """Read the system of a model file, lock freedoms, and give it the speeds and coordinates asked for.

    Raises:
        ModelError: If the file cannot be read or describes an impossible system, or a freedom does not exist.
        OptionError: If an option does not fit the system.
    """
    from kanegen.lowering.accept import reformulated
    from kanegen.readers import load

    system = load(model, floating_base, right_angles, joint_dynamics)
    if lock:
        system = system.with_locked(_locked_values(lock))
    return reformulated(system, speeds, coordinates)


def _locked_values(lock: Sequence[str]) -> dict[str, float | list[float]]:
    """Return values of freedoms by name, from texts such as "elbow=0.3" or "wrist=1,0,0,0".

    Raises:
        OptionError: If a text has another form, or a name occurs twice.
    """
    found: dict[str, float | list[float]] = {}
    for text in lock:
        name, _, value = (part.strip() for part in text.rpartition("="))
        try:
            numbers = [float(part) for part in value.split(",")]
        except ValueError:
            raise OptionError(f"--lock: {quoted(text)} is not NAME=VALUE, such as elbow=0.3.") from None
        if name in found:
            raise OptionError(f"--lock: {quoted(name)} is locked twice. Lock it once.")
        found[name] = numbers if len(numbers) > 1 else numbers[0]
    return found


def with_selection(
    system: System,
    outputs: Sequence[str],
    frames: str | None,
    reactions: str | None,
    contacts: str | None = None,
) -> System:
    """Return the system with the frames, the rows of `reaction_loads` and the contacts of outputs selected.

    Args:
        system: The tree.
        outputs: Names of the outputs that are computed.
        frames: Names of frames and bodies, separated by commas; None keeps the selection of the model.
        reactions: Names of locked directions and frames, separated by commas; None keeps the selection of the
            model.
        contacts: Names of contacts, points, frames and bodies, separated by commas; None keeps the contacts
            of the model.

    Raises:
        OptionError: If a selection is for an output that is not computed.
        ModelError: If the system has no frame, direction or contact of such a name.
    """
    from kanegen.recursion.outputs import OF_CONTACTS, OF_FRAMES

    if frames is not None:
        _require_output("--frames", OF_FRAMES, outputs)
        system = system.with_poses(_names(frames))
    if reactions is not None:
        _require_output("--reactions", ("reaction_loads",), outputs)
        system = system.with_reactions(_names(reactions))
    if contacts is not None:
        _require_output("--contacts", OF_CONTACTS, outputs)
        system = system.with_contacts(_names(contacts))
    return system


def with_places(system: System, points: Sequence[str] | None, loads: str | None) -> System:
    """Return the system with further points, and with further loads as inputs.

    Args:
        system: The tree.
        points: Texts such as "tip=hand:0,0,0.1": a name, a frame or body, and the place in it (m).
        loads: Names of points, bodies and frames, separated by commas.

    Raises:
        OptionError: If a text has another form.
        ModelError: If there is no such frame, or a name is taken.
    """
    for text in points or ():
        name, equals, place = text.partition("=")
        frame, colon, position = place.rpartition(":")
        try:
            at = [float(part) for part in position.split(",")]
        except ValueError:
            at = []
        if not (equals and colon and at):
            raise OptionError(f"--points: {quoted(text)} is not NAME=FRAME:X,Y,Z, such as tip=hand:0,0,0.1.")
        system = system.with_points({name.strip(): (frame.strip(), at)})
    return system if loads is None else system.with_loads(_names(loads))


def _require_output(option: str, among: Sequence[str], outputs: Sequence[str]) -> None:
    """Make sure that one of the outputs to which an option applies is computed."""
    if not set(among).intersection(outputs):
        raise OptionError(
            f"{option}: only with --output {' or '.join(among)}. Add that, or leave {option} out."
        )


def _names(text: str) -> list[str]:
    """Return the names in a text, separated by commas; a name that has one stands between double quotes."""
    words = next(csv.reader([text], skipinitialspace=True), [])
    return [name for word in words if (name := word.strip())]
