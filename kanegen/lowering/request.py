"""What enters the pipeline: a system as it is asked for, that has equations of motion."""

from __future__ import annotations

from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.reference import regularity


def described(system: System, speeds: str | None = None, coordinates: str | None = None) -> System:
    """The same tree with other generalized speeds and coordinates, where they are not None.

    Raises:
        OptionError: If there are no such speeds or coordinates, or they do not go together.
    """
    require_system(system)
    if (speeds, coordinates) == ("angle_rates", "quaternion"):
        raise OptionError(
            'speeds "angle_rates" are for angles, and coordinates "quaternion" leave none. Leave out one.'
        )
    if coordinates is not None:
        system = system.with_coordinates(coordinates)
    return system if speeds is None else system.with_speeds(speeds)


def require_system(system: object) -> None:
    """Make sure that something is a `System`.

    Raises:
        OptionError: If it is not.
    """
    if not isinstance(system, System):
        raise OptionError(f"{system!r} is no System. Make one with kg.load or kg.System.from_arrays.")


def require_usable(system: System) -> None:
    """Make sure that something is a `System` with equations that can be solved.

    Raises:
        OptionError: If it is no system.
        SingularError: If [A] is singular in every state.
    """
    require_system(system)
    regularity.require_regular(system)
