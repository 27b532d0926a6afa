"""The system that a command works on: a model file and the options that change it."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from kanegen.errors import ModelError, OptionError, quoted

if TYPE_CHECKING:
    from kanegen.model.numbers import Number
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
        system = system.with_locked(_locked_values(lock, system))
    return reformulated(system, speeds, coordinates)


def _locked_values(lock: Sequence[str], system: System) -> dict[str, Number | list[Number]]:
    """Return values of freedoms by name, from texts such as "elbow=pi/4" or "wrist=1,0,0,0".

    Raises:
        OptionError: If a text has another form, a value is no number, or a name occurs twice.
    """
    found: dict[str, Number | list[Number]] = {}
    for text in lock:
        name, equals, value = (part.strip() for part in text.rpartition("="))
        if not (name and equals and value):
            raise OptionError(f"--lock: {quoted(text)} is not NAME=VALUE, such as elbow=0.3.")
        if name in found:
            raise OptionError(f"--lock: {quoted(name)} is locked twice. Lock it once.")
        values = _numbers(value, f"--lock {name}", system)
        found[name] = values if len(values) > 1 else values[0]
    return found


def _numbers(text: str, label: str, system: System) -> list[Number]:
    """Return the numbers in a text such as "0,-pi/4,atan2(1,2)": expressions of numbers and parameters.

    Raises:
        OptionError: If one of them is neither a number nor such an expression.
    """
    from kanegen.model.grammar import parse_number
    from kanegen.model.numbers import number

    known = {parameter.name: parameter for parameter in system.parameters}
    outside_brackets = r",(?![^(]*\))"
    try:
        return [number(parse_number(part, known), label) for part in re.split(outside_brackets, text)]
    except ModelError as error:
        raise OptionError(f"{label}: {str(error).removeprefix(f'{label}: ')}") from None


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
        OptionError: If a text has another form, or a coordinate is no number.
        ModelError: If there is no such frame, or a name is taken.
    """
    for text in points or ():
        name, equals, place = text.partition("=")
        frame, colon, position = place.rpartition(":")
        if not (equals and colon and position.strip()):
            raise OptionError(f"--points: {quoted(text)} is not NAME=FRAME:X,Y,Z, such as tip=hand:0,0,0.1.")
        at = _numbers(position, f"--points {name.strip()}", system)
        system = system.with_points({name.strip(): (frame.strip(), at)})
    return system if loads is None else system.with_loads(_names(loads))


def names_of(option: str, texts: Sequence[str] | None) -> list[str]:
    """Return the names in the texts of an option that is repeatable, each text one name or several.

    Raises:
        OptionError: If a text holds no name.
    """
    for text in texts or ():
        if not _names(text):
            raise OptionError(f"{option}: {quoted(text)} names nothing. Name one at least, or leave it out.")
    return [name for text in texts or () for name in _names(text)]


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
