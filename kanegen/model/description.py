"""`SystemDescription`: all that follows from the fields of a system."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from kanegen.errors import ModelError, OptionError, quoted
from kanegen.model.coordinates import FREEDOMS, NOTES, Freedom
from kanegen.model.coupled_limits import with_coupled_limits
from kanegen.model.coupling import Coupling
from kanegen.model.force_elements.element import ForceElement
from kanegen.model.force_elements.names import with_names_of_freedoms
from kanegen.model.frame import Frame
from kanegen.model.limits import SystemLimits
from kanegen.model.nodes import TIME
from kanegen.model.numbers import Parameter, factor_text, parameters_of
from kanegen.model.reaction import COMPONENTS, Reaction, every_reaction, reaction_rows
from kanegen.model.rotor import MountedRotor, Rotor, mounted_rotors
from kanegen.model.system_coordinates import SystemCoordinates
from kanegen.model.system_numbers import numbers_of


@dataclass(frozen=True)
class SystemDescription(SystemCoordinates):
    """The fields of a `System` with all that follows from them.

    Beside points, frames, {x} and {y} these are couplings, motors, limits, parameters and rows of outputs.
    """

    @cached_property
    def mounted_rotors(self) -> tuple[MountedRotor, ...]:
        """The rotors, each with the freedom that it drives and with its carrier.

        Raises:
            ModelError: If there is no freedom, body or frame of a name.
        """

        def carrier(name: str, label: str) -> tuple[int, str]:
            frame = self.frame(name, label)
            return frame.body, frame.name if frame.name in self.frames_by_name else ""

        return mounted_rotors(self.rotors, self.bodies, self.freedom, carrier)

    @property
    def motor_summaries(self) -> tuple[str, ...]:
        """One line for the armature of each freedom that moves, and for each rotor."""
        moving = zip(
            self.moving_places,
            (*self.freedom_names, *self.prescribed_names, *self.coupled_names),
            strict=True,
        )
        armature = [
            (name, self.bodies[freedom.body - 1].joint.armature[freedom.index], freedom)
            for freedom, name in moving
        ]
        lines = [
            f"armature of {name}: {factor_text(value)} {'kg m^2' if freedom.is_angle else 'kg'}"
            for name, value, freedom in armature
            if value
        ]
        return (*lines, *(f"rotor {rotor.summary}" for rotor in self.named_rotors))

    @cached_property
    def _names_of_freedoms(self) -> dict[str, str]:
        """The names of freedoms that move, such as `freedom_names` has, by permanent names."""
        return {
            f"{self.bodies[one.body - 1].name}.{FREEDOMS[one.index]}": self._freedom_name(one)
            for one in self.moving_places
        }

    @property
    def named_rotors(self) -> tuple[Rotor, ...]:
        """The rotors, with the names of freedoms that `freedom_names` has."""
        names = self._names_of_freedoms
        return tuple(replace(one, freedom=names.get(one.freedom, one.freedom)) for one in self.rotors)

    @property
    def named_couplings(self) -> tuple[Coupling, ...]:
        """The couplings, with the names of freedoms that `freedom_names` has."""
        names = self._names_of_freedoms
        return tuple(
            Coupling(
                names[one.freedom], tuple((names[name], factor) for name, factor in one.pairs), one.offset
            )
            for one in self.couplings
        )

    @property
    def named_force_elements(self) -> tuple[ForceElement, ...]:
        """The force elements, with the names of freedoms that `freedom_names` has.

        In `force_elements` every name is `<body>.<freedom>`, which stays when a freedom is locked.
        """
        return with_names_of_freedoms(self.force_elements, self._names_of_freedoms)

    @cached_property
    def depends_on_time(self) -> bool:
        """Whether an expression of a force element contains the time t."""
        return any(
            TIME in expression.variables
            for element in self.force_elements
            for expression in element.expressions()
        )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The run-time parameters, each once, in the order of first use.

        Raises:
            ModelError: If two parameters have one name and different values.
        """
        found: dict[str, Parameter] = {}
        for value in numbers_of(self):
            for one in parameters_of(value):
                if found.setdefault(one.name, one) != one:
                    raise ModelError(
                        f"parameter {quoted(one.name)} has two values, {quoted(found[one.name].value)} and "
                        f"{quoted(one.value)}. One name, one value."
                    )
        return tuple(found.values())

    @property
    def locked_summaries(self) -> tuple[str, ...]:
        """One line for each freedom that is locked at another value than zero, and for each locked joint.

        A locked joint is one with a name and without a freedom that moves.

        Example:
            system.with_locked({"elbow": 0.3}).locked_summaries  # ("forearm.theta3 = 0.3 rad (joint elbow)",)
        """
        lines = []
        for k, body in enumerate(self.bodies, start=1):
            joint = body.joint
            is_named = bool(joint.name) and not any(joint.moving)
            values = [(Freedom(k, index), value) for index, value in enumerate(joint.locked) if value != 0]
            for freedom, value in values:
                unit = f"{freedom.unit}, sequence {joint.sequence}" if freedom.is_angle else freedom.unit
                unit = freedom.unit if joint.sequence == NOTES else unit
                place = f" (joint {joint.name})" if is_named else ""
                lines.append(f"{body.name}.{FREEDOMS[freedom.index]} = {factor_text(value)} {unit}{place}")
            if is_named and not values:
                lines.append(f"all six freedoms of {body.name} = 0 (joint {joint.name})")
        return tuple(lines)

    @cached_property
    def coupling_equations(self) -> tuple[str, ...]:
        """One line for each coupling, with the names of freedoms that `freedom_names` has."""
        return tuple(coupling.equation() for coupling in self.named_couplings)

    @cached_property
    def limits(self) -> SystemLimits:
        """The limits of position, speed and effort in the order of {x} and {y}; infinite where there is none.

        A coordinate that coupled freedoms follow has limits within which these stay within their own, if each
        follows this coordinate alone; `not_kept` names the others.

        Example:
            system.limits.upper  # (m,)
        """
        of_coordinates = [
            (limits.lower[c.index], limits.upper[c.index])
            if c.index < len(FREEDOMS)
            else (-math.inf, math.inf)
            for c in self.coordinates
            for limits in (self.bodies[c.body - 1].joint.limits,)
        ]
        of_speeds = [
            (limits.speed[f.index], limits.effort[f.index])
            for f in self.freedoms
            for limits in (self.bodies[f.body - 1].joint.limits,)
        ]
        return with_coupled_limits(SystemLimits(*np.array(of_coordinates).T, *np.array(of_speeds).T), self)

    @cached_property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the frames in the output `body_poses`, in the order of its rows."""
        return tuple(body.name for body in self.bodies) if self.poses is None else self.poses

    @cached_property
    def pose_frames(self) -> tuple[Frame, ...]:
        """The frames in the output `body_poses`, in the order of its rows."""
        return tuple(self.frames_by_name.get(name) or self.frame(name) for name in self.pose_names)

    @cached_property
    def rows_of_frames(self) -> tuple[str, ...]:
        """Names of six loads on each frame that outputs give, such as "'force3' on frame 'tool'"."""
        return tuple(f"{load!r} on frame {quoted(name)}" for name in self.pose_names for load in COMPONENTS)

    @cached_property
    def reaction_rows(self) -> tuple[Reaction, ...]:
        """The rows of the output `reaction_loads`; by default those of all joints, as in Eq. (1)."""
        if self.reactions is None:
            return tuple(every_reaction(self.bodies, self._further_frames).values())
        return reaction_rows(self.bodies, self.frames_by_name, self.reactions)

    @cached_property
    def reaction_names(self) -> tuple[str, ...]:
        """Names of the rows of the output `reaction_loads`."""
        return tuple(row.name for row in self.reaction_rows)


class HasPrescribedNames(Protocol):
    """An object with the names of prescribed freedoms: a system, or the description of one in a source."""

    @property
    def name(self) -> str:
        """Name of the system, used in messages."""

    @property
    def prescribed_names(self) -> Iterable[str]:
        """Names of the freedoms whose motion is an input."""


def require_unprescribed(system: HasPrescribedNames, label: str) -> None:
    """Make sure that no freedom is prescribed, for functions that cannot take a prescribed motion.

    Args:
        system: The system.
        label: Name of the function or study that cannot take one, for the message.

    Raises:
        OptionError: If a freedom is prescribed.
    """
    if names := tuple(system.prescribed_names):
        raise OptionError(
            f"{label}: system {quoted(system.name)} has prescribed freedoms ({', '.join(names)}), "
            "whose motion cannot be passed here. Free them or lock them."
        )


def require_system(system: object) -> None:
    """Make sure that an object is a `System`.

    Raises:
        OptionError: If `system` is no `System`.
    """
    if not isinstance(system, SystemDescription):
        raise OptionError(f"{quoted(system)} is no System. Make one with kg.load or kg.System.from_arrays.")
