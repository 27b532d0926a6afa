"""Plans of solutions in loops over columns: their values against NumPy, their operations, and their zeros."""

from __future__ import annotations

import numpy as np
import pytest

from kanegen.program.builder import Builder
from kanegen.program.check import check
from kanegen.program.columns import ColumnSolution, column_solution
from kanegen.program.count import count
from kanegen.program.elimination import Elimination
from kanegen.program.evaluate import evaluate
from kanegen.program.expand import expanded
from kanegen.program.ir import Array, Output, Program

ROWS = 9


def tree(seed: int, rows: int = ROWS) -> dict[int, list[int]]:
    """Return the rows inward of each row of a random tree, in the order of elimination."""
    rng = np.random.default_rng(seed)
    inward: list[list[int]] = []
    for row in range(rows):
        lower = int(rng.integers(max(-1, row - 3), row))
        inward.append([*inward[lower], lower] if lower >= 0 else [])
    return {row: inward[row] for row in reversed(range(rows))}


def matrix_of(carriers: dict[int, list[int]], rng: np.random.Generator) -> np.ndarray:
    """Return a positive definite matrix that links the rows of each path and no others."""
    found = np.zeros((ROWS, ROWS))
    for row, inward in carriers.items():
        path = [*inward, row]
        entries = rng.uniform(-1, 1, (len(path), len(path)))
        found[np.ix_(path, path)] += entries @ entries.T + np.eye(len(path))
    return found


def solved(seed: int, *, units: bool) -> tuple[Program, ColumnSolution, np.ndarray, np.ndarray]:
    """Return a program that solves for random columns, its plan, and the matrix and the columns {b}."""
    rng, carriers = np.random.default_rng([seed, 1]), tree(seed)
    matrix = matrix_of(carriers, rng)
    dense = rng.uniform(-1, 1, (ROWS, 7))
    right = dense * (rng.random((ROWS, 7)) < rng.choice([0.1, 0.6, 1.0], 7))
    array = Array("matrix", matrix.shape, "1", "matrix"), Array("right", right.shape, "1", "columns")
    builder = Builder(array)
    entries = {
        (i, j): builder.input("matrix", ROWS * i + j)
        for i in range(ROWS)
        for j in range(i + 1)
        if matrix[i, j]
    }
    elimination = Elimination.of_matrix(builder, entries, carriers, builder.constant(1.0))
    columns = {
        c: {r: builder.input("right", 7 * r + c) for r in range(ROWS) if right[r, c]} for c in range(7)
    }
    unit_columns = slice(7, 7 + ROWS) if units else slice(0, 0)
    plan = column_solution(elimination.carriers, columns, unit_columns)
    values = elimination.values_of(plan, columns, builder.constant(0.0))
    width = 7 + ROWS * units
    output = Output(Array("z", (ROWS, width), "1", "solution"), values, solution=plan)
    if units:
        right = np.hstack([right, -np.eye(ROWS)])
    return check(builder.program([output])), plan, matrix, right


def result(program: Program, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the solution that the instructions compute."""
    inputs = {"matrix": list(matrix.ravel()), "right": list(right[:, :7].ravel())}
    return np.array(evaluate(program, inputs, np)["z"]).reshape(right.shape)


@pytest.mark.parametrize("units", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_the_solution_is_that_of_numpy(seed: int, units: bool) -> None:
    program, _, matrix, right = solved(seed, units=units)
    wanted = np.linalg.solve(matrix, -right)
    found = result(program, matrix, right)
    assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()  # [A] has a condition below 1e3
    assert not found[np.abs(wanted) < 1e-15].any()  # what vanishes by structure is not computed


@pytest.mark.parametrize("seed", range(8))
def test_columns_of_the_inverse_are_symmetric_to_the_bit(seed: int) -> None:
    program, plan, matrix, right = solved(seed, units=True)
    inverse = result(program, matrix, right)[:, 7:]
    for i, j in plan.mirrored:
        assert inverse[i, j] == inverse[j, i]


@pytest.mark.parametrize("seed", range(8))
def test_every_pass_of_a_loop_is_counted(seed: int) -> None:
    """Straight-line code has no more operations: it leaves out those on zeros of rows that columns share."""
    program, plan, _, _ = solved(seed, units=True)
    straight, loops = count(expanded(program)), count(program)
    passes = 0
    for group in plan.groups:
        for _ in group.columns:
            passes += len(group.reduced)
            passes += 2 * sum(len(plan.carriers[k]) for k in (*group.reduced, *group.solved))
    assert sum(plan.operations.values()) == passes
    assert straight["divide"] == loops["divide"] == ROWS
    assert all(straight[kind] <= loops[kind] for kind in straight)


def test_half_of_the_inverse_is_copied() -> None:
    """On a chain, but for the elements of columns that are solved together."""
    plan = column_solution({row: list(range(row)) for row in reversed(range(64))}, {}, slice(0, 64))
    assert 0.8 * 64 * 63 / 2 < len(plan.mirrored) < 64 * 63 / 2


def test_columns_without_common_zeros_have_the_same_operations_in_loops() -> None:
    """On a chain all rows are related; only subtractions from zero are no operation of straight-line code."""
    carriers = {row: list(range(row)) for row in reversed(range(ROWS))}
    plan = column_solution(carriers, {column: range(ROWS) for column in range(12)})
    (group,) = plan.groups
    assert group.columns == tuple(range(12)) and len(group.reduced) == len(group.solved) == ROWS
    assert sum(plan.operations.values()) == 12 * (ROWS + 4 * ROWS * (ROWS - 1) // 2)


def test_columns_of_other_branches_are_not_computed() -> None:
    """Two chains that nothing links, a column for each."""
    carriers = {3: [2], 2: [], 1: [0], 0: []}
    plan = column_solution(carriers, {0: [0], 1: [3]})
    assert [(one.columns, set(one.solved)) for one in plan.groups] == [((1,), {2, 3}), ((0,), {0, 1})]
