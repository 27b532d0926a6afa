"""The base parameters of a tree: the fewest combinations of inertial parameters that motions show."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.description import require_system
from kanegen.model.identification.combinations import combinations, in_si, sampled_combinations
from kanegen.model.identification.inertial_parameters import inertial_parameter_names
from kanegen.model.identification.single_joints import geometry_of
from kanegen.model.limits import Limits
from kanegen.model.rotations import UNIT, ZERO
from kanegen.model.system import System


@dataclass(frozen=True, eq=False)
class BaseParameters:
    """Base parameters: combinations {beta} = [K]{pi} of the inertial parameters with [Y]{pi} = [Y_b]{beta}.

    The columns of [Y_b], the output `base_regressor`, are b columns of the regressor [Y]. No motion makes the
    columns that are left out differ from fixed combinations of these, so {beta} is all that forces and
    motions say of {pi}; see `combinations` for how they are found.

    Attributes:
        parameters: (10 N,) names of the inertial parameters, as `inertial_parameter_names` returns them.
        columns: (b,) columns of [Y] that make up [Y_b].
        matrix: (b, 10 N) combinations [K]; in the columns they are the identity, unless special values of
            run-time parameters leave fewer combinations than columns.
        is_proven: Whether b is proven to be the least number. Where freedoms are coupled or prescribed, it is
            the number that random positions show.

    Example:
        base = kg.base_parameters(system)
        print(len(base), *base.names)
    """

    parameters: tuple[str, ...]
    columns: tuple[int, ...]
    matrix: Floats
    is_proven: bool

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def names(self) -> tuple[str, ...]:
        """(b,) each base parameter as a sum over inertial parameters, such as "Ixx_2 - Iyy_2 + 0.04*m_3"."""
        return tuple(self._sum(row, own) for row, own in zip(self.matrix, self.columns, strict=True))

    def _sum(self, row: Floats, own: int) -> str:
        """Return a base parameter as a sum, the parameter of its own column first."""
        text = self.parameters[own]
        for place in np.flatnonzero(row):
            if place != own:
                factor = f"{abs(row[place]):.6g}*".removeprefix("1*")
                text += f" {'-' if row[place] < 0 else '+'} {factor}{self.parameters[place]}"
        return text


def base_parameters(system: System) -> BaseParameters:
    """Return the base parameters of a system, which follow from the geometry of its joints and from gravity.

    Where run-time parameters are lengths, angles or gravity, the columns are those for general values, so
    that they are the same for all values and those of generated code; the combinations are for the defaults.

    Args:
        system: The tree; no mass or inertia of it matters.

    Raises:
        OptionError: If `system` is no `System`.

    Example:
        base = kg.base_parameters(system)
        beta = base.matrix @ kg.inertial_parameters(system)
        tau = kg.build(system, "base_regressor").base_regressor(x, y, ydot) @ beta
    """
    require_system(system)
    return _of_system(system)


@lru_cache(maxsize=16)
def _of_system(system: System) -> BaseParameters:
    """Return the base parameters of a system; those of the last systems are kept."""
    bare = _without_inertias(system)
    found = _found(bare)
    if bare.parameters:
        columns = list(_found(_with_general_values(bare)).columns)
        # Special values, such as the length 0, may need fewer columns than general ones.
        found = replace(found, columns=tuple(columns), matrix=_in_columns(found.matrix, columns))
    return replace(found, parameters=inertial_parameter_names(system))


def _found(system: System) -> BaseParameters:
    """Return the base parameters for the defaults of all run-time parameters."""
    geometry = geometry_of(system)
    found, is_proven = combinations(geometry), geometry.is_independent
    if not is_proven:
        found = sampled_combinations(geometry, found)
    found = in_si(found, geometry)
    return BaseParameters((), found.columns, found.matrix, is_proven)


def _without_inertias(system: System) -> System:
    """Return the same joints and frames, with bodies that are all alike and nothing that acts on them."""
    bodies = tuple(
        replace(
            body,
            mass=1.0,
            inertia=UNIT,
            mass_center=ZERO,
            joint=replace(body.joint, armature=(0.0,) * 6, limits=Limits()),
            loads=False,
            points=(),
        )
        for body in system.bodies
    )
    return System(system.name, bodies, system.gravity, couplings=system.couplings, frames=system.frames)


def _with_general_values(system: System) -> System:
    """Return the same system with values of its run-time parameters at which nothing vanishes by accident."""
    values = np.random.default_rng(0).uniform(0.3, 1.7, len(system.parameters)).tolist()
    return system.with_parameters(dict(zip((p.name for p in system.parameters), values, strict=True)))


def _in_columns(matrix: Floats, columns: list[int]) -> Floats:
    """Return combinations of other columns that make the same of the inertial parameters as [K] does."""
    found: Floats = np.linalg.lstsq(matrix[:, columns], matrix, rcond=1e-10)[0].astype(np.float64)
    found = np.where(np.abs(found) < 1e-13 * np.abs(found).max(initial=0.0), 0.0, found)
    if len(columns) == len(matrix):
        found[:, columns] = np.eye(len(columns))
    return found
