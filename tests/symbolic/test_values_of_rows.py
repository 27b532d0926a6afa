"""Rows in blocks that refer to the lower body hold for the numbers of the reference."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from kanegen.model.system import System
from kanegen.reference import equations as reference
from kanegen.reference import kinematics
from kanegen.reference.freedoms import free_columns, full_order
from kanegen.symbolic import derive
from kanegen.symbolic.printing.block_rows import BodyRows
from kanegen.symbolic.printing.statements import BlockStatement
from tests.support.systems import eight_body, random_free, random_system

TOKEN = re.compile(r"\[[^\[\]]*\](?:\^T)?|\{[^{}]*\}|m_\d+|[()+-]")


def evaluated(text: str, values: dict[str, Any]) -> Any:
    """The value of a sum of products in the notation of the notes."""
    tokens = TOKEN.findall(text)
    assert text == "0" or "".join(tokens) == text.replace(" ", "")
    return _sum(iter([*tokens, ")"]), values)


def _sum(tokens: Iterator[str], values: dict[str, Any]) -> Any:
    whole, sign, product = 0.0, 1.0, None
    for token in tokens:
        if token in "+-)":
            whole = whole if product is None else whole + sign * product
            sign, product = (-1.0 if token == "-" else 1.0), None
            if token == ")":
                return whole
            continue
        factor = _sum(tokens, values) if token == "(" else _value(token, values)
        scalar = np.ndim(factor) == 0 or np.ndim(product) == 0
        product = factor if product is None else product * factor if scalar else product @ factor
    raise AssertionError("a parenthesis is open")


def _value(token: str, values: dict[str, Any]) -> Any:
    if token not in values and token.endswith("^T"):
        return values[token.removesuffix("^T")].T
    return values[token]


def numbers_of_rows(system: System, rng: np.random.Generator) -> tuple[dict[str, Any], Any, Any]:
    """Values by symbol in a random state, the reference's [A] and {f}."""
    arrays, count, skew = system.values(), system.number_of_bodies, kinematics.skew
    x, y = rng.uniform(-1, 1, (2, len(system.freedoms)))
    force, torque = rng.uniform(-1, 1, (2, count, 3)) * arrays.loads[:, None]
    bodies = kinematics.kinematics(arrays, x, y)
    speeds = full_order(arrays, y, np.zeros(0))
    values: dict[str, Any] = {"{y}": speeds, "{y_1}": speeds[: 3 * count], "{g}": arrays.gravity}
    for k, body in enumerate(bodies, start=1):
        j, C = arrays.connection[k - 1], arrays.joint_orientation[k - 1]
        q, r = arrays.joint_position[k - 1], arrays.mass_center[k - 1]
        relative, relative_rate = np.zeros((2, 3, 3 * count))
        own = slice(3 * k - 3, 3 * k)
        relative[:, own], relative_rate[:, own] = body.rate_matrix, body.rate_matrix_dot
        sliding = np.zeros((3, 6 * count))
        sliding[:, 3 * count + 3 * k - 3 : 3 * count + 3 * k] = C.T
        half = slice(3 * count)
        values |= {
            f"[^{j}R_{k}]": body.relative_rotation,
            f"[R_{k}]": body.rotation,
            f"{{ω'_{k}}}": body.omega,
            f"{{ω̂'_{k}}}": body.relative_omega,
            f"[^{j}ω̃'_{k}]": skew(body.relative_omega),
            f"[ω̃'_{k}]": skew(body.omega),
            f"[P̂_{k}]": body.rate_matrix,
            f"{{θ̂̇_{k}}}": speeds[own],
            f"[ω̂'_{k},y1]": relative,
            f"[ω̂̇'_{k},y1]": relative_rate,
            f"[ω'_{k},y1]": body.omega_y[:, half],
            f"[ω̇'_{k},y1]": body.omega_y_dot[:, half],
            f"[ω'_{k},y]": body.omega_y,
            f"[ω̇'_{k},y]": body.omega_y_dot,
            f"[C_{k}]": C,
            f"{{q'_{k}}}": q,
            f"{{s'_{k}}}": C @ (body.offset - q),
            f"{{ṡ'_{k}}}": C @ body.offset_dot,
            f"{{r'_{k}}}": r,
            f"[q̃'_{k}]": skew(q),
            f"[s̃'_{k}]": skew(body.offset - q),
            f"[ṡ̃'_{k}]": skew(body.offset_dot),
            f"[r̃'_{k}]": skew(r),
            f"{{p'_O{k}}}": body.position,
            f"{{p'_G{k}}}": body.center_position,
            f"{{v'_O{k}}}": body.origin_y @ speeds,
            f"{{v'_G{k}}}": body.center_velocity,
            f"[^{j or 'R'}v'_O{k},y]": sliding,
            f"[v'_O{k},y]": body.origin_y,
            f"[v̇'_O{k},y]": body.origin_y_dot,
            f"[v'_G{k},y]": body.center_y,
            f"[v̇'_G{k},y]": body.center_y_dot,
            f"m_{k}": arrays.mass[k - 1],
            f"[I'_G{k}]": arrays.inertia[k - 1],
            f"{{F'_{k}}}": force[k - 1],
            f"{{M'_{k}}}": torque[k - 1],
        }
    A, f = reference.mass_matrix(system, x), reference.forcing(system, x, y, force, torque)
    return values, A, f


def systems() -> list[System]:
    rng = np.random.default_rng(5)
    drawn = [random_system(rng, 4, free=random_free(rng, 4, 0.6), loads=True) for _ in range(4)]
    return [eight_body(), *drawn]


@pytest.mark.parametrize("system", systems(), ids=["eight", "0", "1", "2", "3"])
def test_rows_by_the_lower_body_hold(system: System) -> None:
    values, A, f = numbers_of_rows(system, np.random.default_rng(3))
    free = free_columns(system.values())
    equations = derive(system, intermediates=True)
    checked: set[str] = set()
    whole_A, whole_f = np.zeros((len(free), len(free))), np.zeros(len(free))
    for k in range(1, system.number_of_bodies + 1):
        for row in BodyRows(equations, k, {}).rows():
            if not isinstance(row, BlockStatement) or "], [" in " ".join(row.forms[0]):
                continue
            if row.name.startswith(("{F_y", "[A_", "{f_")):
                found = evaluated(" ".join(row.forms[0]), values)
                values[row.name] = found
                whole_A = whole_A + found if row.name.startswith("[A_") else whole_A
                whole_f = whole_f + found if row.name.startswith("{f_") else whole_f
            elif row.name in values:
                found, expected = evaluated(row.forms[0][0], values), values[row.name]
                columns = free[: len(expected.T)] if len(expected.T) > 3 else slice(None)
                difference = np.abs((found - expected)[..., columns]).max(initial=0.0)
                assert difference < 1e-12, row.name  # a few products of numbers of the size of 1
                checked |= numbers(row.number)
    bound = 1e-11 * max(np.abs(A).max(), np.abs(f).max())  # rounding of the sums over all bodies
    assert np.abs(whole_A[np.ix_(free, free)] - A).max() < bound
    assert np.abs(whole_f[free] - f).max() < bound
    assert not any(system.connection) or 5 in checked
    assert {11, 15, 19, 20, 22, 23, 25, 27, 28, 32, 34, 35} <= checked


def numbers(text: str) -> set[int]:
    """The last numbers of the ranges in a label such as (12)-(15)."""
    return {int(number) for number in re.findall(r"\((\d+)\)", text)}
