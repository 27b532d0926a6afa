"""The result of a simulation: states over time with names and units, outputs by name, and the accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from kanegen import __version__
from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.linear.names import names_of
from kanegen.model.arguments import Floats
from kanegen.recursion.outputs import OUTPUTS
from kanegen.simulation.accuracy import mescd
from kanegen.simulation.conservation import keeps_energy, keeps_momentum
from kanegen.simulation.elements import Axis, Element, axes_of, elements, state_elements
from kanegen.simulation.events import Occurrence
from kanegen.simulation.picture import figure
from kanegen.simulation.promise import Promise
from kanegen.simulation.tables import TIME, Group, Table, data_frame, dataset, save, writer
from kanegen.simulation.time_history import TimeHistory
from kanegen.simulation.trajectory_html import trajectory_html


@dataclass(frozen=True, repr=False)
class Trajectory(TimeHistory):
    """The motion of a model from one state, or from B states at once.

    Attributes:
        library: Library that computed the accelerations.
        times: (T,) times, s.
        x: (T, m) or (T, B, m) coordinates, rad, m or 1.
        y: (T, n) or (T, B, n) generalized speeds, rad/s and m/s.
        work: (T,) or (T, B) work of the generalized forces since the first time, J; that of loads on bodies
            and points is not part of it.
        evaluations: Evaluations of {ydot}; one for all B states.
        inputs: What acted from outside, by name of the argument of `Library.forward_dynamics`, over the
            times: "tau" (T, n) or (T, B, n), "prescribed" (T, 3, p), "force" (T, N, 3) and so on.
        method: Name of the method with its step or tolerance.
        outputs: Outputs of the library that tables and files contain beside the state.
        events: Events in the order of their times.
        promise: What is known about the error, where one was asked for.

    Example:
        trajectory = kg.simulate(library, [0.1, 0.2], [0.0, 0.0], np.linspace(0, 10, 101), step=1e-3)
        last = trajectory.x[-1]
    """

    method: str = ""
    outputs: tuple[str, ...] = ()
    events: tuple[Occurrence, ...] = ()
    promise: Promise | None = None

    def __repr__(self) -> str:
        span = f"{len(self.times)} times from {self.times[0]:g} to {self.times[-1]:g} s"
        return f"<Trajectory of {self.library.name}: {span}, {self.evaluations} evaluations>"

    def _repr_html_(self) -> str:
        """The caption, the state at a few times and the events, for a notebook."""
        names = [one.name for group in ("x", "y") for one in self._elements[group]]
        columns = {name: self.output(name) for name in names}
        return trajectory_html(self.library.name, self.caption, self.times, columns, self.units, self.events)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all columns: "t", "x.<coordinate>", "y.<speed>", "tau.<freedom>", elements of outputs."""
        return tuple(self.units)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column by its name, such as {"t": "s", "x.pole": "rad"}."""
        return {TIME: "s", **{one.name: one.unit for group in self._elements.values() for one in group}}

    @cached_property
    def _elements(self) -> dict[str, tuple[Element, ...]]:
        """Names and units of the columns of each group: "x", "y", "tau" and the outputs."""
        groups = state_elements(self.library.source.model)
        if "tau" not in self.inputs:
            del groups["tau"]
        return groups | {name: elements(self.library.source, name) for name in self.outputs}

    @cached_property
    def _table(self) -> Table:
        """The motion as groups of columns."""
        axes = {
            "x": [Axis("coordinate", self.library.coordinate_names)],
            "y": [Axis("speed", self.library.speed_names)],
            "tau": [Axis("freedom", self.library.freedom_names)],
        }
        groups = {
            name: Group(axes.get(name) or axes_of(self.library.source, name), own, self._values(name))
            for name, own in self._elements.items()
        }
        attributes = {"model": self.library.name, "method": self.method, "software": f"kanegen {__version__}"}
        return Table(self.times, self.states, groups, attributes)

    def output(self, name: str) -> Floats:
        """Return an output, or one of its elements, at all times.

        Args:
            name: Name of an output that the library was built with, such as "point_positions"; of one element
                of it, such as "point_positions.tip.z"; or of a state or a generalized force, such as
                "x.pole", "y.pole" and "tau.pole".

        Returns:
            (T, ...) or (T, B, ...) with the axes of the output; (T,) or (T, B) for an element.

        Raises:
            OptionError: If there is no such name; the nearest one is proposed.

        Example:
            energy = trajectory.output("kinetic_energy") + trajectory.output("potential_energy")
        """
        if name == TIME:
            return self.times
        group = name.partition(".")[0]
        if name in self.library.source.outputs:
            return self._over_time(name)
        known = self._elements.get(group)
        if known is None and group in self.library.source.outputs:
            known = elements(self.library.source, group)
        names = [one.name for one in known or ()]
        if name in names:
            return self._flat(group)[..., names.index(name)]
        raise self._unknown(name, names or (*self.names, *self.library.source.outputs))

    def unit(self, name: str) -> str:
        """Return the unit of a column, or of an output or an element of one that is no column.

        Raises:
            OptionError: If there is no such name.

        Example:
            trajectory.unit("y.theta3")  # "rad/s"
        """
        known = self.units
        if name in known:
            return known[name]
        output = name.partition(".")[0]
        if output not in self.library.source.outputs:
            raise self._unknown(name, (*known, *self.library.source.outputs))
        of = elements(self.library.source, output)
        return next((one.unit for one in of if one.name == name), of[0].unit)

    def _unknown(self, name: str, known: Sequence[str]) -> OptionError:
        """Return the error that there is no column or output of a name."""
        output = name.partition(".")[0]
        if output in OUTPUTS and output not in self.library.source.outputs:
            advice = f"Ask for this output with outputs=({output!r},) in kg.simulate or kg.build."
        else:
            advice = did_you_mean(name, dict.fromkeys(known))
        return OptionError(f"the motion of {self.library.name} has no {quoted(name)}. {advice}")

    def columns(self) -> dict[str, Floats]:
        """Return all columns by name: (T,) each, or (T, B).

        Example:
            pole = trajectory.columns()["x.theta3"]
        """
        return self._table.columns()

    def _values(self, group: str) -> Floats:
        """Return the values of a group: states, generalized forces, or an output."""
        values = {"x": self.x, "y": self.y, **self.inputs}.get(group)
        return self._over_time(group) if values is None else values

    def _flat(self, group: str) -> Floats:
        """Return the values of a group with one last axis for its columns."""
        return self._values(group).reshape(*self.x.shape[:-1], -1)

    def mescd(self, reference: Trajectory, floor: float = 1.0) -> float:
        """Return the correct digits of the least correct coordinate or speed at any time, as `mescd` does.

        Args:
            reference: A more accurate trajectory over the same times.
            floor: Size below which errors count as absolute.

        Raises:
            ArrayError: If the trajectories have different shapes.
            OptionError: If the trajectories have different times.

        Example:
            digits = coarse.mescd(fine)
        """
        if not np.array_equal(self.times, reference.times):
            raise OptionError("reference: it has other times. Simulate both over the same ones.")
        ours, exact = (np.concatenate([one.x, one.y], axis=-1) for one in (self, reference))
        return mescd(ours, exact, floor)

    def to_pandas(self) -> Any:
        """Return all columns as a `pandas.DataFrame` over the time, or over state and time for B states.

        Units stand in its `attrs["units"]`.

        Raises:
            MissingError: If pandas is not installed (`pip install 'kanegen[results]'`).

        Example:
            frame = trajectory.to_pandas()
        """
        return data_frame(self._table)

    def to_xarray(self) -> Any:
        """Return states and outputs as an `xarray.Dataset`, whose dimensions and elements have names.

        Dimensions are "t", for B states "state", then "coordinate", "speed" or those of an output. Every
        array has its unit in `attrs["units"]`, one for each element where they differ.

        Raises:
            MissingError: If xarray is not installed (`pip install 'kanegen[results]'`).

        Example:
            angle = trajectory.to_xarray().x.sel(coordinate="theta3")
        """
        return dataset(self._table)

    def save(self, path: str | Path) -> None:
        """Write the motion into one file, whole or not at all.

        Args:
            path: Name of the file, whose end is its format: .csv, .parquet, .nc (NetCDF) or .npz (NumPy).

        Raises:
            OptionError: If there is no format of such an end.
            MissingError: If a package of the format is not installed (`pip install 'kanegen[results]'`).
            WriteError: If the file cannot be written; an existing one stays as it is.

        Example:
            trajectory.save("motion.csv")
        """
        save(self._table, path)

    def content(self, path: Path) -> bytes:
        """Return what `save` writes into a file of this name.

        Raises:
            OptionError: If there is no format of its end.
            MissingError: If a package of the format is not installed.

        Example:
            data = trajectory.content(Path("motion.csv"))
        """
        return writer(path)(self._table)

    def as_dict(self, names: Sequence[str] | None = None) -> dict[str, Any]:
        """Return method, accuracy, events and columns as plain data, for JSON.

        Args:
            names: Names of columns beside the time; by default all.

        Raises:
            OptionError: If there is no such name.

        Example:
            json.dumps(trajectory.as_dict(["x.theta3"]))
        """
        chosen = self.names[1:] if names is None else names_of("names", names)
        columns = {name: self.output(name) for name in (TIME, *chosen)}
        return {
            "model": self.library.name,
            "method": self.method,
            "evaluations": self.evaluations,
            "caption": self.caption,
            "promise": None if self.promise is None else self.promise.as_dict(),
            "events": [
                {"condition": one.condition, "t": one.time, "direction": one.direction} for one in self.events
            ],
            "units": {name: self.unit(name) for name in columns},
            "columns": {name: np.asarray(values, np.float64).tolist() for name, values in columns.items()},
        }

    def plot(self, names: Sequence[str] | str | None = None) -> Any:
        """Return a picture of the motion, a `matplotlib.figure.Figure`.

        Columns of the same unit share a panel. The caption has the method, and the drifts of energy and
        momentum where the library has them.

        Args:
            names: Names of columns as in `output`; by default coordinates, speeds, and outputs that are
                single numbers.

        Raises:
            OptionError: If there is no such name.
            MissingError: If Matplotlib is not installed (`pip install 'kanegen[plot]'`).

        Example:
            trajectory.plot(["x.theta3", "y.theta3"]).savefig("motion.svg")
        """
        chosen = self._plotted if names is None else names_of("plot", names)
        columns = {name: self.output(name) for name in chosen}
        units = {name: self.unit(name) for name in chosen}
        return figure(self.library.name, self.times, columns, units, self.caption)

    @property
    def caption(self) -> str:
        """The method, and the drifts of what should be constant, in a few words.

        The energy less the work of the efforts is constant where no force element dissipates and no loads
        act, the momentum where nothing acts from outside. The library must have the outputs.
        """
        parts = [self.method] if self.method else []
        source = self.library.source
        has_energies = {"kinetic_energy", "potential_energy"} <= set(source.outputs)
        with suppress(OptionError):  # where nothing moves there is no drift
            if has_energies and keeps_energy(source, self.inputs):
                parts.append(f"energy less work drifts by {self.energy_drift.largest:.1e}")
        with suppress(OptionError):
            if "momentum" in source.outputs and keeps_momentum(source, self.inputs):
                linear, angular = self.momentum_drift()
                drifts = f"{linear.largest:.1e} and {angular.largest:.1e}"
                parts.append(f"linear and angular momentum by {drifts}")
        return "; ".join(parts)

    @property
    def _plotted(self) -> tuple[str, ...]:
        """Names of the columns that a picture shows unless others are asked for."""
        outputs = [name for name in self.outputs if len(self._elements[name]) == 1]
        return (*(one.name for group in ("x", "y") for one in self._elements[group]), *outputs)
