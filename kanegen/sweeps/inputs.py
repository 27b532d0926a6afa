"""Arguments of a library from the numbers of axes: first states, parameters, and inputs over the time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.components import AXES
from kanegen.model.nodes import TIME
from kanegen.model.system import System
from kanegen.sweeps import formulas
from kanegen.sweeps.axes import Formula


@dataclass(frozen=True)
class Inputs:
    """How the numbers of axes become arguments.

    Attributes:
        x: (m,) coordinates where no axis sets them.
        n: Number of freedoms.
        places: For each axis the array to which its numbers belong, "parameters", "x", "y", "tau", "force",
            "torque", "point_force", "point_moment" or "prescribed", and their place in it, row-major. A
            prescribed freedom has the place of its value; those of its rate and second derivative follow.
        sizes: Shape of each array of inputs, for one state.
        parameters: Names of the parameters that axes set.
        timed: Formulas of inputs that depend on the time, each after those from which it follows.
        defaults: What names in them stand for where they are no axes.
    """

    x: tuple[float, ...]
    n: int
    places: Mapping[str, tuple[str, int]]
    sizes: Mapping[str, tuple[int, ...]]
    parameters: tuple[str, ...]
    timed: Mapping[str, Formula]
    defaults: Mapping[str, float]

    @classmethod
    def of(cls, system: System, names: tuple[str, ...], timed: Mapping[str, Formula]) -> Inputs:
        """Return the inputs of a system for axes of some names, and for formulas that depend on the time."""
        rows = {
            load: {body.name: place for place, body in enumerate(system.bodies)}
            for load in ("force", "torque")
        }
        rows |= {
            load: {point.name: place for place, (_, point) in enumerate(system.points)}
            for load in ("point_force", "point_moment")
        }
        known: dict[str, tuple[str, int]] = {}
        for vector, elements in (
            ("x", system.coordinate_names),
            ("y", system.speed_names),
            ("tau", system.freedom_names),
        ):
            known |= {f"{vector}.{name}": (vector, place) for place, name in enumerate(elements)}
        for load, own in rows.items():
            known |= {
                f"{load}.{name}.{axis}": (load, 3 * place + k)
                for name, place in own.items()
                for k, axis in enumerate(AXES)
            }
        known |= {f"prescribed.{name}": ("prescribed", k) for k, name in enumerate(system.prescribed_names)}
        n, moved = len(system.freedoms), len(system.prescribed_names)
        sizes = {"prescribed": (3, moved), "tau": (n,), **{load: (len(own), 3) for load, own in rows.items()}}
        used = {name: known[name] for name in (*names, *timed) if name in known}
        arrays = {array for array, _ in used.values()}
        return cls(
            x=system.neutral_coordinates,
            n=n,
            places=used,
            sizes={name: size for name, size in sizes.items() if name in arrays},
            parameters=tuple(name for name in names if name not in known),
            timed=dict(timed),
            defaults=formulas.defaults(system),
        )

    def first_state(self, columns: Mapping[str, Floats], size: int) -> tuple[Floats, Floats]:
        """Return (B, m) coordinates and (B, n) speeds at the beginning."""
        x, y = np.tile(np.array(self.x), (size, 1)), np.zeros((size, self.n))
        for name, (array, place) in self.places.items():
            if array in ("x", "y"):
                (x if array == "x" else y)[:, place] = columns[name]
        return x, y

    def parameter_sets(self, columns: Mapping[str, Floats]) -> dict[str, Floats]:
        """Return the (B,) values of each parameter that axes set."""
        return {name: columns[name] for name in self.parameters}

    def over_steps(
        self, columns: Mapping[str, Floats], first: int, steps: int, step: float
    ) -> dict[str, Floats]:
        """Return the inputs of a rollout.

        Args:
            columns: (B,) numbers of the axes.
            first: Number of steps before its beginning.
            steps: Its number of steps S.
            step: Length of a step, s.

        Returns:
            (B, 1, ...) numbers of each array that axes set and that does not depend on the time; (B, 2 S + 1,
            ...) numbers at the beginning, the middle and the end of every step of the others.
        """
        places = 2.0 * first + np.arange(2 * steps + 1, dtype=np.float64)
        return self.at(columns, places * (step / 2))

    def at(self, columns: Mapping[str, Floats], times: Floats) -> dict[str, Floats]:
        """Return the inputs at some times.

        Args:
            columns: (B,) numbers of the axes.
            times: (K,) times, s.

        Returns:
            (B, K, ...) numbers of each array that axes set; (B, 1, ...) of those that do not depend on time.
        """
        size = len(next(iter(columns.values()))) if columns else 1
        known: dict[str, Any] = {**self.defaults, **{name: own[:, None] for name, own in columns.items()}}
        known[TIME] = times[None]
        rates: dict[str, tuple[Floats, ...]] = {}
        for name, one in self.timed.items():
            lead = size, len(times)
            if self.places[name][0] == "prescribed":
                numbers = formulas.with_rates(one, known, lead)
                known[name], rates[name] = numbers[0], numbers[1:]
            else:
                known[name] = formulas.values(one, known, lead)
        changing = {self.places[name][0] for name in self.timed}
        found = {}
        for array, shape in self.sizes.items():
            count = len(times) if array in changing else 1
            filled = np.zeros((size, count, int(np.prod(shape))))
            for name, (own, place) in self.places.items():
                if own == array:
                    filled[:, :, place] = known[name]
                    for order, values in enumerate(rates.get(name, ()), start=1):
                        filled[:, :, place + order * shape[-1]] = values
            found[array] = filled.reshape(size, count, *shape)
        return found
