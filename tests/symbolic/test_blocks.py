"""The eight-body example in blocks, compared with every row that the notes print."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from kanegen.model.system import System
from kanegen.reference import kinematics
from kanegen.reference.freedoms import free_columns
from kanegen.reference.kinematics import BodyKinematics
from kanegen.symbolic import notation
from kanegen.symbolic.printing.block_terms import Factor, Kind, Product, Row, Sum, Term
from kanegen.symbolic.printing.blocks import Blocks
from tests.support.rows_of_the_notes import (
    ANGULAR,
    ANGULAR_RATE,
    CENTER,
    ORIGIN,
    POSITIONS,
    VELOCITY_G8,
    VELOCITY_O8,
)
from tests.support.systems import eight_body, random_system

Floats = NDArray[np.float64]

EIGHT = Blocks(eight_body())


@pytest.mark.parametrize("k", ANGULAR)
def test_angular_rows(k: int) -> None:
    assert EIGHT.partial_angular_velocity(k).text() == ANGULAR[k]
    assert EIGHT.partial_angular_velocity_rate(k).lines() == ANGULAR_RATE[k]


@pytest.mark.parametrize("k", POSITIONS)
def test_positions(k: int) -> None:
    assert EIGHT.position_of_center(k).text() == POSITIONS[k]


def test_velocities_of_body_8() -> None:
    assert EIGHT.velocity_of_origin(8).text() == VELOCITY_O8
    assert EIGHT.velocity_of_center(8).text() == VELOCITY_G8


@pytest.mark.parametrize("k", ORIGIN)
def test_translational_rows_of_origins(k: int) -> None:
    assert EIGHT.partial_velocity_of_origin(k).lines() == ORIGIN[k]


@pytest.mark.parametrize("k", CENTER)
def test_translational_rows_of_mass_centers(k: int) -> None:
    assert EIGHT.partial_velocity_of_center(k).lines() == CENTER[k]


def test_latex() -> None:
    assert notation.latex(EIGHT.partial_angular_velocity(2).text()) == (
        r"[[{}^{1}R_{2}][\hat{P}_{1}], [\hat{P}_{2}], [0], [0], [0], [0], [0], [0]]"
    )
    assert [notation.latex(line) for line in EIGHT.partial_velocity_of_origin(2).lines()] == [
        r"[R_{1}][[0]_{3\times 24}, [I], [0], [0], [0], [0], [0], [0], [0]]",
        r"- ([\tilde{q}'_{2}]+[\tilde{s}'_{2}])"
        r"[[\hat{P}_{1}], [0], [0], [0], [0], [0], [0], [0], [0]_{3\times 24}]",
        r"+ [[0]_{3\times 24}, [0], [I], [0], [0], [0], [0], [0], [0]]",
    ]


def value(term: Term | None, bodies: tuple[BodyKinematics, ...], system: System) -> Any:
    """Return the matrix or column that a term stands for, with the numbers of the reference."""
    match term:
        case None:
            return np.zeros((3, 3))
        case Sum():
            return sum(sign * value(part, bodies, system) for sign, part in term.terms)
        case Product():
            result: Any = np.eye(3)
            for factor in term.factors:
                result = result @ value(factor, bodies, system)
            return result
        case Row():
            return np.hstack([value(block, bodies, system) for block in term.blocks])
        case Factor():
            return _factor(term, bodies[term.body - 1], system, term.body - 1)


def _factor(factor: Factor, body: BodyKinematics, system: System, k: int) -> Any:
    arrays = system.values()
    joint, skew = arrays.joint_orientation[k], kinematics.skew
    return {
        Kind.ROTATION: body.relative_rotation,
        Kind.ROTATION_FROM_GROUND: body.relative_rotation,
        Kind.ANGLE_RATE_MATRIX: body.rate_matrix,
        Kind.ANGLE_RATE_MATRIX_RATE: body.rate_matrix_dot,
        Kind.RELATIVE_OMEGA_TILDE_T: skew(body.relative_omega).T,
        Kind.OMEGA_TILDE_T: skew(body.relative_omega).T,
        Kind.OMEGA_TILDE: skew(body.omega),
        Kind.OFFSET_TILDE: skew(body.offset),
        Kind.OFFSET_RATE_TILDE: skew(body.offset_dot),
        Kind.MASS_CENTER_TILDE: skew(arrays.mass_center[k]),
        Kind.IDENTITY: np.eye(3),
        Kind.JOINT_ORIENTATION_T: joint.T,
        Kind.JOINT_POSITION: arrays.joint_position[k],
        Kind.TRANSLATION: joint @ (body.offset - arrays.joint_position[k]),
        Kind.TRANSLATION_RATE: joint @ body.offset_dot,
        Kind.MASS_CENTER: arrays.mass_center[k],
    }[factor.kind]


@pytest.mark.parametrize(
    "system",
    [eight_body(), *(random_system(np.random.default_rng(seed), 5) for seed in range(3))],
    ids=["eight", "turned 0", "turned 1", "turned 2"],
)
def test_numbers_in_the_blocks_give_the_matrices(system: System) -> None:
    arrays = system.values()
    x, y = np.random.default_rng(7).uniform(-1, 1, (2, len(system.freedoms)))
    bodies = kinematics.kinematics(arrays, x, y)
    free = free_columns(arrays)
    half, blocks = 3 * system.number_of_bodies, Blocks(system)
    for k, body in enumerate(bodies, start=1):
        comparisons = [
            (blocks.position_of_center(k), body.center_position),
            (blocks.velocity_of_center(k), body.center_velocity),
            (blocks.partial_angular_velocity(k), body.omega_y[:, :half]),
            (blocks.partial_angular_velocity_rate(k), body.omega_y_dot[:, :half]),
            (blocks.partial_velocity_of_origin(k), body.origin_y),
            (blocks.partial_velocity_of_origin_rate(k), body.origin_y_dot),
            (blocks.partial_velocity_of_center(k), body.center_y),
            (blocks.partial_velocity_of_center_rate(k), body.center_y_dot),
        ]
        for term, expected in comparisons:
            columns = free[: expected.shape[-1]] if expected.ndim == 2 else slice(None)
            found = np.broadcast_to(value(term, bodies, system), expected.shape)
            assert np.abs(found[..., columns] - expected[..., columns]).max(initial=0.0) < 1e-13
