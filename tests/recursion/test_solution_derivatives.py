"""Derivatives of {ydot} from parts: against tangents of the solver in many digits, their errors and cost."""

from __future__ import annotations

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import kanegen as kg
from benchmarks import models
from kanegen.compiler import compile_module
from kanegen.lowering.accept import accept
from kanegen.lowering.conditioning import condition
from kanegen.options import STRICT
from kanegen.program.count import count
from kanegen.program.evaluate import evaluate
from kanegen.program.expand import expanded
from kanegen.program.ir import Op
from kanegen.recursion.outputs import SOLUTION_PARTS
from tests.support import prescribed_trees, random_trees
from tests.support.cases import slow_except
from tests.support.derived_ways import agree, inputs_of, modules
from tests.support.floating_trees import floating
from tests.support.systems import eight_body

NAME = "forward_dynamics_derivatives"


WITHIN = 1e-12
"""Share of the largest derivative: rounding of constants, which both ways have as doubles."""


@pytest.mark.parametrize("name", slow_except((NAME, "forward_dynamics_input_derivatives"), NAME))
@pytest.mark.parametrize("kind", slow_except(("angles", "angular velocity", "quaternion"), "quaternion"))
@pytest.mark.parametrize("seed", slow_except(range(4), 1))
def test_floating_bases(seed: int, kind: str, name: str) -> None:
    agree(floating(seed, kind), name, seed, WITHIN)


@pytest.mark.parametrize("kind", ["angles", "angular velocity", "quaternion"])
def test_one_floating_body(kind: str) -> None:
    """Whose mass centre is its origin for the solver; a spring along a freedom acts at O_K."""
    system = floating(5, kind)
    moor = (kg.JointSpring("b1.s1", stiffness=50.0, damping=0.4),)
    agree(replace(system, bodies=system.bodies[:1], force_elements=moor), NAME, 3, WITHIN)


@pytest.mark.parametrize("seed", slow_except(range(24), 4))
def test_random_trees_of_all_kinds(seed: int) -> None:
    """With force elements, loads on bodies and points, motors, rotors, couplings and parameters."""
    system = random_trees.everything(seed, bodies=3)
    (first, *_) = condition(accept(system, (NAME,), STRICT))
    if SOLUTION_PARTS in first.methods:
        agree(system, NAME, seed, WITHIN)


@pytest.mark.parametrize("kind", slow_except(("slides and hinges", "rates"), "slides and hinges"))
def test_prescribed_motion(kind: str) -> None:
    agree(prescribed_trees.tree(kind, 2), "forward_dynamics_input_derivatives", 2, WITHIN)


@pytest.mark.slow
def test_next_to_gimbal_lock_of_a_floating_base_no_digits_are_lost() -> None:
    """The angles of the base are those of its file; 2^11 roundoffs of a column, where the solver has 2^8."""
    system = floating(2, "angles")
    module, _ = modules(system, NAME)
    (program,) = module.functions.values()
    for distance in (1e-3, 1e-8):
        given = {key: [float(v) for v in values] for key, values in inputs_of(module, system, 7).items()}
        given["x"][1] = float(np.pi / 2 - distance)
        (rounded,) = evaluate(program, given, np, np.float64).values()
        with mpmath.workdps(60):
            exact_inputs = {key: [mpmath.mpf(v) for v in values] for key, values in given.items()}
            (exact,) = evaluate(program, exact_inputs, mpmath, mpmath.mpf).values()
            errors = [float(a - mpmath.mpf(float(b))) for a, b in zip(exact, rounded, strict=True)]
        error, size = (
            np.linalg.norm(np.array(v, dtype=float).reshape(len(system.freedoms), -1), axis=0)
            for v in (errors, exact)
        )
        assert (error[size > 0] < 2**11 * 2**-53 * size[size > 0]).all()


@pytest.mark.parametrize("system", [eight_body()], ids=["eight bodies"])
def test_several_floating_bodies_are_left_to_the_solver(system: kg.System) -> None:
    (way, *_) = condition(accept(system, (NAME,), STRICT))
    assert SOLUTION_PARTS not in way.methods


OPERATIONS = {
    "ur5": 2191,
    "panda": 5600,
    "go2": 19679,
    "hyq": 21458,
    "chain20": 37999,
    "talos_reduced": 103346,
}
"""Additions, multiplications and divisions of all derivatives of {ydot}, by robot."""


@pytest.mark.parametrize("name", slow_except(OPERATIONS, "ur5"))
def test_operations(name: str) -> None:
    program = compile_module(models.system(name), (NAME,)).module.functions[NAME]
    counts = count(program)
    assert sum(counts[kind] for kind in ("add", "multiply", "divide")) == OPERATIONS[name]


def test_the_pose_and_the_speed_of_a_floating_base_have_no_part_by_structure() -> None:
    """Its accelerations depend on its orientation through efforts alone, and never on where it is."""
    system = replace(floating(3, "angles"), force_elements=())
    program = expanded(compile_module(system, (NAME,)).module.functions[NAME])
    n, values = len(system.freedoms), program.outputs[0].values
    entries = [program.instructions[value] for value in values]
    zero = np.array([x.op is Op.CONSTANT and x.number == 0 for x in entries]).reshape(n, -1)
    moves = [i for freedom, i in system.places.items() if freedom.body == 1 and not freedom.is_angle]
    assert zero[:, moves].all()
    assert zero[:, [n + i for i in moves]].all()
