"""The base parameters of a tree: the fewest combinations of inertial parameters that motions show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from kanegen.errors import ModelError
from kanegen.model.arrays import Floats
from kanegen.model.description import require_system
from kanegen.model.identification.combinations import combinations, in_si, sampled_combinations
from kanegen.model.identification.factors import Factor, changing_factors
from kanegen.model.identification.inertial_parameters import inertial_parameter_names
from kanegen.model.identification.single_joints import geometry_of
from kanegen.model.limits import Limits
from kanegen.model.numbers import value_of
from kanegen.model.rotations import UNIT, ZERO
from kanegen.model.system import System
from kanegen.pictures.html import sentence, shown, table

SPREADS = (0.5, 0.25, 0.1, 0.03, 0.01)
"""Largest relative differences of general values from given ones; the first possible one is taken."""

SMALL = 1e-3
"""Value of a parameter up to which general values differ from it by shares of 1 instead of its own."""

RANK = 1e-10
"""Singular value over the largest one up to which combinations count as dependent."""


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
        factors: The numbers in [K] that change with run-time parameters, by row and column.

    Example:
        base = kg.base_parameters(system)
        print(base)  # the sums, one a line
    """

    parameters: tuple[str, ...]
    columns: tuple[int, ...]
    matrix: Floats
    is_proven: bool
    factors: Mapping[tuple[int, int], Factor] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.columns)

    def __str__(self) -> str:
        defaults = f"at the default values of {', '.join(self.at_defaults)}:"
        return "\n".join([*([defaults] if self.at_defaults else []), *self.names])

    def _repr_html_(self) -> str:
        """The sums, for a notebook."""
        count = f"{len(self)} of {len(self.parameters)} combinations of inertial parameters show in motions"
        defaults = f", at the default values of {', '.join(self.at_defaults)}" if self.at_defaults else ""
        rows = enumerate(self.names)
        return shown(sentence("{}", count + defaults), table(("", "base parameter"), rows, "base.names"))

    @property
    def names(self) -> tuple[str, ...]:
        """(b,) each base parameter as a sum over inertial parameters, such as "Ixx_2 - Iyy_2 + 0.04*m_3".

        A factor that changes with run-time parameters is written in these, as in "mx_1 + l1*m_2", or is a
        number at the default values of `at_defaults`.
        """
        return tuple(self._sum(row, own) for row, own in enumerate(self.columns))

    @property
    def at_defaults(self) -> tuple[str, ...]:
        """Names of the run-time parameters at whose default values numbers in `names` stand."""
        numbers = [factor for factor in self.factors.values() if not factor.symbols]
        return tuple(dict.fromkeys(name for factor in numbers for name in factor.parameters))

    def _sum(self, row: int, own: int) -> str:
        """Return a base parameter as a sum, the parameter of its own column first."""
        places = {int(place) for place in np.flatnonzero(self.matrix[row])}
        places |= {place for i, place in self.factors if i == row}
        text = ""
        for place in sorted(places, key=lambda place: (place != own, place)):
            factor = self.factors.get((row, place))
            number = factor.number if factor else float(self.matrix[row, place])
            size = f"{factor.text}*" if factor else f"{abs(number):.6g}*".removeprefix("1*")
            sign = "-" if number < 0 else "+"
            text += f" {sign} {size}{self.parameters[place]}"
        return f"-{text[3:]}" if text.startswith(" - ") else text[3:]


def base_parameters(system: System) -> BaseParameters:
    """Return the base parameters of a system, which follow from the geometry of its joints and from gravity.

    Where run-time parameters are lengths, angles or gravity, the columns are those for general values around
    the defaults and those of generated code. They are the same for all values, unless expressions such as
    max(0, l) change their form in between; [K] is for the defaults, and the names write lengths as they are
    called.

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
        found = _with_general_columns(bare, found)
    return replace(found, parameters=inertial_parameter_names(system))


def _with_general_columns(system: System, found: BaseParameters) -> BaseParameters:
    """Return the combinations for the defaults in the columns for general values, with changing factors."""
    defaults = {parameter.name: value_of(parameter) for parameter in system.parameters}
    # Values on both sides of the defaults, because an expression such as max(0, l - 1) may vanish on one.
    sides = [_general_values(system, defaults, list(defaults), side) for side in (1, -1)]
    values, general = max(
        ((values, _found(system.with_parameters(values))) for values in sides), key=lambda pair: len(pair[1])
    )
    columns = _enough_columns(general, found)
    in_general = _in_columns(general, columns)
    # Special values, such as the length 0, may need fewer columns than general ones.
    found = replace(found, columns=columns, matrix=_in_columns(found, columns))
    factors = changing_factors(
        (found.matrix, list(defaults.values())),
        (in_general, list(values.values())),
        _one_by_one(system, values, columns),
    )
    return replace(found, factors=factors)


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


def _general_values(
    system: System, values: Mapping[str, float], names: Sequence[str], side: int
) -> dict[str, float]:
    """Return values near given ones, at which nothing vanishes by accident.

    They are as far from the given values as the geometry exists: roots and quotients of parameters may not.

    Args:
        system: The system.
        values: Values of all run-time parameters, at which the geometry exists.
        names: The parameters to change.
        side: 1, or -1 for values on the other side of the given ones.
    """
    for spread in SPREADS:
        shares = side * spread * np.random.default_rng(0).uniform(-1.0, 1.0, len(names))
        found = dict(values)
        for name, share in zip(names, shares.tolist(), strict=True):
            value = values[name]
            found[name] += share * (value if abs(value) > SMALL else 1.0)
        try:
            geometry_of(system.with_parameters(found))
        except ModelError:
            continue
        return found
    return dict(values)


def _one_by_one(
    system: System, values: Mapping[str, float], columns: tuple[int, ...]
) -> dict[str, tuple[Floats, float]]:
    """Return [K] for each run-time parameter where it alone has another value than among `values`."""
    found = {}
    for name in values:
        changed = _general_values(system, values, [name], 1)
        found[name] = _in_columns(_found(system.with_parameters(changed)), columns), changed[name]
    return found


def _enough_columns(general: BaseParameters, found: BaseParameters) -> tuple[int, ...]:
    """Return the columns for general values, with those that the defaults need besides, if any.

    The defaults need more where an expression such as max(0, l) changes its form there.
    """
    rank = np.linalg.lstsq(found.matrix[:, list(general.columns)], found.matrix, rcond=RANK)[2]
    more = [column for column in found.columns if column not in general.columns]
    return general.columns if rank == len(found) else (*general.columns, *more)


def _in_columns(found: BaseParameters, columns: tuple[int, ...]) -> Floats:
    """Return combinations of other columns that make the same of the inertial parameters as [K] does."""
    if found.columns == columns:
        return found.matrix
    chosen = list(columns)
    matrix: Floats = np.linalg.lstsq(found.matrix[:, chosen], found.matrix, rcond=RANK)[0].astype(np.float64)
    matrix = np.where(np.abs(matrix) < 1e-13 * np.abs(matrix).max(initial=0.0), 0.0, matrix)
    if len(columns) == len(found.matrix):
        matrix[:, chosen] = np.eye(len(columns))
    return matrix
