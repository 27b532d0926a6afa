"""The search for equilibria: starts, zeros, equal states and families."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, quoted
from kanegen.library.equilibria.balance import Balance
from kanegen.library.equilibria.equilibrium import Equilibria, Equilibrium
from kanegen.library.equilibria.families import Families
from kanegen.library.equilibria.search import zeros
from kanegen.library.equilibria.stability import Judgement
from kanegen.library.library import Library
from kanegen.model.arguments import NamedInputs
from kanegen.model.force_elements import ForceElement
from kanegen.model.values_by_name import finite_in_order

Floats = NDArray[np.float64]

OUTPUTS = (
    "forcing",
    "forcing_derivatives",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "regularity",
    "potential_energy",
    "potential_energy_derivatives",
    "body_poses",
    "coordinate_rates",
    "coordinate_rates_derivatives",
)
"""Outputs of C that the search needs."""

TURNS = 3.0
"""Factor by which starts go beyond half a turn where forces do not return after a full turn."""

LARGEST_REST = 1e-7
"""Largest acceleration of an equilibrium, as a share of the accelerations of the starts."""

UNCERTAIN = 1e-7
"""Error of a state along a direction in which forces vanish to the second order, as forces of 1e-14 of their
usual size allow it (rad, m)."""


def find_equilibria(
    library: Library,
    starts: Floats,
    speeds: Mapping[str, float] | None = None,
    tau: Mapping[str, float] | None = None,
    *,
    elements: Sequence[ForceElement],
    **inputs: Unpack[NamedInputs],
) -> Equilibria:
    """Return states of rest, or steady motions with given constant speeds.

    Args:
        library: Library with the outputs `OUTPUTS`.
        starts: (B, m) states from which to search.
        speeds: Constant speeds by name of the coordinate that turns or moves; all others are 0.
        tau: Constant generalized forces by name of the freedom.
        elements: Force elements of the system, from whose structure stability is judged.
        inputs: Inputs that only some systems have, held at these values, by default 0.

    Raises:
        OptionError: If a name does not exist, a value is no finite number, a speed is no rate of a
            coordinate, or forces depend on a coordinate that is to turn, so that no motion with its rate is
            steady.
    """
    if library.prescribed_names and "prescribed" in library.further_inputs:
        inputs.setdefault("prescribed", np.zeros((3, len(library.prescribed_names))))
    if "t" in library.further_inputs:
        inputs.setdefault("t", 0.0)
    y = np.array(finite_in_order("speeds", speeds, library.speed_names, [0.0] * library.n), float)
    efforts = np.array(finite_in_order("tau", tau, library.freedom_names, [0.0] * library.n), float)
    balance = Balance(library.with_on_status("ignore"), y, efforts, inputs)
    slopes = balance.slopes(starts)
    depends = (slopes != 0).any(axis=(0, 1))
    turning = _turning(library, y, depends)
    forces = balance.forces(starts)
    scale = _scale(library, forces)
    homogeneous = library.source.model.homogeneous
    periodic = _periodic(balance, starts, scale)
    families = Families(balance, scale, periodic, (depends & ~turning).astype(float), homogeneous)
    angles = np.array([unit == "rad" for unit in library.source.model.coordinate_units])
    starts = starts * np.where(angles & ~periodic, TURNS, 1.0)
    origin = np.zeros(starts.shape[1])
    origin[[places[0] for places in homogeneous]] = 1.0
    starts = np.where(families.moving > 0, starts, origin)
    starts = np.concatenate([origin[None], starts])
    found = zeros(balance.forces, balance.slopes, starts, scale, families.moving)
    size = np.abs(balance.forces(found) / scale).max(axis=1)
    settled = [families.settled(x) for x in found[size < 1e-6]]
    limit = LARGEST_REST * _acceleration(balance, starts)
    kept, singular = [], 0
    for x in settled:
        residual = float(np.abs(balance.accelerations(x[None])[0]).max())
        if residual <= limit and balance.is_regular(x):
            kept.append(x)
        else:
            singular += 1
    results = [_equilibrium(library, families, elements, x, inputs) for x in _distinct(families, kept)]
    results.sort(key=lambda one: float(balance.energies(one.x[None])[0]))
    left = np.abs(balance.accelerations(found)).max(axis=1)
    smallest = float(np.nanmin(left)) if np.isfinite(left).any() else float("nan")
    return Equilibria(library.name, tuple(results), len(starts), len(kept), singular, smallest)


def _turning(library: Library, y: Floats, depends: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (m,) flags of the coordinates that turn or move at constant speed.

    Raises:
        OptionError: If a speed is no rate of a coordinate, or forces depend on the coordinate.
    """
    turning = np.zeros(len(library.coordinate_names), dtype=bool)
    for name, value in zip(library.speed_names, y, strict=True):
        if value == 0:
            continue
        if name not in library.coordinate_names:
            rates = [one for one in library.speed_names if one in library.coordinate_names]
            raise OptionError(
                f"speeds: {quoted(name)} is no rate of a coordinate. Take angles whose rates are constant in "
                f"the motion, such as the sequence 3-1-3 for a top. {did_you_mean(name, rates)}"
            )
        place = library.coordinate_names.index(name)
        if depends[place]:
            raise OptionError(
                f"speeds: forces depend on {quoted(name)} itself, so that no motion with its rate is steady. "
                "Choose a coordinate that is ignorable."
            )
        turning[place] = True
    return turning


