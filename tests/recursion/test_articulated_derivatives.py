"""Derivatives of {ydot} by articulated bodies: against tangents and complex steps, their errors and cost."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import mpmath
import numpy as np
import pytest

import kanegen as kg
from benchmarks import models
from kanegen.compiler import compile_candidate, compile_module
from kanegen.lowering.accept import accept
from kanegen.lowering.compilation import Candidate, Request
from kanegen.lowering.conditioning import condition
from kanegen.model.force_elements.elements import Drive, JointSpring, Potential
from kanegen.model.grammar import parse
from kanegen.options import STRICT
from kanegen.program.count import count
from kanegen.program.evaluate import evaluate
from kanegen.program.ir import Module, Program
from kanegen.recursion import methods
from kanegen.recursion.derivation import ARTICULATED
from kanegen.recursion.derivative_costs import may_cost_less
from kanegen.recursion.legend import legend
from kanegen.recursion.outputs import SOLUTION_BY_STATE, SOLUTION_PARTS, prerequisites
from tests.support import systems
from tests.support.cases import slow_except
from tests.support.complex_steps import STEP, dynamics, state
from tests.support.derived_ways import agree, inputs_of
from tests.support.orientation_trees import close, values

NAME = "forward_dynamics_derivatives"


def request_of(system: kg.System) -> tuple[Request, Candidate]:
    """Return the request for the derivatives, and a candidate."""
    request = accept(system, (NAME,), STRICT)
    return request, condition(request)[0]


@cache
def by_articulated_bodies(system: kg.System) -> Module:
    """Return the programs by articulated bodies, whether they cost less or not."""
    request, first = request_of(system)
    own = {"forward_dynamics": ARTICULATED, SOLUTION_BY_STATE: ARTICULATED}
    return compile_candidate(request, replace(first, methods=own)).module


def ways(system: kg.System, name: str) -> tuple[Module, Module]:
    """Return these programs, and those by tangents of the solver alone."""
    assert name == NAME
    request, first = request_of(system)
    tangents = replace(first, methods={"forward_dynamics": ARTICULATED})
    return by_articulated_bodies(system), compile_candidate(request, tangents).module


def drawn(seed: int, bodies: int = 4) -> kg.System:
    """Return a random tree of hinges and slides, several at some joints, with all that this way takes.

    That is motors, loads on bodies, force elements along freedoms, and, for odd seeds, prescribed motion.
    """
    rng = np.random.default_rng([seed, 27])
    free = systems.random_free(rng, bodies, 0.4)
    free[0] = np.eye(6, dtype=bool)[rng.integers(6)]
    free[free[:, :3].all(axis=1), 1] = False
    free[free[:, 3:].all(axis=1), 4] = False
    armature = rng.uniform(0.1, 1.0, (bodies, 6)) * (rng.random((bodies, 6)) < 0.3)
    system = systems.random_system(rng, bodies, free=free, loads=True, armature=armature)
    a, b, *_ = rng.permutation(system.freedom_names)
    if seed % 2:
        moved = rng.permutation(system.freedom_names)[: len(system.freedoms) // 3]
        system = system.with_prescribed([str(name) for name in moved])
    return system.with_force_elements(
        JointSpring(str(a), 1.2, 0.3, 0.4),
        Drive(str(b), parse(f"sin(x.{a})*cos(t) - y.{a}*abs(x.{b})")),
        Potential(parse(f"cos(x.{a} - 2*x.{b})*x.{a}**2")),
    )


@pytest.mark.parametrize("seed", slow_except(range(24), 5))
def test_random_trees(seed: int) -> None:
    """The same numbers and conditions as tangents of the solver, to the rounding of constants."""
    agree(drawn(seed), NAME, seed, 1e-12, ways)


@pytest.mark.parametrize("seed", slow_except(range(6)))
def test_random_chains(seed: int) -> None:
    rng = np.random.default_rng([seed, 3])
    free = np.eye(6, dtype=bool)[rng.integers(6, size=6)]
    system = systems.random_system(rng, 6, connection=range(6), free=free, orientations=bool(seed % 2))
    agree(system, NAME, seed, 1e-12, ways)


def test_branches_on_a_moving_trunk() -> None:
    """Freedoms in two branches of a trunk accelerate each other, and two trees on the ground do not."""
    rng = np.random.default_rng(4)
    free = np.eye(6, dtype=bool)[[0, 1, 2, 4, 3]]
    system = systems.random_system(rng, 5, connection=(0, 1, 1, 2, 0), free=free)
    agree(system, NAME, 4, 1e-12, ways)


@pytest.mark.slow
def test_a_long_chain_against_complex_steps() -> None:
    """Of 13 hinges and slides with loads, by the way that costs least, through the NumPy reference."""
    rng = np.random.default_rng(13)
    free = np.eye(6, dtype=bool)[[0, 1, 2, 0, 5, 1, 2, 0, 1, 2, 3, 0, 1]]
    system = systems.random_system(rng, 13, connection=range(13), free=free, loads=True, locked=False)
    inputs = state(system, 2)
    columns = []
    for array in ("x", "y", "tau"):
        for k in range(13):
            moved = inputs[array].astype(complex)
            moved[k] += 1j * STEP
            changed = inputs | {array: moved}
            matrix, forcing = dynamics(system, changed)
            columns.append(np.linalg.solve(matrix, forcing + changed["tau"]).imag / STEP)
    close(values(system, inputs, NAME)[NAME], np.stack(columns, axis=1), 1e-11)


def exact_and_errors(program: Program, given: dict[str, list[float]]) -> tuple[np.ndarray, np.ndarray]:
    """Return the norms of the columns, and those of their errors in doubles."""
    (rounded,) = evaluate(program, given, np, np.float64).values()
    with mpmath.workdps(50):
        inputs = {key: [mpmath.mpf(v) for v in row] for key, row in given.items()}
        (exact,) = evaluate(program, inputs, mpmath, mpmath.mpf).values()
        errors = [float(a - mpmath.mpf(float(b))) for a, b in zip(exact, rounded, strict=True)]
    n = program.outputs[0].array.shape[0]
    sizes, wrong = (np.array(v, dtype=float).reshape(n, -1) for v in (exact, errors))
    return np.linalg.norm(sizes, axis=0), np.linalg.norm(wrong, axis=0)


@pytest.mark.parametrize("links", slow_except((1, 2), 1))
def test_errors_are_no_larger_than_those_by_columns(links: int) -> None:
    """Also where pivots are small and nothing but light links is affected, and next to {x} = {0}."""
    system = models.revolute_chain(5)
    inertia = (1.0e-9, 0.0, 0.0), (0.0, 1.2e-9, 0.0), (0.0, 0.0, 1.4e-9)
    light = [replace(one, mass=1e-6, inertia=inertia) for one in system.bodies[5 - links :]]
    system = replace(system, bodies=(*system.bodies[: 5 - links], *light))
    request, first = request_of(system)
    assert SOLUTION_PARTS in first.methods
    both = by_articulated_bodies(system), compile_candidate(request, first).module
    for distance in (1.0, 1e-4):
        largest = []
        for module in both:
            (program,) = module.functions.values()
            given = {key: [float(v) for v in row] for key, row in inputs_of(module, system, 3).items()}
            given["x"] = [distance * value for value in given["x"]]
            sizes, errors = exact_and_errors(program, given)
            largest.append(max(errors / sizes))
        assert largest[0] <= 2 * largest[1] < 1e-12


@pytest.mark.parametrize("links", [11, 12, 20, 32])
def test_long_chains_are_derived_both_ways(links: int) -> None:
    system = models.revolute_chain(links)
    found = methods(system, prerequisites((NAME,), system), ARTICULATED)
    assert [(SOLUTION_PARTS in way, SOLUTION_BY_STATE in way) for way in found] == [
        (True, False),
        (False, True),
    ]


@pytest.mark.parametrize("links", [6, 8, 64, 256])
def test_short_chains_and_those_that_need_loops_are_derived_one_way(links: int) -> None:
    assert not may_cost_less(models.revolute_chain(links))


def pendulum(links: int) -> kg.System:
    """Return a chain of hinges about parallel axes."""
    free, arm = np.eye(6, dtype=bool)[[2] * links], [[0.2, 0.0, 0.0]] * links
    inertia = np.tile(np.diag([0.1, 0.12, 0.14]), (links, 1, 1))
    return kg.System.from_arrays(
        range(links), np.ones(links), inertia, mass_center=arm, joint_position=arm, free=free
    )


def test_hinges_about_parallel_axes_win_early() -> None:
    assert [may_cost_less(pendulum(links)) for links in (2, 4, 5, 8)] == [False, False, True, True]
    functions = compile_module(pendulum(6), (NAME,)).module.functions
    counts = count(functions[NAME])
    assert sum(counts[kind] for kind in ("add", "multiply", "divide")) == 1371


def test_what_this_way_lacks_is_derived_the_other_way() -> None:
    """Floating bases, three angles at a joint, parameters, loads on points, derivatives by inputs beside."""
    chain = models.revolute_chain(12)
    assert may_cost_less(chain)
    (first, *others) = chain.bodies
    floating = replace(first, joint=replace(first.joint, free=(True,) * 6))
    ball = replace(first, joint=replace(first.joint, free=(True, True, True, False, False, False)))
    heavy = replace(first, mass=kg.Parameter("load", 1.0))
    loaded = replace(first, points=(kg.Point("tip", (0.1, 0.0, 0.0), loads=True),))
    for one in (floating, ball, heavy, loaded):
        assert not may_cost_less(replace(chain, bodies=(one, *others)))
    acted = replace(chain, bodies=(replace(first, loads=True), *others))
    both = prerequisites((NAME, "forward_dynamics_input_derivatives"), acted)
    assert SOLUTION_PARTS in both and SOLUTION_BY_STATE not in both
    assert SOLUTION_BY_STATE in prerequisites((NAME,), acted)


@pytest.mark.parametrize(("links", "operations"), [(4, 2517), pytest.param(8, 8698, marks=pytest.mark.slow)])
def test_operations_by_articulated_bodies(links: int, operations: int) -> None:
    """`test_solution_derivatives` has those of chains for which this way is taken."""
    (program,) = by_articulated_bodies(models.revolute_chain(links)).functions.values()
    counts = count(program)
    assert sum(counts[kind] for kind in ("add", "multiply", "divide")) == operations


def test_every_name_has_a_meaning() -> None:
    programs = by_articulated_bodies(drawn(5)).functions.values()
    names = {instruction.name for program in programs for instruction in program.instructions}
    assert legend(names - {""}).unknown == ()
