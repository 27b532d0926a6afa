"""The state in which equations are linearized, as a user gives it: exact values of all variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from sympy import Expr, S, Symbol

from kanegen.model.system import System
from kanegen.model.values_by_name import in_order
from kanegen.symbolic.linear.exact_numbers import exact_value
from kanegen.symbolic.state_symbols import of_system
from kanegen.symbolic.symbols import force, point_force, point_moment, torque

Values = Sequence[Any] | Mapping[str, Any] | None
"""Values in order, or some by name, or none."""


@dataclass(frozen=True)
class State:
    """A state in which equations are linearized.

    Attributes:
        system: The system.
        x: (m) coordinates (rad, m, 1).
        y: (n) generalized speeds (rad/s, m/s).
        tau: (n) generalized forces (N m, N).
        prescribed: (3 p) values, rates and second derivatives of prescribed freedoms.
    """

    system: System
    x: tuple[Expr, ...]
    y: tuple[Expr, ...]
    tau: tuple[Expr, ...]
    prescribed: tuple[Expr, ...]

    @classmethod
    def of(cls, system: System, x: Values, y: Values, tau: Values, prescribed: Values) -> State:
        """Return the state that a user gives.

        Raises:
            OptionError: If a name does not exist.
            ArrayError: If there is another number of values than of names.
        """
        neutral = in_order("x", x, system.coordinate_names, system.neutral_coordinates)
        angles = [coordinate.is_angle for coordinate in system.coordinates]
        n, p = len(system.freedoms), len(system.prescribed)
        still = in_order("y", y, system.speed_names, [0] * n)
        efforts = in_order("tau", tau, system.freedom_names, [0] * n)
        if isinstance(prescribed, Mapping) or prescribed is None or len(prescribed) == p:
            prescribed = [
                *in_order("prescribed", prescribed, system.prescribed_names, [0] * p),
                *([0] * (2 * p)),
            ]
        names = [
            f"{name}{end}" for end in ("", " rate", " second derivative") for name in system.prescribed_names
        ]
        motion = in_order("prescribed", prescribed, names, [0] * (3 * p))
        known = {one.name: one for one in system.parameters}

        def exact(label: str, given: Sequence[Any], flags: Sequence[bool] = ()) -> tuple[Expr, ...]:
            pairs = zip_longest(given, flags, fillvalue=False)
            return tuple(exact_value(value, label, known, is_angle) for value, is_angle in pairs)

        return cls(
            system,
            exact("x", neutral, angles),
            exact("y", still),
            exact("tau", efforts),
            exact("prescribed", motion),
        )

    @property
    def values(self) -> dict[Symbol, Expr]:
        """Value of the symbol of each coordinate, speed, prescribed motion and load; loads are zero."""
        system, symbols = self.system, of_system(self.system)
        found = dict(zip(symbols.coordinates(system), self.x, strict=True))
        found |= dict(zip(symbols.speeds(system), self.y, strict=True))
        found |= dict(zip(symbols.prescribed(system), self.prescribed, strict=True))
        bodies, points = range(1, system.number_of_bodies + 1), range(1, len(system.points) + 1)
        for places, loads in ((bodies, (force, torque)), (points, (point_force, point_moment))):
            found |= {load(k, axis): S.Zero for k in places for load in loads for axis in range(3)}
        return found
