"""Combinations of inertial parameters that the equations of motion contain, from the geometry of the joints.

The equations of motion do not contain a combination {pi} of inertial parameters where no entry of [A] and no
generalized weight contains it, in any position. Such an entry pairs the motion {S_i} of one joint with that
of a joint j further out, or with itself, by the composite body outward of j: {S_i}^T [I_j] {S_j}. {S_i}
depends on the coordinates inward of j, the composite body on those outward of it. So the entry vanishes in
all positions exactly where every linear form does that {S_j} and the motions which body j can reach make of
[I_j]; gravity is one more motion of the ground.

Such a form of a composite body is a sum over its bodies, and each joint on the way out splits it in two: its
mean over the positions of the joint, and the rest, which must vanish by itself. What is left are forms of
single bodies, each with means of it in the bodies further out. Forms that are independent in one body make
independent sums, because no body further in is in them; so their number is the least number of combinations.
The regrouping of Gautier and Khalil (1990) and the count of Mayeda, Yoshida and Osuka (1990) are special
cases.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kanegen.model.arrays import Floats
from kanegen.model.identification.inertial_parameters import INERTIAL_PARAMETERS
from kanegen.model.identification.sampling import sampled_forms
from kanegen.model.identification.single_joints import Element, Geometry, Placement
from kanegen.model.identification.spaces import (
    changing_forms,
    energy_forms,
    mean_forms,
    motions_outward,
    parameters_inward,
    reached_motions,
    reduced,
    span,
)

WIDTH = len(INERTIAL_PARAMETERS)
"""Number of the inertial parameters of a body."""

PREFERRED = (1, 2, 3, 4, 5, 7, 8, 9, 6, 0)
"""Places of the parameters of a body, first those that stay where there is a choice: Iyy and mass pass on."""

NOTHING = 1e-12
"""Coefficient of a combination below which it is rounding, in units of the lengths of the tree."""


@dataclass(frozen=True)
class Combinations:
    """Combinations [K]{pi} of inertial parameters, which the equations of motion contain.

    Lengths are in the unit of the geometry, see `in_si`.

    Attributes:
        columns: (b,) places of parameters, one for each combination; there [K] is the identity.
        matrix: (b, 10 N) [K].
    """

    columns: tuple[int, ...]
    matrix: Floats


def combinations(geometry: Geometry) -> Combinations:
    """Return the combinations, the least number of them where no freedom is coupled or prescribed."""
    forms, means = _forms(geometry), _means(geometry)
    count = len(geometry.chains)
    columns: dict[int, list[int]] = {}
    rows: dict[int, Floats] = {}
    for k in reversed(range(1, count + 1)):
        inward = parameters_inward(geometry.frames[k - 1])
        own, independent = reduced(forms[k].vanishing @ inward, PREFERRED)
        whole = np.zeros((len(own), WIDTH * count))
        of_body = independent @ np.linalg.inv(inward)
        for outer, mean in means[k].items():
            whole[:, _block(outer)] = of_body @ mean @ parameters_inward(geometry.frames[outer - 1])
        whole[:, _block(k)] = independent
        for outer in sorted(means[k].keys() - {k}):
            whole -= whole[:, columns[outer]] @ rows[outer]
        columns[k], rows[k] = [WIDTH * (k - 1) + place for place in own], whole
    chosen = tuple(place for k in range(1, count + 1) for place in columns[k])
    return _with_identity(chosen, np.concatenate([rows[k] for k in range(1, count + 1)]))


def sampled_combinations(geometry: Geometry, enough: Combinations) -> Combinations:
    """Return fewer combinations than are `enough`, where random positions show that they suffice."""
    forms = sampled_forms(geometry, enough.columns)
    kept, combined = reduced(forms, range(len(enough.columns)))  # those of inner bodies are preferred
    return _with_identity(tuple(enough.columns[i] for i in kept), combined @ enough.matrix)


def in_si(found: Combinations, geometry: Geometry) -> Combinations:
    """Return combinations in SI units, from those in the unit of lengths of a geometry."""
    powers = np.array([0, *(1,) * 3, *(2,) * 6])
    scale = np.tile(geometry.length**powers, len(geometry.chains))
    return replace(found, matrix=found.matrix * scale[list(found.columns), None] / scale)


def _with_identity(columns: tuple[int, ...], matrix: Floats) -> Combinations:
    """Return combinations without what rounding leaves of zeros and ones."""
    matrix = np.where(np.abs(matrix) < NOTHING, 0.0, matrix)
    matrix[:, list(columns)] = np.eye(len(columns))
    return Combinations(columns, matrix)


def _block(k: int) -> slice:
    """Return the columns of body `k`."""
    return slice(WIDTH * (k - 1), WIDTH * k)


@dataclass(frozen=True)
class _Forms:
    """Linear forms of a composite body, and the motions of its body, in the frame of the body.

    Attributes:
        vanishing: (r, 10) basis of the forms that must be zero in all positions.
        constant: (s, 10) basis of the forms that must have one value in all positions.
        motions: (t, 6) basis of the motions that the body can reach.
    """

    vanishing: Floats
    constant: Floats
    motions: Floats


def _forms(geometry: Geometry) -> list[_Forms]:
    """Return the forms of the ground, then of every body."""
    none = np.zeros((0, WIDTH))
    found = [_Forms(none, none, span(geometry.weight[None]))]
    for lower, chain in zip(geometry.connection, geometry.chains, strict=True):
        below = found[lower]
        # A form of the lower body vanishes as a sum, in which the part of this branch need only be constant.
        forms = _Forms(none, span(np.concatenate([below.vanishing, below.constant])), below.motions)
        for element in chain:
            forms = _outward(forms, element)
        found.append(forms)
    return found


def _outward(forms: _Forms, element: Element) -> _Forms:
    """Return the forms above a placement or a single joint, from those below it."""
    if isinstance(element, Placement):
        inward = parameters_inward(element)
        return _Forms(
            span(forms.vanishing @ inward),
            span(forms.constant @ inward),
            span(motions_outward(forms.motions, element)),
        )
    motions = reached_motions(forms.motions, element)
    every = span(np.concatenate([forms.vanishing, forms.constant]))
    vanishing = (
        mean_forms(forms.vanishing, element),
        changing_forms(every, element),
        energy_forms(motions, element.motion),
    )
    return _Forms(span(np.concatenate(vanishing)), span(mean_forms(every, element)), motions)


def _mean_above(forms: Floats, element: Element) -> Floats:
    """Return the means of (r, 10) forms below a placement or a single joint, above it."""
    if isinstance(element, Placement):
        return forms @ parameters_inward(element)
    return mean_forms(forms, element)


def _means(geometry: Geometry) -> list[dict[int, Floats]]:
    """Return by body the (10, 10) means of its forms in every body that it carries, itself included."""
    found: list[dict[int, Floats]] = [{} for _ in range(len(geometry.chains) + 1)]
    for k in reversed(range(1, len(found))):
        mean: Floats = np.eye(WIDTH)
        found[k][k] = mean
        for one in geometry.chains[k - 1]:
            mean = _mean_above(mean, one)
        for outer, further in found[k].items():
            found[geometry.connection[k - 1]][outer] = mean @ further
    return found
