"""Certified derivatives of {f}, of inverse dynamics and of {ydot}, by both algorithms.

With r = [A]{ydot} - {f} the derivative of {ydot} is -[A]^-1 times that of r at constant {ydot} (Carpentier
and Mansard 2018, section III). The derivative of r is a central difference over a tiny step h, whose
truncation error is at most h^2 / 6 times the largest third derivative. By speeds and translations r is a
polynomial of degree 2, so there is none. By an angle r is a trigonometric polynomial: the angle turns motions
outward, enters their products of two, and turns forces inward, which makes its degree 3 at most. By
Bernstein's inequality the third derivative is then at most 27 times the largest |r| over all values of the
angle, and a ball that contains all of them bounds that. So the enclosures are proven, like those of
`certify`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from kanegen.choices import require_one
from kanegen.errors import OptionError, SingularError
from kanegen.measure.truth import kane, newton_euler
from kanegen.measure.truth.balls import arb, arb_mat, beside, column, ctx, identity, solution, zeros
from kanegen.measure.truth.certify import LIMIT, WIDTH, DisagreementError, checked_state, first_precision
from kanegen.measure.truth.enclosure import Enclosure, enclosure
from kanegen.measure.truth.tree import Link, Tree, tree
from kanegen.model.coordinates import Coordinate, Freedom
from kanegen.model.system import System

DEGREE = 3
"""Largest degree of [A]{ydot} - {f} as a trigonometric polynomial of one angle."""

OUTPUTS = ("forcing", "inverse_dynamics", "forward_dynamics")
"""Outputs whose derivatives are exact."""

Equations = Callable[[Tree], tuple[arb_mat, arb_mat]]
"""An algorithm that returns [A] and {f} of a tree in its state."""


def derivatives(
    system: System,
    x: ArrayLike,
    y: ArrayLike,
    tau: ArrayLike | None = None,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    unit_roundoff: float = 2.0**-53,
    ydot: ArrayLike | None = None,
    output: str = "forward_dynamics",
) -> Enclosure:
    """Return the exact derivatives of an output in one state, for the very floats of the call.

    Args:
        system: The tree.
        x: (m,) coordinates (rad, m).
        y: (n,) generalized speeds (rad/s, m/s).
        tau: (n,) generalized forces beside loads and gravity (N m, N); default none.
        force: (N, 3) forces F'_K at G_K, in K (N); default none.
        torque: (N, 3) torques M'_K, in K (N m); default none.
        parameters: Values of run-time parameters by name; the others stand at their defaults.
        unit_roundoff: Unit roundoff of the program to evaluate.
        ydot: (n,) generalized accelerations (rad/s^2, m/s^2), for inverse dynamics; default none.
        output: What is differentiated: "forcing", "inverse_dynamics" or "forward_dynamics".

    Returns:
        (n, m + n) derivatives by {x}, then {y}; for forward dynamics (n, m + 2n), with {tau} at the end.

    Raises:
        ArrayError: If an array has the wrong shape or is not finite.
        OptionError: If there is no such output, or the system has quaternions, force elements, loads on
            points or prescribed freedoms.
        SingularError: If [A] is singular.
        DisagreementError: If the two algorithms contradict each other.

    Example:
        >>> exact = truth.derivatives(system, x, y)
        >>> exact.distance(library.forward_dynamics_derivatives(x, y))
    """
    require_one("output", output, OUTPUTS)
    if len(system.coordinates) > len(system.freedoms):
        raise OptionError("there are no exact derivatives by quaternions. Use angles as coordinates.")
    system = system.with_parameters(parameters or {})
    state = checked_state(system, x, y, tau, force, torque, ydot)
    bits = 4 * first_precision(system.number_of_bodies, unit_roundoff)
    while True:
        with ctx.workprec(bits):
            numbers = tree(system, state)
            first, second = (
                _derivatives(system, numbers, method, output) for method in (_kane, _newton_euler)
            )
        one = np.ones(first.shape)
        if all(each.is_narrow(one, unit_roundoff * WIDTH, unit_roundoff) for each in (first, second)):
            break
        if 2 * bits > LIMIT:
            raise SingularError(f"{output}: [A] is singular in this state, to {bits} bits.")
        bits *= 2
    if not first.overlaps(second):
        raise DisagreementError("the enclosures of derivatives by both algorithms do not overlap.")
    return first


def _kane(numbers: Tree) -> tuple[arb_mat, arb_mat]:
    """Return [A] and {f} by partial velocities."""
    equations = kane.equations(numbers)
    return equations.A, equations.f


def _newton_euler(numbers: Tree) -> tuple[arb_mat, arb_mat]:
    """Return [A] and {f} by the equations of Newton and Euler."""
    return newton_euler.mass_matrix(numbers), newton_euler.forcing(numbers)


def _derivatives(system: System, numbers: Tree, method: Equations, output: str) -> Enclosure:
    """Return enclosures of the derivatives by one algorithm."""
    a, f = method(numbers)
    n, ydot = numbers.freedoms, numbers.ydot
    if output == "forcing":
        ydot = zeros(n, 1)
    elif output == "forward_dynamics":
        ydot = solution(a, f + numbers.tau)

    def residual(moved: Tree) -> arb_mat:
        matrix, forces = method(moved)
        return matrix * ydot - forces

    changes = beside(list(_changes(system, numbers, residual)))
    if output == "forcing":
        changes = -changes
    elif output == "forward_dynamics":
        changes = beside([solution(a, -changes), solution(a, identity(n))])
    return enclosure(changes, (n, changes.ncols()))


def _changes(system: System, numbers: Tree, residual: Callable[[Tree], arb_mat]) -> Iterator[arb_mat]:
    """Yield the derivatives of a function of the state by every element of {x}, then of {y}."""
    step = step_size()
    for coordinate in system.coordinates:
        above, below = (residual(_at(numbers, coordinate, by)) for by in (step, -step))
        change = (above - below) * (1 / (2 * step))
        if coordinate.is_angle:
            anywhere = residual(_at(numbers, coordinate, arb(0, 3.2)))  # more than a half turn either way
            rest = step * step * DEGREE**3 / 6
            errors = [arb(0, (abs(value) * rest).upper()) for value in anywhere.entries()]
            change += arb_mat(change.nrows(), 1, errors)
        yield change
    for place, freedom in enumerate(system.freedoms):
        above, below = (residual(_faster(numbers, place, freedom, by)) for by in (step, -step))
        yield (above - below) * (1 / (2 * step))


def step_size() -> arb:
    """Return the step of differences: rounding and truncation lose a third of the bits each."""
    return arb(2) ** -(ctx.prec // 3)


def _at(numbers: Tree, coordinate: Coordinate, by: arb) -> Tree:
    """Return a tree in its state, with one coordinate changed."""
    link = numbers.links[coordinate.body - 1]
    moved = _moved(coordinate.index % 3, by)
    if coordinate.is_translation:
        link = replace(link, translation=link.translation + moved)
    else:
        link = replace(link, angles=link.angles + moved)
    return replace(numbers, links=_with(numbers, coordinate.body, link))


def _faster(numbers: Tree, place: int, freedom: Freedom, by: arb) -> Tree:
    """Return a tree in its state, with one generalized speed changed."""
    link = numbers.links[freedom.body - 1]
    moved = _moved(freedom.axis, by)
    if freedom.is_angle:
        link = replace(link, rates=link.rates + moved)
    else:
        link = replace(link, translation_rates=link.translation_rates + moved)
    speeds = numbers.speeds + column(by if i == place else 0.0 for i in range(numbers.freedoms))
    return replace(numbers, links=_with(numbers, freedom.body, link), speeds=speeds)


def _moved(axis: int, by: arb) -> arb_mat:
    """Return the (3, 1) vector with one component."""
    return column(by if i == axis else 0.0 for i in range(3))


def _with(numbers: Tree, body: int, link: Link) -> tuple[Link, ...]:
    """Return the links of a tree with one of them replaced."""
    return tuple(link if k == body else other for k, other in enumerate(numbers.links, start=1))
