"""Trees, states and errors for the search for large errors of {ydot} without a status.

Programs are evaluated operation by operation as C computes them. Errors are relative to the reference in a
wider precision, which shares no code with the generator; large ones are computed again by certified truth.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

import kanegen as kg
from kanegen.compiler import compile_module
from kanegen.measure.truth import truth
from kanegen.model.arrays import Floats, SystemArrays
from kanegen.options import Variant
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import PARAMETERS, Array, Module, Output, Program
from kanegen.program.precision import Precision, precision_named
from kanegen.reference import equations as reference
from kanegen.reference.kinematics import kinematics
from kanegen.reference.magnitudes import forcing_magnitude, path_maxima
from kanegen.reference.matrices import length

FORWARD = ("forward_dynamics",)

LARGEST_CANCELLATION = 100.0
"""Cancellation of forces up to which errors count: chi, and the terms inside {f} over their sums."""

LARGEST_ERROR = 8192.0
"""Largest error without a status, in unit roundoffs."""


@dataclass(frozen=True)
class Tried:
    """States of a tree with the errors of {ydot} in them.

    Attributes:
        x: (B, n) coordinates.
        y: (B, n) speeds.
        tau: (B, n) generalized forces.
        error: (B,) error of {ydot} in unit roundoffs, as a whole.
        cancellation: (B,) cancellation of the forces, of each other (chi) and inside {f}.
        silent: (B,) whether the status is 0.
    """

    x: Floats
    y: Floats
    tau: Floats
    error: Floats
    cancellation: Floats
    silent: Floats

    @cached_property
    def unreported(self) -> Floats:
        """(B,) error of states without a status in which forces do not cancel, else 0."""
        counts = (self.silent > 0) & (self.cancellation <= LARGEST_CANCELLATION) & np.isfinite(self.error)
        found: Floats = np.where(counts, self.error, 0.0)
        return found


class Evaluator:
    """Forward dynamics of a tree in one precision, with its status.

    Args:
        system: The tree that is compiled.
        precision: "double" or "float".
        parameters: Values of run-time parameters; defaults otherwise.
        choices: Further choices, such as `solver`.
    """

    def __init__(
        self,
        system: kg.System,
        precision: str,
        parameters: Mapping[str, float] | None = None,
        **choices: object,
    ) -> None:
        self.precision: Precision = precision_named(precision)
        variant = Variant(precision=precision, **choices)  # type: ignore[arg-type]
        self._module: Module = compile_module(system, FORWARD, variant=variant).module
        self.system = system.with_parameters(parameters) if parameters else system
        values = [p.value for p in system.parameters]
        for i, parameter in enumerate(system.parameters):
            values[i] = (parameters or {}).get(parameter.name, parameter.value)
        self._parameters = self.rounded(np.array(values))

    def rounded(self, values: Floats) -> Floats:
        """Return the nearest numbers of the precision."""
        return values.astype(self.precision.dtype).astype(float)

    def tried(self, x: Floats, y: Floats, tau: Floats) -> Tried:
        """Return states with their errors."""
        x, y, tau = (self.rounded(values) for values in (x, y, tau))
        value, silent = self._evaluated(x, y, tau)
        parts = _accelerations(self.system, self.precision, x, y, tau)
        true = parts.sum(axis=-1)
        with np.errstate(all="ignore"):
            size = np.sqrt((true**2).sum(axis=1))
            error = np.sqrt(((value - true) ** 2).sum(axis=1)) / size
            chi = np.sqrt((parts**2).sum(axis=1)).sum(axis=1) / size
            cancellation = np.maximum(chi.astype(float), _formation(self.system, x, y, tau))
        roundoffs = (error / self.precision.roundoff).astype(float)
        return Tried(x, y, tau, roundoffs, cancellation, silent)

    def certified_error(self, found: Tried, i: int) -> float:
        """Return the error of {ydot} in a state by certified truth, in unit roundoffs."""
        one = slice(i, i + 1)
        value, _ = self._evaluated(found.x[one], found.y[one], found.tau[one])
        exact = truth(
            self.system, found.x[i], found.y[i], found.tau[i], outputs=FORWARD, unit_roundoff=2.0**-53
        )
        true = exact["forward_dynamics"].value
        error = np.linalg.norm(value[0].astype(float) - true) / np.linalg.norm(true)
        return float(error / self.precision.roundoff)

    def _evaluated(self, x: Floats, y: Floats, tau: Floats) -> tuple[Floats, Floats]:
        """Return {ydot} in the wide type, and whether the status is 0."""
        dtype, count = self.precision.dtype.type, len(x)
        given: dict[str, list[object]] = {
            name: list(values.T.astype(dtype)) for name, values in (("x", x), ("y", y), ("tau", tau))
        }
        given[PARAMETERS] = list(self._parameters.astype(dtype))
        with np.errstate(all="ignore"):
            if self._module.prepare is not None:  # computed at least in double precision, as in C
                wide = np.promote_types(dtype, np.float64).type
                prepared = evaluate(self._module.prepare, {PARAMETERS: list(self._parameters)}, np, wide)
                given |= {name: [dtype(value) for value in values] for name, values in prepared.items()}
            rows = evaluate(_with_status(self._module.functions["forward_dynamics"]), given, np, dtype)
        value, *conditions = (
            np.stack([np.broadcast_to(row, count) for row in array], axis=-1) for array in rows.values()
        )
        silent = np.all([(condition > 0).all(axis=-1) for condition in conditions], axis=0)
        return value.astype(np.longdouble), silent.astype(float)


def _with_status(program: Program) -> Program:
    """Return the same program with the values that its status depends on as further outputs."""
    (output,) = program.outputs
    conditions = {"pivots": output.exists_if_positive, "margins": output.accurate_if_positive}
    added = [
        Output(Array(name, (len(values),), "", ""), values) for name, values in conditions.items() if values
    ]
    return replace(program, outputs=(output, *added))


def _accelerations(system: kg.System, precision: Precision, x: Floats, y: Floats, tau: Floats) -> Floats:
    """Return the (B, n, 3) accelerations by {tau}, gravity and motion, from the reference, widened."""
    wide = np.longdouble if precision.roundoff < 2.0**-30 else np.float64
    arrays = _widened(system.values(), wide)
    with np.errstate(all="ignore"):
        matrix = reference.mass_matrix(arrays, x.astype(wide))
        terms = reference.forcing_terms(arrays, x.astype(wide), y.astype(wide))
        right = np.stack([tau.astype(wide), terms.gravity, terms.total - terms.gravity], axis=-1)
        return _solved(matrix.astype(np.longdouble), right.astype(np.longdouble))


def _formation(system: kg.System, x: Floats, y: Floats, tau: Floats) -> Floats:
    """Return the (B,) magnitudes of the terms of {f} over their sums, after units are taken away."""
    arrays = system.values()
    matrix = reference.mass_matrix(arrays, x)
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    none = np.zeros((len(x), system.number_of_bodies, 3))
    magnitude = forcing_magnitude(arrays, path_maxima(arrays, kinematics(arrays, x, y), y), none, none)
    terms = reference.forcing_terms(arrays, x, y)
    sums = np.abs(terms.gravity) + np.abs(terms.total - terms.gravity)
    sizes = [length((part + np.abs(tau)) * scale, axis=1) for part in (magnitude, sums)]
    found: Floats = sizes[0] / sizes[1]
    return found


def _widened(arrays: SystemArrays, dtype: type) -> SystemArrays:
    """Return the numbers of a system in a wider type."""
    changed = {
        field.name: value.astype(dtype)
        for field in fields(arrays)
        if isinstance(value := getattr(arrays, field.name), np.ndarray) and value.dtype == np.float64
    }
    return replace(arrays, **changed)


def _solved(matrix: Floats, right: Floats) -> Floats:
    """Return the (B, n, k) solutions for positive definite matrices (B, n, n), by Cholesky."""
    size = matrix.shape[1]
    left, found = np.zeros_like(matrix), right.copy()
    for j in range(size):
        left[:, j, j] = np.sqrt(matrix[:, j, j] - (left[:, j, :j] ** 2).sum(axis=1))
        for i in range(j + 1, size):
            inner = (left[:, i, :j] * left[:, j, :j]).sum(axis=1)
            left[:, i, j] = (matrix[:, i, j] - inner) / left[:, j, j]
    for i in range(size):
        found[:, i] -= (left[:, i, :i, None] * found[:, :i]).sum(axis=1)
        found[:, i] /= left[:, i, i, None]
    for i in reversed(range(size)):
        found[:, i] -= (left[:, i + 1 :, i, None] * found[:, i + 1 :]).sum(axis=1)
        found[:, i] /= left[:, i, i, None]
    return found


# Trees


def arm(rng: np.random.Generator, spread: float) -> kg.System:
    """Return an arm or tree of 2 to 5 bodies with masses from 10^-spread to 10^spread kg."""
    bodies = int(rng.integers(2, 6))
    mass = 10 ** rng.uniform(-spread, spread, bodies)
    if rng.random() < 0.5:  # growing outward
        mass = np.cumprod(10 ** rng.uniform(-1, 2 * spread / max(1, bodies - 1), bodies))
    size = 10 ** rng.uniform(-1, 1, bodies) if rng.random() < 0.5 else np.ones(bodies)
    free = np.eye(6, dtype=bool)[rng.integers(0, 3, bodies)]
    kind = rng.random()
    if kind < 0.3:
        free[:] = np.eye(6, dtype=bool)[2]
    elif kind < 0.6:
        others = np.array([[1, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 1], [0, 0, 0, 1, 0, 0]], dtype=bool)
        changed = rng.random(bodies) < 0.4
        free[changed] = others[rng.integers(0, 3, changed.sum())]
    return _tree(rng, mass, size, free)


def elbow(rng: np.random.Generator, spread: float) -> kg.System:
    """Return two links, of which the first is 1e-2 to 10^-spread of the second."""
    mass = np.array([10 ** rng.uniform(-spread, -2), 1.0])
    free = np.eye(6, dtype=bool)[[rng.integers(0, 3), rng.integers(0, 3)]]
    return _tree(rng, mass, np.ones(2), free)


def wrist(rng: np.random.Generator, spread: float) -> kg.System:
    """Return four bodies whose two middle ones are 1e-2 to 10^-spread of the others."""
    light = 10 ** rng.uniform(-spread, -2, 2)
    mass = np.array([1.0, *light, 10 ** rng.uniform(-1, 1)])
    free = np.eye(6, dtype=bool)[rng.permutation([0, 1, 2, int(rng.integers(0, 3))])]
    return _tree(rng, mass, np.ones(4), free)


def chain(rng: np.random.Generator, spread: float) -> kg.System:
    """Return a chain of 4 to 9 rods with parallel axes, whose masses grow outward."""
    bodies = int(rng.integers(4, 10))
    mass = (10 ** rng.uniform(-0.5, spread / 3)) ** np.arange(bodies)
    along = np.array([1.0, 0.0, 0.0])
    return kg.System.from_arrays(
        connection=range(bodies),
        mass=mass,
        inertia=[m * np.diag([1 / 512, 1 / 12, 1 / 12]) for m in mass],
        mass_center=np.tile(0.5 * along, (bodies, 1)),
        joint_position=np.outer(np.arange(bodies) > 0, along),
        free=np.tile(np.eye(6, dtype=bool)[2], (bodies, 1)),
        gravity=along * 9.81 if rng.random() < 0.5 else (0.0, -9.81, 0.0),
        name="chain",
    )


TREES: tuple[Callable[[np.random.Generator, float], kg.System], ...] = (arm, elbow, wrist, chain)
"""The kinds of trees that the search draws."""


def _tree(rng: np.random.Generator, mass: Floats, size: Floats, free: np.ndarray) -> kg.System:
    """Return a tree with random inertias, thin and flat ones among them, arms, and constant turns."""
    bodies = len(mass)
    inertia, center, position = [], np.zeros((bodies, 3)), np.zeros((bodies, 3))
    for k in range(bodies):
        points = rng.standard_normal((4, 3)) * 10 ** rng.uniform(-2, 0, (1, 3))
        points -= points.mean(axis=0)
        second = points.T @ points / 4
        own = (np.trace(second) + 1e-6) * np.eye(3) - second
        inertia.append(own * (mass[k] * size[k] ** 2))
        center[k] = rng.uniform(-1, 1, 3) * rng.integers(0, 2, 3) * size[k]
        before = size[k - 1] if k else 1.0
        position[k] = rng.uniform(-1, 1, 3) * rng.integers(0, 2, 3) * (rng.random() < 0.8) * before
    locked = np.zeros((bodies, 6))
    if rng.random() < 0.5:
        locked[:, :3] = np.where(free[:, :3], 0.0, rng.uniform(-2, 2, (bodies, 3)))
    connection = list(range(bodies))
    if rng.random() < 0.2:
        connection = [int(rng.integers(0, k + 1)) for k in range(bodies)]
    narrow = np.float32  # so that both precisions solve the same problem
    return kg.System.from_arrays(
        connection=connection,
        mass=mass.astype(narrow).astype(float),
        inertia=np.array(inertia).astype(narrow).astype(float),
        mass_center=center.astype(narrow).astype(float),
        joint_position=position.astype(narrow).astype(float),
        free=free,
        locked=locked.astype(narrow).astype(float),
        gravity=(1.0, -2.5, -9.75),
        name="tree",
    )


# States


def states(rng: np.random.Generator, evaluator: Evaluator, count: int) -> Tried:
    """Return random states, bent and nearly straight, fast and slow, with strong and weak forces."""
    n = len(evaluator.system.freedoms)
    x = rng.uniform(-np.pi, np.pi, (count, n)) * 10 ** rng.uniform(-3, 0, (count, 1))
    x *= rng.random((count, n)) < 0.8
    y = rng.uniform(-1, 1, (count, n)) * 10 ** rng.uniform(-3, 1, (count, 1))
    matrix = reference.mass_matrix(evaluator.system, x)
    tau = rng.uniform(-3, 3, (count, n)) * np.diagonal(matrix, axis1=1, axis2=2)
    tau *= 10 ** rng.uniform(-3, 1, (count, 1)) * (rng.random((count, n)) < 0.7)
    return evaluator.tried(x, y, tau)


def climbed(rng: np.random.Generator, evaluator: Evaluator, found: Tried, rounds: int) -> Tried:
    """Return states near those with the largest unreported errors, after some rounds of small changes."""
    for step in range(rounds):
        best = np.argsort(-found.unreported)[: max(8, len(found.x) // 8)]
        again = best[rng.integers(0, len(best), len(found.x))]
        scale = 0.5 / 2**step
        change = scale * rng.standard_normal((3, *found.x.shape)) * (rng.random(found.x.shape) < 0.5)
        new = evaluator.tried(
            found.x[again] + change[0], found.y[again] * (1 + change[1]), found.tau[again] * (1 + change[2])
        )
        rows = np.flatnonzero(new.unreported > found.unreported[again])
        found = Tried(
            *(
                np.concatenate([getattr(found, field.name)[best], getattr(new, field.name)[rows]])
                for field in fields(Tried)
            )
        )
    return found


def largest_unreported(evaluator: Evaluator, found: Tried, confirmed: int = 20) -> float:
    """Return the largest unreported error; of the large ones, `confirmed` are certified, the others not."""
    errors = found.unreported
    suspects = np.flatnonzero(errors > LARGEST_ERROR)
    certified = [evaluator.certified_error(found, i) for i in suspects[:confirmed]]
    return max([float(errors[errors <= LARGEST_ERROR].max(initial=0.0)), *certified])
