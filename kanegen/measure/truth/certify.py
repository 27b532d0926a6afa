"""Exact results: two algorithms in ball arithmetic, whose precision is doubled until both are narrow.

An enclosure is narrow when its radius is 2^-20 of the unit roundoff of the program whose errors are to be
measured. Two enclosures that do not overlap mean a defect in one of the algorithms, not in the program.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kanegen.errors import ArrayError, KanegenError, OptionError, SingularError
from kanegen.measure.truth import kane, newton_euler
from kanegen.measure.truth.balls import arb_mat, ctx, solution
from kanegen.measure.truth.enclosure import Enclosure, enclosure
from kanegen.measure.truth.errors import Units, units
from kanegen.measure.truth.kane import Equations
from kanegen.measure.truth.tree import State, Tree, tree
from kanegen.model.arrays import Floats
from kanegen.model.description import require_unprescribed
from kanegen.model.system import System

EXACT = ("mass_matrix", "forcing", "inverse_dynamics", "forward_dynamics")
"""Outputs with exact results: [A], {f}, and the two that follow from them."""

WIDTH = 2.0**-20
"""Largest radius of an enclosure, relative to the unit roundoff."""

LIMIT = 2**14
"""Largest working precision in bits; a result that is not narrow then is zero, but not exactly computed."""


class DisagreementError(KanegenError):
    """Two enclosures of one number do not overlap: an algorithm of this package is wrong."""


@dataclass(frozen=True)
class Truth:
    """Exact results in one state.

    Attributes:
        system: The system, with the parameters of the call.
        state: The state.
        outputs: Exact outputs by name. Their radii are at most 2^-20 of the unit roundoff, relative to each
            entry; entries smaller than the unit roundoff times the largest one count as that large.
        bits: Working precision that this took.
        units: Factors that take the units from the outputs.
        equations: [A] and the parts of {f} in balls of the working precision.
    """

    system: System
    state: State
    outputs: Mapping[str, Enclosure]
    bits: int
    units: Units
    equations: Equations

    def __getitem__(self, output: str) -> Enclosure:
        """Return the exact result of one output."""
        return self.outputs[output]


def truth(
    system: System,
    x: ArrayLike,
    y: ArrayLike,
    tau: ArrayLike | None = None,
    force: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    outputs: Iterable[str] = ("mass_matrix", "forcing", "forward_dynamics"),
    unit_roundoff: float = 2.0**-53,
    ydot: ArrayLike | None = None,
) -> Truth:
    """Return the exact outputs of a system in one state, for the very floats of the call.

    Args:
        system: The tree.
        x: (m,) coordinates (rad, m, 1).
        y: (n,) generalized speeds (rad/s, m/s).
        tau: (n,) generalized forces beside loads and gravity (N m, N); default none.
        force: (N, 3) forces F'_K at G_K, in K (N); default none. Every row counts.
        torque: (N, 3) torques M'_K, in K (N m); default none.
        parameters: Values of run-time parameters by name; the others stand at their defaults.
        outputs: Names among "mass_matrix", "forcing", "inverse_dynamics" and "forward_dynamics".
        unit_roundoff: Unit roundoff of the program to evaluate: 2^-53 for double, 2^-24 for float.
        ydot: (n,) generalized accelerations (rad/s^2, m/s^2), needed for inverse dynamics.

    Raises:
        ArrayError: If an array has the wrong shape or is not finite.
        OptionError: If an output has no exact result, or the unit roundoff is not between 0 and 1.
        ModelError: If a parameter is unknown or makes the model unusable.
        SingularError: If forward dynamics is asked for where [A] is singular.
        DisagreementError: If the two algorithms contradict each other.

    Example:
        >>> from kanegen.measure import truth
        >>> system = kg.load("models/double_pendulum.toml")
        >>> exact = truth.truth(system, x=[0.3, 0.4], y=[1.0, 2.0])
        >>> exact["forward_dynamics"].value, exact["forward_dynamics"].radius
    """
    names = exact_outputs(outputs, ydot is not None)
    if not 0 < unit_roundoff < 1:
        raise OptionError(f"unit_roundoff is {unit_roundoff!r}; it must lie between 0 and 1.")
    system = system.with_parameters(parameters or {})
    state = checked_state(system, x, y, tau, force, torque, ydot)
    bits = first_precision(system.number_of_bodies, unit_roundoff)
    while True:
        found = _attempt(system, state, names, bits, unit_roundoff)
        if found is not None:
            return found
        bits *= 2


def first_precision(bodies: int, unit_roundoff: float) -> int:
    """Return the working precision to begin with: that of the width, 64 bits more, and 4 for every body."""
    return 64 + math.ceil(-math.log2(unit_roundoff * WIDTH)) + 4 * bodies


def exact_outputs(outputs: Iterable[str], has_ydot: bool) -> tuple[str, ...]:
    """Return the names of the outputs in the order of `EXACT`, each once.

    Args:
        outputs: Names of outputs, or a single one.
        has_ydot: Whether there are accelerations, which inverse dynamics needs.

    Raises:
        ArrayError: If inverse dynamics is asked for without accelerations.
        OptionError: If an output has no exact result, or no output is asked for.
    """
    asked = (outputs,) if isinstance(outputs, str) else tuple(outputs)
    for name in asked:
        if name not in EXACT:
            raise OptionError(f"there is no exact result for {name!r}, only for {', '.join(EXACT)}.")
    if not asked:
        raise OptionError(f"no output is asked for. There are exact results for {', '.join(EXACT)}.")
    if "inverse_dynamics" in asked and not has_ydot:
        raise ArrayError("inverse_dynamics needs ydot, the accelerations.")
    return tuple(name for name in EXACT if name in asked)


def checked_state(
    system: System,
    x: ArrayLike,
    y: ArrayLike,
    tau: ArrayLike | None,
    force: ArrayLike | None,
    torque: ArrayLike | None,
    ydot: ArrayLike | None,
) -> State:
    """Return the arrays of a call as one state of `system`; an array that is None counts as zeros.

    Raises:
        ArrayError: If an array has the wrong shape, or is not finite.
        OptionError: If the system has force elements or loads on points, or a freedom is prescribed.
    """
    require_unprescribed(system, "truth")
    loaded = [point.name for _, point in system.points if point.loads]
    if system.force_elements or loaded:
        unsupported = "force elements" if system.force_elements else f"loads on points ({', '.join(loaded)})"
        raise OptionError(
            f"system {system.name!r} has {unsupported}, for which there are no exact results. Leave them out "
            "of the model that is measured."
        )
    n, loads = (len(system.freedoms),), (system.number_of_bodies, 3)
    coordinates = (len(system.coordinates),)
    return State(
        x=_finite_array(x, coordinates, "x"),
        y=_finite_array(y, n, "y"),
        force=_finite_array(force, loads, "force"),
        torque=_finite_array(torque, loads, "torque"),
        tau=_finite_array(tau, n, "tau"),
        ydot=_finite_array(ydot, n, "ydot"),
    )


def _attempt(
    system: System, state: State, names: tuple[str, ...], bits: int, unit_roundoff: float
) -> Truth | None:
    """Return the results of both algorithms with a working precision; None if they are not narrow."""
    with ctx.workprec(bits):
        numbers = tree(system, state)
        equations = kane.equations(numbers)
        a, f = equations.A, equations.f
        first = _results(names, numbers, a, f, a * numbers.ydot - f)
        a, f = newton_euler.mass_matrix(numbers), newton_euler.forcing(numbers)
        second = _results(names, numbers, a, f, newton_euler.inverse_dynamics(numbers, numbers.ydot))
        scales = units(system, enclosure(equations.A, (len(state.y),) * 2).value.diagonal())
    for results in (first, second):
        for name, result in results.items():
            if not result.is_narrow(scales.of(name), unit_roundoff * WIDTH, unit_roundoff):
                if 2 * bits <= LIMIT:
                    return None
                _require_finite(name, result)
    for name in names:
        _require_overlap(name, first[name], second[name])
    return Truth(system, state, first, bits, scales, equations)


def _results(
    names: tuple[str, ...], numbers: Tree, a: arb_mat, f: arb_mat, required: arb_mat
) -> dict[str, Enclosure]:
    """Return enclosures of the outputs from (n, n) [A], (n, 1) {f} and the forces that {ydot} requires."""
    results = {"mass_matrix": a, "forcing": f, "inverse_dynamics": required}
    if "forward_dynamics" in names:
        results["forward_dynamics"] = solution(a, f + numbers.tau)
    n = numbers.freedoms
    return {name: enclosure(results[name], (n, n) if name == "mass_matrix" else (n,)) for name in names}


def _require_finite(name: str, result: Enclosure) -> None:
    """Make sure that an output is finite, as it is unless [A] is singular."""
    if not all(ball.is_finite() for ball in result.balls):
        raise SingularError(f"{name}: [A] is singular in this state, to {result.bits} bits.")


def _require_overlap(name: str, first: Enclosure, second: Enclosure) -> None:
    """Make sure that the enclosures of both algorithms have numbers in common."""
    if not first.overlaps(second):
        raise DisagreementError(
            f"{name}: partial velocities and Newton-Euler equations give enclosures that do not overlap, so "
            "kanegen.measure.truth has a defect. Please report it."
        )


def _finite_array(value: ArrayLike | None, shape: tuple[int, ...], label: str) -> Floats:
    """Return `value` as doubles of this shape, zeros for None; `label` names it in error messages."""
    if value is None:
        return np.zeros(shape)
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" or array.shape != shape:
        found = f"{array.dtype} of shape {array.shape}"
        raise ArrayError(f"{label}: expected real numbers of shape {shape}, got {found}.")
    if not np.isfinite(array).all():
        raise ArrayError(f"{label}: every number must be finite.")
    return array.astype(np.float64)