def _scale(library: Library, forces: Floats) -> Floats:
    """Return the size of each force that counts as one: the largest of its unit in all starts."""
    units = np.array(library.source.model.freedom_units)
    largest = np.nanmax(np.abs(np.where(np.isfinite(forces), forces, np.nan)), axis=0, initial=0.0)
    found = np.array([largest[units == unit].max() for unit in units])
    return np.where(found > 0, found, 1.0)


def _acceleration(balance: Balance, starts: Floats) -> float:
    """Return a usual size of accelerations: the median of the largest in all starts; 1 where nothing acts."""
    largest = np.abs(balance.accelerations(starts)).max(axis=1)
    usual = float(np.median(largest[np.isfinite(largest)])) if np.isfinite(largest).any() else 0.0
    return usual if usual > 0 else 1.0


def _periodic(balance: Balance, starts: Floats, scale: Floats) -> NDArray[np.bool_]:
    """Return (m,) flags of the angles after whose full turn all forces and the energy return."""
    x = starts[:20]
    forces, energies = balance.forces(x), balance.energies(x)
    spread = max(float(np.ptp(energies)), 1e-300)
    found = []
    for place, unit in enumerate(balance.library.source.model.coordinate_units):
        turned = x.copy()
        turned[:, place] += 2 * np.pi
        if unit != "rad":
            found.append(False)
            continue
        change = np.nanmax(np.abs(balance.forces(turned) - forces) / scale)
        gained = np.abs(balance.energies(turned) - energies).max()
        found.append(bool(change < 1e-9 and gained < 1e-9 * spread))
    return np.array(found)


def _distinct(families: Families, states: list[Floats]) -> list[Floats]:
    """Return one of all states that are the same or belong to one family, the nearest to zero."""
    kept: list[Floats] = []
    for x in sorted(states, key=lambda x: (round(float(np.abs(x).sum()), 6), *np.round(-x, 6))):
        if any(families.is_same(x, other) or families.is_turned(x, other) for other in kept):
            continue
        basis = families.directions(x)
        if basis.shape[1] and any(families.leads_to(x, other) for other in kept):
            continue
        kept.append(x)
    return kept


def _equilibrium(
    library: Library,
    families: Families,
    elements: Sequence[ForceElement],
    x: Floats,
    inputs: NamedInputs,
) -> Equilibrium:
    """Return the result for one state: residual, free directions, linear model and stability."""
    balance, names = families.balance, library.coordinate_names
    model = library.linearize(x, balance.y, balance.tau, **inputs)
    directions = _ignorable(library, families)
    for direction in families.directions(x).T:
        if families.is_family(x, direction):
            largest = direction[np.argmax(np.abs(direction))]
            shares = direction / largest
            directions.append({n: float(s) for n, s in zip(names, shares, strict=True) if abs(s) > 1e-6})
        else:
            near = balance.library.linearize(x + UNCERTAIN * direction, balance.y, balance.tau, **inputs)
            model = replace(model, uncertainty=model.uncertainty + np.nan_to_num(np.abs(near.A - model.A)))
    residual = float(np.abs(balance.accelerations(x[None])[0]).max())
    stability = Judgement(families, elements).stability(x, model, len(directions))
    coordinates = dict(zip(names, map(float, x), strict=True))
    speeds = dict(zip(library.speed_names, map(float, balance.y), strict=True))
    return Equilibrium(coordinates, speeds, x, balance.y, residual, tuple(directions), stability, model)


def _ignorable(library: Library, families: Families) -> list[dict[str, float]]:
    """Return the coordinates on which no force depends, each as a direction; three for an orientation."""
    names = library.coordinate_names
    of_orientations = {place for places in families.homogeneous for place in places}
    found = [
        {name: 1.0}
        for place, name in enumerate(names)
        if families.moving[place] == 0 and place not in of_orientations
    ]
    for places in families.homogeneous:
        if not families.moving[list(places)].any():
            body = names[places[0]].rpartition(".")[0]
            rates = [name for name in library.speed_names if name.startswith(f"{body}.omega")]
            found += [{f"phi.{name}": 1.0} for name in rates]
    return found
