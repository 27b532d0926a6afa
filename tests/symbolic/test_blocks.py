"""The eight-body example in blocks, compared with every row that the notes print, transcribed by hand.

The transcription corrects the errata of the notes. A half of {y} has exactly eight blocks, where the print
has up to ten;
[0]_{3x24} is a half of zeros. In the rows of bodies 7 and 8 the print has lost the brackets that end a block:
[^1R_7] stands in front of [P_1] alone, and [^7R_8] in front of [P_7].
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from kanegen.model.system import System
from kanegen.reference import kinematics
from kanegen.reference.freedoms import free_columns
from kanegen.reference.kinematics import BodyKinematics
from kanegen.symbolic.printing.block_terms import Factor, Kind, Product, Row, Sum, Term
from kanegen.symbolic.printing.blocks import Blocks
from tests.support.systems import eight_body, random_system

Floats = NDArray[np.float64]

EIGHT = Blocks(eight_body())

ANGULAR = {
    1: "[[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
    2: "[[^1R_2][P̂_1], [P̂_2], [0], [0], [0], [0], [0], [0]]",
    3: "[[^2R_3][^1R_2][P̂_1], [^2R_3][P̂_2], [P̂_3], [0], [0], [0], [0], [0]]",
    4: "[[^2R_4][^1R_2][P̂_1], [^2R_4][P̂_2], [0], [P̂_4], [0], [0], [0], [0]]",
    5: "[[^1R_5][P̂_1], [0], [0], [0], [P̂_5], [0], [0], [0]]",
    6: "[[^1R_6][P̂_1], [0], [0], [0], [0], [P̂_6], [0], [0]]",
    7: "[[^1R_7][P̂_1], [0], [0], [0], [0], [0], [P̂_7], [0]]",
    8: "[[^7R_8][^1R_7][P̂_1], [0], [0], [0], [0], [0], [^7R_8][P̂_7], [P̂_8]]",
}
"""[omega'_K,y1] by body, in plain text."""

ANGULAR_RATE = {
    1: ["[[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]"],
    2: [
        "[^1R_2][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^1ω̃'_2]^T[^1R_2][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [[0], [Ṗ̂_2], [0], [0], [0], [0], [0], [0]]",
    ],
    3: [
        "[^2R_3][^1R_2][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^2R_3][^1ω̃'_2]^T[^1R_2][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^2R_3][[0], [Ṗ̂_2], [0], [0], [0], [0], [0], [0]]",
        "+ [^2ω̃'_3]^T[^2R_3][[^1R_2][P̂_1], [P̂_2], [0], [0], [0], [0], [0], [0]]",
        "+ [[0], [0], [Ṗ̂_3], [0], [0], [0], [0], [0]]",
    ],
    4: [
        "[^2R_4][^1R_2][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^2R_4][^1ω̃'_2]^T[^1R_2][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^2R_4][[0], [Ṗ̂_2], [0], [0], [0], [0], [0], [0]]",
        "+ [^2ω̃'_4]^T[^2R_4][[^1R_2][P̂_1], [P̂_2], [0], [0], [0], [0], [0], [0]]",
        "+ [[0], [0], [0], [Ṗ̂_4], [0], [0], [0], [0]]",
    ],
    5: [
        "[^1R_5][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^1ω̃'_5]^T[^1R_5][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [[0], [0], [0], [0], [Ṗ̂_5], [0], [0], [0]]",
    ],
    6: [
        "[^1R_6][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^1ω̃'_6]^T[^1R_6][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [[0], [0], [0], [0], [0], [Ṗ̂_6], [0], [0]]",
    ],
    7: [
        "[^1R_7][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^1ω̃'_7]^T[^1R_7][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [[0], [0], [0], [0], [0], [0], [Ṗ̂_7], [0]]",
    ],
    8: [
        "[^7R_8][^1R_7][[Ṗ̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^7R_8][^1ω̃'_7]^T[^1R_7][[P̂_1], [0], [0], [0], [0], [0], [0], [0]]",
        "+ [^7R_8][[0], [0], [0], [0], [0], [0], [Ṗ̂_7], [0]]",
        "+ [^7ω̃'_8]^T[^7R_8][[^1R_7][P̂_1], [0], [0], [0], [0], [0], [P̂_7], [0]]",
        "+ [[0], [0], [0], [0], [0], [0], [0], [Ṗ̂_8]]",
    ],
}
"""Terms of the time derivative of [omega'_K,y1] by body."""

POSITIONS = {
    1: "[R_1]{s'_1} + {r'_1}",
    2: "[^1R_2]([R_1]{s'_1} + {q'_2} + {s'_2}) + {r'_2}",
    3: "[^2R_3]([^1R_2]([R_1]{s'_1} + {q'_2} + {s'_2}) + {q'_3} + {s'_3}) + {r'_3}",
    4: "[^2R_4]([^1R_2]([R_1]{s'_1} + {q'_2} + {s'_2}) + {q'_4} + {s'_4}) + {r'_4}",
    5: "[^1R_5]([R_1]{s'_1} + {q'_5} + {s'_5}) + {r'_5}",
    6: "[^1R_6]([R_1]{s'_1} + {q'_6} + {s'_6}) + {r'_6}",
    7: "[^1R_7]([R_1]{s'_1} + {q'_7} + {s'_7}) + {r'_7}",
    8: "[^7R_8]([^1R_7]([R_1]{s'_1} + {q'_7} + {s'_7}) + {q'_8} + {s'_8}) + {r'_8}",
}
"""Position {p'_GK} of the mass centre by body."""

VELOCITY_O8 = "[^1R_7]([R_1]{ṡ'_1} + {ṡ'_7} + [ω̃'_1]({q'_7} + {s'_7})) + {ṡ'_8} + [ω̃'_7]({q'_8} + {s'_8})"
VELOCITY_G8 = f"[^7R_8]({VELOCITY_O8}) + [ω̃'_8]{{r'_8}}"

I1 = "[[0]_{3x24}, [I], [0], [0], [0], [0], [0], [0], [0]]"
I2 = "[[0]_{3x24}, [0], [I], [0], [0], [0], [0], [0], [0]]"
I3 = "[[0]_{3x24}, [0], [0], [I], [0], [0], [0], [0], [0]]"
I4 = "[[0]_{3x24}, [0], [0], [0], [I], [0], [0], [0], [0]]"
I7 = "[[0]_{3x24}, [0], [0], [0], [0], [0], [0], [I], [0]]"
I8 = "[[0]_{3x24}, [0], [0], [0], [0], [0], [0], [0], [I]]"
W1 = "[[P̂_1], [0], [0], [0], [0], [0], [0], [0], [0]_{3x24}]"
W2 = "[[^1R_2][P̂_1], [P̂_2], [0], [0], [0], [0], [0], [0], [0]_{3x24}]"
W3 = "[[^2R_3][^1R_2][P̂_1], [^2R_3][P̂_2], [P̂_3], [0], [0], [0], [0], [0], [0]_{3x24}]"
W7 = "[[^1R_7][P̂_1], [0], [0], [0], [0], [0], [P̂_7], [0], [0]_{3x24}]"
W8 = "[[^7R_8][^1R_7][P̂_1], [0], [0], [0], [0], [0], [^7R_8][P̂_7], [P̂_8], [0]_{3x24}]"

ORIGIN = {
    1: [I1],
    2: [f"[R_1]{I1}", f"- ([q̃'_2]+[s̃'_2]){W1}", f"+ {I2}"],
    3: [
        f"[^1R_2][R_1]{I1}",
        f"- [^1R_2]([q̃'_2]+[s̃'_2]){W1}",
        f"+ [^1R_2]{I2}",
        f"- ([q̃'_3]+[s̃'_3]){W2}",
        f"+ {I3}",
    ],
    4: [
        f"[^1R_2][R_1]{I1}",
        f"- [^1R_2]([q̃'_2]+[s̃'_2]){W1}",
        f"+ [^1R_2]{I2}",
        f"- ([q̃'_4]+[s̃'_4]){W2}",
        f"+ {I4}",
    ],
    7: [f"[R_1]{I1}", f"- ([q̃'_7]+[s̃'_7]){W1}", f"+ {I7}"],
    8: [
        f"[^1R_7][R_1]{I1}",
        f"- [^1R_7]([q̃'_7]+[s̃'_7]){W1}",
        f"+ [^1R_7]{I7}",
        f"- ([q̃'_8]+[s̃'_8]){W7}",
        f"+ {I8}",
    ],
}
"""Terms of [v'_OK,y] by body."""

CENTER = {
    1: [f"[R_1]{I1}", f"- [r̃'_1]{W1}"],
    2: [
        f"[^1R_2][R_1]{I1}",
        f"- [^1R_2]([q̃'_2]+[s̃'_2]){W1}",
        f"+ [^1R_2]{I2}",
        f"- [r̃'_2]{W2}",
    ],
    3: [
        f"[^2R_3][^1R_2][R_1]{I1}",
        f"- [^2R_3][^1R_2]([q̃'_2]+[s̃'_2]){W1}",
        f"+ [^2R_3][^1R_2]{I2}",
        f"- [^2R_3]([q̃'_3]+[s̃'_3]){W2}",
        f"+ [^2R_3]{I3}",
        f"- [r̃'_3]{W3}",
    ],
    7: [
        f"[^1R_7][R_1]{I1}",
        f"- [^1R_7]([q̃'_7]+[s̃'_7]){W1}",
        f"+ [^1R_7]{I7}",
        f"- [r̃'_7]{W7}",
    ],
    8: [
        f"[^7R_8][^1R_7][R_1]{I1}",
        f"- [^7R_8][^1R_7]([q̃'_7]+[s̃'_7]){W1}",
        f"+ [^7R_8][^1R_7]{I7}",
        f"- [^7R_8]([q̃'_8]+[s̃'_8]){W7}",
        f"+ [^7R_8]{I8}",
        f"- [r̃'_8]{W8}",
    ],
}
"""Terms of [v'_GK,y] by body."""


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
    assert EIGHT.partial_angular_velocity(2).latex() == (
        r"\left[[{}^{1}R_{2}][\hat{P}_{1}], [\hat{P}_{2}], [0], [0], [0], [0], [0], [0]\right]"
    )
    assert EIGHT.partial_velocity_of_origin(2).lines("latex") == [
        r"[R_{1}]\left[[0]_{3\times 24}, [I], [0], [0], [0], [0], [0], [0], [0]\right]",
        r"- ([\tilde{q}'_{2}]+[\tilde{s}'_{2}])"
        r"\left[[\hat{P}_{1}], [0], [0], [0], [0], [0], [0], [0], [0]_{3\times 24}\right]",
        r"+ \left[[0]_{3\times 24}, [0], [I], [0], [0], [0], [0], [0], [0]\right]",
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
